//! What lies on disk: [`host`] gives the core model files, folders of shaders and the memory of the
//! machine; [`preset_file`] reads and writes presets as TOML, [`effect_files`] are effects that
//! anyone can write, and [`film`] writes the frames of an animated preset.

pub mod archive;
pub mod effect_files;
pub mod film;
pub mod host;
pub mod preset_file;

use rasterlab_evaluator as evaluator;
use rasterlab_kernels::shader;
use rasterlab_model::{effects, frame, math, params, preset, scene, work};
