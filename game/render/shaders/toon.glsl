// The three-tone palette shading shared by people and props. All colours are display-referred sRGB values.
// What is linear in values of a vertex comes ready from there: on a software rasteriser every sum counts per pixel.
#include "frame.glsl"

// What a palette entry shows in full light: bright at the terminator, and what is added where the sun stands above.
const vec3 BRIGHT = vec3(0.965, 0.955, 0.985), BRIGHTER = vec3(0.065, 0.065, 0.015);

// Colour of a shaded surface; ambient 0 (from below) .. 1 (from above).
vec3 under_sky(vec3 shade, float ambient) { return shade * mix(vec3(0.94, 0.93, 1.0), vec3(1.06), ambient); }

// half_lambert h = N.L/2 + 1/2; soft = half width of the terminator; above: under_sky less deep.
// Returns the colour; lit_share receives how much of it is in the light.
vec3 three_tones(vec3 bright, vec3 brighter, vec3 deep, vec3 above, float h, float sun, float soft, out float lit_share) {
    lit_share = sat(h * (0.5 / soft) + (0.5 - 0.25 / soft)) * sun;
    vec3 dark = above * sat(h * 25.0 - 5.25) + deep;
    return mix(dark, brighter * sat(h * 2.0 - 1.0) + bright, lit_share);
}

// Warm blood at the terminator of skin.
vec3 skin_terminator(vec3 c, float h, float sun) {
    float t = sat(h * 16.7 - 7.348) * sat(9.352 - h * 16.7) * sun;
    return c + c * (vec3(0.022, -0.077, -0.110) * t);
}

// warm, cool: of light_terms.
vec3 rims(vec3 c, float warm, float cool, float warm_strength) {
    float a = sat(warm) * warm_strength, b = sat(cool);
    return c + c * (rim_warm_gain.rgb * a + rim_cool_gain.rgb * b) + (rim_warm_glow.rgb * a + rim_cool_glow.rgb * b);
}
