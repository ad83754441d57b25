// Draw records: what all passes read of a draw beside its matrix to clip space, its flags and its first vertex and triangle.
// Chosen by the scene: instanced where many instances show few primitives.
//
// Its vertices and its list of indices.
//@ declare fn draw_vertex_count(draw: u32) -> u32
//@ declare fn draw_topology(draw: u32) -> u32
//@ declare fn draw_index_offset(draw: u32) -> u32
//@ declare fn draw_index_format(draw: u32) -> u32
// Its attributes; the format of colors is 0 where there are none.
//@ declare fn draw_positions(draw: u32) -> AttributePlace
//@ declare fn draw_normals(draw: u32) -> AttributePlace
//@ declare fn draw_colors(draw: u32) -> AttributePlace
//@ declare fn draw_base_color(draw: u32) -> vec4f
// Radius of the discs of its points in pixels, at a distance of 1.
//@ declare fn draw_point_radius(draw: u32) -> f32
// Object-space origin of packed and of eye-relative positions, and one step of a packed one.
//@ declare fn draw_origin(draw: u32) -> vec3f
//@ declare fn draw_step(draw: u32) -> vec3f
// From object space to the world: a point, a difference of points, and a normal, which keeps its direction alone.
//@ declare fn draw_point(draw: u32, p: vec3f) -> vec3f
//@ declare fn draw_vector(draw: u32, v: vec3f) -> vec3f
//@ declare fn draw_normal(draw: u32, n: vec3f) -> vec3f

//@ variant default
// The record of the draw holds all.
//@ use lib/triangle

fn draw_vertex_count(draw: u32) -> u32 {
    return draws[draw].vertex_count;
}

fn draw_topology(draw: u32) -> u32 {
    return draws[draw].topology;
}

fn draw_index_offset(draw: u32) -> u32 {
    return draws[draw].index_offset;
}

fn draw_index_format(draw: u32) -> u32 {
    return draws[draw].index_format;
}

fn draw_positions(draw: u32) -> AttributePlace {
    return AttributePlace(draws[draw].position_offset, draws[draw].position_stride, draws[draw].position_format);
}

fn draw_normals(draw: u32) -> AttributePlace {
    return AttributePlace(draws[draw].normal_offset, draws[draw].normal_stride, draws[draw].normal_format);
}

fn draw_colors(draw: u32) -> AttributePlace {
    return AttributePlace(draws[draw].color_offset, draws[draw].color_stride, draws[draw].color_format);
}

fn draw_base_color(draw: u32) -> vec4f {
    return draws[draw].base_color;
}

fn draw_point_radius(draw: u32) -> f32 {
    return draws[draw].point_radius_px;
}

fn draw_origin(draw: u32) -> vec3f {
    return draws[draw].origin.xyz;
}

fn draw_step(draw: u32) -> vec3f {
    return draws[draw].step.xyz;
}

fn draw_point(draw: u32, p: vec3f) -> vec3f {
    return (draws[draw].world_from_object * vec4f(p, 1.0)).xyz;
}

fn draw_vector(draw: u32, v: vec3f) -> vec3f {
    return (draws[draw].world_from_object * vec4f(v, 0.0)).xyz;
}

fn draw_normal(draw: u32, n: vec3f) -> vec3f {
    return (draws[draw].normal_from_object * vec4f(n, 0.0)).xyz;
}

//@ variant instanced
// What instances share lies in a table, and what only colors need of each behind the attributes: a record is read for every
// triangle, and a million of them fit where a whole one of 336 bytes would fit 399,457 times.
//@ use lib/triangle
//@ use glue/shapes
//@ use variants/loads

// Words of an instance's matrices: four columns to the world, then three columns for normals, of three floats each.
const PLACEMENT_WORDS = 21u;
const PLACEMENT_NORMALS = 12u;

fn draw_shape(draw: u32) -> u32 {
    return draws[draw].flags >> DRAW_PRIMITIVE_SHIFT;
}

fn draw_vertex_count(draw: u32) -> u32 {
    return shapes[draw_shape(draw)].vertex_count;
}

fn draw_topology(draw: u32) -> u32 {
    return shapes[draw_shape(draw)].topology;
}

fn draw_index_offset(draw: u32) -> u32 {
    return shapes[draw_shape(draw)].index_offset;
}

fn draw_index_format(draw: u32) -> u32 {
    return shapes[draw_shape(draw)].index_format;
}

fn draw_positions(draw: u32) -> AttributePlace {
    return AttributePlace(shapes[draw_shape(draw)].position_offset, shapes[draw_shape(draw)].position_stride, shapes[draw_shape(draw)].position_format);
}

fn draw_normals(draw: u32) -> AttributePlace {
    return AttributePlace(shapes[draw_shape(draw)].normal_offset, shapes[draw_shape(draw)].normal_stride, shapes[draw_shape(draw)].normal_format);
}

fn draw_colors(draw: u32) -> AttributePlace {
    return AttributePlace(shapes[draw_shape(draw)].color_offset, shapes[draw_shape(draw)].color_stride, shapes[draw_shape(draw)].color_format);
}

fn draw_base_color(draw: u32) -> vec4f {
    return shapes[draw_shape(draw)].base_color;
}

// Scenes with points are not drawn so.
fn draw_point_radius(draw: u32) -> f32 {
    return 0.0;
}

fn draw_origin(draw: u32) -> vec3f {
    return shapes[draw_shape(draw)].origin.xyz;
}

fn draw_step(draw: u32) -> vec3f {
    return shapes[draw_shape(draw)].step.xyz;
}

fn draw_point(draw: u32, p: vec3f) -> vec3f {
    return draw_columns(draw, 0u) * p + draw_column(draw, 9u);
}

fn draw_vector(draw: u32, v: vec3f) -> vec3f {
    return draw_columns(draw, 0u) * v;
}

fn draw_normal(draw: u32, n: vec3f) -> vec3f {
    return draw_columns(draw, PLACEMENT_NORMALS) * n;
}

fn draw_columns(draw: u32, first: u32) -> mat3x3f {
    return mat3x3f(draw_column(draw, first), draw_column(draw, first + 3u), draw_column(draw, first + 6u));
}

// Three of the words of an instance's matrices.
fn draw_column(draw: u32, first: u32) -> vec3f {
    return bitcast<vec3f>(load_words3(shapes[draw_shape(draw)].first_placement + PLACEMENT_WORDS * draw + first));
}
