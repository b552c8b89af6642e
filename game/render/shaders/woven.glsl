// Patterned cloth: inside the motif the palette is a little lighter or darker; game/render/weave.py makes the tiles.
uniform sampler2DArray weaves;
// place: tiles along and across the cloth, motif, strength.
vec3 woven(vec3 c, vec4 place) {
    vec2 a = fwidth(place.xy);
    float tiles_per_pixel = max(max(a.x, a.y), 1e-4);
    float inside = (texture(weaves, place.xyz).r - 0.5) * 0.25;
    float cover = clamp(inside / tiles_per_pixel + 0.5, 0.0, 1.0);
    // Too fine to be seen: an even tone, no shimmer.
    cover = mix(cover, 0.25, smoothstep(0.13, 0.30, tiles_per_pixel));
    return mix(c, c * (1.0 + place.w) + 0.12 * max(place.w, 0.0), cover);
}
