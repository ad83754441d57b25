// Draws, many: records in a list; an id belongs to the last draw that does not begin after it.
//@ use common/frame

@group(0) @binding(1) var<storage, read> draws: array<Draw>;

fn draws_of_triangle(id: u32) -> u32 {
    var low = 0u;
    var high = frame.draw_count;
    for (var step = 0u; step < 32u && high - low > 1u; step += 1u) {
        let middle = (low + high) / 2u;
        if draws[middle].first_triangle <= id { low = middle; } else { high = middle; }
    }
    return low;
}

fn draws_of_vertex(id: u32) -> u32 {
    var low = 0u;
    var high = frame.draw_count;
    for (var step = 0u; step < 32u && high - low > 1u; step += 1u) {
        let middle = (low + high) / 2u;
        if draws[middle].first_vertex <= id { low = middle; } else { high = middle; }
    }
    return low;
}
