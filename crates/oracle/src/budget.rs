//! What a picture may cost the oracle, checked before anything is allocated: a small file can place
//! a large mesh many times.

use std::sync::OnceLock;

use super::shot::Shot;
use crate::scene::draw::{Draw, DrawError, totals};

/// Memory of a picture, GiB, unless [another](choose_memory) was chosen.
const MEMORY_GIB: f64 = 4.0;

/// The variable of the environment from which the program chooses it.
pub const VARIABLE: &str = "RASTERLAB_ORACLE_GIB";

/// Most positions that are computed: each vertex of each instance once, and once more for each of
/// its morph targets.
const MAX_POSITIONS: u64 = 1 << 32;

/// Bytes of each pixel: its sample, triangle id, depth key, color in f64 and in bytes.
const PIXEL_BYTES: u64 = 12 + 4 + 4 + 32 + 4;
/// More bytes of each pixel where an effect has passes: two pictures in linear light beside the
/// one that is written, and two of right answers.
const PASS_BYTES: u64 = 5 * 32;
/// More bytes of each pixel where a pass is kept: what it read and wrote, in f32, f64, and between
/// two right answers.
const KEPT_BYTES: u64 = 2 * 16 + 2 * 32 + 2 * 32;
/// More bytes of each pixel where layers are summed.
const LAYER_BYTES: u64 = 32 + 4;
/// Bytes of each texel of a shadow map: its depth in f64 and its key.
const TEXEL_BYTES: u64 = 8 + 4;
/// Bytes of each vertex of each instance: the record of its projection.
const VERTEX_BYTES: u64 = 20;
/// More bytes of each vertex that deforms: its position and normal.
const DEFORMED_BYTES: u64 = 64;
/// Bytes of each triangle of each instance, in a list that grows by doubling.
const TRIANGLE_BYTES: u64 = 2 * 80;

/// Who draws: the judge compares two pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    Draw,
    Judge,
}

/// Refuses a picture that takes more memory or work than the oracle may.
/// Errors: [`DrawError::OracleMemory`] or [`DrawError::OracleWork`].
pub fn check(shot: &Shot, purpose: Purpose) -> Result<(), DrawError> {
    let needed_gib =
        bytes(shot) as f64 * if purpose == Purpose::Judge { 2.0 } else { 1.0 } / f64::from(1 << 30);
    let limit_gib = CHOSEN.get().copied().unwrap_or(MEMORY_GIB);
    if needed_gib > limit_gib {
        return Err(DrawError::OracleMemory {
            needed_gib,
            limit_gib,
            variable: VARIABLE,
        });
    }
    let positions = positions(shot);
    if positions > MAX_POSITIONS {
        return Err(DrawError::OracleWork {
            positions,
            limit: MAX_POSITIONS,
        });
    }
    Ok(())
}

/// Memory of the picture at its peak, bytes, if no triangle is turned away.
fn bytes(shot: &Shot) -> u64 {
    let [vertices, triangles] = totals(shot.scene, shot.draws);
    let records = if shot.stack.unshares_vertices() {
        3 * triangles
    } else {
        vertices
    };
    let pixel = PIXEL_BYTES
        + if shot.stack.layers(triangles).is_some() || shot.has_glass() {
            LAYER_BYTES
        } else {
            0
        }
        + if shot.stack.has_passes() {
            PASS_BYTES
        } else {
            0
        }
        + if shot.stack.kept().is_some() {
            KEPT_BYTES
        } else {
            0
        };
    let deforming = shot
        .draws
        .iter()
        .map(|draw| &shot.scene.primitives[draw.primitive])
        .filter(|mesh| !mesh.deformation.is_none());
    let deformed: u64 = deforming.map(|mesh| u64::from(mesh.vertex_count())).sum();
    let texels = shot
        .stack
        .shadow_map_view(shot.scene, shot.view)
        .map_or(0, |light| light.pixels() as u64);
    shot.view.pixels() as u64 * pixel
        + texels * TEXEL_BYTES
        + records * VERTEX_BYTES
        + deformed * DEFORMED_BYTES
        + triangles * TRIANGLE_BYTES
}

fn positions(shot: &Shot) -> u64 {
    let of_draw = |draw: &Draw| {
        let primitive = &shot.scene.primitives[draw.primitive];
        u64::from(primitive.vertex_count()) * (1 + primitive.deformation.morph_targets.len() as u64)
    };
    shot.draws.iter().map(of_draw).sum()
}

static CHOSEN: OnceLock<f64> = OnceLock::new();

/// Gives the pictures of this process so much memory, GiB, each. Only the first call counts.
pub fn choose_memory(gib: f64) {
    CHOSEN.get_or_init(|| gib);
}
