// Hair and cloth: spring bones with the meaning that VRM gives them (VRMC_springBone 1.0), for steps of any length.
#include "rig.h"

static const int PASSES = 3;  // a piece leaves its colliders one after the other, deepest first, so often at most
static const float DEEP_M = 1e-5f;

void prepare_springs(const Rig *rig, float dt_s) {
    // VRM's step is a frame's, of 1/60 s: a longer one has the damping and the terminal velocity of that many.
    float steps = dt_s * 60.0f;
    for (int i = 0; i < rig->pieces; i++) {
        float keep = rig->piece[i].keep, kept = powf(keep, steps);
        rig->pull[i].kept_s = kept * dt_s;
        rig->pull[i].force = steps * (1 - kept) / most(1 - keep, 1e-4f) / 60.0f;
    }
}

static void place_capsules(const Rig *rig) {
    for (int i = 0; i < rig->colliders; i++) {
        const Collider *collider = &rig->collider[i];
        const Mat4 *model = &rig->model[collider->joint];
        Capsule *capsule = &rig->capsule[i];
        capsule->start = transform(model, collider->start);
        capsule->way = sub(transform(model, add(collider->start, collider->way)), capsule->start);
        capsule->square = most(dot(capsule->way, capsule->way), 1e-12f);
    }
}

// The tail at its piece's length from the head.
static Vec3 reach(Vec3 head, Vec3 tail, float length_m) {
    Vec3 way = sub(tail, head);
    return add(head, scale(way, length_m / (length(way) + 1e-9f)));
}

// The same along a collider's surface: among the points at the piece's length from the head the one in the plane of
// head, tail and collider that keeps the height over the collider which the push gained, where that is possible.
static Vec3 reach_outside(Vec3 head, Vec3 tail, Vec3 away, float length_m) {
    Vec3 way = sub(tail, head);
    float rise = dot(way, away);
    Vec3 flat = sub(way, scale(away, rise));
    float kept = clamp(rise, -length_m, length_m);
    float run = sqrtf(most(length_m * length_m - kept * kept, 0)) / (length(flat) + 1e-9f);
    return add(head, add(scale(away, kept), scale(flat, run)));
}

// The tail out of the colliders that it meets.
static Vec3 leave(const Rig *rig, const Piece *piece, Vec3 head, Vec3 tail) {
    for (int pass = 0; pass < PASSES; pass++) {
        float deepest = DEEP_M;
        Vec3 away = {0, 0, 0};
        for (int i = 0; i < piece->colliders; i++) {
            int at = rig->met[piece->first_collider + i];
            const Capsule *capsule = &rig->capsule[at];
            Vec3 out = sub(tail, capsule->start);
            float along = clamp(dot(out, capsule->way) / capsule->square, 0, 1);
            out = sub(out, scale(capsule->way, along));
            float distance = length(out) + 1e-9f;
            float deep = rig->collider[at].radius_m + piece->radius_m - distance;
            if (deep > deepest) {
                deepest = deep;
                away = scale(out, 1 / distance);
            }
        }
        if (deepest <= DEEP_M)
            break;
        tail = reach_outside(head, add(tail, scale(away, deepest)), away, piece->length_m);
    }
    return tail;
}

// The smallest rotation from one unit vector to another; opposite ones turn about any axis across.
static Quat between(Vec3 a, Vec3 b) {
    Vec3 axis = cross(a, b);
    return normalized((Quat){axis.x, axis.y, axis.z, most(1 + dot(a, b), 1e-3f)});
}

// Where a piece has swung to. before: none at first.
static Swing swing(const Rig *rig, const Piece *piece, const Pull *pull, const Swing *before, Vec3 head,
                   Vec3 axis, float dt_s) {
    Vec3 rest = add(head, scale(axis, piece->length_m)), still = {0, 0, 0};
    if (!before)
        return (Swing){rest, still};
    if (dt_s <= 0)
        return (Swing){reach(head, before->tail, piece->length_m), before->speed};
    // VRMC_springBone 1.0, "Inertia", "Stiffness" and "External forces" of the reference implementation.
    Vec3 force = add(scale(axis, piece->stiffness), piece->gravity);
    Vec3 tail = add(before->tail, add(scale(before->speed, pull->kept_s), scale(force, pull->force)));
    tail = leave(rig, piece, head, reach(head, tail, piece->length_m));
    return (Swing){tail, scale(sub(tail, before->tail), 1 / dt_s)};
}

void swing_springs(const Rig *rig, const Swing *before, Swing *after_, float dt_s) {
    place_capsules(rig);
    for (int i = 0; i < rig->sprung; i++) {
        const Sprung *sprung = &rig->spring[i];
        place_joint(rig, sprung->joint, rig->joint[sprung->joint].offset);
        Mat4 *model = &rig->model[sprung->joint];
        const Mat4 rest = *model;
        Vec3 head = place_of(&rest);
        for (int at = sprung->first; at < sprung->first + sprung->pieces; at++) {
            const Piece *piece = &rig->piece[at];
            Vec3 axis = sub(transform(&rest, piece->axis), head);
            after_[at] = swing(rig, piece, &rig->pull[at], before ? &before[at] : NULL, head, axis, dt_s);
            Vec3 way = scale(sub(after_[at].tail, head), 1 / piece->length_m);
            Mat4 turned = affine(between(axis, way), vec3(0, 0, 0));
            *model = after(&turned, &rest);
            model->m[0][3] = head.x, model->m[1][3] = head.y, model->m[2][3] = head.z;
        }
    }
}
