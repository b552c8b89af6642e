// One tick of the performer: from the planner's decisions to one pose per character, one character after the other.
//
//   playback    where every unit stands in its clip, what begins (EMBOS eq. 5)
//   blending    layers into one row, transitions without pops (SPEC 6)
//   liveliness  breath, sway, gaze, blinking
//   contacts    where the hands are wanted, and out of body and table
//
// The structs are those of game/animation/tick_data.py, field by field (a test compares them).
#pragma once

#include "../limbs.h"

enum { EMOTIONS = 7, LAYERS = 3, PARTS = 7, JOINTS = 41, FIGURE = 19, LIMBS = 4, SWAYS = 12 };

// A row is all that a unit says about one moment (game/animation/channels.py), rounded up to whole vectors.
enum { PALM = 4 * JOINTS, WRIST = PALM + 8, ROOT = WRIST + 6, POINTS = ROOT + 3, CHANNELS = POINTS + 24, ROW = 208 };
enum { POINTS_PER_HAND = 4 };

// Body parts, and sets of them as bits.
enum { SPINE, HEAD, LEFT_ARM, RIGHT_ARM, LEFT_HAND, RIGHT_HAND, LEGS };
#define ALL_PARTS ((1 << PARTS) - 1)

// Frames a hand can be held in. The table does not move, so its frame is model space.
enum { AT_TABLE, AT_HEAD, AT_CHEST, AT_HIPS, CONTACT_FRAMES };

// ---- what does not change ----

// One recorded variant of a unit. frames: what a posture's loop takes, the last frame of what is played once.
typedef struct {
    int32_t first; // row of its first frame
    float frames, before_s, after_s;
} Variant;

typedef struct {
    int32_t count[EMOTIONS];         // variants, 0 where an emotion has none
    float stroke, loop_first, loop_frames; // frames; the stretch that repeats, of 0 frames where none does
    int32_t owned;                   // parts
    int32_t frame[2];                // of the hands
    int32_t looks;                   // whether it moves the gaze itself
    float mix_slope[EMOTIONS], mix_level[EMOTIONS]; // eq. 5's exponent is slope · i' + level
} Unit;

typedef struct {
    const float (*rows)[ROW];
    const Unit *units;
    const Variant *variants; // [unit][emotion][most_variants]
    int32_t most_variants;
    int32_t order[LAYERS];   // the posture's layer, then the others: who comes first is heard first
    float rows_per_s;
    int32_t rest[LAYERS];    // the unit that says nothing, by layer
    float rest_weight[LAYERS][EMOTIONS];
} Bank;

// Channels first .. first + count belong to a part.
typedef struct { int32_t first, count, part; } Run;
// How much of a cue a channel gets.
typedef struct { int32_t cue, channel; float amount; } Effect;
// A part of the body: the figure's joint it hangs on; a point p of that joint's frame is p / radii + middle in the unit
// sphere's, and touches nothing where its square there is above near_square.
typedef struct { int32_t joint; float inverse[3], middle[3], near_square; } Ellipsoid;

enum { RUNS = 20, EFFECTS = 48, BREATH = 65, BLINK = 4, BODY = 6, POINTS_OF_HAND = 7 };

typedef struct {
    // By emotion: pace of the sway, breaths per second, depth of the breath, sway, tempo; then of the eyes; then the
    // bow of the hands' ways.
    double sway_pace[EMOTIONS], breath_hz[EMOTIONS], breath_depth[EMOTIONS], sway[EMOTIONS], tempo[EMOTIONS];
    double darts_per_s[EMOTIONS], dart_size[EMOTIONS], blinks_per_min[EMOTIONS], arc[EMOTIONS];
    double sway_rate[SWAYS]; // radians per second
    double transition_s, eye_half_life_s, mood_half_life_s, blink_s;
    double head_stiffness, torso_stiffness; // per second, see half_life_to_damping
    float head_share, torso_share, eye_yaw_rad, eye_pitch_rad, nod_rad;
    float breath[BREATH];    // over one cycle
    float blink_at[BLINK], blink[BLINK]; // over one blink
    int32_t effect_count;
    Effect effects[EFFECTS];

    int32_t run_count;
    Run runs[RUNS];
    int32_t joint[FIGURE], parent[FIGURE]; // the figure: torso, head, arms, legs; parents come before their children
    float offset[FIGURE][3];
    int32_t frame_joint[CONTACT_FRAMES];   // the figure's joints that carry contact frames; the table has none
    int32_t bones[LIMBS][4];               // of the figure: what the limb hangs on, upper, lower bone, end
    Limb limbs[LIMBS];
    float feet[2][3];                      // where the ankles stand
    float eyes[3];                         // between the eyes, in the head's frame

    Ellipsoid body[BODY];
    float point_radius[POINTS_OF_HAND];
    float reach_m[POINTS_OF_HAND + 1];     // radii less what may press into the soft body, and a number to spare
    float table_top_m, table_back_z_m, table_front_z_m;
} Setup;

