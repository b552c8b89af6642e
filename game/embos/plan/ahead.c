// Many ticks of characters that each have a clock of their own, where all that reaches them is known beforehand.
#include "plan.h"

// A tick that is told of, see Told.
typedef struct {
    int64_t row, unit[LAYERS];
    double time_s, numbers[LAYERS][11];
    uint8_t started[LAYERS], unused[5];
} Happening;

_Static_assert(sizeof(Happening) == 312, "as in judging.py");

typedef struct {
    double dt_s, half_window_s, lead_radius;
    Habit habit;
    const Tables *tables;
    Character *characters;
    const int64_t *rows;
    uint32_t count;         // of rows; what follows stands for each of them
    const double *emotion;  // [ticks][7]
    uint32_t ticks, cues;
    const int64_t *cue;   // [cues] gesture of each word
    const double *cue_s;  // [cues] its moment, infinite where there are no more
    const int64_t *tick;  // the first one's number
    const int64_t *length;
    const uint8_t *told;  // the first tick is told of whatever happens in it
    int64_t *at;          // ticks gone through
    Factors *factors;
    Happening *happenings;
    uint32_t most, *happened;
    Character *before;   // as they were before what happened, or nowhere
    double *emotions, *words;
} Ahead;

// The words that stand at a moment: a gesture's stroke falls on its word, so its window opens earlier by the time that
// the unit needs to reach its stroke (GestureCues.factors).
static void listen(const Ahead *a, uint32_t i, const double *emotion, double time_s, double *said) {
    const Tables *t = a->tables;
    memset(said, 0, t->gestures * sizeof *said);
    for (uint32_t n = 0; n < a->cues; n++) {
        double cue_s = a->cue_s[i * a->cues + n], weights[FEELINGS];
        if (cue_s == INFINITY) break;
        int64_t gesture = a->cue[i * a->cues + n], slot = t->first_gesture + gesture;
        const double *lead_s = t->leads_s + 2 * gesture;
        if (time_s < cue_s - lead_s[1] - a->half_window_s || time_s > cue_s - lead_s[0] + a->half_window_s) continue;
        mix_weights(t, emotion, slot, a->lead_radius, weights);
        double to_stroke_s = mixed(t->timing_s + (slot * 3 + 2) * FEELINGS, weights);
        if (fabs(time_s - (cue_s - to_stroke_s)) <= a->half_window_s) said[gesture] = 1;
    }
}

// Every row goes through its ticks, until there is no room to tell of more.
EXPORT(follow) {
    static double said[MOST_UNITS];
    const Ahead *a = PARAMETERS(Ahead);
    const Tables *t = a->tables;
    *a->happened = 0;
    for (uint32_t i = 0; i < a->count; i++) {
        Character *c = character(t, a->characters, a->rows[i]);
        for (; a->at[i] < a->length[i]; a->at[i]++) {
            if (*a->happened == a->most) return;
            const double *emotion = a->emotion + (i * a->ticks + a->at[i]) * FEELINGS;
            double time_s = (double)(a->tick[i] + a->at[i]) * a->dt_s;
            bool told = a->told[i] && a->at[i] == 0;
            listen(a, i, emotion, time_s, said);
            memset(c->started, 0, sizeof c->started);
            if (is_due(t, c, emotion, said, time_s, a->dt_s)) {
                if (a->before) memcpy(character(t, a->before, *a->happened), c, t->character_bytes);
                judge_one(t, c, emotion, said, time_s, a->dt_s, &a->habit, a->factors);
            }
            if (!told && !(c->started[0] | c->started[1] | c->started[2])) continue;
            Happening *happening = &a->happenings[*a->happened];
            happening->row = i;
            happening->time_s = time_s;
            memcpy(happening->unit, c->unit, sizeof c->unit);
            memcpy(happening->numbers, c->numbers, sizeof c->numbers);
            memcpy(happening->started, c->started, sizeof c->started);
            memcpy(a->emotions + *a->happened * FEELINGS, emotion, FEELINGS * sizeof *emotion);
            memcpy(a->words + *a->happened * t->gestures, said, t->gestures * sizeof *said);
            ++*a->happened;
        }
    }
}
