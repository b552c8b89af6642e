// The halo of a lamp: a soft disc that faces the eye, a little before the glass.
#include "frame.glsl"
uniform float reach;  // radii of the lamp
in vec2 corner;
in vec4 lamp;  // centre, radius
out vec2 v_place;
void main() {
    vec4 p = world_to_clip * vec4(lamp.xyz + normalize(eye.xyz - lamp.xyz) * lamp.w * 1.5, 1.0);
    vec4 side = world_to_clip * vec4(lamp.xyz + vec3(0.0, lamp.w * reach, 0.0), 1.0);
    float tall = abs(side.y / side.w - p.y / p.w);
    v_place = corner;
    p.xy += corner * vec2(tall * viewport.y / viewport.x, tall) * p.w;
    gl_Position = lamp.w > 0.0 ? p : vec4(2.0, 2.0, 2.0, 1.0);
}
