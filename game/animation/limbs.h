// Two-bone inverse kinematics: arms to their hands, legs to their feet.
//
// The pose's own elbow and knee directions are kept: the limb is opened or closed about its present hinge and then
// swung to the target, so a target where the limb already ends changes nothing.
#pragma once

#include "geometry.h"

// How much of the rest hinge is added to the bent limb's own normal (metres, upper bone x direction), which vanishes in
// a straight limb.
static const float HINGE_WEIGHT_M = 1.5e-3f;

// As LIMB in game/animation/reach.py.
typedef struct {
    float upper_m, lower_m; // bone lengths
    float give_m, full_m;   // where the reach begins to give way, and what it comes to at most
    Vec3 hinge;             // the axis of the upper bone's frame about which a straight limb bends
} Limb;

// As far as the limb reaches, softly.
static inline float reached(const Limb *limb, float asked_m) {
    float room = limb->full_m - limb->give_m, over = asked_m - limb->give_m;
    float reach = over > 0 ? limb->give_m - room * expm1f(-over / room) : asked_m;
    return most(reach, fabsf(limb->upper_m - limb->lower_m) + 1e-3f);
}

// The turn about an axis by the difference of two angles of a triangle, given by their cosines.
static inline Quat turn_between(Vec3 axis, float before, float now) {
    float sine_before = sqrtf(1 - before * before), sine_now = sqrtf(1 - now * now);
    float cosine = now * before + sine_now * sine_before, sine = sine_now * before - now * sine_before;
    // Half the angle of (cosine, sine) lies half way between it and (1, 0).
    Vec3 v = scale(axis, sine);
    return normalized((Quat){v.x, v.y, v.z, most(1 + cosine, 1e-6f)});
}

// Brings the end of a limb to its goal. above: the turn of what the upper bone hangs on; upper, lower, end: the limb as
// it is; all in model space. local: the upper bone's, the lower bone's and the end's turns in their parents' frames.
static inline void place_limb(
    const Limb *limb, Quat above, const Rigid *upper, const Rigid *lower, const Rigid *end, const Rigid *goal,
    Quat local[3]) {
    Vec3 bone = sub(lower->place, upper->place), now = sub(end->place, upper->place);
    Vec3 way = sub(goal->place, upper->place);
    float reach_before = length(now) + 1e-6f, reach = length(way) + 1e-6f;

    // Opening leaves the end on the way where it was: what is left is to swing that way to the wanted one. Just above
    // 1: opposite directions leave a rotation to normalise.
    Vec3 swing_axis = cross(now, way);
    float swing_cosine = dot(now, way) + reach_before * reach * 1.0001f;
    Quat swing = normalized((Quat){swing_axis.x, swing_axis.y, swing_axis.z, swing_cosine});

    Vec3 hinge = rotate(upper->turn, scale(limb->hinge, HINGE_WEIGHT_M * reach_before));
    Vec3 normal = add(cross(now, bone), hinge);
    normal = scale(normal, 1 / most(length(normal), 1e-12f));

    // Law of cosines: the triangle's angles at root and joint, before and after.
    float a = limb->upper_m, b = limb->lower_m, root[2], joint[2];
    reach = reached(limb, reach);
    for (int after = 0; after < 2; after++) {
        float r = after ? reach : reach_before;
        root[after] = clamp((r * r + a * a - b * b) / (2 * a * r), -1, 1);
        joint[after] = clamp((a * a + b * b - r * r) / (2 * a * b), -1, 1);
    }
    Quat open = turn_between(normal, root[0], root[1]), bend = turn_between(normal, joint[0], joint[1]);

    Quat opened = multiply(swing, open);
    Quat new_upper = multiply(opened, upper->turn);
    Quat new_lower = multiply(opened, multiply(bend, lower->turn));
    local[0] = normalized(multiply(conjugate(above), new_upper));
    local[1] = normalized(multiply(conjugate(new_upper), new_lower));
    local[2] = normalized(multiply(conjugate(new_lower), goal->turn));
}
