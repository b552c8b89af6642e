// What all passes of one frame share (std140, binding 0); written once per frame by lighting.py.
layout(std140) uniform Frame {
    mat4 world_to_clip;
    mat4 world_to_light;   // clip space of the shadow map, -1..1
    vec4 light;            // xyz: unit vector toward the sun
    vec4 rim_warm;         // xyz: unit vector toward the warm back light
    vec4 rim_cool;         // xyz: toward the cool one
    vec4 eye;              // xyz: world
    vec4 viewport;         // x, y: pixels; z: outline width in pixels; w: feather in pixels
    vec4 depth_terms;      // x, y: projection[2][3], -projection[2][2]; z: shadow bias; w: head push in metres
    vec4 tint_lit;         // rgb: what the hour of the day makes of lit palette colours; w: lamps, 0 out to 1 bright
    vec4 tint_shade;       // rgb: of shaded ones
    vec4 tint_deep;        // rgb: of the darkest, and of outlines
    vec4 rim_warm_gain;    // rgb: what the warm back light makes of a colour, times it …
    vec4 rim_warm_glow;    // … and beside it
    vec4 rim_cool_gain;
    vec4 rim_cool_glow;
    vec4 tint_rim;         // rgb: of the back lights
};
float sat(float v) { return clamp(v, 0.0, 1.0); }
