#include "frame.glsl"
#include "joints.glsl"
in vec3 position;
in uvec4 joint;
in vec4 weight;
in float push;  // 1: the head, moved away from the sun so that fringe and nose do not speckle the face
void main() {
    vec4 r0, r1, r2;
    blend(joint, weight, r0, r1, r2);
    vec4 p = vec4(position, 1.0);
    vec3 world = vec3(dot(r0, p), dot(r1, p), dot(r2, p)) - light.xyz * (push * depth_terms.w);
    gl_Position = world_to_light * vec4(world, 1.0);
}
