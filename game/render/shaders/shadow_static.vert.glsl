#include "frame.glsl"
in vec3 position;
void main() { gl_Position = world_to_light * vec4(position, 1.0); }
