// Layers into one row, and transitions that never pop (SPEC 6).
//
// The posture moves the whole body; a gesture and a mannerism replace the parts they own and add a trace to torso and
// head. Whenever the source of a part changes, the difference between what was shown and what is wanted is kept and
// dies away along a minimum-jerk curve (inertialisation after Bollo, GDC 2018): place and velocity stay continuous, and
// the acceleration starts and ends at 0. The curve is closed-form, so the frame rate does not matter.
#include "tick.h"

// Limits of a transition's length.
static const float SHORTEST_S = 0.2f, LONGEST_S = 1.4f;
// A transition lasts base · (a + b · √(turn / 90°)): far moves take longer (Fitts).
static const float GROWTH_A = 0.6f, GROWTH_B = 0.7f;
// A gesture's preparation must be free of the past before its stroke: at most this share of the time up to it.
static const float STROKE_SHARE = 0.85f;
// Speed left over from the old source is braked within min(span, this / speed): it carries a joint at most 0.2 × this
// (half radians) too far, a wrist at most 0.2 × this × an arm's length.
static const float MOMENTUM = 0.55f, SHORTEST_BRAKE_S = 0.12f;
// A hand's way bows out, up and forward by the emotion's arc times its length (MOTION.md, hands).
static const float ARC[2][3] = {{0.55f, 0.5f, 0.65f}, {-0.55f, 0.5f, 0.65f}};
static const float LONGEST_ARC_M = 0.12f;
// A bowed way takes at least this times √(bow in metres) seconds: higher bows need time.
static const float ARC_PACE = 1.3f;
// Between below and above the table a hand goes round its edge: it bows up by this and what it lacks of this height.
static const float EDGE_LIFT_M = 0.05f, EDGE_CLEAR_M = 0.13f;
// A wrist's way counts as the turn of an arm of this length.
static const float ARM_M = 0.42f;

enum { OFFSET, EXCESS };
// What a unit moves besides what it owns.
enum { TRACED = 1 << SPINE | 1 << HEAD | 1 << LEFT_ARM | 1 << RIGHT_ARM };
static const float FOUR_OVER_PI = 1.27323954f;

// What all layers say through their gates.
static void compose(const Tick *tick, const Character *c, bool speed, float row[ROW]) {
    const Setup *setup = tick->setup;
    memset(row, 0, ROW * sizeof *row);
    for (int order = 0; order < LAYERS; order++) {
        int at = tick->bank->order[order];
        if (!c->layers[at].active) continue;
        float said[ROW];
        say(tick, &c->layers[at], speed, said);
        for (int r = 0; r < setup->run_count; r++) {
            Run run = setup->runs[r];
            if (c->gate[at] >> run.part & 1)
                for (int i = run.first; i < run.first + run.count; i++) row[i] += said[i];
        }
    }
}

// What is left of the transitions, or how fast it changes, is added to a row.
//
// With v in [1, 0] what is left of their time and u = 1 − v: quintic Hermite curves of value 1 -> 0,
// v³ · (1 + 3u + 6u²), and of slope 1 -> 0, v³ · (u + 3u²), which have no speed and acceleration but this at either
// end; and for the hands' bows a bump of height 1 with neither, 64·u³v³.
static void add_remains(const Setup *setup, const Character *c, bool speed, float row[ROW]) {
    float offset[PARTS], excess[PARTS], bow[PARTS];
    bool any = false;
    for (int p = 0; p < PARTS; p++) {
        float v = c->left[OFFSET][p], w = c->left[EXCESS][p], u = 1 - v;
        any |= v > 0;
        if (speed) { // v dies away by its pace
            float by = -c->pace[OFFSET][p], by_excess = -c->pace[EXCESS][p];
            offset[p] = by * v * v * (30 + v * (-60 + v * 30));
            excess[p] = by_excess * w * w * (12 + w * (-28 + w * 15));
            bow[p] = by * 192 * u * u * v * v * (u - v);
        } else {
            offset[p] = v * v * v * (10 + v * (-15 + v * 6));
            excess[p] = w * w * w * (4 + w * (-7 + w * 3));
            bow[p] = 64 * u * u * u * v * v * v;
        }
    }
    if (!any) return;
    for (int r = 0; r < setup->run_count; r++) {
        Run run = setup->runs[r];
        float a = offset[run.part], b = excess[run.part];
        if (c->left[OFFSET][run.part] > 0)
            for (int i = run.first; i < run.first + run.count; i++) row[i] += a * c->offset[i] + b * c->excess[i];
    }
    for (int i = 0; i < 6; i++) row[WRIST + i] += bow[LEFT_ARM + i / 3] * c->bow[i];
}

