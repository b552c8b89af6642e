// One program per material class: branches on a flag would cost all sides of it on a software rasteriser.
#include "toon.glsl"
#include "woven.glsl"
#needs SKIN FACE HAIR GLOSS LAMP WOVEN
in vec3 v_terms;
in vec2 v_sun;
in vec3 v_above;
flat in vec3 v_bright;
flat in vec3 v_brighter;
flat in vec3 v_deep;
#if FACE || HAIR || LAMP || WOVEN
in vec4 v_extra;
#endif
#if HAIR
flat in vec3 v_gleam;
#endif
#if FACE
uniform sampler2D face_texture;
uniform sampler2D planes;   // where the light ends on the face, for light from the right
uniform vec3 head_left;     // unit vector to the person's left
#endif
out vec4 colour;
void main() {
    float h = v_terms.x;
    float sun = sat(v_sun.x);
#if FACE
    sun = mix(sun, 1.0, v_extra.w);
    float side = dot(light.xyz, head_left);
    float plane = texture(planes, vec2(side > 0.0 ? 1.0 - v_extra.x : v_extra.x, v_extra.y)).r - 128.0 / 255.0;
    h += plane * v_extra.z * sat(abs(side) * 3.0 - 0.1);
#endif
    float lit_share;
    vec3 c = three_tones(v_bright, v_brighter, v_deep, v_above, h, sun, FACE == 1 ? 0.030 : 0.018, lit_share);
#if WOVEN
    c = woven(c, v_extra);
#endif
#if SKIN || FACE
    c = skin_terminator(c, h, sun);
#endif
#if HAIR
    float e = v_extra.y;
    float wide = sat(e * 66.0 - 25.41) * sat(24.75 - e * 50.0);
    float thin = sat(e * 100.0 - 33.5) * sat(36.7 - e * 100.0);
    c = mix(c, v_gleam, (wide * 0.72 + thin * 0.35) * (0.35 + 0.65 * lit_share) * sat(v_sun.y * 2.5 - 0.12));
#endif
#if GLOSS
    c = mix(c, vec3(1.0, 0.98, 0.93) * tint_lit.rgb, sat((h - 0.955) * 60.0) * 0.8 * sun);
#endif
#if FACE
    vec4 ink = texture(face_texture, v_extra.xy) * v_extra.z;
    c = c * (1.0 - ink.a) + ink.rgb * mix(vec3(0.90, 0.84, 0.90), vec3(1.0), max(lit_share, 0.35)) * mix(vec3(1.0), tint_lit.rgb, 0.5);
#endif
#if LAMP
    float glow = v_extra.x * tint_lit.w;
    c = mix(c, mix(vec3(1.0, 0.80, 0.42), vec3(1.0, 0.96, 0.82), sat(h * 1.6 - 0.4)), glow);
#endif
    colour = vec4(rims(c, v_terms.y, v_terms.z, SKIN + FACE > 0 ? 0.41 : 0.75), 1.0);
}
