#include "grade.glsl"
in vec4 v_ink;
out vec4 colour;
void main() {
    float a = v_ink.a;
    colour = vec4(grade(clamp(v_ink.rgb / max(a, 1e-4), 0.0, 1.0)) * a, a);
}
