//! Promise: on a lattice of inputs, the evaluator in single precision and the adapter compute the
//! same: built-in functions and operators of whole numbers exactly, those of f32 within the accuracy that WGSL asks for (https://www.w3.org/TR/WGSL/#floating-point-accuracy).
//! Needs an adapter.

use pollster::FutureExt as _;
use rasterlab::{
    evaluator::{NoHost, Options, Precision, Program, Word},
    gpu::{Gpu, buffers},
};

use crate::common::*;

/// What the kernel `calculate` of `text` writes to its binding 1, `size` bytes, of `given` at its
/// binding 0.
pub fn calculated<In: bytemuck::Pod, Out: bytemuck::Pod>(
    gpu: &Gpu,
    text: String,
    given: &[In],
    size: usize,
    workgroups: [u32; 2],
) -> Vec<Out> {
    let module = gpu
        .device
        .create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some("calculate"),
            source: wgpu::ShaderSource::Wgsl(text.into()),
        });
    let pipeline = gpu
        .device
        .create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some("calculate"),
            layout: None,
            module: &module,
            entry_point: Some("calculate"),
            compilation_options: Default::default(),
            cache: None,
        });
    let buffer = |size: usize, usage| {
        gpu.device.create_buffer(&wgpu::BufferDescriptor {
            label: None,
            size: size as u64,
            usage: wgpu::BufferUsages::STORAGE | usage,
            mapped_at_creation: false,
        })
    };
    let inputs = buffer(size_of_val(given), wgpu::BufferUsages::COPY_DST);
    let results = buffer(size, wgpu::BufferUsages::COPY_SRC);
    gpu.queue
        .write_buffer(&inputs, 0, bytemuck::cast_slice(given));
    let bind_group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[
            wgpu::BindGroupEntry {
                binding: 0,
                resource: inputs.as_entire_binding(),
            },
            wgpu::BindGroupEntry {
                binding: 1,
                resource: results.as_entire_binding(),
            },
        ],
    });
    let mut encoder = gpu.device.create_command_encoder(&Default::default());
    let mut pass = encoder.begin_compute_pass(&Default::default());
    pass.set_pipeline(&pipeline);
    pass.set_bind_group(0, &bind_group, &[]);
    pass.dispatch_workgroups(workgroups[0], workgroups[1], 1);
    drop(pass);
    gpu.queue.submit([encoder.finish()]);
    let bytes = buffers::read(gpu, &results, size as u64)
        .block_on()
        .expect("results are read back");
    assert_eq!(gpu.take_error(), None);
    bytemuck::pod_collect_to_vec(&bytes)
}

/// Results of every expression for every input: `bits[input * expressions + expression]`.
fn by_adapter(gpu: &Gpu, text: &str, inputs: &[[u32; 4]], expressions: usize) -> Vec<u32> {
    let size = 4 * inputs.len() * expressions;
    let workgroups = [inputs.len().div_ceil(64) as u32, 1];
    calculated(gpu, text.into(), inputs, size, workgroups)
}

/// One function `case_0`, `case_1`, … for each expression of `a`, `b` and `c`, and the kernel that
/// calls all.
fn module(kind: &str, expressions: &[&str]) -> String {
    let mut text = String::new();
    let mut calls = String::new();
    for (index, expression) in expressions.iter().enumerate() {
        text.push_str(&format!(
            "fn case_{index}(x: vec3u) -> u32 {{\n    let a = bitcast<{kind}>(x.x);\n    let b = bitcast<{kind}>(x.y);\n    \
             let c = bitcast<{kind}>(x.z);\n    return bitcast<u32>({expression});\n}}\n"
        ));
        calls.push_str(&format!(
            "    results[i * {}u + {index}u] = case_{index}(inputs[i].xyz);\n",
            expressions.len()
        ));
    }
    text + &format!(
        "@group(0) @binding(0) var<storage, read> inputs: array<vec4u>;
@group(0) @binding(1) var<storage, read_write> results: array<u32>;
@compute @workgroup_size(64)
fn calculate(@builtin(global_invocation_id) id: vec3u) {{
    let i = id.x;
    if i >= arrayLength(&inputs) {{ return; }}
{calls}}}
"
    )
}

