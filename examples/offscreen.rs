//! Renders a preset without a window, and prints what its pixels hold and how wrong the picture is.
//!
//! ```sh
//! cargo run --release --example offscreen -- walk-dissolve
//! ```

use pollster::FutureExt as _;
use rasterlab::{
    gpu::{Gpu, Renderer, device::AdapterChoice},
    oracle, preset_file,
};

fn main() -> anyhow::Result<()> {
    let name = std::env::args()
        .nth(1)
        .unwrap_or_else(|| "walk-dissolve".into());
    let preset_file = preset_file::open(&name, &preset_file::Folders::default())?;
    let preset = &preset_file.preset;
    let scene = preset_file::load_scene(preset, preset_file.path.as_deref())?;

    let mut renderer = Renderer::new(Gpu::open(&AdapterChoice::Any).block_on()?);
    renderer.set_scene(&scene).block_on()?;
    // Most presets show one moment; where an effect reads earlier pictures, those come first.
    let moments = preset.moments(&scene, preset.output.size);
    let capture = renderer
        .capture_last(&moments, &preset.accuracy)
        .block_on()?;

    // Row-major pixels: triangle id, depth key and gamma-encoded color.
    let frame = &capture.frame;
    let middle = (frame.height / 2 * frame.width + frame.width / 2) as usize;
    println!(
        "{} x {} pixels, {} covered",
        frame.width,
        frame.height,
        frame.covered()
    );
    println!(
        "middle: triangle {}, depth key {:#x}, color {:?}",
        frame.triangle_id[middle], frame.depth_key[middle], frame.color[middle]
    );

    let (view, stack) = moments.last().expect("a preset shows a moment");
    let verdict = oracle::judge(&scene, view, stack, &capture.picture())?;
    println!(
        "{} wrong triangles, colors at most {} of 255 off",
        verdict.report.wrong_triangles, verdict.report.max_color_delta
    );
    Ok(())
}
