in vec2 uv;
uniform sampler2D picture;
uniform vec2 texel;
out vec4 colour;
void main() {
    vec4 sum = texture(picture, uv) * 2.0;
    for (int i = 0; i < 6; i++) {
        float a = float(i) * 1.0472;
        sum += texture(picture, uv + vec2(cos(a), sin(a)) * texel * 1.7);
    }
    colour = sum / 8.0;
}
