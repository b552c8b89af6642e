// Soft ellipses before everything else.
#include "frame.glsl"
uniform vec2 shift;
uniform float zoom;
in vec2 corner;
in vec4 box;    // centre in clip coordinates, half length and half width of the picture's height
in vec2 form;   // angle, softness
in vec4 paint;  // colour and cover
out vec2 v_place;
flat out vec4 v_paint;
flat out float v_soft;
void main() {
    float c = cos(form.x), s = sin(form.x);
    vec2 p = corner * box.zw * 2.0 * (1.0 + form.y);
    p = vec2(c * p.x - s * p.y, s * p.x + c * p.y) * vec2(viewport.y / viewport.x, 1.0);
    v_place = corner * (1.0 + form.y);
    v_paint = vec4(paint.rgb * mix(tint_shade.rgb, tint_lit.rgb, 0.55), paint.a);
    v_soft = form.y;
    vec2 centre = sign(box.xy) + (box.xy - sign(box.xy)) * zoom;  // keeps to its corner when the picture is narrower
    gl_Position = vec4(centre + shift + p * zoom, 0.0, 1.0);
}
