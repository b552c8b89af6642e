in vec2 v_place;
flat in vec4 v_paint;
flat in float v_soft;
out vec4 colour;
void main() {
    float a = v_paint.a * smoothstep(1.0 + v_soft, 1.0 - v_soft, length(v_place));
    colour = vec4(v_paint.rgb * a, a);
}
