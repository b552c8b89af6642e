#include "frame.glsl"
in vec4 clip;
in vec4 line;
in vec3 deep;
out vec4 v_line;
out vec3 v_deep;
void main() {
    gl_Position = clip;
    v_line = line;
    v_deep = deep * tint_deep.rgb;
}
