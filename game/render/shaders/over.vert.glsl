// The second face layer, 8.5 cm nearer to the eye so that brows and lashes show through the fringe.
#include "frame.glsl"
in vec4 clip;
in vec4 extra;
out vec3 v_ink;
void main() {
    float w = clip.w - 0.085;
    v_ink = extra.xyz;
    gl_Position = vec4(clip.xy, (depth_terms.x + depth_terms.y * w) / w * clip.w, clip.w);
}
