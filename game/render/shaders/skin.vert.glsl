// Once per frame: every vertex of the character, captured by transform feedback and shared by all passes.
#include "light_terms.glsl"
#include "joints.glsl"
#needs CAST_SIZE
in vec3 position;
in vec3 normal;
in uvec4 joint;
in vec4 weight;
in float outline;
#if CAST_SIZE
uniform sampler2DShadow shadow_map;
#endif
out vec4 clip;
out vec4 terms;
out vec4 shadow_place;  // xyz 0..1; w: N.V, which makes front hair brighter
out vec2 sun;           // x: share of the sun that arrives, y: N.V
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
    q.z -= depth_terms.z;
    shadow_place = vec4(q, dot(n, to_eye));
    sun = vec2(1.0, shadow_place.w);
#if CAST_SIZE
    // Many looks into the map for every vertex cost less than one for every pixel, and what lies between vertices is
    // even: edges without steps.
    const vec2 at[8] = vec2[](vec2(-0.2, -0.9), vec2(0.6, -0.6), vec2(-0.8, -0.3), vec2(0.2, -0.1), vec2(0.9, 0.1),
                              vec2(-0.4, 0.4), vec2(0.4, 0.7), vec2(-0.3, 0.95));
    float lit = 0.0;
    for (int i = 0; i < 8; i++) lit += texture(shadow_map, q + vec3(at[i] * (3.0 / float(CAST_SIZE)), 0.0));
    sun.x = lit * 0.125;
#endif
    vec4 ahead = clip + world_to_clip * vec4(n * 0.01, 0.0);
    vec2 away = (ahead.xy / ahead.w - clip.xy / clip.w) * viewport.xy * 0.5;
    float size = length(away) + 1e-9;
    line = vec4(away / size, outline * viewport.z * line_weight(terms.x * 2.0 - 1.0), size);
    gl_Position = clip;
}
