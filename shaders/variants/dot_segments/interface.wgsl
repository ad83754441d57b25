// Dot segments: the lines along which dots lie.
// Chosen by the parameter dots.lines: polyline for that value, edges for all others. Default: edges.
//
// Clip-space ends of a segment.
//@ declare fn dot_segment(segment: u32) -> SegmentEnds
