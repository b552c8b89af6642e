#include "frame.glsl"
in vec2 v_place;
out vec4 colour;
void main() {
    float d = dot(v_place, v_place), fade = sat(1.0 - d);
    float bright = tint_lit.w * (0.55 * fade * fade * fade + 0.35 * exp(-d * 22.0));
    colour = vec4(vec3(1.0, 0.66, 0.28) * bright, 0.0);  // no alpha: light is added
}
