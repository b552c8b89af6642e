in vec2 v_place;
flat in float v_strength;
out vec4 colour;
void main() {
    float fade = clamp(1.0 - dot(v_place, v_place), 0.0, 1.0);
    colour = vec4(vec3(1.0, 0.90, 0.66) * (fade * fade * v_strength), 0.0);  // no alpha: light is added
}
