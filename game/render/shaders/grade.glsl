// Gentle S-curve and warmth; grading.py holds the same curve for palettes.
vec3 grade(vec3 c) {
    c = mix(c, c * c * (3.0 - 2.0 * c), 0.16);
    return pow(max(c, vec3(1e-6)), vec3(0.97, 1.0, 1.015));
}
