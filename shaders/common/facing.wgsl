// Facing: do all triangles of a meshlet turn their backs? Which side shows is decided after the snap, so a back must be so
// large on screen that no rounding of its corners turns it over.
//@ use common/instances
//@ use common/meshlets
//@ use common/extent

// Share of a length that sums of a few products may be off.
const FACING_SLACK = 9.5367431640625e-7; // 2^-20

fn facing_is_turned(instance: u32, record: u32, e: Extent) -> bool {
    let altitude = meshlets[record].axis.w;
    let is_telling = (instances[instance].flags & INSTANCE_FACES) != 0u && altitude > 0.0;
    if !is_telling || !extent_is_plain(e) { return false; }
    let eye = instances[instance].eye;
    let center = extent_place(instance, meshlets[record].center.xyz);
    let axis = meshlets[record].axis.xyz;
    let is_point = eye.w != 0.0;
    let way = select(eye.xyz, (center - eye.xyz) * eye.w, vec3<bool>(is_point));
    let square = dot(way, way);
    let along = dot(axis, way);
    let across = sqrt(max(square - along * along, 0.0) + FACING_SLACK * square);
    let slack = FACING_SLACK * select(4.0, dot(abs(center) + abs(eye.xyz), vec3f(1.0)), is_point);
    let radius = select(0.0, length(meshlets[record].half.xyz) * 1.000002, is_point);
    // How far the eye lies behind the plane of the triangle that turns away least: the cosine of a sum of angles.
    let behind = along * meshlets[record].center.w - across * meshlets[record].half.w - radius - slack;
    if behind <= 0.0 { return false; }
    // A back of longest side s covers at least s * depth units squared, doubled. Corners that move by `shift` along either
    // axis change that by at most 4 sqrt(2) shift per unit of its longest side on screen, and 8 shift^2.
    let depth = instances[instance].center.w * altitude / e.high.w * (behind / e.high.w) / e.high.w;
    let shift = extent_shift(e);
    return depth > 5.7 * shift * instances[instance].half.w / e.low.w + 8.0 * shift * shift / altitude;
}
