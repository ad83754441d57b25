// Lace: cuts every triangle into Sierpinski's gasket, and light falls through the holes.
//
// `areas` are three whole numbers: how far the sample lies from each edge, in exact doubled areas. Whatever is decided with them is
// decided alike on every adapter, in every pass, and in the shadow map, so the shadow has the same holes.
//@ use lib/sample
//@ use lib/hash

struct Lace {
    /// How often a triangle is divided into four.
    @range(0, 8, 3) depth: u32,
    /// How many divisions the coarsest triangles lack.
    @range(0, 4, 0) uneven: u32,
    /// Width of the seam along the edges, in thousandths of the triangle's height.
    @range(0, 300, 40) @hard(0, 1000) seam: u32,
    /// Draws the holes and leaves out the lace.
    @toggle(0) invert: u32,
    /// How many triangles are cut; those with higher ids stay whole, a room around the model for instance.
    @range(1, 100000, 100000) @hard(1, 4294967295) count: u32,
    /// Another seed gives another choice of coarse triangles.
    @range(0, 999, 1) seed: u32,
}

fn lace(sample: Sample, p: Lace) -> bool {
    if sample.triangle >= p.count { return true; }
    return is_thread(p, sample) != (p.invert != 0u);
}

fn is_thread(p: Lace, sample: Sample) -> bool {
    let whole = sample_total_area(sample);
    let least = min(sample.areas.x, min(sample.areas.y, sample.areas.z));
    // Dividing first keeps the product within 32 bits: areas have up to 31.
    if least < whole / 1000u * p.seam { return true; }
    var depth = p.depth;
    if p.uneven > 0u {
        depth -= min(depth, hash(sample.triangle ^ (p.seed * 0x9e3779b9u)) % (p.uneven + 1u));
    }
    // Barycentric coordinates of the quarter in which the sample lies; `whole` is 1. Each turn doubles them.
    var at = sample.areas;
    for (var level = 0u; level < depth; level += 1u) {
        // A sum below 2^31 doubled stays below 2^32.
        at *= 2u;
        if at.x >= whole { at.x -= whole; }
        else if at.y >= whole { at.y -= whole; }
        else if at.z >= whole { at.z -= whole; }
        else { return false; } // the middle quarter is the hole
    }
    return true;
}