// ---- what changes ----

// A unit on its way through its clips.
typedef struct {
    int32_t unit;   // −1: none yet
    int32_t active; // 0 once it has played to its end
    int32_t first[EMOTIONS];
    float frames[EMOTIONS];
    float weight[EMOTIONS]; // of eq. 5, as mixed
    // Its timing: second of the stroke, frames per second before and after it, first frame, length and added frames of
    // a stretched middle, first frame, frames and times of a repeated one, last frame.
    float before_s, lead_rate, after_rate;
    float hold_first, hold_length, held;
    float loop_first, loop_frames, loop_times;
    float last;
    float elapsed_s, lap;   // since it began; repeats made
    float rate;             // frames per second now
    int32_t row[EMOTIONS];  // of the frame shown, or just before it
    float part[EMOTIONS];   // share of the way to the next
} Layer;

typedef struct {
    // Draws: the seed of them, and how many darts of the eyes and blinks there were.
    uint64_t key;
    int64_t darts, blinks;
    double phase[SWAYS];
    double clock, breaths, dart_left_s, blink_left_s, blink_age_s;
    // Yaw and pitch added to the head, yaw added to the torso, radians, and their speeds.
    float head[3], head_speed[3];
    float attention, voice; // 1 looks at the target, 0 where a unit's own gaze leads; speaking; both smoothed
    float dart[2];          // of the eyes
    float aim[2];           // yaw and pitch of the target in model space, radians
    int32_t leap;           // the eyes have just been sent far

    float held[EMOTIONS];   // the posture's weights before the least are left out, which drift
    Layer layers[LAYERS];

    // What the row is made of since the last switch.
    int32_t known;          // 0 before the first tick, whose row is taken as it comes
    int32_t adopted;        // 1: taken over from other units; its speed is in excess
    int32_t owned[LAYERS], gate[LAYERS]; // parts that a layer's unit owns, parts that it is heard in
    int32_t frame[2];       // contact frames of the hands
    int32_t looks;          // a unit moves the gaze itself
    // Transitions: what is left of them, 1 .. 0, and how much of that dies away per second; of the offset, and of the
    // excess speed.
    float left[2][PARTS], pace[2][PARTS];
    float offset[ROW];      // how far what was shown lay from what was wanted
    float excess[ROW];      // how much faster it moved, times its brake
    float bow[6];           // of the hands' ways, in their contact frames
    float row[ROW];         // shown at the last tick
    Rigid frames[CONTACT_FRAMES]; // as last shown
    float off[2][2][3];     // how far the hands are held off, and how fast that changes, metres

    // The pose.
    float rotation[JOINTS][4];
    float root[3], gaze[2], blink, breath;
} Character;

// What a tick brings. numbers as in game.embos.Decisions.
enum { START_S, DURATION_S, PICK, STROKE_S, WEIGHTS, NUMBERS = WEIGHTS + EMOTIONS };
typedef struct {
    double emotion[EMOTIONS], gaze_target[3], speaking;
    double numbers[LAYERS][NUMBERS];
    int32_t unit[LAYERS], started[LAYERS];
} Signal;

// The present call. held: layers that stand at rest, as bits; neutral: the feeling does not show either.
typedef struct {
    const Setup *setup;
    const Bank *bank;
    int32_t count;
    const Character *before;
    const Signal *signals;
    Character *after;
    double dt_s;
    int32_t held, neutral, collide;
} Call;

// A call's own numbers, made once for all characters.
typedef struct {
    const Setup *setup;
    const Bank *bank;
    double dt_s;
    int32_t held, neutral;
    float drift, mood, eyes;     // shares of the way that slow changes go in a tick
    float let_go[2][2];          // a critically damped spring over dt on distance and speed
} Tick;

// Playback. -> layers whose unit began, jumped or ended, as bits.
int play(const Tick *tick, Character *c, const Signal *signal);
// Time passes for a layer's unit. -> whether it went back to repeat its middle, or came to its end.
bool run(Layer *layer, bool loops, float dt_s);
// What a layer says now, or how fast that changes per second.
void say(const Tick *tick, const Layer *layer, bool speed, float *restrict out);

// Blending. before: the character at the last tick.
void blend(const Tick *tick, const Character *before, Character *c, int events, const double share[EMOTIONS]);
void shown_speed(const Tick *tick, const Character *c, float out[ROW]);

// Liveliness: adds to a row what never stops.
void live(const Tick *tick, Character *c, const double share[EMOTIONS], double speaking, float row[ROW]);
void look(const Tick *tick, Character *c, const double target[3], const Rigid *head, const Rigid *chest);

// Contacts: how far each hand has to go to be out of body and table.
void clear_hands(
    const Setup *setup, const Rigid figure[FIGURE], const Rigid goals[2], const float *points, Vec3 push[2]);
void hold_off(const Tick *tick, Character *c, const Vec3 wanted[2]);
