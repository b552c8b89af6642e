// What Python calls: a tick of all characters, or of some of them, or the factors behind it.
#include "plan.h"

// Arrays are copied by one instruction.
#pragma clang attribute push(__attribute__((target("bulk-memory"))), apply_to = function)

// Every function's parameters. signal: for each character judged emotion[7], words[G]; rows, times_s: judge only.
typedef struct {
    double time_s, dt_s;
    Habit habit;
    const Tables *tables;
    Character *characters;
    uint32_t count;  // of characters
    const double *signal;
    Factors *factors;
    double *soonest_s;
    uint32_t *started;
    const int64_t *rows;
    uint32_t judged;  // of rows
    const double *times_s;
} Call;

// Thresholds before this moment count as passed: half a look ahead, so that lengths are right on average.
static double moment(const Tables *t, double time_s, double dt_s) { return time_s + 0.5 * larger(t->look_s, dt_s); }

// Whether times and emotions are looked at in this tick.
static bool looks(const Tables *t, double time_s, double dt_s) {
    if (t->look_s <= dt_s) return true;
    return floor((time_s + 1e-6) / t->look_s) > floor((time_s - dt_s + 1e-6) / t->look_s);
}

static bool is_fresh(const Character *c) { return !(c->starts[0] | c->starts[1] | c->starts[2]); }

// Whether a character's decision may change in this tick. said: words have come or gone, come: some have come.
static bool is_due(const Tables *t, const Character *c, const double *emotion, bool said, bool come, bool looking,
                   double now_s) {
    bool passed = c->next_s < now_s;
    if (looking ? passed || apart(emotion, c->emotion) > t->tolerance : is_fresh(c)) return true;
    // A word that goes is heard by those whom it may move, or who look at the clock only now and then.
    return come || (said && (!c->calm || passed));
}

static void judge_one(const Call *call, Character *c, const double *signal, double time_s, Factors *f) {
    const Tables *t = call->tables;
    double now_s = moment(t, time_s, call->dt_s);
    feel(t, c, signal, is_fresh(c) || looks(t, time_s, call->dt_s));
    settle(t, c, time_s);
    memcpy(words(t, c), signal + FEELINGS, t->gestures * sizeof *signal);
    evaluate(t, c, now_s, &call->habit, f);
    decide(t, c, time_s, now_s, f);
}

// The least next_s of all, and whether anybody has started anything.
static void sum_up(const Call *call) {
    *call->soonest_s = INFINITY;
    *call->started = 0;
    for (uint32_t row = 0; row < call->count; row++) {
        const Character *c = character(call->tables, call->characters, row);
        *call->soonest_s = smaller(*call->soonest_s, c->next_s);
        *call->started |= c->started[0] | c->started[1] | c->started[2];
    }
}

// One tick: eq. 1 where something has happened, the standing decision elsewhere.
EXPORT(advance) {
    const Call *call = PARAMETERS(Call);
    const Tables *t = call->tables;
    double now_s = moment(t, call->time_s, call->dt_s);
    bool looking = looks(t, call->time_s, call->dt_s);
    for (uint32_t row = 0; row < call->count; row++) {
        Character *c = character(t, call->characters, row);
        const double *signal = call->signal + row * (FEELINGS + t->gestures), *now_said = signal + FEELINGS;
        double *before = words(t, c);
        int said = 0, come = 0;
        for (int g = 0; g < t->gestures; g++) {
            said |= now_said[g] != before[g];
            come |= now_said[g] > before[g];
        }
        memset(c->started, 0, sizeof c->started);
        if (is_due(t, c, signal, said, come, looking, now_s)) judge_one(call, c, signal, call->time_s, call->factors);
        else if (said) memcpy(before, now_said, t->gestures * sizeof *before);
    }
    sum_up(call);
}

// Eq. 1 for some characters, each at a time of its own.
EXPORT(judge) {
    const Call *call = PARAMETERS(Call);
    const Tables *t = call->tables;
    for (uint32_t row = 0; row < call->count; row++)
        memset(character(t, call->characters, row)->started, 0, LAYERS);
    for (uint32_t i = 0; i < call->judged; i++) {
        const double *signal = call->signal + i * (FEELINGS + t->gestures);
        judge_one(call, character(t, call->characters, call->rows[i]), signal, call->times_s[i], call->factors);
    }
    sum_up(call);
}

// The factors of each character as eq. 1 finds them in its tick: its emotion noted, nothing begun. factors: one each.
EXPORT(weigh) {
    const Call *call = PARAMETERS(Call);
    const Tables *t = call->tables;
    size_t factors_bytes = sizeof(Factors) + FACTORS * t->slots * sizeof(double);
    for (uint32_t row = 0; row < call->count; row++) {
        Character *c = character(t, call->characters, row);
        const double *signal = call->signal + row * (FEELINGS + t->gestures);
        feel(t, c, signal, true);
        settle(t, c, call->times_s[row]);
        memcpy(words(t, c), signal + FEELINGS, t->gestures * sizeof *signal);
        Factors *f = (Factors *)((uint8_t *)call->factors + row * factors_bytes);
        evaluate(t, c, moment(t, call->times_s[row], call->dt_s), &call->habit, f);
    }
}

#pragma clang attribute pop
