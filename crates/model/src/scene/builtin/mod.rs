//! Built-in scenes: meshes from formulas, selected by a query such as `sphere?triangles=160000`.
//!
//! Teapot, sphere, knot, cube-wall, tentacle, walker, town, still-life, finishes, golf, sunglasses,
//! notch, hair, crossing and chamber are meant to look good. The others stress one property of the rasterizer each and bring a camera for it. All
//! are indexed, finite and identical on every machine.

mod extremes;
mod field;
mod finishes;
mod glassware;
mod golf;
mod hair;
mod leaves;
mod nebula;
mod painted;
mod panes;
mod plates;
mod query;
mod shapes;
mod still_life;
mod survey;
mod teapot;
mod tentacle;
mod town;
mod walker;
mod weights;

pub use query::{Builtin, BuiltinError, BuiltinParam, MAX_TRIANGLES, MAX_TRIANGLES_OF_SPHERE};
use query::{real, whole};

use super::model::Scene;

const SEED: BuiltinParam = whole(
    "seed",
    "seed of the random arrangement",
    0.0,
    0.0..=4_294_967_295.0,
);

const fn points(default: f64) -> BuiltinParam {
    whole("points", "number of points", default, 100.0..=100_000_000.0)
}

/// Every built-in scene.
pub const BUILTINS: &[Builtin] = &[
    Builtin {
        name: "teapot",
        about: "the Utah teapot, tessellated from its Bézier patches",
        params: &[whole(
            "tess",
            "segments along each side of each of the 32 patches",
            16.0,
            1.0..=256.0,
        )],
        build: teapot::build,
    },
    Builtin {
        name: "sphere",
        about: "a closed sphere with smooth bumps",
        params: &[whole(
            "triangles",
            "number of triangles; an odd number is rounded down",
            20_000.0,
            100.0..=MAX_TRIANGLES_OF_SPHERE as f64,
        )],
        build: shapes::sphere,
    },
    Builtin {
        name: "knot",
        about: "a closed trefoil tube in two colors",
        params: &[whole(
            "tess",
            "tessellation; the tube has 96 * tess^2 triangles",
            16.0,
            2.0..=256.0,
        )],
        build: shapes::knot,
    },
    Builtin {
        name: "cube-wall",
        about: "a wall of colored cubes, each an instance",
        params: &[
            whole("columns", "number of columns", 16.0, 1.0..=64.0),
            whole("rows", "number of rows", 10.0, 1.0..=64.0),
            SEED,
        ],
        build: shapes::cube_wall,
    },
    Builtin {
        name: "field",
        about: "a lattice of bumpy spheres seen from its center; most are outside the picture or occluded",
        params: &[
            whole("count", "number of spheres", 216.0, 1.0..=5_000.0),
            whole(
                "triangles",
                "triangles of each; an odd number is rounded down",
                2_000.0,
                100.0..=40_000.0,
            ),
            SEED,
        ],
        build: field::build,
    },
    Builtin {
        name: "tentacle",
        about: "a skinned tube with the clips Sway, Curl, Twist and Breathe; one or many",
        params: &[
            whole("joints", "number of joints", 8.0, 1.0..=128.0),
            whole(
                "influences",
                "most joints that influence a vertex",
                4.0,
                1.0..=8.0,
            ),
            whole(
                "tess",
                "tessellation; each has 16 * tess * (tess + 2) triangles and two caps",
                8.0,
                1.0..=128.0,
            ),
            whole(
                "instances",
                "number of instances, each with its own joints",
                1.0,
                1.0..=5_000.0,
            ),
        ],
        build: tentacle::build,
    },
    Builtin {
        name: "walker",
        about: "a long-necked animal on four legs with the clips Walk, Trot and Idle; one or a herd",
        params: &[
            whole(
                "tess",
                "tessellation; each has about 1,300 * tess^2 triangles",
                2.0,
                1.0..=12.0,
            ),
            whole(
                "instances",
                "number of instances, each with its own joints",
                1.0,
                1.0..=1_000.0,
            ),
        ],
        build: walker::build,
    },
    Builtin {
        name: "town",
        about: "a town on a hill in the sea: houses, a tower, trees and boats, drawn from the shore up",
        params: &[
            whole(
                "houses",
                "number of houses; the hill grows with them",
                40.0,
                1.0..=400.0,
            ),
            real(
                "lights",
                "how brightly the windows shine; 0: dark",
                0.0,
                0.0..=1.0,
            ),
            SEED,
        ],
        build: town::build,
    },
    Builtin {
        name: "still-life",
        about: "a jug, a bottle, a bowl of oranges, pears and a lemon on a round table, each a closed surface",
        params: &[whole(
            "tess",
            "tessellation; it has about 2,400 * tess^2 triangles",
            3.0,
            1.0..=32.0,
        )],
        build: still_life::build,
    },
    Builtin {
        name: "finishes",
        about: "balls in rows, from metal behind to glaze in front, rougher from left to right",
        params: &[
            whole(
                "tess",
                "tessellation; a ball has about 16 * tess^2 triangles",
                12.0,
                2.0..=64.0,
            ),
            whole("columns", "number of columns", 6.0, 1.0..=16.0),
            whole("rows", "number of rows", 3.0, 1.0..=16.0),
            whole(
                "lamps",
                "number of lights, which shine on the effect studio",
                0.0,
                0.0..=16.0,
            ),
        ],
        build: finishes::build,
    },
    Builtin {
        name: "golf",
        about: "golf balls: white lacquer, brass under worn lacquer, and rubber; textures make their dimples, and say where they are worn",
        params: &[whole(
            "tess",
            "tessellation; a ball has 16 * tess^2 - 8 * tess triangles",
            12.0,
            2.0..=64.0,
        )],
        build: golf::build,
    },
    Builtin {
        name: "chamber",
        about: "six walls visible only from the inside, so that the camera can look in from anywhere; for particles",
        params: &[real(
            "half",
            "half the length of a wall, meters",
            2.0,
            0.1..=1000.0,
        )],
        build: shapes::chamber,
    },
    Builtin {
        name: "globe",
        about: "a globe with a texture of colored cells",
        params: &[whole(
            "tess",
            "tessellation; it has 16 * tess^2 - 8 * tess triangles",
            12.0,
            2.0..=512.0,
        )],
        build: painted::globe,
    },
    Builtin {
        name: "panels",
        about: "panels with textures that are repeated, mirrored, clamped, rotated, emissive and unlit, above a ground of gravel",
        params: &[real(
            "repeats",
            "repeats of the image along each side of the ground",
            24.0,
            1.0..=4096.0,
        )],
        build: painted::panels,
    },
    Builtin {
        name: "panes",
        about: "blended sheets that cross each other round colored posts, so that no order of whole sheets is right",
        params: &[whole("sheets", "number of sheets", 5.0, 1.0..=256.0)],
        build: panes::build,
    },
    Builtin {
        name: "sunglasses",
        about: "pairs of tinted sunglasses behind one another, and colored balls between them",
        params: &[
            whole("pairs", "number of pairs", 2.0, 1.0..=32.0),
            whole(
                "tess",
                "tessellation; a ball has 16 * tess^2 - 8 * tess triangles",
                8.0,
                2.0..=32.0,
            ),
        ],
        build: glassware::sunglasses,
    },
    Builtin {
        name: "notch",
        about: "a concave block of glass with a notch, in which a ball lies: its back faces are seen through its front",
        params: &[real(
            "depth",
            "depth of the notch, as a fraction of the height of the block",
            0.62,
            0.05..=0.95,
        )],
        build: glassware::notch,
    },
    Builtin {
        name: "crossing",
        about: "two thick tubes of glass that cross in the middle, with a rod in one of them",
        params: &[
            whole("tess", "sides of a tube", 32.0, 3.0..=256.0),
            real(
                "clear",
                "fraction of light that passes through clear walls; 0: colored walls cover a part of what lies behind",
                0.0,
                0.0..=1.0,
            ),
        ],
        build: glassware::crossing,
    },
    Builtin {
        name: "hair",
        about: "a head under blended strips of hair, in stacks as deep as there are strips",
        params: &[
            whole("cards", "number of strips", 420.0, 1.0..=20_000.0),
            SEED,
        ],
        build: hair::build,
    },
    Builtin {
        name: "leaves",
        about: "a crown of leaves: quadrilaterals masked by the alpha of an image",
        params: &[
            whole("n", "number of leaves", 160.0, 1.0..=1_000_000.0),
            SEED,
        ],
        build: leaves::build,
    },
    Builtin {
        name: "survey",
        about: "a town as a scanner has it: points with colors and normals, in classes",
        params: &[
            points(60_000.0),
            whole("houses", "number of houses", 24.0, 1.0..=400.0),
            SEED,
        ],
        build: survey::build,
    },
    Builtin {
        name: "nebula",
        about: "points in a volume, in colored clouds along a spiral",
        params: &[
            points(60_000.0),
            real(
                "height",
                "height of a cloud by its width; 0: all points lie in a plane",
                0.6,
                0.0..=1.0,
            ),
            SEED,
        ],
        build: nebula::build,
    },
    Builtin {
        name: "near",
        about: "inside a hall of rings and very long walls that cross the near plane and every side of the guard band",
        params: &[real(
            "reach",
            "half the length of the walls, meters",
            1e5,
            10.0..=1e6,
        )],
        build: extremes::near,
    },
    Builtin {
        name: "grid",
        about: "a plane of jittered cells without folds: every sample is covered exactly once",
        params: &[
            real("cell", "side of a cell, pixels", 1.0, 0.1..=64.0),
            whole(
                "width",
                "width of the covered picture, pixels",
                256.0,
                1.0..=16_384.0,
            ),
            whole(
                "height",
                "height of the covered picture, pixels",
                256.0,
                1.0..=16_384.0,
            ),
            whole(
                "lattice",
                "vertices lie on multiples of 1/lattice px, which forces ties; 0: anywhere",
                0.0,
                0.0..=256.0,
            ),
            SEED,
        ],
        build: plates::grid,
    },
    Builtin {
        name: "fan",
        about: "triangles around one sample, which exactly one of them covers",
        params: &[
            whole("n", "number of triangles", 8.0, 3.0..=100_000.0),
            real("radius", "radius of the fan, pixels", 100.0, 0.1..=30_000.0),
            SEED,
        ],
        build: plates::fan,
    },
    Builtin {
        name: "sizes",
        about: "triangles of 1/1000 px to 100,000 px, small ones in front of large ones",
        params: &[SEED],
        build: extremes::sizes,
    },
    Builtin {
        name: "slivers",
        about: "needles 1 to 8 units of 1/256 px wide, in all directions",
        params: &[
            whole("n", "number of needles", 64.0, 1.0..=100_000.0),
            real(
                "length",
                "length of a needle, pixels",
                120.0,
                1.0..=30_000.0,
            ),
        ],
        build: extremes::slivers,
    },
    Builtin {
        name: "stack",
        about: "layers that all cover the center of the picture",
        params: &[
            whole("layers", "number of layers", 8.0, 1.0..=1_000_000.0),
            real(
                "gap",
                "distance between layers, meters; 0: coplanar, the smaller id wins",
                0.0,
                0.0..=1.0,
            ),
        ],
        build: extremes::stack,
    },
];

/// Builds the scene of a query, `name?parameter=value&parameter=value`. Missing parameters have
/// their defaults.
pub fn build(query: &str) -> Result<Scene, BuiltinError> {
    let (builtin, values) = query::parse(BUILTINS, query)?;
    let mut scene = (builtin.build)(&values)?;
    scene.name = builtin.name.into();
    scene.name_nodes();
    Ok(scene)
}
