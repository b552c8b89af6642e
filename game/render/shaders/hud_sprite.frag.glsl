#needs GLYPHS
uniform sampler2D sheet;
in vec2 v_uv;
flat in vec4 v_tint;
out vec4 colour;
void main() {
#if GLYPHS
    colour = v_tint * texture(sheet, v_uv).r;
#else
    colour = v_tint * texture(sheet, v_uv);
#endif
}
