// Cast shadows: one light, one map.
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
