// The stages of a tick, one after the other, for one character after the other.
#include "tick.h"

static const float DRIFT_HALF_LIFE_S = 0.9f;  // how fast a held posture follows the emotion through its variants
static const float PUSH_HALF_LIFE_S = 0.025f; // how softly body and table let go of a hand

// Felt emotion as shares that sum to 1 (their sum is never below 1, eq. 4).
static void shares_of(const Tick *tick, const Signal *signal, double share[EMOTIONS]) {
    double total = 0;
    for (int k = 0; k < EMOTIONS; k++) total += signal->emotion[k];
    for (int k = 0; k < EMOTIONS; k++)
        share[k] = tick->neutral ? k == EMOTIONS - 1 : signal->emotion[k] / fmax(total, 1e-9);
}

static Tick tick_of(const Call *call) {
    const Setup *setup = call->setup;
    double dt_s = call->dt_s;
    // Half the damping of a critical spring, 4 · ln 2 / half-life (game/core/springs.py).
    double y = 2 * 0.6931471805599453 / PUSH_HALF_LIFE_S, decay = exp(-y * dt_s);
    return (Tick){
        .setup = setup,
        .bank = call->bank,
        .dt_s = call->dt_s,
        .held = call->held,
        .neutral = call->neutral,
        .drift = (float)(1 - exp2(-dt_s / DRIFT_HALF_LIFE_S)),
        .mood = (float)(1 - exp2(-dt_s / setup->mood_half_life_s)),
        .eyes = (float)(1 - exp2(-dt_s / setup->eye_half_life_s)),
        .let_go = {
            {(float)(decay * (1 + y * dt_s)), (float)(decay * dt_s)},
            {(float)(decay * -y * y * dt_s), (float)(decay * (1 - y * dt_s))},
        },
    };
}

// The row's turns and places on the figure; hands and feet to where they belong.
static void pose(const Tick *tick, Character *c, const Signal *signal, const float row[ROW], bool collide) {
    const Setup *setup = tick->setup;
    Quat turns[JOINTS + 2];
    memcpy(turns, row, sizeof turns);
    for (int joint = 0; joint < JOINTS + 2; joint++) turns[joint] = normalized(turns[joint]);

    Rigid figure[FIGURE];
    figure[0] = (Rigid){turns[setup->joint[0]], vec3(row[ROOT], row[ROOT + 1], row[ROOT + 2])};
    for (int i = 1; i < FIGURE; i++) {
        const float *offset = setup->offset[i];
        figure[i] = carried(&figure[setup->parent[i]], turns[setup->joint[i]], vec3(offset[0], offset[1], offset[2]));
    }
    c->frames[AT_TABLE] = (Rigid){{0, 0, 0, 1}, {0, 0, 0}};
    for (int at = AT_HEAD; at < CONTACT_FRAMES; at++) c->frames[at] = figure[setup->frame_joint[at]];

    Rigid goals[LIMBS];
    for (int hand = 0; hand < 2; hand++) {
        const float *wrist = row + WRIST + 3 * hand;
        goals[hand] = carried(&c->frames[c->frame[hand]], turns[JOINTS + hand], vec3(wrist[0], wrist[1], wrist[2]));
        const float *foot = setup->feet[hand];
        goals[2 + hand] = (Rigid){{0, 0, 0, 1}, {foot[0], foot[1], foot[2]}};
    }
    if (collide) {
        Vec3 push[2];
        clear_hands(setup, figure, goals, row + POINTS, push);
        hold_off(tick, c, push);
        for (int hand = 0; hand < 2; hand++) {
            const float *off = c->off[0][hand];
            goals[hand].place = add(goals[hand].place, vec3(off[0], off[1], off[2]));
        }
    }
    for (int k = 0; k < LIMBS; k++) {
        const int32_t *bone = setup->bones[k];
        Quat local[3];
        place_limb(
            &setup->limbs[k], figure[bone[0]].turn, &figure[bone[1]], &figure[bone[2]], &figure[bone[3]], &goals[k],
            local);
        for (int i = 0; i < 3; i++) turns[setup->joint[bone[1 + i]]] = local[i];
    }
    look(tick, c, signal->gaze_target, &c->frames[AT_HEAD], &c->frames[AT_CHEST]);
    memcpy(c->rotation, turns, sizeof c->rotation);
    memcpy(c->root, row + ROOT, sizeof c->root);
}

EXPORT(tick) {
    Call call = *PARAMETERS(Call);
    Tick tick = tick_of(&call);
    for (int who = 0; who < call.count; who++) {
        const Character *before = &call.before[who];
        const Signal *signal = &call.signals[who];
        Character *c = &call.after[who];
        double share[EMOTIONS];
        float row[ROW];
        *c = *before;
        shares_of(&tick, signal, share);
        int events = play(&tick, c, signal);
        blend(&tick, before, c, events, share);
        memcpy(row, c->row, sizeof row);
        live(&tick, c, share, signal->speaking, row);
        pose(&tick, c, signal, row, call.collide);
    }
}

// Characters who will move by other units from the next tick on: what they were doing is over, but they are as fast.
EXPORT(leave) {
    Call call = *PARAMETERS(Call);
    Tick tick = tick_of(&call);
    for (int who = 0; who < call.count; who++) {
        Character *c = &call.after[who];
        *c = call.before[who];
        shown_speed(&tick, &call.before[who], c->excess);
        c->adopted = c->known;
        for (int p = 0; p < PARTS; p++) c->left[0][p] = c->left[1][p] = 0;
        for (int at = 0; at < LAYERS; at++) c->layers[at] = (Layer){.unit = -1};
    }
}
