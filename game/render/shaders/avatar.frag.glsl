// A foreign avatar's material: MToon 1.0 (lit and shade, shift and toony, parametric rim), unlit, or PBR seen as toon.
// Factors and vertex colours are linear, pictures are decoded from sRGB by the sampler: materials are mixed in linear
// light, as their specification says, and encoded at the end; the hour's tints and the rims are display-referred.
#include "toon.glsl"
#include "sunlight.glsl"
#include "grade.glsl"
#include "srgb.glsl"
#needs UNLIT CUT BLEND
in vec4 v_terms;
in vec4 v_shadow;
in vec2 v_uv;
in vec4 v_tint;
flat in vec3 v_sun;    // the hour's tints in linear light
flat in vec3 v_shade;
uniform sampler2D lit_picture;
uniform sampler2D shade_picture;
uniform sampler2D glow_picture;
uniform vec4 lit;
uniform vec3 shade;
uniform vec3 glow;
uniform vec3 rim;
uniform vec2 rim_shape;  // power, lift
uniform vec2 toon_shape; // shift, toony
uniform float cutoff;
out vec4 colour;
void main() {
    vec4 texel = texture(lit_picture, v_uv) * v_tint;
    float alpha = texel.a * lit.a;
#if CUT
    if (alpha < cutoff) discard;
    alpha = 1.0;
#endif
#if !CUT && !BLEND
    alpha = 1.0;
#endif
    vec3 c = texel.rgb * lit.rgb * v_sun;
#if !UNLIT
    float h = gl_FrontFacing ? v_terms.x : 1.0 - v_terms.x;
    float n_dot_l = h * 2.0 - 1.0 + toon_shape.x;
    float soft = max(1.0 - toon_shape.y, 0.02);
    // Nobody knows how closed a foreign mesh is: a centimetre of doubt keeps it from shading itself in stripes.
    float sun = sunlight(v_shadow.xyz - vec3(0.0, 0.0, 0.006));
    float share = sat((n_dot_l + soft) / (2.0 * soft)) * mix(0.35, 1.0, sun);
    vec3 dark = texture(shade_picture, v_uv).rgb * v_tint.rgb * shade * v_shade;
    c = mix(dark * mix(vec3(0.87, 0.85, 1.0), vec3(1.07), v_terms.w), c, share);
    c += rim * pow(sat(1.0 - abs(v_shadow.w) + rim_shape.y), max(rim_shape.x, 1e-3));
#endif
    c = encoded(c + texture(glow_picture, v_uv).rgb * glow);
#if !UNLIT
    c = rims(c, v_terms.y, v_terms.z, 0.41);
#endif
    c = grade(min(c, vec3(1.0)));
    colour = vec4(c * alpha, alpha);
}
