#include "toon.glsl"
#needs HAIR
in vec4 clip;
in vec4 terms;
in vec2 sun;
in vec3 lit;
in vec3 shade;
in vec3 deep;
in vec4 extra;  // face: uv, texture share, shadow fade; hair: tone of the strand, height term
out vec3 v_terms;      // half-Lambert, warm rim, cool rim
out vec2 v_sun;        // x: share of the sun that arrives, sharpened; y: N.V
out vec4 v_extra;
out vec3 v_above;
flat out vec3 v_bright;
flat out vec3 v_brighter;
flat out vec3 v_deep;
#if HAIR
flat out vec3 v_gleam;
#endif
void main() {
    gl_Position = clip;
    v_terms = terms.xyz;
    v_sun = vec2(sun.x * 3.5 - 1.05, sun.y);
    v_extra = extra;
    vec3 own = lit * tint_lit.rgb;
    v_bright = own * BRIGHT;
    v_brighter = own * BRIGHTER;
    v_deep = deep * tint_deep.rgb;
    v_above = under_sky(shade * tint_shade.rgb, terms.w) - v_deep;
#if HAIR
    v_gleam = own * 1.0875 + vec3(0.0975, 0.0675, 0.03) + vec3(0.25, 0.20, 0.145) * tint_lit.rgb;
#endif
}
