//! Promise: drawing again compiles nothing, so memory does not grow with the number of pictures.
//! lavapipe compiles a kernel anew in every draw where one of its conditions reads uniforms alone,
//! and frees none of what it compiled; elsewhere there is nothing to see.

use std::process::Command;

use pollster::FutureExt as _;
use rasterlab::{
    gpu::{Gpu, Renderer, device::AdapterChoice},
    plan::Tuning,
    preset_file::{self, Folders},
};

use crate::common::{Reach, few_and_all};

/// Presets that together have nearly every effect, particles, shadows, layers, textures, skins and
/// a background of two colors.
const PRESETS: [&str; 14] = [
    "hero-xray",
    "particles",
    "boxes",
    "dither",
    "explode",
    "facet-radial",
    "hero-swarm",
    "hero-walk",
    "inflate",
    "outline",
    "plinth",
    "shadow",
    "smear",
    "stipple",
];

/// Is set in the process that measures itself.
const CHILD: &str = "RASTERLAB_TEST_COMPILED_ONCE";

/// Bytes of code in this process that no file contains. Regions of it that touch become one, so their
/// number says less.
fn code_bytes() -> usize {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux tells");
    let bytes = |line: &str| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        let is_compiled = fields[1].contains('x') && fields.len() == 5;
        let (start, end) = fields[0].split_once('-')?;
        let at = |address| usize::from_str_radix(address, 16).ok();
        is_compiled.then_some(at(end)? - at(start)?)
    };
    maps.lines().filter_map(bytes).sum()
}

/// Bytes of code that come while `name` is drawn `times` times, after it was drawn often enough to have
/// compiled everything.
fn code_of_draws(gpu: &std::sync::Arc<Gpu>, name: &str, times: usize, tuning: Tuning) -> usize {
    let file = preset_file::open(name, &Folders::default()).expect("a preset of the gallery");
    let scene = preset_file::load_scene(&file.preset, None).expect("a built-in scene");
    let view = file.preset.view(&scene, [64, 40]);
    let mut renderer = Renderer::new(gpu.clone());
    renderer.set_tuning(tuning);
    renderer.set_scene(&scene).block_on().expect("it fits");
    let mut draw = || {
        renderer
            .draw(&view, &file.preset.stack, &file.preset.accuracy)
            .block_on()
            .expect("it draws");
        renderer.finish().block_on().expect("it ends");
    };
    (0..3).for_each(|_| draw());
    let before = code_bytes();
    (0..times).for_each(|_| draw());
    code_bytes().saturating_sub(before)
}

fn drawing_again_compiles_nothing(reach: Reach) {
    let test = format!("{reach:?}").to_lowercase();
    let presets = reach.of(2, PRESETS);
    let gpu = Gpu::open(&AdapterChoice::Any)
        .block_on()
        .expect("an adapter");
    if !gpu.summary.name.contains("llvmpipe") {
        return;
    }
    if std::env::var_os(CHILD).is_none() {
        // Other tests of this process compile meanwhile.
        let child = Command::new(std::env::current_exe().expect("its path"))
            .args([
                "--exact",
                &format!("compiled_once::drawing_again_compiles_nothing::{test}"),
                "--include-ignored",
                "--nocapture",
            ])
            .env(CHILD, "1")
            .output()
            .expect("the test starts");
        assert!(
            child.status.success(),
            "{}{}",
            String::from_utf8_lossy(&child.stdout),
            String::from_utf8_lossy(&child.stderr)
        );
        return;
    }
    let tuning = gpu.caps.tuning();
    assert!(
        tuning.stored_uniforms,
        "lavapipe binds enough storage buffers"
    );
    for &name in &presets {
        assert_eq!(
            code_of_draws(&gpu, name, 4, tuning),
            0,
            "{name}: bytes of code that came with four draws"
        );
    }
    if gpu.summary.driver.contains("Mesa 22.") {
        // What this test sees without the tuning.
        let untuned = Tuning {
            stored_uniforms: false,
            ..tuning
        };
        let compiles = |name: &&str| code_of_draws(&gpu, name, 4, untuned) > 0;
        assert!(
            presets.iter().any(compiles),
            "uniforms in conditions compile nothing: the test sees nothing"
        );
    }
}

few_and_all!(drawing_again_compiles_nothing,);
