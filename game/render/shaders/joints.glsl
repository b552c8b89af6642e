// Linear blend skinning; rows of 3x4 matrices (std140, binding 1).
layout(std140) uniform Joints { vec4 joint_rows[768]; };
void blend(uvec4 joint, vec4 weight, out vec4 r0, out vec4 r1, out vec4 r2) {
    ivec4 j = ivec4(joint) * 3;
    r0 = joint_rows[j.x] * weight.x + joint_rows[j.y] * weight.y + joint_rows[j.z] * weight.z + joint_rows[j.w] * weight.w;
    j += 1;
    r1 = joint_rows[j.x] * weight.x + joint_rows[j.y] * weight.y + joint_rows[j.z] * weight.z + joint_rows[j.w] * weight.w;
    j += 1;
    r2 = joint_rows[j.x] * weight.x + joint_rows[j.y] * weight.y + joint_rows[j.z] * weight.z + joint_rows[j.w] * weight.w;
}
