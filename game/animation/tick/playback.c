// Where every running unit stands in its clip, and what the mixed variants say at that moment (EMBOS eq. 5).
#include "tick.h"

// Limits of the playback rate as stretch of the natural length: never slower than 0.75, never faster than 1.35.
static const double LONGEST = 1 / 0.75, SHORTEST = 1 / 1.35;
// Share of the part after the stroke that may be held when a unit has to last longer; a hold adds at most HOLD_MOST of
// the held part's own length, so that it never stands still.
static const double HOLD_START = 0.2, HOLD_END = 0.8, HOLD_MOST = 0.8;
// Variants below this share are left out; it is subtracted first, so nothing jumps when one comes in.
static const float LEAST_WEIGHT = 0.02f;
static const float TAU = 6.28318531f;

// Weights as they are mixed: the least left out, the sum 1.
static void share_out(const float weight[EMOTIONS], float shares[EMOTIONS]) {
    float total = 0;
    for (int k = 0; k < EMOTIONS; k++) {
        shares[k] = most(weight[k] - LEAST_WEIGHT, 0);
        total += shares[k];
    }
    // All are at most the least only where there is no variant at all.
    total = most(total, LEAST_WEIGHT);
    for (int k = 0; k < EMOTIONS; k++) shares[k] /= total;
}

// Starts a unit; the tick plays its first frame.
static void begin(
    const Tick *tick, Character *c, int at, int unit, double duration_s, double pick, const double weight[EMOTIONS]) {
    const Bank *bank = tick->bank;
    const Unit *u = &bank->units[unit];
    Layer *layer = &c->layers[at];
    bool loops = at == bank->order[0];
    double frame_s = 1 / bank->rows_per_s, before = 0, after = 0, around = 0;
    float weights[EMOTIONS];
    layer->unit = unit;
    layer->active = 0;
    for (int k = 0; k < EMOTIONS; k++) {
        int slot = (int)(pick * u->count[k]);
        slot = slot < u->count[k] ? slot : u->count[k] - 1;
        const Variant *v = &bank->variants[(unit * EMOTIONS + k) * bank->most_variants + (slot > 0 ? slot : 0)];
        layer->first[k] = v->first;
        layer->frames[k] = v->frames;
        layer->active |= u->count[k] > 0;
        before += weight[k] * v->before_s;
        after += weight[k] * v->after_s;
        around += weight[k] * v->frames;
        weights[k] = (float)weight[k];
    }
    share_out(weights, layer->weight);
    after = fmax(after, frame_s);
    // After the stroke the clip is stretched within limits, then a middle part is repeated or slowed.
    double left = layer->frames[0] - u->stroke, wanted = fmax(duration_s - before, frame_s);
    double played = fmin(fmax(wanted, after * SHORTEST), after * LONGEST), rate = left / played;
    double extra = fmax(wanted - played, 0) * rate, room = (HOLD_END - HOLD_START) * left;
    double held = u->loop_frames > 0 ? 0 : fmin(extra, HOLD_MOST * room);
    // A posture never comes to its stroke or its end.
    layer->before_s = loops ? INFINITY : (float)before;
    layer->last = loops ? INFINITY : layer->frames[0];
    layer->lead_rate = loops ? bank->rows_per_s : (float)(u->stroke / fmax(before, 1e-6));
    layer->after_rate = (float)rate;
    layer->hold_first = (float)(u->stroke + HOLD_START * left);
    layer->hold_length = (float)(room + held);
    layer->held = loops ? 0 : (float)held;
    layer->loop_first = u->loop_first;
    layer->loop_frames = u->loop_frames;
    layer->loop_times = u->loop_frames > 0 ? (float)rint(extra / fmax(u->loop_frames, 1)) : 0;
    layer->lap = 0;
    // Postures come in anywhere in their loop, so that the same one does not look the same twice.
    double turns = pick * 7.31, phase = loops ? (turns - floor(turns)) * around * frame_s : 0;
    layer->elapsed_s = (float)(phase - tick->dt_s);
    if (loops) memcpy(c->held, weights, sizeof weights);
}

