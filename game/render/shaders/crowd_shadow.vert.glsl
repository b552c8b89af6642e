// The soft shadow at a passer-by's feet, drawn out away from the sun.
#include "frame.glsl"
in vec2 corner;
in vec4 foot;  // place, radius
out vec2 v_place;
void main() {
    vec2 away = -normalize(light.xz);
    float longer = min(1.0 / max(light.y, 0.2), 3.2);
    vec2 side = vec2(-away.y, away.x);
    vec2 at = side * corner.x * foot.w + away * (corner.y + 0.75) * foot.w * longer * 0.6;
    v_place = corner;
    gl_Position = world_to_clip * vec4(foot.x + at.x, 0.0, foot.z + at.y, 1.0);
}
