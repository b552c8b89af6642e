// What skins a character: everything here is written by Python once per rig (game/animation/skin_loop.py).
#pragma once

#include "geometry.h"

// A joint that moves, or that something moving hangs on, in a frame whose axes are the model's in the T-pose.
typedef struct {
    int32_t parent;  // before it in the list; -1: none
    int32_t source;  // its local rotation among those of Turns; -1: it stands still in its parent
    Vec3 offset;     // from the parent in the T-pose, metres
} Joint;

// A bone that stands for two of the reference's, one of which the rig lacks: it takes both rotations.
typedef struct { int32_t bone, above, below; } Fold;

// How far an eye turns at the ends of the gaze, radians.
typedef struct {
    float yaw[2][2];  // left and right eye: looking to the right, to the left
    float pitch[2];   // down, up
} Eyes;

// A joint that springs turn or move, and those of its pieces.
typedef struct { int32_t joint, first, pieces; } Sprung;

// A piece of a spring chain, from its joint to the next.
typedef struct {
    Vec3 axis;  // from the joint to the next one in the T-pose, unit length
    float length_m;
    float stiffness;
    Vec3 gravity;  // power and direction
    float keep;    // 1 - drag
    float radius_m;
    int32_t first_collider, colliders;  // places in Rig.met
} Piece;

typedef struct { Vec3 tail, speed; } Swing;  // model space, metres and metres per second

typedef struct {
    int32_t joint;
    Vec3 start, way;  // of a capsule's segment in the joint's frame; a sphere has no way
    float radius_m;
} Collider;

// What a step does to a piece.
typedef struct {
    float kept_s;  // of its speed: metres per metre per second
    float force;   // metres per unit of stiffness and gravity
} Pull;

// A collider in model space.
typedef struct {
    Vec3 start, way;
    float square;  // of the way's length
} Capsule;

typedef struct Fit Fit;

typedef struct {
    int32_t joints;
    const Joint *joint;
    int32_t hips;     // the joint that takes the root's way
    Vec3 hips_rest;   // where the hips of a pose rest
    int32_t reference;  // rotations of a pose
    // Local rotations: the reference's, then the outermost finger joints, both eyes, the forearms' twists.
    int32_t folds;
    const Fold *fold;
    int32_t tips;
    const int32_t *tip;  // the reference's joint that each tip bends with
    float tip_share;
    const Eyes *eyes;    // or none
    int32_t twists;
    const int32_t *hand;  // whose twist each takes a share of
    float twist_share, most_half_twist[2];  // cosine and sine
    const Fit *fit;  // or none: the reference's own proportions
    int32_t sprung;
    const Sprung *spring;
    int32_t pieces;
    const Piece *piece;
    int32_t colliders;
    const Collider *collider;
    const int32_t *met;  // colliders of all pieces, one piece after the other
    // Room to work in.
    Quat *turn;
    Mat4 *model;
    Pull *pull;
    Capsule *capsule;
} Rig;

// fit.c: the pose's rotations and root, in place, from the reference to this body.
void fit_pose(const Fit *fit, Quat *turn, Vec3 *root);

// turns.c: the local rotations of a character, from the pose's, which are there already.
void local_turns(const Rig *rig, const float gaze[2]);

// springs.c. prepare_springs: once per call.
void prepare_springs(const Rig *rig, float dt_s);
void swing_springs(const Rig *rig, const Swing *before, Swing *after, float dt_s);

// skin.c: a joint to model space.
void place_joint(const Rig *rig, int joint, Vec3 offset);
