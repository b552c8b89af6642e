#include "frame.glsl"
in vec3 v_normal;
in vec3 v_shadow;
uniform sampler2DShadow shadow_map;
out vec4 colour;
void main() {
    float h = dot(normalize(v_normal), light.xyz) * 0.5 + 0.5;
    float sun = texture(shadow_map, v_shadow - vec3(0, 0, 0.002));
    float tone = step(0.5, h) * sun + step(0.2, h);
    colour = vec4(vec3(0.9, 0.6, 0.4) * (0.4 + 0.3 * tone), 1.0);
}
