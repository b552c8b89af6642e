// What keeps the hands out of body and table: how far a wrist has to be pushed so that nothing is inside.
//
// The body is a handful of ellipsoids on chest, spine, hips and head, the table a slab (MOTION.md, contacts). Depth
// grows smoothly from before the touch and all contacts of a hand are weighed together, so the push has no jumps.
#include "tick.h"

static const float TABLE_CLEARANCE_M = 0.004f, TABLE_MARGIN_M = 0.04f;
// The push begins this far before the touch.
static const float SOFTNESS_M = 0.006f;
// Each pass leaves about a third of what contacts that pull apart left inside.
enum { PASSES = 3 };
// Points further inside the table than this, by the shortest way, are left to the clip.
static const float DEEPEST_M = 0.12f;
// The middle of the palm from the wrist, along the fingers.
static const float PALM_M[2] = {0.05f, -0.05f};
// What is held off less than this is let go.
static const float GONE_M = 1e-7f;

// Points of a hand: wrist, palm, middle knuckle, tips of middle, index and little finger, middle of the forearm; the
// eighth is far from everything.
enum { WIDE = 8 };
typedef struct { float x[WIDE], y[WIDE], z[WIDE]; } Points;
// The points in an ellipsoid's unit sphere, how steeply its distance grows there, and how deep they are inside, softly
// and 4 × SOFTNESS_M times too large.
typedef struct { float x[WIDE], y[WIDE], z[WIDE], slope[WIDE], depth[WIDE]; } Touch;

static void put(Points *points, int i, Vec3 p) { points->x[i] = p.x, points->y[i] = p.y, points->z[i] = p.z; }

// The map from model space into an ellipsoid's unit sphere.
static Mat4 sphere_frame(const Ellipsoid *e, const Rigid *joint) {
    Mat4 turn = affine(joint->turn, vec3(0, 0, 0)), map;
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 3; j++) map.m[i][j] = turn.m[j][i] * e->inverse[i];
        Vec3 row = vec3(map.m[i][0], map.m[i][1], map.m[i][2]);
        map.m[i][3] = e->middle[i] - dot(row, joint->place);
    }
    return map;
}

// -> whether any of the points touches the ellipsoid.
static bool touches(const Setup *setup, const Ellipsoid *e, const Mat4 *map, const Points *points, Touch *touch) {
    const float(*m)[4] = map->m;
    float square[WIDE];
    int near = 0, any = 0;
    for (int i = 0; i < WIDE; i++) {
        float px = points->x[i], py = points->y[i], pz = points->z[i];
        float x = m[0][0] * px + m[0][1] * py + m[0][2] * pz + m[0][3];
        float y = m[1][0] * px + m[1][1] * py + m[1][2] * pz + m[1][3];
        float z = m[2][0] * px + m[2][1] * py + m[2][2] * pz + m[2][3];
        touch->x[i] = x, touch->y[i] = y, touch->z[i] = z;
        square[i] = x * x + y * y + z * z + 1e-12f;
        near |= square[i] < e->near_square;
    }
    if (!near) return false;
    for (int i = 0; i < WIDE; i++) {
        float x = touch->x[i] * e->inverse[0], y = touch->y[i] * e->inverse[1], z = touch->z[i] * e->inverse[2];
        float slope = sqrtf(x * x + y * y + z * z + 1e-12f);
        // Quílez' estimate for an ellipsoid, norm · (norm − 1) / slope; exact on the surface.
        float distance = (square[i] - sqrtf(square[i])) / slope, deep = setup->reach_m[i] - distance;
        // The difference of two ramps' squares is a smooth max(depth, 0).
        float outer = most(deep + SOFTNESS_M, 0), inner = most(deep - SOFTNESS_M, 0);
        touch->slope[i] = slope;
        touch->depth[i] = outer * outer - inner * inner;
        any |= touch->depth[i] > 0;
    }
    return any;
}

