// Specks of dust in the sun, drifting before the stall: place and size follow from seed and time alone.
uniform float time_s;
uniform float aspect;
in vec2 corner;
in vec4 seed;  // 0..1 each: left, below, size, phase
out vec2 v_place;
flat out float v_strength;
void main() {
    float near = 0.4 + 0.6 * seed.z;  // larger specks are nearer and faster
    float x = fract(seed.x + time_s * 0.006 * near) * 1.2 - 0.1 + 0.012 * sin(time_s * 0.23 + seed.w * 40.0);
    float y = fract(seed.y + time_s * 0.011 * near) * 1.2 - 0.1 + 0.010 * sin(time_s * 0.31 + seed.w * 60.0);
    float size = 0.0025 + 0.0115 * seed.z * seed.z;  // of the picture's height
    v_place = corner;
    v_strength = (0.30 - 0.19 * seed.z) * (0.55 + 0.45 * sin(time_s * 0.9 + seed.w * 25.0));
    gl_Position = vec4(vec2(x, y) * 2.0 - 1.0 + corner * size * 2.0 * vec2(1.0 / aspect, 1.0), 0.0, 1.0);
}
