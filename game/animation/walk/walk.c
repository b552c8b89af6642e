// Legs that walk, layered under what the engine's units do with trunk, head and hands.
//
// The step is drawn in the plane that each leg swings in: during stance the foot goes back under the body exactly as
// fast as the body goes forward, so feet do not slide; two bones reach it by the law of cosines.
#include "geometry.h"

static const float PI = 3.14159265f;
static const float STANCE = 0.6f; // share of a cycle that a foot is on the ground
static const float LIFT_M = 0.075f, HEEL_M = 0.045f;
static const float FULL_STEP_M = 0.5f; // ground per cycle from which feet and arms go all the way
// How much lower walking hips are, how they bob twice and shift once a cycle.
static const float DROP_M = 0.034f, BOB_M = 0.012f, SHIFT_M = 0.012f;
static const float TURN = 0.10f, COUNTER_TURN = 0.16f, LEAN = 0.05f; // of the trunk, radians
static const float ARM_DOWN = 1.28f, ARM_SWING = 0.42f, ELBOW = 0.38f;

// The reference's body.
typedef struct {
    int32_t joints, hips, spine, leg[2][3], arm[2][3];
    Vec3 rest; // of the hips
    float hip_m, ankle_m, thigh_m, shin_m; // heights and lengths of a leg
} Body;

typedef struct { float phase, length_m, amount; } Stride; // cycles; ground per cycle; 0 stands, 1 walks

typedef struct {
    const Body *body;
    int32_t characters;
    Quat *rotation; // (characters, joints), in and out
    Vec3 *root;     // (characters), in and out
    const Stride *stride;
} Walk;

// Where an ankle is in its cycle: ahead of the hip, above its rest, and how far the toes point down.
typedef struct { float ahead_m, up_m, pitch; } Foot;

static float share_of(float x, float from, float to) { return clamp((x - from) / (to - from), 0, 1); }

static float square(float x) { return x * x; }

static Foot foot_at(float phase, float length_m) {
    phase -= floorf(phase);
    float half_m = 0.5f * STANCE * length_m, size = least(length_m / FULL_STEP_M, 1);
    if (phase < STANCE) {
        float stance = phase / STANCE, heel = square(share_of(stance, 0.7f, 1));
        return (Foot){half_m * (1 - 2 * stance), size * HEEL_M * heel, size * 0.75f * heel};
    }
    float swing = (phase - STANCE) / (1 - STANCE), eased = swing * swing * (3 - 2 * swing);
    float heel = square(1 - share_of(swing, 0, 0.55f)), toes_up = square(share_of(swing, 0.55f, 1));
    return (Foot){
        half_m * (2 * eased - 1),
        size * (HEEL_M * heel + LIFT_M * square(sinf(PI * swing))),
        size * (0.75f * heel - 0.30f * toes_up),
    };
}

static Quat about(int axis, float angle) {
    float s = sinf(0.5f * angle);
    return (Quat){axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0, cosf(0.5f * angle)};
}

static void blend(Quat *now, Quat wanted, float share) {
    float s = dot4(*now, wanted) < 0 ? -share : share, rest = 1 - share;
    *now = normalized((Quat){
        rest * now->x + s * wanted.x, rest * now->y + s * wanted.y,
        rest * now->z + s * wanted.z, rest * now->w + s * wanted.w,
    });
}

static float mix(float a, float b, float share) { return a + (b - a) * share; }

// The angle between two sides of a triangle.
static float corner(float side, float other, float opposite) {
    return acosf(clamp((side * side + other * other - opposite * opposite) / (2 * side * other), -1, 1));
}

static void walk_leg(const Body *body, Quat *rotation, Vec3 root, int side, float phase, const Stride *stride) {
    Foot foot = foot_at(phase, stride->length_m);
    float down = root.y - body->rest.y + body->hip_m - (body->ankle_m + foot.up_m);
    float a = body->thigh_m, b = body->shin_m;
    float far = clamp(hypotf(foot.ahead_m, down), fabsf(a - b) + 0.02f, a + b - 0.002f);
    float thigh = atan2f(foot.ahead_m, down) + corner(a, far, b), knee = PI - corner(a, b, far);
    const int32_t *joint = body->leg[side];
    blend(&rotation[joint[0]], multiply(conjugate(rotation[body->hips]), about(0, -thigh)), stride->amount);
    blend(&rotation[joint[1]], about(0, knee), stride->amount);
    blend(&rotation[joint[2]], about(0, thigh - knee + foot.pitch), stride->amount);
}

// An arm swings with the other leg.
static void swing_arm(const Body *body, Quat *rotation, int side, float phase, const Stride *stride) {
    float out = side ? -1 : 1; // left is +x
    float swing = ARM_SWING * cosf(2 * PI * (phase + 0.5f)) * least(stride->length_m / FULL_STEP_M, 1);
    const int32_t *joint = body->arm[side];
    blend(&rotation[joint[0]], multiply(about(0, -swing), about(2, -ARM_DOWN * out)), stride->amount);
    blend(&rotation[joint[1]], about(1, -out * (ELBOW + 0.5f * most(swing, 0))), stride->amount);
    blend(&rotation[joint[2]], about(0, 0), stride->amount);
}

EXPORT(walk) {
    const Walk *call = PARAMETERS(Walk);
    const Body *body = call->body;
    for (int n = 0; n < call->characters; n++) {
        const Stride *stride = &call->stride[n];
        Quat *rotation = call->rotation + n * body->joints;
        Vec3 *root = &call->root[n];
        float cycle = 2 * PI * (stride->phase - floorf(stride->phase)), amount = stride->amount;
        root->x = mix(root->x, SHIFT_M * sinf(cycle), amount);
        root->y = mix(root->y, body->rest.y - DROP_M + BOB_M * cosf(2 * cycle), amount);
        root->z = mix(root->z, 0, amount);
        blend(&rotation[body->hips], about(1, TURN * cosf(cycle)), amount);
        blend(&rotation[body->spine], multiply(about(0, LEAN), about(1, -COUNTER_TURN * cosf(cycle))), amount);
        for (int side = 0; side < 2; side++) {
            float phase = stride->phase + 0.5f * (float)side;
            walk_leg(body, rotation, *root, side, phase, stride);
            swing_arm(body, rotation, side, phase, stride);
        }
    }
}
