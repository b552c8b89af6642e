// Where the character keeps the sun off the table, the picture of the table in full shadow shows.
#include "sunlight.glsl"
in vec3 v_shadow;
uniform sampler2D dark_picture;
out vec4 colour;
void main() {
    float dark = 1.0 - sunlight(v_shadow - vec3(0, 0, 0.002));
    colour = vec4(texelFetch(dark_picture, ivec2(gl_FragCoord.xy), 0).rgb * dark, dark);
}
