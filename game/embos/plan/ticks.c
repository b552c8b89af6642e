// A tick of all characters, and the factors behind it.
#include "plan.h"

// Every function's parameters. signal: for each character emotion[7], words[G]; times_s: of each, weigh only.
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
    const double *times_s;
} Call;

// Thresholds before this moment count as passed: half a look ahead, so that lengths are right on average.
double moment(const Tables *t, double time_s, double dt_s) { return time_s + 0.5 * larger(t->look_s, dt_s); }

// Whether times and emotions are looked at in this tick.
static bool looks(const Tables *t, double time_s, double dt_s) {
    if (t->look_s <= dt_s) return true;
    return floor((time_s + 1e-6) / t->look_s) > floor((time_s - dt_s + 1e-6) / t->look_s);
}

// Whether a character's decision may change in this tick. said: [G], noted as the words of the last tick.
bool is_due(const Tables *t, Character *c, const double *emotion, const double *said, double time_s, double dt_s) {
    double *before = words(t, c);
    int differ = 0, come = 0;
    for (int g = 0; g < t->gestures; g++) {
        differ |= said[g] != before[g];
        come |= said[g] > before[g];
    }
    if (differ) memcpy(before, said, t->gestures * sizeof *said);
    bool passed = c->next_s < moment(t, time_s, dt_s), looking = looks(t, time_s, dt_s);
    if (looking ? passed || apart(emotion, c->emotion) > t->tolerance : is_fresh(c)) return true;
    // A word that goes is heard by those whom it may move, or who look at the clock only now and then.
    return come || (differ && (!c->calm || passed));
}

// Eq. 1 and what follows from it.
void judge_one(const Tables *t, Character *c, const double *emotion, const double *said, double time_s, double dt_s,
               const Habit *habit, Factors *f) {
    double now_s = moment(t, time_s, dt_s);
    feel(t, c, emotion, is_fresh(c) || looks(t, time_s, dt_s));
    settle(t, c, time_s);
    memcpy(words(t, c), said, t->gestures * sizeof *said);
    evaluate(t, c, now_s, habit, f);
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
    for (uint32_t row = 0; row < call->count; row++) {
        Character *c = character(t, call->characters, row);
        const double *emotion = call->signal + row * (FEELINGS + t->gestures), *said = emotion + FEELINGS;
        memset(c->started, 0, sizeof c->started);
        if (is_due(t, c, emotion, said, call->time_s, call->dt_s))
            judge_one(t, c, emotion, said, call->time_s, call->dt_s, &call->habit, call->factors);
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
        const double *emotion = call->signal + row * (FEELINGS + t->gestures), *said = emotion + FEELINGS;
        feel(t, c, emotion, true);
        settle(t, c, call->times_s[row]);
        memcpy(words(t, c), said, t->gestures * sizeof *said);
        Factors *f = (Factors *)((uint8_t *)call->factors + row * factors_bytes);
        evaluate(t, c, moment(t, call->times_s[row], call->dt_s), &call->habit, f);
    }
}
