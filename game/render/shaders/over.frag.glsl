#include "frame.glsl"
in vec3 v_ink;
uniform sampler2D face_texture;
out vec4 colour;
void main() { colour = texture(face_texture, v_ink.xy) * vec4(tint_lit.rgb, 1.0) * (v_ink.z * 0.8); }
