//! Builtin scenes: meshes from formulas, asked for by a query such as `sphere?triangles=160000`.
//!
//! The handsome ones (teapot, sphere, knot, cube-wall, tentacle, walker, chamber) are for looking at; the others put one promise of the
//! rasterizer under load and bring the camera that does so. All are indexed, finite and the same on every machine.

mod body;
mod extremes;
mod field;
mod flesh;
mod gait;
mod hold;
mod leaves;
mod mesh;
mod painted;
mod plates;
mod query;
mod shapes;
mod teapot;
mod tentacle;
mod walker;

use std::ops::RangeInclusive;

pub use mesh::{Mesh, Ring};
use query::Values;

use super::Scene;

/// A parameter of a builtin scene.
#[derive(Clone, Debug)]
pub struct BuiltinParam {
    pub name: &'static str,
    pub doc: &'static str,
    pub default: f64,
    pub range: RangeInclusive<f64>,
    /// Only whole numbers are accepted.
    pub whole: bool,
}

/// A builtin scene for listings.
pub struct Builtin {
    pub name: &'static str,
    pub about: &'static str,
    pub params: &'static [BuiltinParam],
    build: fn(&Values) -> Result<Scene, BuiltinError>,
}

/// A query that names no builtin, or a parameter outside its range; one sentence.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BuiltinError(pub String);

/// Most triangles that a builtin makes: their indices and vertices stay below 128 MiB each.
pub const MAX_TRIANGLES: u64 = 10_000_000;

const fn whole(name: &'static str, doc: &'static str, default: f64, range: RangeInclusive<f64>) -> BuiltinParam {
    BuiltinParam { name, doc, default, range, whole: true }
}

const fn real(name: &'static str, doc: &'static str, default: f64, range: RangeInclusive<f64>) -> BuiltinParam {
    BuiltinParam { name, doc, default, range, whole: false }
}

const SEED: BuiltinParam = whole("seed", "another seed gives another arrangement", 0.0, 0.0..=4_294_967_295.0);

