// Props and stall; shaded per pixel because they are baked once per camera.
#include "toon.glsl"
#include "sunlight.glsl"
#include "light_terms.glsl"
#needs GLOSS FLAT
in vec3 v_world;
in vec3 v_normal;
in vec3 v_shadow;
flat in vec3 v_lit;
flat in vec3 v_shade;
flat in vec3 v_deep;
uniform float sun_share;  // 0 draws everything in shadow (what the character's shadow shows of the table)
out vec4 colour;
void main() {
    vec3 n = normalize(v_normal), to_eye = normalize(eye.xyz - v_world);
    vec4 terms = light_terms(n, to_eye);
    float n_dot_light = terms.x * 2.0 - 1.0;
    float bias = 0.0012 + 0.0022 * (1.0 - sat(n_dot_light));
    float sun = sunlight(v_shadow - vec3(0, 0, bias)) * sun_share;
    float lit_share;
    vec3 above = under_sky(v_shade, terms.w) - v_deep;
    vec3 c = three_tones(v_lit * BRIGHT, v_lit * BRIGHTER, v_deep, above, terms.x, sun, 0.018, lit_share);
#if GLOSS
    float spot = pow(max(dot(n, normalize(light.xyz + to_eye)), 0.0), 60.0);
    c = mix(c, vec3(1.0, 0.98, 0.93) * tint_lit.rgb, smoothstep(0.35, 0.5, spot) * 0.85 * sun);
    c += vec3(0.05, 0.06, 0.09) * smoothstep(0.35, 0.6, 1.0 - dot(n, to_eye));
#endif
#if !FLAT
    c = rims(c, terms.y, terms.z, 0.75);
#endif
    colour = vec4(c, 1.0);
}