void shown_speed(const Tick *tick, const Character *c, float out[ROW]) {
    memset(out, 0, ROW * sizeof *out);
    if (c->adopted) memcpy(out, c->excess, ROW * sizeof *out);
    if (c->adopted || !c->known) return;
    compose(tick, c, true, out);
    add_remains(tick->setup, c, true, out);
}

// Which layer is heard in each part, and the contact frames of the hands.
static void open_gates(const Bank *bank, Character *c) {
    int unheard = ALL_PARTS;
    c->looks = 0;
    for (int order = 0; order < LAYERS; order++) {
        // The posture comes last: what nobody else has taken.
        int at = bank->order[(order + 1) % LAYERS];
        bool posture = at == bank->order[0];
        const Layer *layer = &c->layers[at];
        const Unit *unit = &bank->units[layer->unit];
        c->owned[at] = layer->active ? unit->owned : 0;
        c->gate[at] = layer->active || posture ? unheard : 0;
        int taken = unheard & c->owned[at];
        for (int hand = 0; hand < 2; hand++)
            if ((posture ? unheard : taken) >> (LEFT_ARM + hand) & 1) c->frame[hand] = unit->frame[hand];
        unheard &= ~taken;
        c->looks |= layer->active && unit->looks;
    }
}

// A hand's place and turn, or their speeds, as another contact frame sees them.
static void into_frame(const Rigid *old, const Rigid *new, bool speed, float wrist[3], float palm[4]) {
    Quat back = conjugate(new->turn), turn = multiply(back, old->turn);
    Vec3 w = rotate(turn, vec3(wrist[0], wrist[1], wrist[2]));
    if (!speed) w = add(w, rotate(back, sub(old->place, new->place)));
    Quat p = multiply(turn, (Quat){palm[0], palm[1], palm[2], palm[3]});
    memcpy(wrist, &w, sizeof w);
    memcpy(palm, &p, sizeof p);
}

// Quaternions of a row turned to the goal's hemisphere (the same rotations).
static void same_side(float row[ROW], float speed[ROW], const float goal[ROW]) {
    for (int q = 0; q < WRIST; q += 4) {
        float along = row[q] * goal[q] + row[q + 1] * goal[q + 1] + row[q + 2] * goal[q + 2] + row[q + 3] * goal[q + 3];
        if (along >= 0) continue;
        for (int i = q; i < q + 4; i++) row[i] = -row[i], speed[i] = -speed[i];
    }
}

// How far a hand's way bows, in its contact frame.
static Vec3 bow_of(const Setup *setup, int hand, const float *start, const float *end, float arc, const Rigid *frame) {
    Vec3 ways[2] = {vec3(start[0], start[1], start[2]), vec3(end[0], end[1], end[2])};
    float size = clamp(arc * length(sub(ways[1], ways[0])), -LONGEST_ARC_M, LONGEST_ARC_M);
    Vec3 bow = scale(vec3(ARC[hand][0], ARC[hand][1], ARC[hand][2]), size);
    Vec3 from = point_from(frame, ways[0]), to = point_from(frame, ways[1]);
    bool passes = (from.z < setup->table_back_z_m) != (to.z < setup->table_back_z_m);
    if (passes && least(from.y, to.y) < setup->table_top_m + EDGE_LIFT_M) {
        float height = 0.5f * (from.y + to.y) - setup->table_top_m;
        float lift = EDGE_LIFT_M + clamp(EDGE_CLEAR_M - height, 0, EDGE_CLEAR_M);
        bow = add(bow, rotate(conjugate(frame->turn), vec3(0, lift, 0)));
    }
    return bow;
}

// The largest change of a joint by part, half radians; a wrist's way counts as the arm's turn.
static void largest(const Setup *setup, const float row[ROW], float by_part[PARTS]) {
    for (int p = 0; p < PARTS; p++) by_part[p] = 0;
    for (int r = 0; r < setup->run_count; r++) {
        Run run = setup->runs[r];
        bool wrist = run.first >= WRIST && run.first < ROOT;
        if (run.first >= PALM && !wrist) continue;
        int step = wrist ? 3 : 4;
        for (int i = run.first; i < run.first + run.count; i += step) {
            float square = 0;
            for (int k = i; k < i + step; k++) square += row[k] * row[k];
            by_part[run.part] = most(by_part[run.part], sqrtf(square) * (wrist ? 0.5f / ARM_M : 1));
        }
    }
}

