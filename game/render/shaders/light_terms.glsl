// Per-normal light terms: x half-Lambert; y warm rim, z cool rim: from 0 to 1 across their edges; w ambient.
#include "frame.glsl"
vec4 light_terms(vec3 normal, vec3 to_eye) {
    float edge = 1.0 - max(dot(normal, to_eye), 0.0);
    float warm = dot(normal, rim_warm.xyz), cool = dot(normal, rim_cool.xyz);
    return vec4(dot(normal, light.xyz) * 0.5 + 0.5,
                edge * (0.55 + 0.75 * max(warm, 0.0)) * sat(warm / 0.3) * 10.0 - 6.0,
                edge * (0.55 + 0.65 * max(cool, 0.0)) * sat(cool / 0.3) * 10.0 - 6.6,
                smoothstep(-0.9, 0.6, normal.y));
}
// Lines are thicker on the side away from the sun.
float line_weight(float n_dot_light) { return mix(1.25, 0.75, smoothstep(-0.6, 0.8, n_dot_light)); }
