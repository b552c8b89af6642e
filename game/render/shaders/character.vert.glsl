#include "frame.glsl"
in vec4 clip;
in vec4 terms;
in vec4 shadow_place;
in vec3 lit;
in vec3 shade;
in vec3 deep;
in vec4 extra;  // face: uv, texture share, shadow fade; hair: azimuth, height term
out vec4 v_terms;
out vec4 v_shadow;
out vec4 v_extra;
flat out vec3 v_lit;
flat out vec3 v_shade;
flat out vec3 v_deep;
void main() {
    gl_Position = clip;
    v_terms = terms;
    v_shadow = shadow_place;
    v_extra = extra;
    v_lit = lit * tint_lit.rgb;
    v_shade = shade * tint_shade.rgb;
    v_deep = deep * tint_deep.rgb;
}