// The held posture's weights drawn toward the present emotion's mix, slowly enough never to flicker.
//
// Eq. 5's exponent is −(|i'|² − 2·i'_k·i_k + i_k²) / r²; what is the same for all k cancels in the shares.
static void drift(const Tick *tick, Character *c, const double emotion[EMOTIONS]) {
    Layer *layer = &c->layers[tick->bank->order[0]];
    if (layer->unit < 0) return;
    const Unit *u = &tick->bank->units[layer->unit];
    float goal[EMOTIONS], highest = -INFINITY, total = 0;
    for (int k = 0; k < EMOTIONS; k++) {
        goal[k] = u->mix_slope[k] * (float)emotion[k] + u->mix_level[k];
        highest = most(highest, goal[k]);
    }
    for (int k = 0; k < EMOTIONS; k++) total += goal[k] = expf(goal[k] - highest);
    for (int k = 0; k < EMOTIONS; k++) c->held[k] += (goal[k] / total - c->held[k]) * tick->drift;
    share_out(c->held, layer->weight);
}

// The frame a unit has come to.
static float frame_now(Layer *layer) {
    float past = layer->elapsed_s - layer->before_s;
    float at = least(layer->elapsed_s, layer->before_s) * layer->lead_rate;
    if (past > 0) at += past * layer->after_rate;
    layer->rate = past < 0 ? layer->lead_rate : layer->after_rate;
    if (layer->loop_times > 0) {
        layer->lap = clamp(floorf((at - layer->loop_first) / most(layer->loop_frames, 1)), 0, layer->loop_times);
        at -= layer->lap * layer->loop_frames;
    }
    if (layer->held > 0) {
        float length = most(layer->hold_length, 1e-6f);
        float u = TAU * clamp((at - layer->hold_first) / length, 0, 1);
        at -= layer->held * (u - sinf(u)) / TAU;
        layer->rate *= 1 - layer->held / length * (1 - cosf(u));
    }
    return at;
}

bool run(Layer *layer, bool loops, float dt_s) {
    float lap = layer->lap;
    layer->elapsed_s += dt_s;
    if (!layer->active) return false;
    float at = frame_now(layer);
    if (at >= layer->last) {
        layer->active = 0;
        return true;
    }
    for (int k = 0; k < EMOTIONS; k++) {
        float frame = loops ? at - floorf(at / layer->frames[k]) * layer->frames[k] : at;
        float low = clamp(truncf(frame), 0, layer->frames[k] - 1);
        layer->row[k] = layer->first[k] + (int32_t)low;
        layer->part[k] = frame - low;
    }
    return layer->lap != lap;
}

int play(const Tick *tick, Character *c, const Signal *signal) {
    const Bank *bank = tick->bank;
    int events = 0;
    for (int at = 0; at < LAYERS; at++) {
        bool held = tick->held >> at & 1;
        int unit = held ? bank->rest[at] : signal->unit[at];
        // A posture that is chosen again goes on; a layer that is held does not hear the planner's starts.
        bool again = signal->started[at] && !held && at != bank->order[0];
        if (unit == c->layers[at].unit && !again) continue;
        const double *numbers = signal->numbers[at];
        double weight[EMOTIONS];
        for (int k = 0; k < EMOTIONS; k++) weight[k] = held ? bank->rest_weight[at][k] : numbers[WEIGHTS + k];
        begin(tick, c, at, unit, numbers[DURATION_S], numbers[PICK], weight);
        events |= 1 << at;
    }
    for (int at = 0; at < LAYERS; at++)
        if (run(&c->layers[at], at == bank->order[0], (float)tick->dt_s)) events |= 1 << at;
    static const double neutral[EMOTIONS] = {[EMOTIONS - 1] = 1};
    drift(tick, c, tick->held ? neutral : signal->emotion);
    return events;
}

void say(const Tick *tick, const Layer *layer, bool speed, float *restrict out) {
    // One after the other: so many numbers stay in the cache next to the processor.
    const float *rows[2 * EMOTIONS];
    float shares[2 * EMOTIONS];
    int count = 0;
    for (int k = 0; k < EMOTIONS; k++) {
        float weight = layer->weight[k];
        if (weight == 0) continue;
        const float *before = tick->bank->rows[layer->row[k]];
        float to = weight * (speed ? layer->rate : layer->part[k]);
        rows[count] = before, shares[count++] = speed ? -to : weight - to;
        rows[count] = before + ROW, shares[count++] = to;
    }
    enum { WIDE = 16 };
    for (int first = 0; first < ROW; first += WIDE) {
        float sum[WIDE] = {0};
        for (int r = 0; r < count; r++)
            for (int i = 0; i < WIDE; i++) sum[i] += shares[r] * rows[r][first + i];
        memcpy(out + first, sum, sizeof sum);
    }
}
