// Out of focus like the painted backdrop: taps between texels, so that nothing of a texel's size is left.
in vec2 uv;
uniform sampler2D picture;
uniform vec2 texel;
out vec4 colour;
void main() {
    colour = vec4(0.0);
    for (int i = 0; i < 4; i++) {
        vec2 way = vec2(i % 2 == 0 ? -1.0 : 1.0, i < 2 ? -1.0 : 1.0) * texel;
        colour += 0.17 * texture(picture, uv + way * 0.5) + 0.08 * texture(picture, uv + way * 1.5);
    }
}
