// The painted far plane, in the light of the hour; towards evening its stalls light their lamps.
in vec2 uv;
uniform sampler2D picture;
uniform vec4 place;  // scale xy, offset xy: where the painted far plane lies in this camera
uniform float gain;
uniform vec4 eye_level;  // x: height of the horizon in the painting; y: lamps, 0 to 1; z: width over height
uniform vec3 sky;
uniform vec3 horizon;
uniform vec3 ground;
out vec4 colour;
void main() {
    vec2 at = uv * place.xy + place.zw;
    vec2 mirrored = vec2(abs(mod(at.x + 1.0, 2.0) - 1.0), at.y);  // mirrored beyond the painting's sides
    float up = (at.y - eye_level.x) / (1.0 - eye_level.x), down = (eye_level.x - at.y) / eye_level.x;
    vec3 tint = at.y > eye_level.x ? mix(horizon, sky, smoothstep(0.05, 1.0, up))
                                   : mix(horizon, ground, smoothstep(0.0, 0.75, down));
    vec3 c = texture(picture, mirrored).rgb * gain * tint;
    if (eye_level.y > 0.0) {
        for (int i = 0; i < 18; i++) {  // strings of lamps far away, out of focus
            float x = (float(i) + 0.5) / 18.0, n = fract(sin(float(i) * 91.7) * 437.5);
            vec2 d = mirrored - vec2(x + 0.02 * n, eye_level.x + 0.055 + 0.045 * n - 0.03 * abs(sin(x * 19.0)));
            float r = length(d * vec2(eye_level.z, 1.0)) / (0.011 + 0.006 * n);
            c = mix(c, vec3(1.0, 0.87, 0.58), eye_level.y * (0.75 * smoothstep(1.0, 0.7, r) + 0.22 * exp(-r * r * 0.09)));
        }
    }
    colour = vec4(c, 1.0);
}
