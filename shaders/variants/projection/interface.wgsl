// Projection: from stored vertices to snapped vertices, and cuts at the planes of the clipper.
// Chosen by the accuracy axis `vertex_transform`: strict for that option, float for all others. Default: float.
//
// A clip-space position.
//@ declare struct ClipPosition
// The snapped vertex of a vertex, or of a corner of the triangle `id` where triangles share no vertices.
//@ declare fn projection_record(draw: u32, vertex: u32, id: u32) -> vec4u
// A corner that was not rejected, before clipping.
//@ declare fn projection_corner(draw: u32, vertex: u32, id: u32) -> ClipPosition
// Does a position lie outside a plane, given as VERTEX_NEAR, VERTEX_LEFT and so on?
//@ declare fn projection_is_outside(plane: u32, v: ClipPosition) -> bool
// Where the edge from its inside to its outside end meets a plane.
//@ declare fn projection_cut(plane: u32, inside: ClipPosition, outside: ClipPosition) -> ClipPosition
// The snapped vertex of a corner that was cut at `planes`.
//@ declare fn projection_cut_record(clip: ClipPosition, planes: u32) -> vec4u
