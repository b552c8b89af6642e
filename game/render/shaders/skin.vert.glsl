// Once per frame: every vertex of the character, captured by transform feedback and shared by all passes.
#include "light_terms.glsl"
#include "joints.glsl"
in vec3 position;
in vec3 normal;
in uvec4 joint;
in vec4 weight;
in float outline;
out vec4 clip;
out vec4 terms;
out vec4 shadow_place;  // xyz 0..1, w: N.V, which makes front hair brighter
out vec4 line;          // xy: outward on the screen, z: width in pixels, w: length of 1 cm of normal in pixels
void main() {
    vec4 r0, r1, r2;
    blend(joint, weight, r0, r1, r2);
    vec4 p = vec4(position, 1.0);
    vec3 world = vec3(dot(r0, p), dot(r1, p), dot(r2, p));
    vec3 n = normalize(vec3(dot(r0.xyz, normal), dot(r1.xyz, normal), dot(r2.xyz, normal)));
    vec3 to_eye = normalize(eye.xyz - world);
    clip = world_to_clip * vec4(world, 1.0);
    terms = light_terms(n, to_eye);
    vec3 q = (world_to_light * vec4(world, 1.0)).xyz * 0.5 + 0.5;
    shadow_place = vec4(q.xy, q.z - depth_terms.z, dot(n, to_eye));
    vec4 ahead = clip + world_to_clip * vec4(n * 0.01, 0.0);
    vec2 away = (ahead.xy / ahead.w - clip.xy / clip.w) * viewport.xy * 0.5;
    float size = length(away) + 1e-9;
    line = vec4(away / size, outline * viewport.z * line_weight(terms.x * 2.0 - 1.0), size);
    gl_Position = clip;
}
