//! What the first frame after an edit of an effect file costs: reading and checking its text,
//! compiling its pipelines, drawing.
//!
//! `cargo run --release --no-default-features --example reload_time [SAVES] [WIDTHxHEIGHT]`

use std::time::Instant;

use anyhow::Context;
use pollster::FutureExt as _;
use rasterlab::{
    effect_files::Catalog,
    gpu::{Gpu, Renderer, device::AdapterChoice},
    preset_file,
};

const PRESET: &str = r#"
scene = { builtin = "teapot" }
[effects.ink]
"#;

/// A surface effect whose text differs with every save, so that no driver finds it in its cache.
fn effect(salt: u32) -> String {
    format!(
        "/// Darkens what is seen at a slant.\nstruct Ink {{\n    /// Strength.\n    @range(0, 1, 0.7)\n    amount: f32,\n}}\n\n\
         fn ink(surface: Surface, p: Ink) -> Surface {{\n    var s = surface;\n    let slant = 1.0 - abs(dot(s.normal, s.view));\n    \
         s.color = vec4f(s.color.rgb * (1.0 - p.amount * smoothstep(0.3, 0.{salt:09}, slant)), s.color.a);\n    return s;\n}}\n"
    )
}

fn main() -> anyhow::Result<()> {
    let mut args = std::env::args().skip(1);
    let saves: u32 = args
        .next()
        .map_or(Ok(9), |text| text.parse())
        .context("SAVES is a number")?;
    let size = args.next().unwrap_or_else(|| "1280x720".into());
    let (width, height) = size.split_once('x').context("the size is WIDTHxHEIGHT")?;
    let size = [width.parse()?, height.parse()?];

    let gpu = Gpu::open(&AdapterChoice::Any).block_on()?;
    println!("{}", gpu.summary.name);
    let mut renderer = Renderer::new(gpu);
    // The time decides what the driver's cache cannot know from an earlier run.
    let salt = std::time::SystemTime::now()
        .duration_since(std::time::UNIX_EPOCH)?
        .subsec_nanos()
        / 2
        + 500_000_000;
    let mut times = [Vec::new(), Vec::new(), Vec::new()];
    for save in 0..=saves {
        let text = effect(salt - save);
        let start = Instant::now();
        let mut catalog = Catalog::default();
        catalog.add_text("ink", &text)?;
        let file = preset_file::parse_with(PRESET, "reload", "reload.toml", &catalog)?;
        let read = start.elapsed();

        let scene = preset_file::load_scene(&file.preset, None)?;
        let moments = file.preset.moments(&scene, size);
        let (view, stack) = moments.last().context("a preset shows a moment")?;
        renderer.set_scene(&scene).block_on()?;
        let compiled = renderer.compiled();
        let mut frame = || -> anyhow::Result<f64> {
            let start = Instant::now();
            renderer
                .draw(view, stack, &file.preset.accuracy)
                .block_on()?;
            renderer.finish().block_on()?;
            Ok(start.elapsed().as_secs_f64() * 1e3)
        };
        let first = frame()?;
        let second = frame()?;
        // The first save also compiles what every frame needs.
        if save == 0 {
            println!("first effect: {:.1} ms", first);
            continue;
        }
        let passes = renderer.compiled() - compiled;
        println!(
            "save {save}: {passes} pipelines, read {:.1} ms, first frame {first:.1} ms, second {second:.1} ms",
            read.as_secs_f64() * 1e3
        );
        for (times, ms) in times.iter_mut().zip([
            read.as_secs_f64() * 1e3,
            first - second,
            read.as_secs_f64() * 1e3 + first,
        ]) {
            times.push(ms);
        }
    }
    for (name, times) in ["read and check", "compile", "save to picture"]
        .iter()
        .zip(&mut times)
    {
        times.sort_by(f64::total_cmp);
        println!(
            "{name:16} median {:.1} ms, most {:.1} ms",
            times[times.len() / 2],
            times[times.len() - 1]
        );
    }
    Ok(())
}
