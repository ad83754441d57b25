//! Links: the address under which a page draws a preset and proves that its picture has the same bits
//! as the oracle's.

use std::sync::Arc;

use crate::{
    accuracy::AccuracyRequest,
    gpu::device::Caps,
    oracle,
    plan::Planner,
    preset::{Preset, SceneSource},
    preset_file::{self, Fnv, PresetFile, hex},
    scene::{Scene, needs::Needs},
};

/// Where `sh scripts/web.sh --serve` serves the page.
pub const PAGE: &str = "http://localhost:8000/";

/// The line that a page reads behind `#`.
///
/// # Errors
/// The preset shows a model, which a page cannot read from this machine: in one sentence.
pub fn line(preset_file: &PresetFile) -> Result<String, String> {
    match &preset_file.preset.scene {
        SceneSource::Builtin(_) => Ok(preset_file::to_line(preset_file)),
        SceneSource::File(model) => Err(format!(
            "{}: its scene is the model {}, which a page cannot read from here; choose a built-in scene",
            preset_file.id,
            model.display()
        )),
    }
}

/// The link to `page` with this line and, where they are known, the bits of its picture.
pub fn address(page: &str, line: &str, bits: Option<&str>) -> String {
    let proof = bits.map(|bits| format!(";{bits}")).unwrap_or_default();
    format!("{page}#{line}{proof}")
}

/// The bits that a picture of the preset must have, for [`address`]: FNV-1a of the triangle ids and
/// of the depth keys, which are the same on every adapter.
///
/// # Errors
/// They are not the same everywhere: why, in one sentence.
pub fn bits(preset: &Preset, scene: &Scene) -> Result<String, String> {
    let size = preset.output.size;
    let (view, stack) = (preset.view(scene, size), preset.stack_on(scene, size));
    let draws = stack
        .draws(scene, &view)
        .map_err(|error| error.to_string())?;
    let needs = Arc::new(Needs::of(scene, &draws, &view));
    let (caps, request) = (Caps::ALL, AccuracyRequest::portable_bits());
    Planner::default()
        .plan(&needs, &stack, &caps, &caps.tuning(), &request)
        .map_err(|error| error.to_string())?;
    let (triangle_ids, depth_keys) =
        oracle::strict_frame(scene, &view, &stack).map_err(|error| error.to_string())?;
    let hashes = [triangle_ids, depth_keys].map(|words| hex(Fnv::new().words(&words)));
    Ok(hashes.join("-"))
}
