//! Promise: strict arithmetic gives the same bits on every adapter and on the CPU. Needs an adapter.

mod common;

use common::*;
use rasterlab::{
    gpu::{Gpu, buffers},
    math::hash,
    oracle::flushed,
    shader::library::Library,
};

// ---------------------------------------------------------------- soft floats

const KERNEL: &str = "
@group(0) @binding(0) var<storage, read> pairs: array<vec2u>;
@group(0) @binding(1) var<storage, read_write> results: array<vec4u>;

@compute @workgroup_size(64)
fn calculate(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u, @builtin(local_invocation_index) lane: u32) {
    let i = (group.y * groups.x + group.x) * 64u + lane;
    let x = pairs[i].x;
    let y = pairs[i].y;
    results[i] = vec4u(soft_add(x, y), soft_multiply(x, y), soft_divide(x, y), bitcast<u32>(soft_round(x)));
}
";

/// Sum, product, quotient and the first rounded, of each pair, by the shaders of `library` on the adapter.
fn calculated(gpu: &Gpu, library: &Library, pairs: &[[u32; 2]]) -> Vec<[u32; 4]> {
    let text = format!("{}{KERNEL}", library.text("common/soft").expect("the file is there"));
    let module =
        gpu.device.create_shader_module(wgpu::ShaderModuleDescriptor { label: Some("soft"), source: wgpu::ShaderSource::Wgsl(text.into()) });
    let pipeline = gpu.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some("soft"),
        layout: None,
        module: &module,
        entry_point: Some("calculate"),
        compilation_options: Default::default(),
        cache: None,
    });
    let buffer = |size, usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size,
            usage: wgpu::BufferUsages::STORAGE | usage,
            mapped_at_creation: false,
        })
    };
    let given = buffer(8 * pairs.len() as u64, wgpu::BufferUsages::COPY_DST);
    let results = buffer(16 * pairs.len() as u64, wgpu::BufferUsages::COPY_SRC);
    gpu.queue.write_buffer(&given, 0, bytemuck::cast_slice(pairs));
    let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry { binding: 0, resource: given.as_entire_binding() },
            wgpu::BindGroupEntry { binding: 1, resource: results.as_entire_binding() },
        ],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bind_group, &[]);
    pass.dispatch_workgroups(1024, pairs.len() as u32 / 65_536, 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let bytes = buffers::read(gpu, &results, 16 * pairs.len() as u64).expect("results are read back");
    assert_eq!(gpu.take_error(), None);
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Pairs that are hard in one way or another; none is NaN or infinite.
fn hard_pairs(seed: u32, count: u32) -> Vec<[u32; 2]> {
    let number = |word: u32| if word >> 23 & 255 == 255 { word ^ 0x4000_0000 } else { word };
    let near = |value: f32, steps: u32| number(value.to_bits().wrapping_add(steps % 7).wrapping_sub(3));
    let pair = |i: u32| {
        let dice = |k: u32| hash(hash(seed ^ i.wrapping_mul(0x9e37_79b9)) ^ k.wrapping_mul(0x85eb_ca6b));
        let (x, y) = (number(dice(1)), number(dice(2)));
        let of_few_bits = |word: u32| number(word & 0xff80_0000 | dice(3) & dice(4) & dice(5) & 0x7f_ffff);
        // An exponent that differs by at most 27.
        let beside = |word: u32| {
            let exponent = (x >> 23 & 255) as i32 + (word >> 23 & 63) as i32 % 55 - 27;
            number(word & 0x807f_ffff | (exponent.clamp(1, 254) as u32) << 23)
        };
        let value = f32::from_bits(x);
        match i % 9 {
            0 => [x, y],
            1 => [x, beside(y)],
            2 => [of_few_bits(x), of_few_bits(beside(y))],
            // Cancellation, to nothing or next to it.
            3 => [x, near(-value, dice(6))],
            // Products and quotients about 2^-126.
            4 => [x, near((f64::from(f32::MIN_POSITIVE) / f64::from(value)) as f32, dice(6))],
            5 => [x, near((f64::from(value) / f64::from(f32::MIN_POSITIVE)) as f32, dice(6))],
            // Subnormals and zeros.
            6 => [x & 0x807f_ffff, if dice(6) % 2 == 0 { y } else { y & 0x807f_ffff }],
            // About integers and halves.
            7 => [near((dice(6) >> (7 + dice(7) % 25)) as f32 / 2.0, dice(8)) | x & 0x8000_0000, x],
            // Quotients about powers of two, products about squares.
            _ => [x, near(value, dice(6)) ^ dice(7) & 0x8000_0000],
        }
    };
    (0..count).map(pair).collect()
}

/// Results that differ from Rust's f32 with explicit flushing; those that leave the range of f32 are no promise.
fn differences(gpu: &Gpu, library: &Library, seed: u32, count: u32) -> Vec<String> {
    let pairs = hard_pairs(seed, count);
    let mut different = Vec::new();
    let mut compared = 0u64;
    for (&[x, y], found) in pairs.iter().zip(calculated(gpu, library, &pairs)) {
        let (a, b) = (f32::from_bits(x), f32::from_bits(y));
        let expected = [
            Some(flushed::sum(a, b)).filter(|v| v.is_finite()).map(f32::to_bits),
            Some(flushed::product(a, b)).filter(|v| v.is_finite()).map(f32::to_bits),
            Some(flushed::quotient(a, b)).filter(|v| v.is_finite()).map(f32::to_bits),
            Some(flushed::round(a) as u32),
        ];
        for (name, (expected, found)) in ["+", "*", "/", "round"].into_iter().zip(expected.into_iter().zip(found)) {
            compared += u64::from(expected.is_some());
            if expected.is_some_and(|expected| expected != found) {
                different.push(format!("{x:08x} {name} {y:08x} is {:08x}, not {found:08x}", expected.unwrap_or_default()));
            }
        }
    }
    assert!(compared > 3 * u64::from(count), "hardly anything was compared: {compared} of {count} pairs");
    different
}

#[test]
fn soft_floats_are_those_of_the_cpu_with_subnormals_flushed() {
    let Some(gpu) = gpu() else { return };
    for seed in 0..4 {
        let different = differences(&gpu, &Library::Embedded, seed, 1 << 20);
        assert!(different.is_empty(), "seed {seed}: {} of 2^20 pairs, such as {:?}", different.len(), &different[..different.len().min(5)]);
    }
}

#[test]
fn a_soft_float_with_one_mistake_is_told_from_the_cpu() {
    let Some(gpu) = gpu() else { return };
    for (from, to) in [
        ("+ 127u + (kept & 1u)", "+ 127u"),
        ("+ 127u + (kept & 1u)", "+ 128u"),
        ("| select(0u, 1u, is_lossy)", ""),
        ("(product << zeros) | sticky", "product << zeros"),
        ("| select(0u, 1u, rest != 0u)", ""),
        ("i < 26u", "i < 25u"),
        ("bits >= 0x800000", "bits >= 0"),
        ("(1u << behind) - 1u + is_odd", "0u"),
        ("(1u << behind) - 1u + is_odd", "(1u << behind)"),
        ("select(a & SOFT_SIGN, 0u, is_minus)", "0u"),
    ] {
        let mutant = mutated("common/soft", from, to);
        assert!(!differences(&gpu, &mutant.shaders(), 1, 1 << 17).is_empty(), "{from:?} -> {to:?} makes no difference");
    }
}
