in vec2 v_place;
flat in vec2 v_half;
flat in vec4 v_form;
flat in vec4 v_edge;
in vec4 v_fill;  // premultiplied
out vec4 colour;
void main() {
    float radius = min(v_form.x, min(v_half.x, v_half.y));
    vec2 q = abs(v_place) - v_half + radius;
    float outside = length(max(q, vec2(0))) + min(max(q.x, q.y), 0.0) - radius;
    float soft = max(v_form.z, 1.0);
    float cover = clamp(0.5 - outside / soft, 0.0, 1.0);
    if (v_form.z > 1.5) cover = cover * cover * (3.0 - 2.0 * cover);
    vec4 c = v_fill;
    if (v_form.y > 0.0) {
        float rim = clamp(outside + v_form.y + 0.5, 0.0, 1.0) * v_edge.a;
        c = mix(c, vec4(v_edge.rgb / max(v_edge.a, 1e-4), 1.0), rim);
    }
    colour = c * cover;
}
