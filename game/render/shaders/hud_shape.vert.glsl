// Instanced boxes with rounded corners, turned by an angle: rectangles, circles, line pieces, soft shadows.
uniform vec2 screen;  // pixels
in vec2 corner;       // -1..1
in vec4 box;          // centre, half size (pixels)
in vec4 form;         // radius, border, feather (pixels), angle
in vec4 fill_top;
in vec4 fill_bottom;
in vec4 edge;
out vec2 v_place;
flat out vec2 v_half;
flat out vec4 v_form;
flat out vec4 v_edge;
out vec4 v_fill;
void main() {
    vec2 reach = box.zw + form.z + 1.0;
    v_place = corner * reach;
    v_half = box.zw;
    v_form = form;
    v_edge = edge;
    v_fill = mix(fill_top, fill_bottom, clamp(v_place.y / max(box.w, 1e-3) * 0.5 + 0.5, 0.0, 1.0));
    float c = cos(form.w), s = sin(form.w);
    vec2 p = box.xy + vec2(c * v_place.x - s * v_place.y, s * v_place.x + c * v_place.y);
    gl_Position = vec4(p.x / screen.x * 2.0 - 1.0, 1.0 - p.y / screen.y * 2.0, 0.0, 1.0);
}