// What the contacts of one hand with the body ask for.
static Vec3 push_from_body(const Setup *setup, const Mat4 maps[BODY], const Points *hand) {
    Points points = *hand;
    Vec3 push = vec3(0, 0, 0);
    for (int pass = 0; pass < PASSES; pass++) {
        // Contacts that pull apart leave something inside: what is left is pushed again. The deepest contact leads,
        // others join in as they come near: no switching. Their weights are cubes of the depth.
        Vec3 total = vec3(0, 0, 0);
        float weight = 0;
        for (int b = 0; b < BODY; b++) {
            Touch touch;
            if (!touches(setup, &setup->body[b], &maps[b], &points, &touch)) continue;
            for (int i = 0; i < POINTS_OF_HAND; i++) {
                // The map holds rotation / radius, so its transpose takes position / radius to the gradient.
                const float(*m)[4] = maps[b].m;
                float slope = touch.slope[i], x = touch.x[i] / slope, y = touch.y[i] / slope, z = touch.z[i] / slope;
                Vec3 away = vec3(
                    m[0][0] * x + m[1][0] * y + m[2][0] * z, m[0][1] * x + m[1][1] * y + m[2][1] * z,
                    m[0][2] * x + m[1][2] * y + m[2][2] * z);
                float depth = touch.depth[i], cube = depth * depth * depth;
                total = add(total, scale(away, cube * depth / (4 * SOFTNESS_M)));
                weight += cube;
            }
        }
        if (weight <= 0) break;
        Vec3 step = scale(total, 1 / most(weight, 1e-20f));
        push = add(push, step);
        for (int i = 0; i < WIDE; i++) points.x[i] += step.x, points.y[i] += step.y, points.z[i] += step.z;
    }
    return push;
}

// How far up, and how far back, the deepest point of a hand must go to be clear of the table.
static void table_depth(const Setup *setup, const Points *points, float *lift, float *back) {
    *lift = *back = 0;
    for (int i = 0; i < POINTS_OF_HAND; i++) {
        float radius = setup->point_radius[i] + TABLE_CLEARANCE_M;
        float up = most(setup->table_top_m + radius - points->y[i], 0);
        float out = most(points->z[i] + radius - setup->table_back_z_m, 0);
        float shortest = least(up, out);
        if (shortest <= 0 || shortest >= DEEPEST_M || points->z[i] >= setup->table_front_z_m + TABLE_MARGIN_M) continue;
        // Near the edge the short way out is backward, elsewhere upward; where both are as short, both are gone.
        float share = 2 * out * out / most(up * up + out * out, 1e-12f);
        *lift = most(*lift, up * least(share, 1));
        *back = most(*back, out * least(2 - share, 1));
    }
}

void clear_hands(
    const Setup *setup, const Rigid figure[FIGURE], const Rigid goals[2], const float *points, Vec3 push[2]) {
    Mat4 maps[BODY];
    for (int b = 0; b < BODY; b++) maps[b] = sphere_frame(&setup->body[b], &figure[setup->body[b].joint]);
    for (int hand = 0; hand < 2; hand++) {
        const Rigid *goal = &goals[hand];
        Points at;
        put(&at, 0, goal->place);
        put(&at, 1, point_from(goal, vec3(PALM_M[hand], 0, 0)));
        for (int i = 0; i < POINTS_PER_HAND; i++) {
            const float *p = points + 3 * (hand * POINTS_PER_HAND + i);
            put(&at, 2 + i, point_from(goal, vec3(p[0], p[1], p[2])));
        }
        // The elbow follows the wrist about half way.
        const Rigid *elbow = &figure[setup->bones[hand][2]], *wrist = &figure[setup->bones[hand][3]];
        Vec3 shifted = sub(scale(goal->place, 0.75f), scale(wrist->place, 0.25f));
        put(&at, 6, add(scale(elbow->place, 0.5f), shifted));
        put(&at, 7, vec3(1e3f, 1e3f, 1e3f));
        push[hand] = push_from_body(setup, maps, &at);
        float lift, back;
        table_depth(setup, &at, &lift, &back);
        push[hand].y += most(lift - most(push[hand].y, 0), 0);
        push[hand].z -= back;
    }
}

// Along its way a hand is held off at least as far as wanted: a surface stops it at once, and lets go of it softly.
void hold_off(const Tick *tick, Character *c, const Vec3 wanted[2]) {
    for (int hand = 0; hand < 2; hand++) {
        const float want[3] = {wanted[hand].x, wanted[hand].y, wanted[hand].z};
        float *off = c->off[0][hand], *speed = c->off[1][hand];
        float square = 0, along = 0;
        for (int i = 0; i < 3; i++) {
            float away = off[i] - want[i];
            off[i] = tick->let_go[0][0] * away + tick->let_go[0][1] * speed[i] + want[i];
            speed[i] = tick->let_go[1][0] * away + tick->let_go[1][1] * speed[i];
            if (fabsf(off[i]) <= GONE_M) off[i] = 0;
            if (fabsf(speed[i]) <= GONE_M) speed[i] = 0;
            square += want[i] * want[i];
            along += off[i] * want[i];
        }
        float lacking = most(1 - along / most(square, 1e-12f), 0);
        for (int i = 0; i < 3; i++) off[i] += want[i] * lacking;
    }
}
