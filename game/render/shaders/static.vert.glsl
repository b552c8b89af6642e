#include "frame.glsl"
in vec3 position;
in vec3 normal;
in vec3 lit;
in vec3 shade;
in vec3 deep;
out vec3 v_world;
out vec3 v_normal;
out vec3 v_shadow;
flat out vec3 v_lit;
flat out vec3 v_shade;
flat out vec3 v_deep;
void main() {
    v_world = position;
    v_normal = normal;
    v_shadow = (world_to_light * vec4(position, 1.0)).xyz * 0.5 + 0.5;
    v_lit = lit * tint_lit.rgb;
    v_shade = shade * tint_shade.rgb;
    v_deep = deep * tint_deep.rgb;
    gl_Position = world_to_clip * vec4(position, 1.0);
}
