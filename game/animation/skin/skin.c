// From poses to the matrices that move a mesh, one character after the other.
#include "rig.h"

typedef struct {
    const Rig *rig;
    int32_t characters;
    const Quat *rotation;   // (characters, reference)
    const Vec3 *root;       // (characters)
    const float (*gaze)[2]; // (characters)
    const Swing *before;    // (characters, pieces); none: the springs hang where this pose puts them
    Swing *after;           // or none: the springs stay where the pose has them
    int32_t columns;
    const int32_t *column;  // the joint of every skin column
    const Mat4 *bind;       // what takes a vertex to that joint's frame
    Mat4 *skin;             // (characters, columns)
    float dt_s;
} Skinning;

void place_joint(const Rig *rig, int joint, Vec3 offset) {
    const Joint *j = &rig->joint[joint];
    Mat4 *model = &rig->model[joint];
    Mat4 local = j->source < 0 ? affine((Quat){0, 0, 0, 1}, offset) : affine(rig->turn[j->source], offset);
    *model = j->parent < 0 ? local : after(&rig->model[j->parent], &local);
}

EXPORT(skin) {
    const Skinning *call = PARAMETERS(Skinning);
    const Rig *rig = call->rig;
    if (call->after)
        prepare_springs(rig, call->dt_s);
    for (int n = 0; n < call->characters; n++) {
        Vec3 root = call->root[n];
        memcpy(rig->turn, call->rotation + n * rig->reference, rig->reference * sizeof(Quat));
        if (rig->fit)
            fit_pose(rig->fit, rig->turn, &root);
        local_turns(rig, call->gaze[n]);
        for (int joint = 0; joint < rig->joints; joint++) {
            Vec3 offset = rig->joint[joint].offset;
            if (joint == rig->hips)
                offset = add(offset, sub(root, rig->hips_rest));
            place_joint(rig, joint, offset);
        }
        if (call->after)
            swing_springs(rig, call->before ? call->before + n * rig->pieces : NULL, call->after + n * rig->pieces,
                          call->dt_s);
        Mat4 *skin = call->skin + n * call->columns;
        for (int k = 0; k < call->columns; k++)
            skin[k] = after(&rig->model[call->column[k]], &call->bind[k]);
    }
}
