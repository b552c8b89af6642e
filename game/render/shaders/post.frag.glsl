// Bloom above .78, warm vignette, grading.
#include "grade.glsl"
in vec2 uv;
uniform sampler2D picture;
uniform sampler2D blurred;
uniform float vignette;
out vec4 colour;
void main() {
    vec3 c = clamp(texture(picture, uv).rgb, 0.0, 1.0);
    c = 1.0 - (1.0 - c) * (1.0 - max(texture(blurred, uv).rgb - 0.78, 0.0) * 0.6);
    vec2 d = uv - 0.5;
    c = mix(c, c * vec3(0.80, 0.70, 0.74), smoothstep(0.16, 0.52, dot(d, d)) * 0.65 * vignette);
    colour = vec4(grade(c), 1.0);
}
