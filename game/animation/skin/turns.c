// Local rotations that no pose has: missing bones, outermost finger joints, eyes, twists of the forearms.
#include "rig.h"

static Quat about_x(float half) { return (Quat){sinf(half), 0, 0, cosf(half)}; }

static Quat about_y(float half) { return (Quat){0, sinf(half), 0, cosf(half)}; }

// A share of a rotation.
static Quat part(Quat q, float share) {
    float s = q.w < 0 ? -share : share;
    return normalized((Quat){s * q.x, s * q.y, s * q.z, s * q.w + 1 - share});
}

// A share of a rotation's twist about the x axis, along which forearms lie. most_half: cosine and sine of half of the
// largest twist.
static Quat twist(Quat q, float share, const float most_half[2]) {
    float size = sqrtf(q.x * q.x + q.w * q.w) + 1e-9f, cosine = fabsf(q.w), sine = q.w < 0 ? -q.x : q.x;
    if (cosine < most_half[0] * size) {
        cosine = most_half[0] * size;
        sine = copysignf(most_half[1] * size, sine);
    }
    return normalized((Quat){share * sine, 0, 0, share * cosine + (1 - share) * size});
}

// gaze: across (1: to the character's left) and up.
static Quat eye(const Eyes *eyes, int side, const float gaze[2]) {
    float x = clamp(gaze[0], -1, 1), y = clamp(gaze[1], -1, 1);
    return multiply(about_y(0.5f * x * eyes->yaw[side][x >= 0]), about_x(-0.5f * y * eyes->pitch[y >= 0]));
}

void local_turns(const Rig *rig, const float gaze[2]) {
    Quat *turn = rig->turn, *next = turn + rig->reference;
    Quat *twists = next + rig->tips + (rig->eyes ? 2 : 0);
    for (int i = 0; i < rig->twists; i++)
        twists[i] = twist(turn[rig->hand[i]], rig->twist_share, rig->most_half_twist);
    for (int i = 0; i < rig->folds; i++)
        turn[rig->fold[i].bone] = multiply(turn[rig->fold[i].above], turn[rig->fold[i].below]);
    for (int i = 0; i < rig->tips; i++)
        *next++ = part(turn[rig->tip[i]], rig->tip_share);
    for (int side = 0; rig->eyes && side < 2; side++)
        *next++ = eye(rig->eyes, side, gaze);
}
