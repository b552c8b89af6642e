// Keeps hands that are bigger than the reference's out of the body they belong to, its clothes and its beard
// (game/animation/body_shape.py). What the reference's hands touch is kept by fit.c; here is only what lies too deep.
#include "fit.h"

// The push begins this far before the touch; as deep hands may press into cloth.
static const float SOFTNESS_M = 0.008f, TOLERANCE_M = 0.001f;
// Toward the ends of a region it counts less.
static const float FADE_M = 0.03f;
static const float MOST_M = 0.10f;
enum { PASSES = 2 };

typedef struct { Vec3 place; float radius; } Ball;

// What a hand consists of, from its wrist, in model space.
static void balls_of(const Fit *fit, int side, Quat hand, const Quat *turn, Ball ball[BALLS]) {
    const Hand *h = &fit->own_hand[side];
    for (int i = 0; i < PALM_BALLS; i++) ball[i] = (Ball){rotate(hand, h->palm[i].place), h->palm[i].radius};
    for (int i = 0; i < FINGERS; i++) {
        const Finger *f = &h->finger[i];
        Quat first = multiply(hand, turn[f->first]), second = multiply(first, turn[f->second]);
        Vec3 joint = add(rotate(hand, f->base), rotate(first, f->joint));
        ball[PALM_BALLS + 2 * i] = (Ball){joint, f->radius};
        ball[PALM_BALLS + 2 * i + 1] = (Ball){add(joint, rotate(second, f->tip)), f->radius};
    }
}

// How deep a ball is in a region, and which way is out, both in the region's frame. -> whether it is.
static bool inside(const Shape *shape, Vec3 p, float radius, float *depth, Vec3 *out) {
    float top = shape->height, x = p.x, z = p.z, square = x * x + z * z;
    if (p.y <= 0 || p.y >= top) return false;
    float rows = (SHAPE_ROWS - 1) / top, row = p.y * rows;
    int i = (int)row;
    if (i > SHAPE_ROWS - 2) i = SHAPE_ROWS - 2;
    float far = shape->around[i] + radius + SOFTNESS_M;
    if (square > far * far) return false;
    float r = most(sqrtf(square), 0.02f), diamond = most(fabsf(x) + fabsf(z), 1e-4f);
    // The direction as a share of a turn: even along a square.
    float per_diamond = 1 / diamond, t = x * per_diamond, share = (z >= 0 ? t : 2 - t) * 0.25f;
    if (share < 0) share += 1;
    float column = share * SHAPE_COLUMNS;
    int j = (int)column;
    float u = row - i, v = column - j;
    int j0 = j % SHAPE_COLUMNS, j1 = (j + 1) % SHAPE_COLUMNS;
    const float *low = shape->radius[i], *high = shape->radius[i + 1];
    float below = low[j0] + (low[j1] - low[j0]) * v, above = high[j0] + (high[j1] - high[j0]) * v;
    float surface = below + (above - below) * u;
    float per_share = (low[j1] - low[j0] + (high[j1] - high[j0] - low[j1] + low[j0]) * u) * SHAPE_COLUMNS;
    float turn = (z >= 0 ? 0.25f : -0.25f) * per_diamond * per_diamond;
    float along_x = turn * fabsf(z), along_z = z >= 0 ? -turn * x : turn * x;
    float per_r = 1 / r;
    Vec3 slope = vec3(x * per_r - per_share * along_x, (below - above) * rows, z * per_r - per_share * along_z);
    float gentle = 1 / length(slope);
    float soft = radius - TOLERANCE_M - (r - surface) * gentle;
    if (soft <= -SOFTNESS_M) return false;
    float fade = least(least(p.y, top - p.y) / FADE_M, 1);
    float outer = most(soft + SOFTNESS_M, 0), within = most(soft - SOFTNESS_M, 0);
    *depth = fade * (outer * outer - within * within) / (4 * SOFTNESS_M);
    *out = scale(slope, gentle);
    return *depth > 0;
}

Vec3 clear_of_body(const Fit *fit, int side, const Rigid *mine, Vec3 wrist, Quat hand, const Quat *turn) {
    Vec3 push = {0, 0, 0};
    // Of the regions that the hand may reach: which, and its balls in their frames.
    int near = 0, which[REGIONS];
    Vec3 half = rotate(hand, scale(fit->palm[side], fit->hand));
    Vec3 at[REGIONS];
    for (int s = 0; s < fit->shapes; s++) {
        const Shape *shape = &fit->shape[s];
        const Rigid *joint = &mine[shape->joint];
        Vec3 p = sub(rotate(conjugate(joint->turn), sub(wrist, joint->place)), shape->centre);
        Vec3 middle = add(p, rotate(conjugate(joint->turn), half));
        float reach = shape->widest + fit->reach, over = middle.y - shape->height;
        if (middle.y < -fit->reach || over > fit->reach || middle.x * middle.x + middle.z * middle.z > reach * reach)
            continue;
        which[near] = s;
        at[near++] = p;
    }
    if (!near) return push;
    Ball ball[BALLS], own[REGIONS][BALLS];
    balls_of(fit, side, hand, turn, ball);
    for (int n = 0; n < near; n++) {
        Quat back = conjugate(mine[fit->shape[which[n]].joint].turn);
        for (int i = 0; i < BALLS; i++)
            own[n][i] = (Ball){add(at[n], rotate(back, ball[i].place)), ball[i].radius};
    }
    for (int pass = 0; pass < PASSES; pass++) {
        // The deepest contact leads, others join in as they come near: no switching.
        Vec3 total = {0, 0, 0};
        float weight = 0;
        for (int n = 0; n < near; n++) {
            const Shape *shape = &fit->shape[which[n]];
            Quat there = mine[shape->joint].turn;
            Vec3 moved = pass ? rotate(conjugate(there), push) : push, sum = {0, 0, 0};
            float before = weight;
            for (int i = 0; i < BALLS; i++) {
                float depth;
                Vec3 out;
                if (!inside(shape, add(own[n][i].place, moved), own[n][i].radius, &depth, &out)) continue;
                float cube = depth * depth * depth;
                sum = add(sum, scale(out, cube * depth));
                weight += cube;
            }
            if (weight > before) total = add(total, rotate(there, sum));
        }
        if (weight <= 0) break;
        push = add(push, scale(total, 1 / most(weight, 1e-20f)));
    }
    return scale(push, least(1, MOST_M / most(length(push), 1e-6f)));
}
