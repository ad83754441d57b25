// Hi-Z: the farthest depth key of every 8x8 and of every 64x64 pixels. A meshlet that is farther than every depth that it could cover is
// hidden (hierarchical z-buffers: Greene, Kass and Miller 1993).
//@ use lib/frame
//@ use lib/fixed
//@ use lib/triangle
//@ use lib/meshlets
//@ use lib/extent
//@ use variants/depth

@group(0) @binding(28) var<storage, read> hiz: array<u32>;

// The farthest key of the tiles that a box of pixels touches; 0, which hides nothing, where the box touches too many tiles.
fn hiz_farthest(pixels: vec4i) -> u32 {
    var width = culling.hiz_width;
    var first = 0u;
    var tiles = vec4u(pixels) / 8u;
    if any(tiles.zw - tiles.xy >= vec2u(8u)) {
        tiles /= 8u;
        width /= 8u;
        first = culling.hiz_first_block;
    }
    let sides = tiles.zw - tiles.xy + 1u;
    if sides.x * sides.y > 256u { return 0u; }
    var farthest = 0xffffffffu;
    for (var i = 0u; i < sides.x * sides.y; i += 1u) {
        farthest = min(farthest, hiz[first + (tiles.y + i / sides.x) * width + tiles.x + i % sides.x]);
    }
    return farthest;
}

// Is a box of object space certainly behind what has been drawn, in spite of rounding?
fn hiz_hides(draw: u32, box: Box, e: Extent) -> bool {
    if !extent_is_unclipped(e) { return false; }
    let m = draws[draw].clip_from_object;
    let middle = extent_position(draw, box.center);
    var low = vec2f(2.0);
    var high = vec2f(-2.0);
    for (var i = 0u; i < 8u; i += 1u) {
        let side = vec3f(vec3u(i, i >> 1u, i >> 2u) & vec3u(1u)) * 2.0 - 1.0;
        let corner = middle + box.half * side;
        let clip = m[0] * corner.x + m[1] * corner.y + m[2] * corner.z + m[3];
        low = min(low, clip.xy / clip.w);
        high = max(high, clip.xy / clip.w);
    }
    // One more pixel on every side; y points down in the picture.
    let shift = 1.0 + extent_shift(e) / f32(grid_unit());
    let half = vec2f(frame.size) * 0.5;
    let first = half + vec2f(low.x, -high.y) * half - shift;
    let last = half + vec2f(high.x, -low.y) * half + shift;
    let ends = vec2f(frame.size) - 1.0;
    if any(last < vec2f(0.0)) || any(first > ends) { return false; }
    let pixels = vec4i(vec4f(clamp(floor(first), vec2f(0.0), ends), clamp(floor(last), vec2f(0.0), ends)));
    // No corner is nearer than this, and no sample is nearer than all corners.
    let nearest = depth_key(clamp(e.high.z / e.low.w * 1.000004, 0.0, 1.0));
    return nearest < hiz_farthest(pixels);
}
