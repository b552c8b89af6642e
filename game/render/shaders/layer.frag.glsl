// The person's layer: samples that nobody covers are transparent, so their mean is an antialiased, premultiplied colour.
#needs SAMPLES
uniform sampler2DMS layer;
out vec4 colour;
void main() {
    ivec2 at = ivec2(gl_FragCoord.xy);
    vec4 sum = vec4(0.0);
    for (int i = 0; i < SAMPLES; i++) sum += texelFetch(layer, at, i);
    colour = sum / float(SAMPLES);
}
