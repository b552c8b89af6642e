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
void main() {
    gl_Position = clip;
    v_terms = terms;
    v_shadow = shadow_place;
    vec2 t = uv * place.zw;
    v_uv = vec2(t.x * spin.x + t.y * spin.y, t.y * spin.x - t.x * spin.y) + place.xy;
    v_tint = tint;
}
