// A passer-by: far away, so every vertex follows one joint and is lit by itself.
#include "frame.glsl"
#include "joints.glsl"
in vec3 position;
in vec3 normal;
in vec2 face_uv;
in vec3 lit;
in vec3 shade;
in uvec2 joint;
out vec3 v_lit;
out vec3 v_shade;
out vec3 v_terms;  // half-Lambert, rim, height of the normal
out vec2 v_face;
void main() {
    int j = int(joint.x) * 3;
    vec4 r0 = joint_rows[j], r1 = joint_rows[j + 1], r2 = joint_rows[j + 2], p = vec4(position, 1.0);
    vec3 world = vec3(dot(r0, p), dot(r1, p), dot(r2, p));
    vec3 n = normalize(vec3(dot(r0.xyz, normal), dot(r1.xyz, normal), dot(r2.xyz, normal)));
    float edge = 1.0 - max(dot(n, normalize(eye.xyz - world)), 0.0);
    v_terms = vec3(dot(n, light.xyz) * 0.5 + 0.5, edge * sat(dot(n, rim_warm.xyz)), n.y);
    v_lit = lit * tint_lit.rgb;
    v_shade = shade * tint_shade.rgb;
    v_face = face_uv;
    gl_Position = world_to_clip * vec4(world, 1.0);
}
