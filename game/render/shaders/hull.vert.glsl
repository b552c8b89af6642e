// Inverted hull: the prop again, a line's width larger on the screen and inside out.
#include "light_terms.glsl"
in vec3 position;
in vec3 normal;
in float outline;
in vec3 deep;
flat out vec3 ink;
void main() {
    vec4 p = world_to_clip * vec4(position, 1.0);
    vec4 ahead = p + world_to_clip * vec4(normal * 0.01, 0.0);
    vec2 away = (ahead.xy / ahead.w - p.xy / p.w) * viewport.xy * 0.5;
    float size = length(away);
    away = size > 1e-4 ? away / size : vec2(0);
    float width = outline * viewport.z * line_weight(dot(normal, light.xyz)) * min(1.0, size * 2.0 * 0.6);
    p.xy += away * width * 2.0 / viewport.xy * p.w;
    p.z += 0.0009 * p.w;
    ink = deep * tint_deep.rgb * vec3(0.50, 0.40, 0.46);
    gl_Position = p;
}
