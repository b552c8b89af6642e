in vec2 uv;
uniform sampler2D picture;
uniform vec4 place;  // scale xy, offset xy: where the painted far plane lies in this camera
uniform float gain;
out vec4 colour;
void main() { colour = vec4(texture(picture, uv * place.xy + place.zw).rgb * gain, 1.0); }
