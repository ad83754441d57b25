// sample_setup: computes, once per triangle or clipped triangle, the integers that sample tests compare samples with. Values
// from floats are rounded here and nowhere else, so all passes agree.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/geometry
//@ use lib/queued_triangle
//@ use lib/sample
//@ use lib/sample_setup_write
//@ use variants/vertex_effects
// What is computed besides the setups of sample effects: alpha_mask where a material has an alpha mask. `at`: vertices of the triangle, or of
// the parent of a clipped triangle, within the draw.
//@ steps fn setup_step(t: Triangle, at: vec3u)
//@ use glue/sample_setup

@group(0) @binding(4) var<storage, read_write> vertices: array<vec4u>;

@compute @workgroup_size(GROUP_SIZE)
fn sample_setup(
    @builtin(workgroup_id) workgroup: vec3u, @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) invocation_index: u32
) {
    let index = frame_invocation(workgroup, workgroups, invocation_index, GROUP_SIZE);
    var count = frame.triangle_count;
    if IS_CLIPPED_TRIANGLES { count = min(atomicLoad(&counters.clipped_triangles), frame.clipped_triangle_capacity); }
    if index >= count { return; }
    let t = queued_triangle(index | select(0u, CLIPPED_ENTRY, IS_CLIPPED_TRIANGLES));
    let at = triangle_vertices(t.draw, t.id - draws[t.draw].first_triangle);
    var center_screen: vec2f;
    if IS_CLIPPED_TRIANGLES {
        let corners = vertex_effects_triangle(t.draw, at, t.id);
        center_screen = center_clipped(corners[0], corners[1], corners[2], vec2f(0.5));
    } else {
        if ((t.a.x | t.b.x | t.c.x) & 255u) != 0u { return; }
        center_screen = center_unclipped(t.a, t.b, t.c);
    }
    setup_step(t, at);
    let center = center_world(t.draw, at);
    center_screen = center_in_picture(center, center_screen);
    glue_sample_setup(TriangleSetup(t.id, vertex_at(t.a), vertex_at(t.b), vertex_at(t.c), t.outline, frame.size, center, center_screen), t.entry);
}

//@ step alpha_mask
// Positions of a triangle's corners in the image of its alpha mask, in 1/256 of a texel. They are rounded
// here and nowhere else, so all passes agree. Those of whole triangles are stored with the scene; only those of clipped
// triangles are computed in floats.
//@ use lib/frame
//@ use lib/triangle
//@ use lib/sample_setup
//@ use lib/sample_setup_write
//@ use lib/material_atlas
//@ use variants/vertex_effects

// Two records: x and y of three corners, and behind them 1 + the word of the material's record; 0 without a mask.
fn setup_step_alpha_mask(t: Triangle, at: vec3u) {
    let record = atlas_record(t.draw);
    let material = atlas_material(record);
    if (material.flags & MATERIAL_MASKED) == 0u {
        sample_setup_store(t.entry, SAMPLE_SETUPS - 1u, vec4u(0u));
        return;
    }
    let a = alpha_mask_corner(material.first_corner + 2u * at.x);
    let b = alpha_mask_corner(material.first_corner + 2u * at.y);
    let c = alpha_mask_corner(material.first_corner + 2u * at.z);
    var corners = array<vec2i, 3>(a, b, c);
    if IS_CLIPPED_TRIANGLES {
        // Homogeneous barycentrics in the parent (Olano and Greer 1997).
        let v = vertex_effects_triangle(t.draw, at, t.id);
        let lines = mat3x3f(cross(v[1].xyw, v[2].xyw), cross(v[2].xyw, v[0].xyw), cross(v[0].xyw, v[1].xyw));
        corners[0] = a + alpha_mask_offset(lines, vertex_at(t.a), b - a, c - a);
        corners[1] = a + alpha_mask_offset(lines, vertex_at(t.b), b - a, c - a);
        corners[2] = a + alpha_mask_offset(lines, vertex_at(t.c), b - a, c - a);
    }
    let words = array<vec2u, 3>(bitcast<vec2u>(corners[0]), bitcast<vec2u>(corners[1]), bitcast<vec2u>(corners[2]));
    sample_setup_store(t.entry, SAMPLE_SETUPS - 2u, vec4u(words[0], words[1]));
    sample_setup_store(t.entry, SAMPLE_SETUPS - 1u, vec4u(words[2], record + 1u, 0u));
}

fn alpha_mask_corner(word: u32) -> vec2i {
    return bitcast<vec2i>(vec2u(atlas_word(word), atlas_word(word + 1u)));
}

// Offset from the first corner's position in the image to that of a snapped position on the parent's plane.
fn alpha_mask_offset(lines: mat3x3f, position: vec2i, ab: vec2i, ac: vec2i) -> vec2i {
    let ndc = (vec2f(position) - frame.center) / frame.center;
    let terms = vec3f(ndc.x, -ndc.y, 1.0) * lines;
    let sum = terms.x + terms.y + terms.z;
    let offset = (vec2f(ab) * terms.y + vec2f(ac) * terms.z) / select(1.0, sum, sum != 0.0);
    return vec2i(round(clamp(offset, vec2f(-1073741824.0), vec2f(1073741824.0))));
}
