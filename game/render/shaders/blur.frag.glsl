in vec2 uv;
uniform sampler2D picture;
uniform vec2 texel_step;
out vec4 colour;
void main() {
    vec3 sum = vec3(0);
    float weights = 0.0;
    for (int i = -6; i <= 6; i++) {
        float w = exp(-float(i * i) / 14.0);
        sum += w * texture(picture, uv + texel_step * float(i)).rgb;
        weights += w;
    }
    colour = vec4(sum / weights, 1.0);
}