/// All triples of these words; the third from every third word only.
fn lattice(words: &[u32]) -> Vec<[u32; 4]> {
    let thirds: Vec<u32> = words.iter().copied().step_by(3).collect();
    let pairs = words
        .iter()
        .flat_map(|&a| words.iter().map(move |&b| (a, b)));
    pairs
        .flat_map(|(a, b)| thirds.iter().map(move |&c| [a, b, c, 0]))
        .collect()
}

/// Runs all expressions on both sides; `is_same` gets the index of the expression, the input and
/// both results.
pub fn compare(
    kind: &str,
    expressions: &[&str],
    words: &[u32],
    is_same: impl Fn(usize, [u32; 3], u32, u32) -> bool,
) {
    let Some(gpu) = gpu() else { return };
    let (text, inputs) = (module(kind, expressions), lattice(words));
    let found = by_adapter(&gpu, &text, &inputs, expressions.len());
    let parsed = naga::front::wgsl::parse_str(&text)
        .unwrap_or_else(|error| panic!("{}", error.emit_to_string(&text)));
    let options = Options {
        precision: Precision::Single,
        source: Some(&text),
        ..Options::default()
    };
    let mut faults = Vec::new();
    for (index, expression) in expressions.iter().enumerate() {
        let program = Program::new(&parsed, &format!("case_{index}"), &options)
            .unwrap_or_else(|error| panic!("{expression}: {error}"));
        let mut machine = program.machine();
        let mut wrong = inputs.iter().enumerate().filter_map(|(at, &[a, b, c, _])| {
            let arguments = [a, b, c].map(Word::from_u32);
            let evaluated = machine.call(&arguments, &mut NoHost).expect("it ends")[0].to_u32();
            let found = found[at * expressions.len() + index];
            (!is_same(index, [a, b, c], evaluated, found)).then_some(([a, b, c], evaluated, found))
        });
        if let Some((input, evaluated, found)) = wrong.next() {
            let shown = |word: u32| {
                if kind == "f32" {
                    format!("{:?}", f32::from_bits(word))
                } else {
                    format!("{word:#x}")
                }
            };
            let at = input.map(shown).join(", ");
            let count = 1 + wrong.count();
            faults.push(format!(
                "{expression} at {at}: evaluator {}, adapter {} ({count} such)",
                shown(evaluated),
                shown(found)
            ));
        }
    }
    println!(
        "{} expressions of {kind} at {} inputs",
        expressions.len(),
        inputs.len()
    );
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

pub const WHOLE: [u32; 17] = [
    0,
    1,
    2,
    3,
    7,
    31,
    32,
    33,
    100,
    0x1234_5678,
    0x5555_5555,
    0x7fff_ffff,
    0x8000_0000,
    0x8000_0001,
    0xffff_fff9,
    0xffff_fffe,
    0xffff_ffff,
];

#[test]
fn whole_numbers_are_equal() {
    let of_both = [
        "a + b",
        "a - b",
        "a * b",
        "a / b",
        "a % b",
        "a & b",
        "a | b",
        "a ^ b",
        "~a",
        "a << (u32(b) & 31u)",
        "a >> (u32(b) & 31u)",
        "abs(a)",
        "min(a, b)",
        "max(a, b)",
        "clamp(a, min(b, c), max(b, c))",
        "select(a, b, c > a)",
        "countLeadingZeros(a)",
        "countOneBits(a)",
        "countTrailingZeros(a)",
        "firstLeadingBit(a)",
        "firstTrailingBit(a)",
        "reverseBits(a)",
        "extractBits(a, u32(b), u32(c))",
        "insertBits(a, b, u32(c), 7u)",
        "u32(a < b) + 2u * u32(a <= b) + 4u * u32(a == b) + 8u * u32(a != b)",
        "dot(vec3(a, b, c), vec3(c, a, b))",
        "f32(a)",
    ];
    let equal = |_: usize, _: [u32; 3], evaluated: u32, found: u32| evaluated == found;
    compare(
        "u32",
        &[
            &of_both[..],
            &[
                "dot4U8Packed(a, b)",
                "pack4xU8(vec4u(a, b, c, a))",
                "unpack4xU8(a).y",
                "pack4xU8Clamp(vec4u(a, b, c, a))",
            ],
        ]
        .concat(),
        &WHOLE,
        equal,
    );
    compare(
        "i32",
        &[
            &of_both[..],
            &[
                "-a",
                "sign(a)",
                "dot4I8Packed(u32(a), u32(b))",
                "pack4xI8(vec4i(a, b, c, a))",
                "unpack4xI8(u32(a)).y",
                "pack4xI8Clamp(vec4i(a, b, c, a))",
            ],
        ]
        .concat(),
        &WHOLE,
        equal,
    );
}

/// Values without subnormals, which adapters may flush.
const FLOATS: [f32; 24] = [
    0.0, 1.0, -1.0, 0.5, -0.5, 0.25, 1.5, -1.5, 2.5, -2.5, 0.1, -0.7, 0.999, 1.001, 3.3, -3.3,
    7.75, 12.0, -31.5, 100.125, 1e-3, -1e-6, 1e4, 65536.0,
];

/// How far the adapter may be from the evaluator: (expression, allowed absolute difference at
/// inputs a, b and c with result r; none where WGSL promises nothing).
type Case = (&'static str, fn(f64, f64, f64, f64) -> Option<f64>);

/// Distance from |r| to the next f32.
fn ulp(r: f64) -> f64 {
    let r = (r.abs() as f32).max(f32::MIN_POSITIVE);
    f64::from(f32::from_bits(r.to_bits() + 1)) - f64::from(r)
}

const EXACT: &[&str] = &[
    "abs(a)",
    "-a",
    "min(a, b)",
    "max(a, b)",
    "clamp(a, min(b, c), max(b, c))",
    "saturate(a)",
    "sign(a)",
    "floor(a)",
    "ceil(a)",
    "round(a)",
    "trunc(a)",
    "step(a, b)",
    "select(a, b, c > a)",
    "frexp(a).fract",
    "f32(frexp(a).exp)",
    "ldexp(a, i32(clamp(b, -20.0, 20.0)))",
    "modf(a).whole",
    "f32(i32(a))",
    "f32(u32(abs(a)))",
    "f32(i32(a * 1e9))",
    "f32(u32(a * 1e9))",
    "f32(a < b) + 2.0 * f32(a <= b) + 4.0 * f32(a == b)",
    "f32(pack4x8unorm(vec4f(a, b, c, 1.0)) >> 24u)",
    "unpack4x8unorm(bitcast<u32>(a)).z * 0.0",
    "unpack2x16float(pack2x16float(vec2f(floor(clamp(a, -100.0, 100.0)), 0.5))).x",
];

const WITHIN: &[Case] = &[
    ("a + b", |_, _, _, r| Some(ulp(r))),
    ("a - b", |_, _, _, r| Some(ulp(r))),
    ("a * b", |_, _, _, r| Some(ulp(r))),
    ("a / b", |_, b, _, r| (b != 0.0).then(|| 2.5 * ulp(r))),
    // From a - b * trunc(a / b): where the quotient is next to a whole number, either one is
    // right.
    ("a % b", |a, b, _, _| {
        let quotient = a / b;
        let is_near = (quotient - quotient.round()).abs() <= 3.0 * ulp(quotient);
        (b != 0.0).then(|| 3.0 * ulp(a) + if is_near { b.abs() } else { 0.0 })
    }),
    ("fract(a)", |a, _, _, _| Some(ulp(a))),
    ("modf(a).fract", |a, _, _, _| Some(ulp(a))),
    ("sqrt(abs(a))", |_, _, _, r| Some(5.0 * ulp(r))),
    ("inverseSqrt(abs(a))", |a, _, _, r| {
        (a != 0.0).then(|| 2.0 * ulp(r))
    }),
    ("degrees(a)", |_, _, _, r| Some(2.0 * ulp(r))),
    ("radians(a)", |_, _, _, r| Some(2.0 * ulp(r))),
    ("fma(a, b, c)", |a, b, _, r| Some(ulp(a * b) + ulp(r))),
    ("mix(a, b, c)", |a, b, c, r| {
        Some(
            2.0 * ulp(a * (1.0 - c))
                + 2.0 * ulp(b * c)
                + 2.0 * ulp(b - a) * c.abs()
                + 2.0 * ulp(a)
                + ulp(r),
        )
    }),
    ("smoothstep(-1.0, 2.0, a)", |_, _, _, _| Some(1e-6)),
    ("exp(min(a, 60.0))", |a, _, _, r| {
        Some((3.0 + 2.0 * a.abs().min(60.0)) * ulp(r))
    }),
    ("exp2(min(a, 60.0))", |a, _, _, r| {
        Some((3.0 + 2.0 * a.abs().min(60.0)) * ulp(r))
    }),
    ("log(abs(a))", |a, _, _, r| {
        (a != 0.0).then(|| {
            if (0.5..=2.0).contains(&a.abs()) {
                1.0 / 2_097_152.0
            } else {
                3.0 * ulp(r)
            }
        })
    }),
    ("log2(abs(a))", |a, _, _, r| {
        (a != 0.0).then(|| {
            if (0.5..=2.0).contains(&a.abs()) {
                1.0 / 2_097_152.0
            } else {
                3.0 * ulp(r)
            }
        })
    }),
    ("pow(abs(a), clamp(b, -4.0, 4.0))", |a, b, _, r| {
        let (log, b) = (a.abs().log2(), b.clamp(-4.0, 4.0));
        let log_error = if (0.5..=2.0).contains(&a.abs()) {
            1.0 / 2_097_152.0
        } else {
            3.0 * ulp(log)
        };
        (a != 0.0).then(|| {
            (3.0 + 2.0 * (b * log).abs() + 1.0) * ulp(r)
                + r.abs() * (b.abs() * log_error + ulp(b * log))
        })
    }),
    ("sin(a)", |a, _, _, _| {
        (a.abs() < std::f64::consts::PI).then_some(1.0 / 2048.0)
    }),
    ("cos(a)", |a, _, _, _| {
        (a.abs() < std::f64::consts::PI).then_some(1.0 / 2048.0)
    }),
    ("tan(a)", |a, _, _, r| {
        (a.abs() < 1.1).then(|| (1.0 + r.abs()) / 2048.0 / a.cos().abs() + 2.5 * ulp(r))
    }),
    ("asin(clamp(a, -1.0, 1.0))", |_, _, _, r| {
        Some((4096.0 * ulp(r)).max(6.81e-5))
    }),
    ("acos(clamp(a, -1.0, 1.0))", |_, _, _, r| {
        Some((4096.0 * ulp(r)).max(6.81e-5))
    }),
    ("atan(a)", |_, _, _, r| Some(4096.0 * ulp(r))),
    ("atan2(a, b)", |a, b, _, r| {
        (a != 0.0 && b != 0.0).then(|| 4096.0 * ulp(r))
    }),
    ("sinh(clamp(a, -9.0, 9.0))", |a, _, _, _| {
        Some((4.0 + 2.0 * a.abs().min(9.0)) * ulp(a.abs().min(9.0).exp()))
    }),
    ("cosh(clamp(a, -9.0, 9.0))", |a, _, _, _| {
        Some((4.0 + 2.0 * a.abs().min(9.0)) * ulp(a.abs().min(9.0).exp()))
    }),
    ("tanh(clamp(a, -9.0, 9.0))", |_, _, _, _| Some(1e-5)),
    ("asinh(a)", |a, _, _, r| {
        (a.abs() < 200.0).then(|| {
            1e-5 + if a < 0.0 {
                (2.0 * a.abs()).exp().min(1e9) * 1e-7
            } else {
                4.0 * ulp(r)
            }
        })
    }),
    ("acosh(1.0 + abs(a))", |_, _, _, r| {
        Some(2e-3 + 4.0 * ulp(r))
    }),
    ("atanh(clamp(a, -0.9, 0.9))", |_, _, _, _| Some(1e-5)),
    ("length(vec3f(a, b, c))", |_, _, _, r| Some(8.0 * ulp(r))),
    ("distance(vec2f(a, b), vec2f(b, c))", |a, b, c, r| {
        Some(8.0 * ulp(r) + ulp(a) + ulp(b) + ulp(c))
    }),
    ("dot(vec3f(a, b, c), vec3f(b, c, a))", |a, b, c, r| {
        Some(2.0 * (ulp(a * b) + ulp(b * c) + ulp(a * c)) + ulp(r))
    }),
    (
        "cross(vec3f(a, b, c), vec3f(1.0, b, 0.5)).y",
        |a, _, c, r| Some(2.0 * (ulp(a) + ulp(c)) + ulp(r)),
    ),
    ("normalize(vec3f(a, b, 1.0)).x", |_, _, _, r| {
        Some(12.0 * ulp(r))
    }),
    ("reflect(vec2f(a, b), vec2f(0.6, 0.8)).x", |a, b, _, r| {
        Some(8.0 * (ulp(a) + ulp(b)) + ulp(r))
    }),
    (
        "faceForward(vec2f(a, b), vec2f(b, c), vec2f(1.0, 0.0)).y",
        |_, _, _, _| Some(0.0),
    ),
    (
        "refract(normalize(vec2f(a, -1.0)), vec2f(0.0, 1.0), 0.9).x",
        |_, _, _, _| Some(1e-5),
    ),
    ("determinant(mat2x2f(a, b, c, 1.5))", |a, b, c, r| {
        Some(2.0 * (ulp(1.5 * a) + ulp(b * c)) + ulp(r))
    }),
    ("(mat2x2f(a, b, c, 1.5) * vec2f(b, a)).y", |a, b, _, r| {
        Some(2.0 * (ulp(b * b) + ulp(1.5 * a)) + ulp(r))
    }),
    // Values below the normal range of f16 may be flushed.
    ("quantizeToF16(clamp(a, -1000.0, 1000.0))", |_, _, _, r| {
        Some((8192.0 * ulp(r)).max(1.0 / 16384.0))
    }),
    (
        "unpack2x16unorm(pack2x16unorm(vec2f(a, b))).x",
        |_, _, _, _| Some(1.0 / 65535.0),
    ),
    (
        "unpack2x16snorm(pack2x16snorm(vec2f(a, b))).y",
        |_, _, _, _| Some(1.0 / 32767.0),
    ),
    (
        "unpack4x8snorm(pack4x8snorm(vec4f(a, b, c, 0.0))).x",
        |_, _, _, _| Some(1.0 / 127.0),
    ),
];

#[test]
fn floats_are_within_the_accuracy_of_wgsl() {
    let words = FLOATS.map(f32::to_bits);
    let expressions: Vec<&str> = EXACT
        .iter()
        .copied()
        .chain(WITHIN.iter().map(|(expression, _)| *expression))
        .collect();
    compare(
        "f32",
        &expressions,
        &words,
        |index, input, evaluated, found| {
            let [a, b, c] = input.map(|word| f64::from(f32::from_bits(word)));
            let (evaluated, found) = (f32::from_bits(evaluated), f32::from_bits(found));
            // Zeros have no promised sign, and results below the normal range may be flushed.
            let is_equal = evaluated == found
                || evaluated.abs() < f32::MIN_POSITIVE && found.abs() < f32::MIN_POSITIVE;
            let Some((_, bound)) = index.checked_sub(EXACT.len()).map(|at| WITHIN[at]) else {
                return is_equal;
            };
            let Some(bound) = bound(a, b, c, evaluated.into()) else {
                return true;
            };
            is_equal
                || !evaluated.is_finite()
                || (f64::from(evaluated) - f64::from(found)).abs() <= bound
        },
    );
}
