// Clouds in front of the painted sky, wherever the painting shows blue.
in vec2 uv;
uniform sampler2D mask;
uniform sampler2D clouds;
uniform vec4 place;
uniform float lowest;
uniform float drift;
uniform vec3 tint;
out vec4 colour;
void main() {
    vec2 at = uv * place.xy + place.zw;
    float sky = texture(mask, vec2(abs(mod(at.x + 1.0, 2.0) - 1.0), at.y)).r;
    vec2 up = vec2(at.x * 0.62 - drift, (at.y - lowest) / (1.0 - lowest));
    float a = sky * texture(clouds, up).r * 0.85;
    colour = vec4(mix(vec3(0.93, 0.91, 0.94), vec3(1.0, 0.975, 0.925), clamp(up.y * 1.4, 0.0, 1.0)) * tint * a, a);
}
