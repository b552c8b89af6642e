// What never stops: breath, sway, blinking, and a gaze that leads the head, which leads the body.
//
// Everything is a function of seeded draws and of clocks that run at the emotion's own pace, so a character is the same
// alone and in a crowd, at 30 or at 60 ticks a second.
#include "tick.h"

// Cues: what moves the torso and head. The sways are two sines each.
enum { CUE_BREATH, CUE_SWAY, CUE_YAW = CUE_SWAY + SWAYS, CUE_PITCH, CUE_TORSO, CUE_NOD, CUES };
// Who speaks nods with the second sine of the head's yaw.
enum { NOD_WAVE = 9 };
// A jump of the eyes beyond this brings a blink with it.
static const float LEAP = 0.55f;
static const double TAU = 6.283185307179586;

// game/embos/draws.py: numbers that depend on nothing but (key, stream, how often, which).
static uint64_t mixed(uint64_t x) {
    x = (x ^ x >> 30) * 0xBF58476D1CE4E5B9u;
    x = (x ^ x >> 27) * 0x94D049BB133111EBu;
    return x ^ x >> 31;
}
static double drawn(uint64_t key, int stream, int64_t often, int which) {
    uint64_t counter = (uint64_t)often * 64 + (uint64_t)stream * 8 + (uint64_t)which + 1;
    uint64_t bits = mixed(mixed(key ^ counter * 0x9E3779B97F4A7C15u));
    return ((double)(bits >> 11) + 0.5) * 0x1p-53;
}

static double felt(const double share[EMOTIONS], const double by_emotion[EMOTIONS]) {
    double sum = 0;
    for (int k = 0; k < EMOTIONS; k++) sum += share[k] * by_emotion[k];
    return sum;
}

// A new dart of the eyes.
static void dart(const Setup *setup, Character *c, const double share[EMOTIONS]) {
    double draw[4];
    for (int i = 0; i < 4; i++) draw[i] = drawn(c->key, 0, c->darts, i);
    // Every third returns to the target itself, so the gaze does not wander off.
    double size = draw[3] < 0.33 ? 0 : 2 * felt(share, setup->dart_size);
    c->dart[0] = (float)((draw[0] - 0.5) * 2 * size);
    c->dart[1] = (float)((draw[1] - 0.5) * size);
    c->dart_left_s = (0.35 + 1.3 * draw[2]) / felt(share, setup->darts_per_s);
    c->darts++;
}

static void blink(const Setup *setup, Character *c, const double share[EMOTIONS]) {
    double wait_s = (0.3 + 1.4 * drawn(c->key, 1, c->blinks, 0)) * 60 / felt(share, setup->blinks_per_min);
    // One blink in eight comes double.
    c->blink_left_s = drawn(c->key, 1, c->blinks, 1) < 0.125 ? 0.3 : wait_s;
    c->blink_age_s = 0;
    c->blinks++;
}

// A critically damped spring, exact in dt (game/core/springs.py).
static void spring(float *value, float *speed, float goal, float stiffness, float dt_s) {
    float decay = expf(-stiffness * dt_s), away = *value - goal, push = (*speed + away * stiffness) * dt_s;
    *value = goal + decay * (away + push);
    *speed = decay * (*speed - push * stiffness);
}

// Straight lines between points; level beyond the ends.
static float lids_at(const Setup *setup, float at) {
    const float *x = setup->blink_at, *y = setup->blink;
    if (at <= x[0]) return y[0];
    for (int i = 1; i < BLINK; i++)
        if (at < x[i]) return y[i - 1] + (at - x[i - 1]) / (x[i] - x[i - 1]) * (y[i] - y[i - 1]);
    return y[BLINK - 1];
}
static float lungs_at(const Setup *setup, double breaths) {
    float at = (float)((breaths - floor(breaths)) * (BREATH - 1));
    int i = (int)least(at, BREATH - 2);
    return setup->breath[i] + (at - (float)i) * (setup->breath[i + 1] - setup->breath[i]);
}

