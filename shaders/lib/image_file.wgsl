// Pictures that an effect takes as inputs, in linear light. `file` is a parameter with @image. Values are filtered here from whole
// texels, with weights that are whole multiples of 1/256, so that the oracle computes the same.

// Words as `shader::image_files::words` lays them out: 4096 in a row, 4096 rows in a layer.
@group(0) @binding(37) var image_files: texture_2d_array<u32>;

const IMAGE_FILE_COUNT = 256u;    // word of the number of pictures; linear light of every byte is before it
const IMAGE_FILE_RECORDS = 257u;  // two words of each picture: its first word, its width and height; then the first word of a panorama
const IMAGE_FILE_FARTHEST = 16.0; // farthest place that is told from others, in pictures

fn image_file_word(index: u32) -> u32 {
    return textureLoad(image_files, vec2u(index & 4095u, (index >> 12u) & 4095u), index >> 24u, 0).x;
}

// Word of a picture's record.
fn image_file_record(file: u32) -> u32 {
    return IMAGE_FILE_RECORDS + 2u * min(file, image_file_word(IMAGE_FILE_COUNT) - 1u);
}

// Width and height of a picture, texels.
fn image_file_size(file: u32) -> vec2u {
    let size = image_file_word(image_file_record(file) + 1u);
    return vec2u(size & 0xffffu, size >> 16u);
}

// A texel of a picture; outside, the nearest one.
fn image_file_texel(file: u32, x: i32, y: i32) -> vec4f {
    let size = image_file_size(file);
    let at = vec2u(clamp(vec2i(x, y), vec2i(0), vec2i(size) - 1));
    let texel = image_file_word(image_file_word(image_file_record(file)) + at.y * size.x + at.x);
    let bytes = (vec4u(texel) >> vec4u(0u, 8u, 16u, 24u)) & vec4u(255u);
    let light = vec3u(image_file_word(bytes.x), image_file_word(bytes.y), image_file_word(bytes.z));
    return vec4f(bitcast<vec3f>(light), f32(bytes.w) / 255.0);
}

// The place in 1/256 of a texel from the middle of the first one.
fn image_file_grid(file: u32, place: vec2f) -> vec2i {
    let held = clamp(place, vec2f(-IMAGE_FILE_FARTHEST), vec2f(IMAGE_FILE_FARTHEST));
    return vec2i(floor(held * vec2f(image_file_size(file)) * 256.0 + 0.5)) - 128;
}

fn image_file_mixed(file: u32, left: i32, right: i32, top: i32, bottom: i32, part: vec2f) -> vec4f {
    let upper = mix(image_file_texel(file, left, top), image_file_texel(file, right, top), part.x);
    let lower = mix(image_file_texel(file, left, bottom), image_file_texel(file, right, bottom), part.x);
    return mix(upper, lower, part.y);
}

// A picture at a place between texels: (0, 0) is its top left corner, (1, 1) the bottom right one. Its edges go on outside.
fn image_file_at(file: u32, place: vec2f) -> vec4f {
    let grid = image_file_grid(file, place);
    let near = grid >> vec2u(8u);
    return image_file_mixed(file, near.x, near.x + 1, near.y, near.y + 1, vec2f(grid & vec2i(255)) / 256.0);
}

// The same of a picture that is repeated across and down.
fn image_file_tiled(file: u32, place: vec2f) -> vec4f {
    let size = vec2i(image_file_size(file));
    let grid = image_file_grid(file, place - floor(place)) + 256 * size;
    let near = (grid >> vec2u(8u)) % size;
    let next = (near + 1) % size;
    return image_file_mixed(file, near.x, next.x, near.y, next.y, vec2f(grid & vec2i(255)) / 256.0);
}
