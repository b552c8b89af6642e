// What the fit knows of the reference and of another body; written by Python (game/animation/fitting.py).
#pragma once

#include "../limbs.h"
#include "rig.h"

enum {
    FIGURE = 19,  // torso, head, arms and legs
    REGIONS = 4,  // chest, spine, hips: the trunk; head
    TRUNK = 3,
    LIMBS = 4,  // arms, legs
    SHAPE_ROWS = 16,
    SHAPE_COLUMNS = 32,
    FINGERS = 4,  // thumb, index, middle and little finger
    PALM_BALLS = 3,
    BALLS = PALM_BALLS + 2 * FINGERS,
};

// A measure at which something counts not at all, and at which fully.
typedef struct { float none, full; } Limit;

typedef struct { Vec3 centre, radius; } Region;  // in its joint's frame

typedef struct {
    int32_t joint;  // of the figure
    Region reference, mine;
} BodyPart;

typedef struct {
    int32_t turn, parent;  // its rotation in a pose; a joint of the figure
    Vec3 reference, mine;  // from its parent on both bodies
} FigureJoint;

typedef struct {
    int32_t above, upper, lower, end;  // joints of the figure
    Limb bones;
    Vec3 foot_reference, foot;  // where it stands at rest on both bodies
} FigureLimb;

// The outer surface of a region, about an upright axis in its joint's frame: by height and by direction.
typedef struct {
    int32_t joint;  // of the figure
    Vec3 centre;    // of the lowest row
    float height, widest;
    float around[SHAPE_ROWS];  // the largest radius between each row and the next
    float radius[SHAPE_ROWS][SHAPE_COLUMNS];
} Shape;

typedef struct { Vec3 place; float radius; } PalmBall;  // in the hand's frame

typedef struct {
    int32_t first, second;  // rotations of a pose
    Vec3 base, joint, tip;  // from the wrist, and each from the one before
    float radius;
} Finger;

typedef struct {
    PalmBall palm[PALM_BALLS];
    Finger finger[FINGERS];
} Hand;

struct Fit {
    FigureJoint joint[FIGURE];
    FigureLimb limb[LIMBS];
    BodyPart part[REGIONS];
    Vec3 hips_reference, hips;  // where they rest
    Vec3 palm[2];               // from the wrist, in the hand's frame
    float leg, hand, arm[2];    // this body's lengths over the reference's
    float table_m;
    float clear, middle;  // a palm further out than the first is out of a region; nearer to its middle than the second
                          // it may be anywhere
    Limit beside_body, low_back, high_back, beside_table, above_table, low, together;
    int32_t shapes;  // none where the hands are the reference's
    float reach;     // from the middle of a hand to what is furthest from it
    Hand own_hand[2];
    Shape shape[REGIONS];
};

// clear.c: how far a wrist has to go for its hand to lie on the body and not in it.
Vec3 clear_of_body(const Fit *fit, int side, const Rigid *mine, Vec3 wrist, Quat hand, const Quat *turn);
