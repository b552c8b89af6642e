in vec2 uv;
uniform sampler2D picture;
uniform vec4 place;  // scale xy, offset xy: where the painted far plane lies in this camera
uniform float gain;
out vec4 colour;
void main() {
    vec2 at = uv * place.xy + place.zw;
    at.x = abs(mod(at.x + 1.0, 2.0) - 1.0);  // mirrored beyond the painting's sides
    colour = vec4(texture(picture, at).rgb * gain, 1.0);
}
