// What a change of emotion changes: φ_state of eq. 1, the mixing of eq. 5, and waits that a strong feeling shortens.
#include "plan.h"

// Differences d closer than this are equal in rank.
static const double STEPS = 0x1p40;
enum { PLACE_BITS = 10 };  // MOST_UNITS
// A change of any of the seven emotions beyond this is one that strikes.
static const double LEAP = 0.35;
// Relative weights below exp(this) are kept there: they are nothing, and must not underflow.
static const double LOWEST_LOG = -600;

// The largest difference of any of the seven.
double apart(const double *a, const double *b) {
    double most_apart = 0;
    for (int k = 0; k < FEELINGS; k++) most_apart = larger(most_apart, fabs(a[k] - b[k]));
    return most_apart;
}

// Insertion sort, ascending: linear where the order has hardly changed.
static void sort(int64_t *keys, int count) {
    for (int i = 1; i < count; i++) {
        int64_t key = keys[i];
        int to = i;
        for (; to > 0 && keys[to - 1] > key; to--) keys[to] = keys[to - 1];
        keys[to] = key;
    }
}

// φ_state without words: constant thresholds for rest, (1 − d) · (n − rank + 1)/n · presence for the others.
// order: by layer, the places of its real units from the smallest d to the largest, as they were found last.
static void compute_phi_state(const Tables *t, const double *emotion, double *phi, int16_t *order) {
    static double d[LAYERS * MOST_UNITS], presence[LAYERS * MOST_UNITS];
    static int64_t keys[MOST_UNITS];
    int slots = t->slots;
    double total = 0;
    for (int k = 0; k < FEELINGS; k++) total += emotion[k];
    total = larger(total, 1e-12);
    memset(d, 0, slots * sizeof *d);
    memset(presence, 0, slots * sizeof *presence);
    for (int k = 0; k < FEELINGS; k++) {
        double felt = emotion[k];
        if (felt == 0) continue;  // what is not felt does not count
        const double *intensity = t->intensity_by_feeling + k * slots, *exists = t->exists_by_feeling + k * slots;
        for (int p = 0; p < slots; p++) {
            d[p] += felt * fabs(felt - intensity[p]);  // d = Σ_k i'_k·|i'_k − i_k| / Σ_k i'_k
            presence[p] += felt * exists[p];           // Σ_k i'_k·σ_k / Σ_k i'_k
        }
    }
    double share = t->presence / total, rest = 1 - t->presence;
    for (int p = 0; p < slots; p++) {
        d[p] /= total;
        presence[p] = presence[p] * share + rest;
    }
    memcpy(phi, t->constant_state, slots * sizeof *phi);
    for (int layer = 0; layer < LAYERS; layer++) {
        int first = layer * t->width, count = t->count[layer];
        for (int i = 0; i < count; i++) {
            int place = order[first + i];
            // Rounded, not cut: values such as ½ are whole steps, and noise must not push them below.
            keys[i] = (int64_t)(smaller(d[first + place], 1) * STEPS + 0.5) << PLACE_BITS | place;
        }
        sort(keys, count);
        double rank_share = 1;  // (n − rank + 1)/n; equal d share the best rank
        for (int i = 0; i < count; i++) {
            int place = keys[i] & (MOST_UNITS - 1), p = first + place;
            if (i && keys[i] >> PLACE_BITS > keys[i - 1] >> PLACE_BITS) rank_share = 1 - (double)i / count;
            order[first + i] = place;
            phi[p] = (1 - d[p]) * rank_share * presence[p];
        }
    }
}

// Before its first tick.
bool is_fresh(const Character *c) { return !(c->starts[0] | c->starts[1] | c->starts[2]); }

// φ_state anew where the emotion has moved.
void feel(const Tables *t, Character *c, const double *emotion, bool looking) {
    if (!looking || apart(emotion, c->emotion) <= t->tolerance) return;
    memcpy(c->emotion, emotion, sizeof c->emotion);
    compute_phi_state(t, emotion, phi_state(t, c), order(t, c));
}

// Normalised σ_k·Γ_k of eq. 5, radial over the whole space: variant k sits at i_k on axis k and at 0 on the others.
void mix_weights(const Tables *t, const double *emotion, int64_t slot, double radius, double *weights) {
    const double *intensity = t->intensity + slot * FEELINGS, *exists = t->exists + slot * FEELINGS;
    double nearest = -1e12, sum = 0;
    for (int k = 0; k < FEELINGS; k++) {
        // |i'|² is the same for every k and falls out of the quotient; i_k² − 2·i'_k·i_k is left of the distance.
        weights[k] = (2 * emotion[k] - intensity[k]) * intensity[k] * (1 / (radius * radius));
        if (exists[k]) nearest = larger(nearest, weights[k]);
    }
    for (int k = 0; k < FEELINGS; k++) {
        weights[k] = exists[k] ? exp(larger(weights[k] - nearest, LOWEST_LOG)) : 0;
        sum += weights[k];
    }
    for (int k = 0; k < FEELINGS; k++) weights[k] /= larger(sum, 1e-300);
}

// Σ_k v_k·w_k.
double mixed(const double *values, const double *weights) {
    double sum = 0;
    for (int k = 0; k < FEELINGS; k++) sum += values[k] * weights[k];
    return sum;
}

// Some way through its waiting time, for each unit of the settled layers of a character about to begin. Where the
// emotion has leapt since, units that have not run yet come sooner: a feeling that strikes shows.
void settle(const Tables *t, Character *c, double time_s) {
    if (!t->settled_count || apart(c->emotion, c->settled) <= LEAP) return;  // … or has never been settled
    bool fresh = is_fresh(c);
    for (int i = 0; i < t->settled_count; i++) {
        int slot = t->settled[i];
        if (!untried(t, c)[slot]) continue;
        double weights[FEELINGS], period_s[FEELINGS], chance;
        const double *timing_s = t->timing_s + slot * 3 * FEELINGS;
        for (int k = 0; k < FEELINGS; k++) period_s[k] = timing_s[k] + timing_s[FEELINGS + k];  // L_d + L_w
        mix_weights(t, c->emotion, slot, t->radius, weights);
        uniform(c->key, slot, fresh ? -1 : -2, 1, &chance);  // events of their own, before the first start
        double due_s = time_s + chance * mixed(period_s, weights) * (fresh ? 1 : t->eager);
        if (fresh || due_s < wait_s(c)[slot]) wait_s(c)[slot] = due_s;
    }
    memcpy(c->settled, c->emotion, sizeof c->settled);
}
