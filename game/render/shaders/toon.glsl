// The three-tone palette shading shared by people and props. All colours are display-referred sRGB values.
#include "frame.glsl"
#needs TAPS SHADOW_SIZE
uniform sampler2DShadow shadow_map;

// Share of the sun that arrives at shadow coordinates c (0..1).
float sunlight(vec3 c) {
    const float r = 1.0 / float(SHADOW_SIZE);
#if TAPS == 0
    return 1.0;
#elif TAPS == 1
    float s = texture(shadow_map, c);
#elif TAPS == 2
    float s = 0.5 * (texture(shadow_map, c + vec3(-r, -0.5 * r, 0)) + texture(shadow_map, c + vec3(r, 0.5 * r, 0)));
#else
    float s = 0.25 * (texture(shadow_map, c + vec3(-r, -0.4 * r, 0)) + texture(shadow_map, c + vec3(0.4 * r, -r, 0))
                    + texture(shadow_map, c + vec3(r, 0.4 * r, 0)) + texture(shadow_map, c + vec3(-0.4 * r, r, 0)));
#endif
#if TAPS > 0
    return sat((s - 0.22) * 2.5);
#endif
}

// half_lambert h = N.L/2 + 1/2; ambient 0 (from below) .. 1 (from above); soft = half width of the terminator.
// Returns the colour; lit_share receives how much of it is in the light.
vec3 three_tones(vec3 lit, vec3 shade, vec3 deep, float h, float sun, float ambient, float soft, out float lit_share) {
    lit_share = sat((h - 0.5 + soft) * (0.5 / soft)) * sun;
    float shade_share = sat((h - 0.21) * 25.0);
    vec3 from_sky = mix(shade * vec3(0.94, 0.93, 1.0), shade * 1.06, ambient);
    vec3 bright = lit * mix(vec3(0.965, 0.955, 0.985), vec3(1.03, 1.02, 1.0), sat(h * 2.0 - 1.0));
    return mix(mix(deep, from_sky, shade_share), bright, lit_share);
}

// Warm blood at the terminator of skin.
vec3 skin_terminator(vec3 c, float h, float sun) {
    float t = sat((h - 0.44) * 16.7) * sat((0.56 - h) * 16.7) * sun;
    return c * mix(vec3(1.0), vec3(1.04, 0.86, 0.80), t * 0.55);
}

vec3 rims(vec3 c, float warm, float cool, float warm_strength) {
    float a = sat((warm - 0.60) * 10.0), b = sat((cool - 0.66) * 10.0);
    return c + (c * 0.55 + vec3(0.16, 0.13, 0.09)) * tint_rim.rgb * (a * warm_strength) + (c * 0.3 + vec3(0.04, 0.07, 0.13)) * tint_shade.rgb * (b * 0.55);
}