/// Every builtin scene.
pub const BUILTINS: &[Builtin] = &[
    Builtin {
        name: "teapot",
        about: "the Utah teapot, tessellated from its Bézier patches",
        params: &[whole("tess", "segments per side of each of the 32 patches", 16.0, 1.0..=256.0)],
        build: teapot::build,
    },
    Builtin {
        name: "sphere",
        about: "a closed sphere with smooth bumps, of as many triangles as asked",
        params: &[whole("triangles", "number of triangles; odd numbers lose one", 20_000.0, 100.0..=MAX_TRIANGLES as f64)],
        build: shapes::sphere,
    },
    Builtin {
        name: "knot",
        about: "a closed trefoil tube in two tones",
        params: &[whole("tess", "fineness; the tube has 96 * tess^2 triangles", 16.0, 2.0..=256.0)],
        build: shapes::knot,
    },
    Builtin {
        name: "cube-wall",
        about: "a wall of coloured cubes, each a placement of its own",
        params: &[
            whole("columns", "cubes side by side", 16.0, 1.0..=64.0),
            whole("rows", "cubes one above another", 10.0, 1.0..=64.0),
            SEED,
        ],
        build: shapes::cube_wall,
    },
    Builtin {
        name: "field",
        about: "bumpy spheres in a lattice, seen from the middle: most lie outside the picture or behind others",
        params: &[
            whole("count", "how many", 216.0, 1.0..=5_000.0),
            whole("triangles", "triangles of each; odd numbers lose one", 2_000.0, 100.0..=40_000.0),
            SEED,
        ],
        build: field::build,
    },
    Builtin {
        name: "tentacle",
        about: "a tube held by a chain of joints, with clips Sway, Curl, Twist and Breathe; one, or a field of them",
        params: &[
            whole("joints", "joints of the chain", 8.0, 1.0..=128.0),
            whole("influences", "most joints that hold a vertex", 4.0, 1.0..=8.0),
            whole("tess", "fineness; one has 16 * tess * (tess + 2) triangles and two caps", 8.0, 1.0..=128.0),
            whole("instances", "how many, each with joints of its own", 1.0, 1.0..=5_000.0),
        ],
        build: tentacle::build,
    },
    Builtin {
        name: "walker",
        about: "a long-necked animal on four legs, with clips Walk, Trot and Idle; one, or a herd out of step",
        params: &[
            whole("tess", "fineness; one has about 1,300 * tess^2 triangles", 2.0, 1.0..=12.0),
            whole("instances", "how many, each with joints of its own", 1.0, 1.0..=1_000.0),
        ],
        build: walker::build,
    },
    Builtin {
        name: "chamber",
        about: "six walls that show their insides alone, so that one presets in from everywhere; a place for particles",
        params: &[real("half", "half the length of a wall in metres", 2.0, 0.1..=1000.0)],
        build: shapes::chamber,
    },
    Builtin {
        name: "globe",
        about: "a globe with a map of coloured cells for its texture",
        params: &[whole("tess", "fineness; it has 16 * tess^2 - 8 * tess triangles", 12.0, 2.0..=512.0)],
        build: painted::globe,
    },
    Builtin {
        name: "panels",
        about: "panels that show images in every way: repeated, mirrored, clamped, turned, shining, unlit; and a ground of gravel",
        params: &[real("repeats", "how often the ground repeats its image along a side", 24.0, 1.0..=4096.0)],
        build: painted::panels,
    },
    Builtin {
        name: "leaves",
        about: "a crown of leaves, which the alpha of an image cuts out of quadrilaterals",
        params: &[whole("n", "number of leaves", 160.0, 1.0..=1_000_000.0), SEED],
        build: leaves::build,
    },
    Builtin {
        name: "near",
        about: "inside a hall of hoops and endless walls that cross the near plane and every side of the guard band",
        params: &[real("reach", "half the length of the walls in metres", 1e5, 10.0..=1e6)],
        build: extremes::near,
    },
    Builtin {
        name: "grid",
        about: "a fold-free plane of jittered cells: every sample is covered exactly once",
        params: &[
            real("cell", "side of a cell in pixels", 1.0, 0.1..=64.0),
            whole("width", "width of the covered picture in pixels", 256.0, 1.0..=16_384.0),
            whole("height", "height of the covered picture in pixels", 256.0, 1.0..=16_384.0),
            whole("lattice", "vertices on multiples of 1/lattice px, which forces ties; 0: anywhere", 0.0, 0.0..=256.0),
            SEED,
        ],
        build: plates::grid,
    },
    Builtin {
        name: "fan",
        about: "triangles round one sample, which exactly one of them owns",
        params: &[
            whole("n", "number of triangles", 8.0, 3.0..=100_000.0),
            real("radius", "radius of the fan in pixels", 100.0, 0.1..=30_000.0),
            SEED,
        ],
        build: plates::fan,
    },
    Builtin {
        name: "sizes",
        about: "triangles of 1/1000 px to 100,000 px, the smaller in front of the larger",
        params: &[SEED],
        build: extremes::sizes,
    },
    Builtin {
        name: "slivers",
        about: "needles of 1 to 8 units of 1/256 px across, in all directions",
        params: &[
            whole("n", "number of needles", 64.0, 1.0..=100_000.0),
            real("length", "length of a needle in pixels", 120.0, 1.0..=30_000.0),
        ],
        build: extremes::slivers,
    },
    Builtin {
        name: "stack",
        about: "layers that all cover the middle of the picture",
        params: &[
            whole("layers", "number of layers", 8.0, 1.0..=1_000_000.0),
            real("gap", "distance between layers in metres; 0: coplanar, so the smaller id is in front", 0.0, 0.0..=1.0),
        ],
        build: extremes::stack,
    },
];

/// Builds `name?key=value&key=value`; what is not said has its default.
pub fn build(query: &str) -> Result<Scene, BuiltinError> {
    let (builtin, values) = query::parse(query)?;
    let mut scene = (builtin.build)(&values)?;
    scene.name = builtin.name.into();
    Ok(scene)
}