void live(const Tick *tick, Character *c, const double share[EMOTIONS], double speaking, float row[ROW]) {
    const Setup *setup = tick->setup;
    double dt_s = tick->dt_s;
    c->clock += felt(share, setup->sway_pace) * dt_s;
    c->breaths += felt(share, setup->breath_hz) * dt_s;
    c->dart_left_s -= dt_s;
    c->blink_left_s -= dt_s;
    c->blink_age_s += dt_s;
    if (c->leap) c->blink_left_s = fmin(c->blink_left_s, 0);
    if (c->dart_left_s <= 0) dart(setup, c, share);
    if (c->blink_left_s <= 0) blink(setup, c, share);
    c->attention += ((c->looks ? 0 : 1) - c->attention) * tick->mood;
    c->voice += ((float)speaking - c->voice) * tick->mood;

    // At the emotion's tempo.
    double tempo = felt(share, setup->tempo);
    float head = (float)(setup->head_stiffness / tempo), torso = (float)(setup->torso_stiffness / tempo);
    float turn = setup->head_share * c->attention, twist = setup->torso_share * c->attention;
    spring(&c->head[0], &c->head_speed[0], c->aim[0] * turn, head, (float)dt_s);
    spring(&c->head[1], &c->head_speed[1], -c->aim[1] * turn, head, (float)dt_s);
    spring(&c->head[2], &c->head_speed[2], c->aim[0] * twist, torso, (float)dt_s);

    float cues[CUES];
    float sway = (float)felt(share, setup->sway);
    for (int i = 0; i < SWAYS; i++) {
        double angle = c->clock * setup->sway_rate[i] + c->phase[i];
        float wave = sinf((float)(angle - TAU * floor(angle / TAU + 0.5)));
        cues[CUE_SWAY + i] = wave * sway;
        if (i == NOD_WAVE) cues[CUE_NOD] = c->voice * wave * setup->nod_rad;
    }
    c->breath = lungs_at(setup, c->breaths);
    c->blink = lids_at(setup, (float)(c->blink_age_s / setup->blink_s));
    cues[CUE_BREATH] = c->breath * (float)felt(share, setup->breath_depth);
    cues[CUE_YAW] = c->head[0];
    cues[CUE_PITCH] = c->head[1];
    cues[CUE_TORSO] = c->head[2];
    for (int i = 0; i < setup->effect_count; i++) {
        Effect effect = setup->effects[i];
        row[effect.channel] += cues[effect.cue] * effect.amount;
    }
}

// Eyes to the target as far as they go.
void look(const Tick *tick, Character *c, const double target[3], const Rigid *head, const Rigid *chest) {
    const Setup *setup = tick->setup;
    Vec3 eyes = point_from(head, vec3(setup->eyes[0], setup->eyes[1], setup->eyes[2]));
    Vec3 way = sub(vec3((float)target[0], (float)target[1], (float)target[2]), eyes);
    c->aim[0] = atan2f(way.x, way.z);
    c->aim[1] = atan2f(way.y, hypotf(way.x, way.z));
    Vec3 seen = rotate(conjugate(head->turn), way);
    float want[2] = {
        atan2f(seen.x, seen.z) * (c->attention / setup->eye_yaw_rad) + c->dart[0],
        atan2f(seen.y, hypotf(seen.x, seen.z)) * (c->attention / setup->eye_pitch_rad) + c->dart[1],
    };
    if (c->attention < 0.999f) {
        // Where a unit's own gaze leads, the eyes go a little further the way the head has turned.
        Vec3 face = rotate(conjugate(chest->turn), rotate(head->turn, vec3(0, 0, 1)));
        want[0] += (1 - c->attention) * atan2f(face.x, face.z) * (0.5f / setup->eye_yaw_rad);
    }
    c->leap = 0;
    for (int i = 0; i < 2; i++) {
        float way_left = clamp(want[i], -1, 1) - c->gaze[i];
        c->leap |= fabsf(way_left) > LEAP;
        c->gaze[i] += way_left * tick->eyes;
    }
}
