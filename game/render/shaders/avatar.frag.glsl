// A foreign avatar's material: MToon 1.0 (lit and shade, shift and toony, parametric rim), unlit, or PBR seen as toon.
// Factors come display-referred, as pow(linear, 1/2.2); textures are sRGB, so that products are those of linear light.
#include "toon.glsl"
#include "grade.glsl"
#needs UNLIT CUT BLEND
in vec4 v_terms;
in vec4 v_shadow;
in vec2 v_uv;
in vec4 v_tint;
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
    vec3 bright = texel.rgb * lit.rgb * tint_lit.rgb;
#if UNLIT
    vec3 c = bright;
#else
    float h = gl_FrontFacing ? v_terms.x : 1.0 - v_terms.x;
    float n_dot_l = h * 2.0 - 1.0 + toon_shape.x;
    float soft = max(1.0 - toon_shape.y, 0.02);
    // Nobody knows how closed a foreign mesh is: a centimetre of doubt keeps it from shading itself in stripes.
    float sun = sunlight(v_shadow.xyz - vec3(0.0, 0.0, 0.006));
    float share = sat((n_dot_l + soft) / (2.0 * soft)) * mix(0.35, 1.0, sun);
    vec3 dark = texture(shade_picture, v_uv).rgb * v_tint.rgb * shade * tint_shade.rgb;
    vec3 c = mix(dark * mix(vec3(0.94, 0.93, 1.0), vec3(1.03), v_terms.w), bright, share);
    float edge = pow(sat(1.0 - abs(v_shadow.w) + rim_shape.y), max(rim_shape.x, 1e-3));
    c = sqrt(c * c + rim * rim * edge);
    c = rims(c, v_terms.y, v_terms.z, 0.41);
#endif
    // Light adds up in linear space; squares come near enough to it.
    vec3 own = texture(glow_picture, v_uv).rgb * glow;
    c = sqrt(c * c + own * own);
    c = grade(min(c, vec3(1.0)));
    colour = vec4(c * alpha, alpha);
}
