// Vectors, quaternions (x, y, z, w) and rigid transforms. Right-handed, metres, radians.
#pragma once

#include "compiled.h"

typedef struct { float x, y, z; } Vec3;
typedef struct { float x, y, z, w; } Quat;
typedef float Four __attribute__((vector_size(16)));
// Row-major 4 x 4; the last row is 0 0 0 1.
typedef union { float m[4][4]; Four row[4]; } Mat4;

static inline Vec3 vec3(float x, float y, float z) { return (Vec3){x, y, z}; }
static inline Vec3 add(Vec3 a, Vec3 b) { return vec3(a.x + b.x, a.y + b.y, a.z + b.z); }
static inline Vec3 sub(Vec3 a, Vec3 b) { return vec3(a.x - b.x, a.y - b.y, a.z - b.z); }
static inline Vec3 scale(Vec3 a, float s) { return vec3(a.x * s, a.y * s, a.z * s); }
static inline float dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static inline Vec3 cross(Vec3 a, Vec3 b) {
    return vec3(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float length(Vec3 a) { return sqrtf(dot(a, a)); }

static inline Quat conjugate(Quat q) { return (Quat){-q.x, -q.y, -q.z, q.w}; }
static inline float dot4(Quat a, Quat b) { return a.x * b.x + a.y * b.y + a.z * b.z + a.w * b.w; }
static inline Quat multiply(Quat a, Quat b) {
    return (Quat){
        a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
        a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x,
        a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w,
        a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z,
    };
}
static inline Quat normalized(Quat q) {
    float s = 1.0f / sqrtf(dot4(q, q));
    return (Quat){q.x * s, q.y * s, q.z * s, q.w * s};
}
// v turned by a unit quaternion.
static inline Vec3 rotate(Quat q, Vec3 v) {
    Vec3 axis = vec3(q.x, q.y, q.z), twice = scale(cross(axis, v), 2.0f);
    return add(add(v, scale(twice, q.w)), cross(axis, twice));
}

// The transform of a unit quaternion and a place.
static inline Mat4 affine(Quat q, Vec3 place) {
    float xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z, xy = q.x * q.y, yz = q.y * q.z, zx = q.z * q.x;
    float xw = q.x * q.w, yw = q.y * q.w, zw = q.z * q.w;
    return (Mat4){{
        {1 - 2 * (yy + zz), 2 * (xy - zw), 2 * (zx + yw), place.x},
        {2 * (xy + zw), 1 - 2 * (xx + zz), 2 * (yz - xw), place.y},
        {2 * (zx - yw), 2 * (yz + xw), 1 - 2 * (xx + yy), place.z},
        {0, 0, 0, 1},
    }};
}
static inline Mat4 after(const Mat4 *a, const Mat4 *b) {
    Mat4 c;
    for (int i = 0; i < 3; i++)
        c.row[i] = a->m[i][0] * b->row[0] + a->m[i][1] * b->row[1] + a->m[i][2] * b->row[2] + a->m[i][3] * b->row[3];
    c.row[3] = b->row[3];
    return c;
}
static inline Vec3 place_of(const Mat4 *a) { return vec3(a->m[0][3], a->m[1][3], a->m[2][3]); }
// A point of the transform's frame in the space that it leads to.
static inline Vec3 transform(const Mat4 *a, Vec3 v) {
    return vec3(
        a->m[0][0] * v.x + a->m[0][1] * v.y + a->m[0][2] * v.z + a->m[0][3],
        a->m[1][0] * v.x + a->m[1][1] * v.y + a->m[1][2] * v.z + a->m[1][3],
        a->m[2][0] * v.x + a->m[2][1] * v.y + a->m[2][2] * v.z + a->m[2][3]);
}

// A turn and a place: where a joint is, seen from the space that it leads to.
typedef struct { Quat turn; Vec3 place; } Rigid;
// A point of the joint's frame in that space.
static inline Vec3 point_from(const Rigid *a, Vec3 v) { return add(a->place, rotate(a->turn, v)); }
// What lies at an offset in a's frame and is turned there.
static inline Rigid carried(const Rigid *a, Quat turn, Vec3 offset) {
    return (Rigid){multiply(a->turn, turn), point_from(a, offset)};
}
