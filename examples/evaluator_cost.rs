//! What the evaluator of WGSL costs: time per call of every surface effect, as a function in Rust
//! and as its own text in f64, on one thread.
//!
//! `cargo run --release --no-default-features --example evaluator_cost`

use std::{hint::black_box, time::Instant};

use glam::{DVec2, DVec3};
use rasterlab::{
    effect_files::evaluated,
    effects::{
        EFFECTS,
        hooks::{Finish, Surface, SurfaceFunction},
    },
    shader::library::Library,
};
use rasterlab_fuzz::stress::scenes::Rng;

const SURFACES: usize = 256;
const TURNS: usize = 40;
/// The fastest of as many measurements counts.
const MEASUREMENTS: usize = 15;

fn surface(rng: &mut Rng) -> Surface {
    let mut vector =
        |low: f64, high: f64| DVec3::from_array(std::array::from_fn(|_| rng.real(low, high)));
    let [normal, flat_normal, view] =
        std::array::from_fn(|_| vector(-1.0, 1.0).normalize_or(DVec3::Y));
    let screen = vector(0.0, 1.0).truncate();
    Surface {
        color: vector(0.0, 1.0).extend(1.0),
        glow: vector(0.0, 0.2),
        position: vector(-1.0, 1.0),
        normal,
        flat_normal,
        view,
        center: vector(-1.0, 1.0),
        center_screen: screen,
        screen,
        pixel: screen * 320.0,
        barycentrics: DVec3::splat(1.0 / 3.0),
        edge_distance_px: vector(0.0, 8.0),
        depth_m: rng.real(1.0, 9.0),
        pixel_size_m: 0.002,
        flat_depth_m: rng.real(1.0, 9.0),
        depth_range_m: DVec2::new(1.0, 9.0),
        triangle_id: rng.next_u32() >> 12,
        rank: rng.real(0.0, 1.0),
        lit: rng.real(0.0, 1.0),
        finish: Finish::default(),
        passed: DVec3::ZERO,
        step_offset: 0.0,
    }
}

/// Nanoseconds per call.
fn cost(function: &SurfaceFunction, surfaces: &[Surface], words: &[u32]) -> f64 {
    let measured = (0..MEASUREMENTS).map(|_| {
        let start = Instant::now();
        for _ in 0..TURNS {
            for together in surfaces.chunks(64) {
                let mut together = together.to_vec();
                function(&mut together, words);
                black_box(together);
            }
        }
        start.elapsed().as_nanos() as f64 / (TURNS * surfaces.len()) as f64
    });
    measured.fold(f64::INFINITY, f64::min)
}

fn main() {
    let mut rng = Rng(7);
    let surfaces: Vec<Surface> = (0..SURFACES).map(|_| surface(&mut rng)).collect();
    println!(
        "{:12} {:>8} {:>10} {:>6}",
        "effect", "Rust ns", "WGSL ns", "ratio"
    );
    let mut product = (0.0, 0);
    for effect in EFFECTS.iter() {
        let Some(native) = &effect.hooks.surface else {
            continue;
        };
        let of_text = evaluated(&Library::Embedded, effect).map(|hooks| hooks.surface);
        let Ok(Some(text)) = of_text else {
            println!("{:12} cannot be evaluated", effect.name);
            continue;
        };
        let words = &effect.defaults;
        let [native, text] = [
            cost(&**native, &surfaces, words),
            cost(&*text, &surfaces, words),
        ];
        println!(
            "{:12} {native:8.1} {text:10.1} {:6.1}",
            effect.name,
            text / native
        );
        product = (product.0 + (text / native).ln(), product.1 + 1);
    }
    println!(
        "geometric mean of the ratios: {:.1}",
        (product.0 / f64::from(product.1)).exp()
    );
}