// Takes up new sources. events: layers whose source jumped; goal: what is wanted now.
static void switch_sources(
    const Tick *tick, const Character *before, Character *c, int events, const double share[EMOTIONS],
    const float goal[ROW]) {
    const Setup *setup = tick->setup;
    float dt_s = (float)tick->dt_s, row[ROW], speed[ROW], goal_speed[ROW];
    memcpy(row, before->row, sizeof row);
    shown_speed(tick, before, speed);
    compose(tick, c, true, goal_speed);
    for (int hand = 0; hand < 2; hand++) {
        if (before->frame[hand] == c->frame[hand]) continue;
        const Rigid *old = &before->frames[before->frame[hand]], *new = &before->frames[c->frame[hand]];
        int wrist = WRIST + 3 * hand, palm = PALM + 4 * hand;
        into_frame(old, new, false, row + wrist, row + palm);
        into_frame(old, new, true, speed + wrist, speed + palm);
    }
    for (int i = 0; i < ROW; i++) row[i] += speed[i] * dt_s;
    same_side(row, speed, goal);

    double base_s = 0, arc = 0;
    for (int k = 0; k < EMOTIONS; k++) {
        base_s += setup->transition_s * share[k] * setup->tempo[k];
        arc += share[k] * setup->arc[k];
    }
    Vec3 bow[2];
    float offset[ROW], excess[ROW], turn[PARTS], pace[PARTS];
    for (int i = 0; i < ROW; i++) offset[i] = row[i] - goal[i], excess[i] = speed[i] - goal_speed[i];
    largest(setup, offset, turn);
    largest(setup, excess, pace);
    for (int hand = 0; hand < 2; hand++) {
        int wrist = WRIST + 3 * hand;
        bow[hand] = bow_of(setup, hand, row + wrist, goal + wrist, (float)arc, &before->frames[c->frame[hand]]);
    }

    int fresh = 0;
    for (int at = 0; at < LAYERS; at++) {
        int traced = at == tick->bank->order[0] ? 0 : TRACED;
        if (events >> at & 1) fresh |= c->owned[at] | before->owned[at] | traced;
    }
    for (int p = 0; p < PARTS; p++) {
        if (!(fresh >> p & 1)) continue;
        float growth = GROWTH_A + GROWTH_B * sqrtf(turn[p] * FOUR_OVER_PI);
        float span = clamp((float)base_s * growth, SHORTEST_S, LONGEST_S);
        if (p == LEFT_ARM || p == RIGHT_ARM) span = most(span, ARC_PACE * sqrtf(length(bow[p - LEFT_ARM])));
        for (int at = 0; at < LAYERS; at++) {
            // At the longest until the stroke that a gesture is on its way to.
            float until = STROKE_SHARE * (c->layers[at].before_s - c->layers[at].elapsed_s);
            if (c->owned[at] >> p & 1 && until > 0) span = least(span, most(until, SHORTEST_S));
        }
        float brake = least(most(MOMENTUM / most(pace[p], 1e-3f), SHORTEST_BRAKE_S), span);
        c->pace[OFFSET][p] = 1 / span;
        c->pace[EXCESS][p] = 1 / brake;
        // The tick that comes now takes its share of what is left: it shows the beginning.
        for (int kind = 0; kind < 2; kind++) c->left[kind][p] = 1 + c->pace[kind][p] * dt_s;
        for (int r = 0; r < setup->run_count; r++) {
            Run run = setup->runs[r];
            if (run.part != p) continue;
            for (int i = run.first; i < run.first + run.count; i++) {
                c->offset[i] = offset[i];
                c->excess[i] = excess[i] * brake;
            }
        }
        if (p == LEFT_ARM || p == RIGHT_ARM) memcpy(c->bow + 3 * (p - LEFT_ARM), &bow[p - LEFT_ARM], sizeof(Vec3));
    }
}

void blend(const Tick *tick, const Character *before, Character *c, int events, const double share[EMOTIONS]) {
    float dt_s = (float)tick->dt_s;
    if (events) open_gates(tick->bank, c);
    compose(tick, c, false, c->row);
    if (events && before->known) {
        c->adopted = 0;
        switch_sources(tick, before, c, events, share, c->row);
    }
    c->known = 1;
    for (int kind = 0; kind < 2; kind++)
        for (int p = 0; p < PARTS; p++)
            c->left[kind][p] = most(c->left[kind][p] - c->pace[kind][p] * dt_s, 0);
    add_remains(tick->setup, c, false, c->row);
}
