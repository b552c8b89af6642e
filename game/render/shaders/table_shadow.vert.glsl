#include "frame.glsl"
in vec3 position;
out vec3 v_shadow;
void main() {
    gl_Position = world_to_clip * vec4(position, 1.0);
    v_shadow = (world_to_light * vec4(position, 1.0)).xyz * 0.5 + 0.5;
}
