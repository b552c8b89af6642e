uniform vec2 screen;
in vec2 corner;
in vec4 box;        // left, top, width, height (pixels)
in vec4 piece;      // u, v of left top; size in u, v
in vec4 fill_top;   // premultiplied tint
out vec2 v_uv;
flat out vec4 v_tint;
void main() {
    vec2 k = corner * 0.5 + 0.5;
    v_uv = piece.xy + piece.zw * k;
    v_tint = fill_top;
    vec2 p = box.xy + box.zw * k;
    gl_Position = vec4(p.x / screen.x * 2.0 - 1.0, 1.0 - p.y / screen.y * 2.0, 0.0, 1.0);
}
