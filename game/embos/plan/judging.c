// Eq. 1 for one character, and what follows from it.
#include "plan.h"

// The running slot stays although another has the best score.
static bool kept(const Tables *t, int layer, int64_t mine, int64_t best, bool held, Factors *f) {
    const double *score = factor(t, f, SCORE);
    // Inside the least time; or nothing has any score at all (an emotion no take has shown); or the best is itself
    // waiting. Filling such gaps with it would give the strongest unit of an emotion more time than it has in the take
    // (random takes: shares agree at r = 0.94; with the running one kept 0.98, worst 0.95).
    if (mine >= t->slots || factor(t, f, LINKAGE)[mine] == 0) return false;
    bool gap = factor(t, f, TIME)[best] <= t->minimum[layer * t->width] && score[mine] > 0;
    return held || gap || score[best] <= 0;
}

// All factors, and the slots chosen: argmax over m of ω_c(m_d, m) · ω_l(m, m_u) · φ_time(m, t) · φ_state(m, t).
void evaluate(const Tables *t, Character *c, double now_s, const Habit *habit, Factors *f) {
    int width = t->width, slots = t->slots;
    double *continuity = factor(t, f, CONTINUITY), *linkage = factor(t, f, LINKAGE), *time = factor(t, f, TIME);
    double *state = factor(t, f, STATE), *score = factor(t, f, SCORE);

    // φ_time: 1 while it runs, the minimum while it waits, steady otherwise.
    const double *until_s = wait_s(c), *minimum = t->minimum;
    double steady = t->steady;
    for (int p = 0; p < slots; p++) time[p] = until_s[p] >= now_s ? minimum[p] : steady;
    for (int layer = 0; layer < LAYERS; layer++) {
        f->within[layer] = c->marks_s[layer][0] >= now_s;
        if (f->within[layer]) time[c->running[layer]] = 1;
    }

    // φ_state, for gestures times the word factor. One under way runs to its end though its word has passed.
    memcpy(state, phi_state(t, c), slots * sizeof *state);
    double *said = words(t, c), *gesture = state + t->first_gesture;
    int64_t running = f->within[t->gesture_layer] ? c->running[t->gesture_layer] - t->first_gesture : -1;
    bool under_way = running >= 0 && running < t->gestures && said[running] < 1;
    double unsaid = under_way ? gesture[running] : 0;
    for (int g = 0, count = t->gestures; g < count; g++) gesture[g] *= said[g];
    if (under_way) gesture[running] = unsaid;
    for (int i = 0; i < habit->count; i++) state[habit->slots[i]] = larger(state[habit->slots[i]], habit->share);

    for (int layer = 0; layer < LAYERS; layer++) {  // a layer depends on those above it
        int first = layer * width, end = first + width;
        memcpy(continuity + first, t->follow + c->running[layer] * width, width * sizeof *continuity);  // ω_c
        for (int p = first; p < end; p++) linkage[p] = 1;
        for (int above = 0; above < layer; above++) {  // ω_l
            const double *blocks = t->blocks + (layer * (slots + 1) + f->chosen[above]) * width;
            for (int place = 0; place < width; place++) linkage[first + place] *= blocks[place];
        }
        for (int p = first; p < end; p++) score[p] = time[p] * state[p] * continuity[p] * linkage[p];
        int64_t mine = c->running[layer], best = first;
        double highest = score[first];
        for (int p = first + 1; p < end; p++) {
            if (score[p] > highest) {
                highest = score[p];
                best = p;
            }
        }
        f->beaten[layer] = best != mine && kept(t, layer, mine, best, c->marks_s[layer][1] >= now_s, f);
        f->chosen[layer] = f->beaten[layer] ? mine : best;
    }
}

// A slot starts in a layer: its duration and waiting time for the present emotion.
static void begin(const Tables *t, Character *c, int layer, int64_t slot, double time_s, double now_s) {
    int64_t left = c->running[layer];
    double ended_s = c->marks_s[layer][0];
    untried(t, c)[slot] = false;
    if (left != slot && ended_s >= now_s) {
        // A unit cut short has had its duration: its waiting time begins now.
        wait_s(c)[left] -= ended_s - time_s;
        c->next_s = smaller(c->next_s, larger(wait_s(c)[left], now_s));
    }
    double draw[3], *numbers = c->numbers[layer], *weights = numbers + 4;
    const double *timing_s = t->timing_s + slot * 3 * FEELINGS;
    uniform(c->key, layer, c->starts[layer], 3, draw);
    mix_weights(t, c->emotion, slot, t->radius, weights);
    double duration_s = mixed(timing_s, weights) * spread_factor(t, draw[0], t->sigma[slot]);  // L_d
    double waiting_s = mixed(timing_s + FEELINGS, weights) * spread_factor(t, draw[1], t->sigma[slot]);  // L_w
    numbers[0] = time_s;
    numbers[1] = larger(duration_s, t->least_s[slot]);
    numbers[2] = draw[2];
    numbers[3] = mixed(timing_s + 2 * FEELINGS, weights);
    c->running[layer] = slot;
    c->starts[layer]++;
    c->unit[layer] = t->unit[slot];
    c->marks_s[layer][0] = time_s + numbers[1];
    c->marks_s[layer][1] = time_s + t->least_s[slot];
    wait_s(c)[slot] = c->marks_s[layer][0] + waiting_s;
    for (int i = 0; i < 2; i++)
        if (c->marks_s[layer][i] >= now_s) c->next_s = smaller(c->next_s, c->marks_s[layer][i]);
}

// Start what was chosen, and note when to look again.
void decide(const Tables *t, Character *c, double time_s, double now_s, Factors *f) {
    const double *time = factor(t, f, TIME), *score = factor(t, f, SCORE);
    bool anew = false;
    for (int layer = 0; layer < LAYERS; layer++) {
        // A unit that wins again after its waiting time starts again; while it waits it is merely kept.
        int64_t chosen = f->chosen[layer];
        bool again = !f->within[layer] && t->real[chosen] && time[chosen] == t->steady;
        c->started[layer] = chosen != c->running[layer] || again;
        anew |= c->started[layer];
    }
    // What can change the decision by time alone: the end of a duration, the least time of a unit that is beaten, the
    // end of a wait after which a unit would score as much as the one chosen. Who starts something is judged from
    // another unit next time, so there every end counts.
    const double *wait = wait_s(c);
    double next_s = INFINITY;
    for (int layer = 0; layer < LAYERS; layer++) {
        double end_s = c->marks_s[layer][0], least_until_s = c->marks_s[layer][1];
        double bar = anew ? -1 : score[f->chosen[layer]] * t->reach[layer];
        if (end_s >= now_s) next_s = smaller(next_s, end_s);
        if (least_until_s >= now_s && (f->beaten[layer] || anew)) next_s = smaller(next_s, least_until_s);
        for (int p = layer * t->width, end = p + t->width; p < end; p++)
            next_s = smaller(next_s, wait[p] >= now_s && score[p] >= bar ? wait[p] : INFINITY);
    }
    c->next_s = next_s;
    int gesture = t->gesture_layer;
    c->calm = !(anew || f->beaten[gesture]) && (f->within[gesture] || !t->real[f->chosen[gesture]]);
    for (int layer = 0; layer < LAYERS; layer++)
        if (c->started[layer]) begin(t, c, layer, f->chosen[layer], time_s, now_s);
}
