// The planner's records. game/embos/planner_state.py and judging.py hold the same layout as NumPy types.
#pragma once

#include "compiled.h"

// MOST_UNITS: in a layer.
enum { LAYERS = 3, FEELINGS = 7, MOST_UNITS = 1024 };

// Everything static: L layers of M slots each, P = L·M in all (game/embos/tables.py says what each array is).
typedef struct {
    double steady, look_s, eager, presence, radius, tolerance;
    double reach[LAYERS];
    int32_t count[LAYERS], width, slots, gestures, first_gesture, gesture_layer, settled_count, quantiles;
    int32_t character_bytes;
    const double *intensity, *exists;                           // [P][7]
    const double *intensity_by_feeling, *exists_by_feeling;     // [7][P]
    const double *timing_s;                                     // [P][3][7]: L_d, L_w, start to stroke
    const double *sigma, *constant_state, *least_s, *minimum;   // [P]
    const double *follow;                                       // [P + 1][M]: ω_c
    const double *blocks;                                       // [L][P + 1][M]: ω_l
    const double *leads_s;                                      // [G][2]: least and most from start to stroke
    const double *normal, *share;                               // [quantiles] of the normal distribution, what is below
    const int64_t *unit;                                        // [P]
    const uint8_t *real;                                        // [P]
    const int32_t *settled;                                     // [settled_count]
} Tables;

// One character, see PlannerState. After it: wait_s[P], phi_state[P], words[G], order[P], untried[P].
typedef struct {
    uint64_t key;
    double next_s, emotion[FEELINGS], settled[FEELINGS];
    int64_t running[LAYERS], starts[LAYERS], unit[LAYERS];
    double marks_s[LAYERS][2], numbers[LAYERS][11];
    uint8_t started[LAYERS], calm, unused[4];
} Character;

_Static_assert(sizeof(Character) == 520, "as in CharacterKind");

static inline double *wait_s(Character *c) { return (double *)(c + 1); }
static inline double *phi_state(const Tables *t, Character *c) { return (double *)(c + 1) + t->slots; }
static inline double *words(const Tables *t, Character *c) { return (double *)(c + 1) + 2 * t->slots; }
static inline int16_t *order(const Tables *t, Character *c) { return (int16_t *)(words(t, c) + t->gestures); }
static inline uint8_t *untried(const Tables *t, Character *c) { return (uint8_t *)(order(t, c) + t->slots); }
static inline Character *character(const Tables *t, Character *first, size_t row) {
    return (Character *)((uint8_t *)first + row * t->character_bytes);
}

// Eq. 1 for one character, see Factors. After it: continuity[P], linkage[P], time[P], state[P], score[P].
typedef struct {
    int64_t chosen[LAYERS];
    uint8_t within[LAYERS], beaten[LAYERS], unused[2];
} Factors;

_Static_assert(sizeof(Factors) == 32, "as in judging.py");

enum Factor { CONTINUITY, LINKAGE, TIME, STATE, SCORE, FACTORS };

static inline double *factor(const Tables *t, Factors *f, enum Factor which) {
    return (double *)(f + 1) + which * t->slots;
}

// Units that somebody shows whatever they feel: φ_state is at least share there.
typedef struct {
    double share;
    int32_t count;
    const int32_t *slots;
} Habit;

static inline double smaller(double a, double b) { return a < b ? a : b; }
static inline double larger(double a, double b) { return a > b ? a : b; }

// See the sources.
void uniform(uint64_t key, uint64_t purpose, int64_t event, int count, double *draws);
double spread_factor(const Tables *t, double draw, double sigma);
void mix_weights(const Tables *t, const double *emotion, int64_t slot, double radius, double *weights);
double mixed(const double *values, const double *weights);
double apart(const double *a, const double *b);
bool is_fresh(const Character *c);
void feel(const Tables *t, Character *c, const double *emotion, bool looking);
void settle(const Tables *t, Character *c, double time_s);
void evaluate(const Tables *t, Character *c, double now_s, const Habit *habit, Factors *f);
void decide(const Tables *t, Character *c, double time_s, double now_s, Factors *f);
double moment(const Tables *t, double time_s, double dt_s);
bool is_due(const Tables *t, Character *c, const double *emotion, const double *said, double time_s, double dt_s);
void judge_one(const Tables *t, Character *c, const double *emotion, const double *said, double time_s, double dt_s,
               const Habit *habit, Factors *f);
