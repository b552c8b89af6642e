// A feathered ribbon along every edge between a front and a back face: antialiased without multisampling.
// Adjacency: opposite corner of one face, edge start, edge end, opposite corner of the other face.
// A border edge repeats its own start as the fourth corner and is drawn where its only face is in front.
#include "frame.glsl"
layout(lines_adjacency) in;
layout(triangle_strip, max_vertices = 4) out;
in vec4 v_line[];
in vec3 v_deep[];
noperspective out vec2 across;  // pixels from the edge, width in pixels
flat out vec3 ink;
float turn(vec2 a, vec2 b, vec2 c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }
vec2 pixel(vec4 p) { return p.xy / p.w * viewport.xy * 0.5; }
void main() {
    vec2 a = pixel(gl_in[1].gl_Position), b = pixel(gl_in[2].gl_Position);
    bool one = turn(a, b, pixel(gl_in[0].gl_Position)) > 0.0;
    bool other = turn(b, a, pixel(gl_in[3].gl_Position)) > 0.0;
    vec2 edge = b - a;
    float size = length(edge);
    if (one == other || size < 0.02) return;
    vec2 side = vec2(-edge.y, edge.x) / size;
    if (dot(side, v_line[1].xy + v_line[2].xy) < 0.0) side = -side;
    float feather = viewport.w;
    for (int i = 1; i < 3; i++) {
        vec4 p = gl_in[i].gl_Position;
        vec2 away = dot(v_line[i].xy, side) < 0.5 ? side : v_line[i].xy;
        float width = v_line[i].z * min(1.0, v_line[i].w * 0.6);
        for (int j = 0; j < 2; j++) {
            float o = j == 0 ? -0.5 * feather - 0.35 : width + 0.5 * feather;
            gl_Position = vec4(p.xy + away * (2.0 * o * p.w) / viewport.xy, p.z + 0.0003 * p.w, p.w);
            across = vec2(o, width);
            ink = v_deep[i] * vec3(0.50, 0.40, 0.46);
            EmitVertex();
        }
    }
    EndPrimitive();
}
