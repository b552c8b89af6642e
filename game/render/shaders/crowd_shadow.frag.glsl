#include "frame.glsl"
in vec2 v_place;
out vec4 colour;
void main() {
    float a = 0.42 * sat(1.0 - dot(v_place, v_place));
    colour = vec4(vec3(0.42, 0.27, 0.22) * tint_shade.rgb * a, a);
}
