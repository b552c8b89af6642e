#include "frame.glsl"
in vec4 clip;
in vec4 terms;
in vec4 shadow_place;
in vec2 uv;
in vec4 tint;
uniform vec4 place;  // offset, scale of the texture
uniform vec2 spin;   // cosine and sine of its rotation
out vec4 v_terms;
out vec4 v_shadow;
out vec2 v_uv;
out vec4 v_tint;
flat out vec3 v_sun;
flat out vec3 v_shade;
void main() {
    gl_Position = clip;
    v_terms = terms;
    v_shadow = shadow_place;
    vec2 t = uv * place.zw;
    v_uv = vec2(t.x * spin.x + t.y * spin.y, t.y * spin.x - t.x * spin.y) + place.xy;
    v_tint = vec4(pow(tint.rgb, vec3(2.2)), tint.a);  // vertex colours are stored as bytes of the power 1/2.2
    v_sun = pow(tint_lit.rgb, vec3(2.2));
    v_shade = pow(tint_shade.rgb, vec3(2.2));
}
