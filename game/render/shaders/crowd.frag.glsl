#include "frame.glsl"
in vec3 v_lit;
in vec3 v_shade;
in vec3 v_terms;
in vec2 v_face;
uniform vec4 haze;  // colour and share
out vec4 colour;
void main() {
    vec3 c = mix(v_shade * (0.96 + 0.08 * v_terms.z), v_lit, sat((v_terms.x - 0.47) * 14.0));
    // Two eyes and a mouth are all that is left of a face so far away (34 cm square, eyes at ±63 mm).
    vec2 e = (vec2(abs(v_face.x - 0.5) - 0.185, v_face.y - 0.52) * vec2(1.0, 0.78)) / 0.062;
    float ink = sat((1.0 - dot(e, e)) * 3.0);
    vec2 m = (v_face - vec2(0.5, 0.735)) / vec2(0.055, 0.016);
    ink = max(ink, 0.75 * sat((1.0 - dot(m, m)) * 2.0)) * step(0.0, v_face.x);
    c = mix(c, vec3(0.30, 0.17, 0.18) * tint_shade.rgb, ink);
    c += vec3(0.20, 0.16, 0.10) * tint_rim.rgb * sat((v_terms.y - 0.35) * 4.0);
    colour = vec4(mix(c, haze.rgb, haze.w), 1.0);
}
