// What tests ask for: where the fields of the structs lie (they are compared with game/animation/tick_data.py), and
// stages alone.
#include "tick.h"

#define SIZE(type) (uint32_t)sizeof(type)
#define AT(type, field) (uint32_t)offsetof(type, field)

static const uint32_t LAYOUT[] = {
    CHANNELS, ROW, LAYERS, PARTS,
    SIZE(Variant), AT(Variant, first), AT(Variant, frames), AT(Variant, before_s), AT(Variant, after_s),
    SIZE(Unit), AT(Unit, count), AT(Unit, stroke), AT(Unit, loop_first), AT(Unit, loop_frames), AT(Unit, owned),
    AT(Unit, frame), AT(Unit, looks), AT(Unit, mix_slope), AT(Unit, mix_level),
    SIZE(Bank), AT(Bank, rows), AT(Bank, units), AT(Bank, variants), AT(Bank, most_variants), AT(Bank, order),
    AT(Bank, rows_per_s), AT(Bank, rest), AT(Bank, rest_weight),
    SIZE(Run), AT(Run, first), AT(Run, count), AT(Run, part),
    SIZE(Effect), AT(Effect, cue), AT(Effect, channel), AT(Effect, amount),
    SIZE(Ellipsoid), AT(Ellipsoid, joint), AT(Ellipsoid, inverse), AT(Ellipsoid, middle),
    AT(Ellipsoid, near_square),
    SIZE(Setup), AT(Setup, sway_pace), AT(Setup, breath_hz), AT(Setup, breath_depth), AT(Setup, sway), AT(Setup, tempo),
    AT(Setup, darts_per_s), AT(Setup, dart_size), AT(Setup, blinks_per_min), AT(Setup, arc), AT(Setup, sway_rate),
    AT(Setup, transition_s), AT(Setup, eye_half_life_s), AT(Setup, mood_half_life_s), AT(Setup, blink_s),
    AT(Setup, head_stiffness), AT(Setup, torso_stiffness), AT(Setup, head_share), AT(Setup, torso_share),
    AT(Setup, eye_yaw_rad), AT(Setup, eye_pitch_rad), AT(Setup, nod_rad), AT(Setup, breath), AT(Setup, blink_at),
    AT(Setup, blink), AT(Setup, effect_count), AT(Setup, effects), AT(Setup, run_count), AT(Setup, runs),
    AT(Setup, joint), AT(Setup, parent), AT(Setup, offset), AT(Setup, frame_joint), AT(Setup, bones), AT(Setup, limbs),
    AT(Setup, feet), AT(Setup, eyes), AT(Setup, body), AT(Setup, point_radius), AT(Setup, reach_m),
    AT(Setup, table_top_m), AT(Setup, table_back_z_m), AT(Setup, table_front_z_m),
    SIZE(Layer), AT(Layer, unit), AT(Layer, active), AT(Layer, first), AT(Layer, frames), AT(Layer, weight),
    AT(Layer, before_s), AT(Layer, lead_rate), AT(Layer, after_rate), AT(Layer, hold_first), AT(Layer, hold_length),
    AT(Layer, held), AT(Layer, loop_first), AT(Layer, loop_frames), AT(Layer, loop_times), AT(Layer, last),
    AT(Layer, elapsed_s), AT(Layer, lap), AT(Layer, rate), AT(Layer, row), AT(Layer, part),
    SIZE(Character), AT(Character, key), AT(Character, darts), AT(Character, blinks), AT(Character, phase),
    AT(Character, clock), AT(Character, breaths), AT(Character, dart_left_s), AT(Character, blink_left_s),
    AT(Character, blink_age_s), AT(Character, head), AT(Character, head_speed), AT(Character, attention),
    AT(Character, voice), AT(Character, dart), AT(Character, aim), AT(Character, leap), AT(Character, held),
    AT(Character, layers), AT(Character, known), AT(Character, adopted), AT(Character, owned), AT(Character, gate),
    AT(Character, frame), AT(Character, looks), AT(Character, left), AT(Character, pace), AT(Character, offset),
    AT(Character, excess), AT(Character, bow), AT(Character, row), AT(Character, frames), AT(Character, off),
    AT(Character, rotation), AT(Character, root), AT(Character, gaze), AT(Character, blink), AT(Character, breath),
    SIZE(Signal), AT(Signal, emotion), AT(Signal, gaze_target), AT(Signal, speaking), AT(Signal, numbers),
    AT(Signal, unit), AT(Signal, started),
};

typedef struct { uint32_t *count, *layout; } Told;
EXPORT(layout) {
    const Told *told = PARAMETERS(Told);
    *told->count = sizeof LAYOUT / sizeof *LAYOUT;
    memcpy(told->layout, LAYOUT, sizeof LAYOUT);
}

// One limb: what it hangs on, upper, lower bone and end, and the goal -> their turns in their parents' frames.
typedef struct { const Limb *limb; const Rigid *bones; Quat *local; } LimbCall;
EXPORT(limb_alone) {
    const LimbCall *call = PARAMETERS(LimbCall);
    const Rigid *b = call->bones;
    place_limb(call->limb, b[0].turn, &b[1], &b[2], &b[3], &b[4], call->local);
}

// The push of both hands; figure, goals and points as in clear_hands.
typedef struct { const Setup *setup; const Rigid *figure, *goals; const float *points; Vec3 *push; } HandsCall;
EXPORT(hands_alone) {
    const HandsCall *call = PARAMETERS(HandsCall);
    clear_hands(call->setup, call->figure, call->goals, call->points, call->push);
}

// A layer's unit, a tick further.
typedef struct { Layer *layer; int32_t loops, *event; float dt_s; } RunCall;
EXPORT(unit_alone) {
    const RunCall *call = PARAMETERS(RunCall);
    *call->event = run(call->layer, call->loops, call->dt_s);
}
