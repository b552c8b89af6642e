#include "frame.glsl"
#include "grade.glsl"
#include "srgb.glsl"
#needs CUT
in vec2 v_uv;
in vec4 v_tint;
uniform sampler2D lit_picture;
uniform vec4 lit;
uniform vec3 ink;
uniform float ink_lit; // how much of the surface's own colour is in the line
uniform float cutoff;
out vec4 colour;
void main() {
    vec4 texel = texture(lit_picture, v_uv) * v_tint * lit;
#if CUT
    if (texel.a < cutoff) discard;
#endif
    colour = vec4(grade(encoded(ink * mix(vec3(1.0), texel.rgb, ink_lit)) * min(tint_deep.rgb, vec3(1.0))), 1.0);
}
