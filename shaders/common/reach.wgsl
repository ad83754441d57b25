// Reach: what a triangle covers, where an effect says otherwise than its own samples.

override SHAPE: u32 = 0u;

const SHAPE_TRIANGLES = 0u;
const SHAPE_BOXES = 1u;
const SHAPE_POINTS = 2u;
