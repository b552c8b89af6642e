// What a test asks for: where the fields of the structs lie. They are compared with the tables that Python fills.
#include "fit.h"

#define SIZE(type) (uint32_t)sizeof(type)
#define AT(type, field) (uint32_t)offsetof(type, field)

static const uint32_t LAYOUT[] = {
    SIZE(Joint), AT(Joint, parent), AT(Joint, source), AT(Joint, offset),
    SIZE(Fold), AT(Fold, bone), AT(Fold, above), AT(Fold, below),
    SIZE(Eyes), AT(Eyes, yaw), AT(Eyes, pitch),
    SIZE(Sprung), AT(Sprung, joint), AT(Sprung, first), AT(Sprung, pieces),
    SIZE(Piece), AT(Piece, axis), AT(Piece, length_m), AT(Piece, stiffness), AT(Piece, gravity), AT(Piece, keep),
    AT(Piece, radius_m), AT(Piece, first_collider), AT(Piece, colliders),
    SIZE(Collider), AT(Collider, joint), AT(Collider, start), AT(Collider, way), AT(Collider, radius_m),
    SIZE(Rig), AT(Rig, joints), AT(Rig, joint), AT(Rig, hips), AT(Rig, hips_rest), AT(Rig, reference), AT(Rig, folds),
    AT(Rig, fold), AT(Rig, tips), AT(Rig, tip), AT(Rig, tip_share), AT(Rig, eyes), AT(Rig, twists), AT(Rig, hand),
    AT(Rig, twist_share), AT(Rig, most_half_twist), AT(Rig, fit), AT(Rig, sprung), AT(Rig, spring), AT(Rig, pieces),
    AT(Rig, piece), AT(Rig, colliders), AT(Rig, collider), AT(Rig, met), AT(Rig, turn), AT(Rig, model), AT(Rig, pull),
    AT(Rig, capsule),
    SIZE(FigureJoint), AT(FigureJoint, turn), AT(FigureJoint, parent), AT(FigureJoint, reference),
    AT(FigureJoint, mine),
    SIZE(FigureLimb), AT(FigureLimb, above), AT(FigureLimb, bones), AT(FigureLimb, foot_reference),
    AT(FigureLimb, foot),
    SIZE(BodyPart), AT(BodyPart, joint), AT(BodyPart, reference), AT(BodyPart, mine),
    SIZE(Shape), AT(Shape, joint), AT(Shape, centre), AT(Shape, height), AT(Shape, widest), AT(Shape, around),
    AT(Shape, radius),
    SIZE(Finger), AT(Finger, first), AT(Finger, second), AT(Finger, base), AT(Finger, joint), AT(Finger, tip),
    AT(Finger, radius),
    SIZE(Hand), AT(Hand, palm), AT(Hand, finger),
    SIZE(Fit), AT(Fit, joint), AT(Fit, limb), AT(Fit, part), AT(Fit, hips_reference), AT(Fit, hips), AT(Fit, palm),
    AT(Fit, leg), AT(Fit, hand), AT(Fit, arm), AT(Fit, table_m), AT(Fit, clear), AT(Fit, middle),
    AT(Fit, beside_body), AT(Fit, low_back), AT(Fit, high_back), AT(Fit, beside_table), AT(Fit, above_table),
    AT(Fit, low), AT(Fit, together), AT(Fit, shapes), AT(Fit, reach), AT(Fit, own_hand), AT(Fit, shape),
    SIZE(Swing), SIZE(Pull), SIZE(Capsule), SIZE(Quat), SIZE(Mat4),
};

typedef struct { uint32_t *count, *layout; } Told;
EXPORT(layout) {
    const Told *told = PARAMETERS(Told);
    *told->count = sizeof LAYOUT / sizeof *LAYOUT;
    memcpy(told->layout, LAYOUT, sizeof LAYOUT);
}
