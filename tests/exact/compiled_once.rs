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

/// How many memory regions of this process hold code that no file contains.
fn code_regions() -> usize {
    let maps = std::fs::read_to_string("/proc/self/maps").expect("Linux tells");
    let is_compiled = |line: &&str| {
        let fields: Vec<&str> = line.split_whitespace().collect();
        fields[1].contains('x') && fields.len() == 5
    };
    maps.lines().filter(is_compiled).count()
}

/// Regions that come while `name` is drawn `times` times, after it was drawn often enough to have
/// compiled everything.
fn regions_of_draws(gpu: &std::sync::Arc<Gpu>, name: &str, times: usize, tuning: Tuning) -> usize {
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
    let before = code_regions();
    (0..times).for_each(|_| draw());
    code_regions().saturating_sub(before)
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
            regions_of_draws(&gpu, name, 4, tuning),
            0,
            "{name}: regions of code that came with four draws"
        );
    }
    if gpu.summary.driver.contains("Mesa 22.") {
        // What this test sees without the tuning.
        let untuned = Tuning {
            stored_uniforms: false,
            ..tuning
        };
        let compiles = |name: &&str| regions_of_draws(&gpu, name, 4, untuned) > 0;
        assert!(
            presets.iter().any(compiles),
            "uniforms in conditions compile nothing: the test sees nothing"
        );
    }
}

few_and_all!(drawing_again_compiles_nothing,);
