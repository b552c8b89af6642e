// The inverted hull: back faces pushed outward on the screen.
#include "frame.glsl"
in vec4 clip;
in vec4 line;   // xy: outward on the screen, w: length of 1 cm of normal in pixels
in float width; // metres, or a share of half the picture's height
in vec2 uv;
in vec4 tint;
uniform float in_metres;
uniform vec4 place;
uniform vec2 spin;
out vec2 v_uv;
out vec4 v_tint;
void main() {
    float pixels = mix(width * 0.5 * viewport.y * min(1.0, line.w * 0.6), width * 100.0 * line.w, in_metres);
    // Never a second skin, however near the camera comes.
    pixels = clamp(pixels, 0.0, 4.0 * viewport.z);
    gl_Position = vec4(clip.xy + line.xy * (2.0 * pixels * clip.w) / viewport.xy, clip.z + 0.0004 * clip.w, clip.w);
    vec2 t = uv * place.zw;
    v_uv = vec2(t.x * spin.x + t.y * spin.y, t.y * spin.x - t.x * spin.y) + place.xy;
    v_tint = vec4(pow(tint.rgb, vec3(2.2)), tint.a);  // vertex colours are stored as bytes of the power 1/2.2
}
