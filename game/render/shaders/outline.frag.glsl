#include "frame.glsl"
noperspective in vec2 across;
flat in vec3 ink;
out vec4 colour;
void main() {
    float a = sat((across.y - across.x) / viewport.w + 0.5) * sat((across.x + 0.35) / viewport.w + 0.5);
    colour = vec4(ink * a, a);
}
