// Draw search, binary: draws lie in the order of their first triangles and first vertices.
//@ use lib/frame
//@ use lib/triangle

fn draw_of_triangle(id: u32) -> u32 {
    var search = search_begin(frame.draw_count);
    for (var i = 0u; i < SEARCH_STEPS && search_is_open(search); i += 1u) {
        search = search_narrow(search, draws[search_middle(search)].first_triangle <= id);
    }
    return search.low;
}

fn draw_of_vertex(id: u32) -> u32 {
    var search = search_begin(frame.draw_count);
    for (var i = 0u; i < SEARCH_STEPS && search_is_open(search); i += 1u) {
        search = search_narrow(search, draws[search_middle(search)].first_vertex <= id);
    }
    return search.low;
}
