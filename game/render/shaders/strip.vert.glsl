// Rectangles of the picture, at the far plane: only what shows the backdrop lets them through.
in vec2 corner;
in vec4 span;  // left, low, right, high in clip coordinates
out vec2 uv;
void main() {
    vec2 at = clamp(mix(span.xy, span.zw, corner * 0.5 + 0.5), -1.0, 1.0);
    uv = at * 0.5 + 0.5;
    gl_Position = vec4(at, 0.9999, 1.0);
}
