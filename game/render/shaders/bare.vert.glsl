#include "frame.glsl"
#include "joints.glsl"
#needs DEPTH_ONLY
in vec3 position;
in vec3 normal;
in uvec4 joint;
in vec4 weight;
out vec3 v_normal;
out vec3 v_shadow;
void main() {
    vec4 r0, r1, r2;
    blend(joint, weight, r0, r1, r2);
    vec4 p = vec4(position, 1.0);
    vec4 world = vec4(dot(r0, p), dot(r1, p), dot(r2, p), 1.0);
    v_normal = vec3(dot(r0.xyz, normal), dot(r1.xyz, normal), dot(r2.xyz, normal));
    vec4 lit = world_to_light * world;
    v_shadow = lit.xyz * 0.5 + 0.5;
#if DEPTH_ONLY
    gl_Position = lit;
#else
    gl_Position = world_to_clip * world;
#endif
}
