// X-ray sums: the words in which a pixel sums the weighted colors of its layers. SUM_WORDS tells the format:
// 4, four32: a word for each channel and one for the weights · 2, packed16: two words of two halves: red and green, blue and
// the number of layers, 8 bits per channel · 3, three8: three words for 8-bit channels; the number of layers stands above the
// first channel, in 12 bits. With IS_ONE64 two words are one integer of 64 bits, lower word first: sums of 19 bits for red, green and
// blue, channels of at most 12 bits, and the number of layers in 7 bits.
//@ use effects/xray

// Words per pixel.
override SUM_WORDS: u32 = 4u;
override IS_ONE64: bool = false;
// Bits per channel that four32 and one64 add up.
override SUM_BITS: u32 = 12u;

const XRAY_PACKED16_LAYERS = 257u; // layers that the sums of each format can hold
const XRAY_THREE8_LAYERS = 4095u;
const XRAY_ONE64_LAYERS = 127u;

// The words that a layer adds.
fn xray_sums_layer(color: vec3f, weight: u32) -> vec4u {
    if SUM_WORDS == 4u || IS_ONE64 {
        let whole = (1u << SUM_BITS) - 1u;
        let sum = vec3u(round(color * f32(whole))) * weight;
        if IS_ONE64 { return vec4u(sum.r | (sum.g << 19u), (sum.b << 6u) | (1u << 25u), 0u, 0u); }
        return vec4u(sum, weight);
    }
    let sum = vec3u(round(color * 255.0));
    if SUM_WORDS == 2u { return vec4u(sum.r | (sum.g << 16u), sum.b | (1u << 16u), 0u, 0u); }
    return vec4u(sum.r | (1u << 20u), sum.g, sum.b, 0u);
}

// Does a pixel hold more than fits with this layer, given its words before? True for one layer of a pixel at most.
fn xray_sums_overflow(before: vec4u, weight: u32) -> bool {
    if SUM_WORDS == 4u {
        let capacity = 0xffffffffu / ((1u << SUM_BITS) - 1u);
        return before.w <= capacity && before.w + weight > capacity;
    }
    if IS_ONE64 { return (before.y >> 25u) == XRAY_ONE64_LAYERS; }
    if SUM_WORDS == 2u { return (before.y >> 16u) == XRAY_PACKED16_LAYERS; }
    return (before.x >> 20u) == XRAY_THREE8_LAYERS;
}

// Sum of the weights of a pixel's layers.
fn xray_sums_weight(words: vec4u) -> u32 {
    if SUM_WORDS == 4u { return words.w; }
    if IS_ONE64 { return words.y >> 25u; }
    if SUM_WORDS == 2u { return words.y >> 16u; }
    return words.x >> 20u;
}

// Weighted mean of the colors, divided in integers.
fn xray_sums_color(words: vec4u) -> vec3f {
    let weight = xray_sums_weight(words);
    var sums = words.xyz;
    var whole = 255u;
    if SUM_WORDS == 4u || IS_ONE64 { whole = (1u << SUM_BITS) - 1u; }
    if IS_ONE64 {
        let green = (words.x >> 19u) | ((words.y & 0x3fu) << 13u);
        sums = vec3u(words.x & 0x7ffffu, green, (words.y >> 6u) & 0x7ffffu);
    } else if SUM_WORDS == 2u {
        sums = vec3u(words.x & 0xffffu, words.x >> 16u, words.y & 0xffffu);
    }
    if SUM_WORDS == 3u { sums = vec3u(words.x & 0xfffffu, words.y, words.z); }
    return vec3f(vec3u(xray_average(sums.x, weight), xray_average(sums.y, weight), xray_average(sums.z, weight))) / f32(whole);
}

// Have the sums overflowed? In three8 and one64, unless the number of layers has overflowed to 0 and beyond.
fn xray_sums_is_full(words: vec4u) -> bool {
    let weight = xray_sums_weight(words);
    if SUM_WORDS == 4u { return weight > 0xffffffffu / ((1u << SUM_BITS) - 1u); }
    if SUM_WORDS == 2u && !IS_ONE64 { return weight > XRAY_PACKED16_LAYERS; }
    return weight == 0u && (words.x | words.y) != 0u;
}
