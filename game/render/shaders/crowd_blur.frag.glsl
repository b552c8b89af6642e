// Out of focus like the painted backdrop: few taps, for the picture is small and will be enlarged.
in vec2 uv;
uniform sampler2D picture;
uniform vec2 texel;
out vec4 colour;
void main() {
    vec2 far = texel * 1.15;
    colour = 0.28 * texture(picture, uv)
           + 0.18 * (texture(picture, uv + far) + texture(picture, uv - far)
                   + texture(picture, uv + vec2(far.x, -far.y)) + texture(picture, uv + vec2(-far.x, far.y)));
}
