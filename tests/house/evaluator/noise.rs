//! Noise of `lib/noise`: its hash is that of its inventors, its values keep to their ranges, and
//! nothing shows where its cells meet.

use rasterlab::{
    evaluator::{Program, Word},
    math::hash,
    shader::library::Library,
};

use super::common::{call, floats, program, single, to_floats};

/// Functions of a place and a seed, with the range of every number that they give.
const NOISES: [(&str, &[[f64; 2]]); 4] = [
    ("noise_value", &[[0.0, 1.0]]),
    ("noise_gradient", &[[-1.0, 1.0]]),
    ("noise_simplex", &[[-1.0, 1.0]]),
    ("noise_cellular", &[[0.0, 1.0], [0.0, 1.0], [0.0, 1.0]]),
];

fn text() -> String {
    let text = Library::Embedded.text("lib/noise").expect("it is there");
    text.into_owned()
}

fn at(program: &Program, place: [f64; 3], seed: u32) -> Vec<f64> {
    let mut arguments = floats(&place);
    arguments.push(Word::from_u32(seed));
    to_floats(&call(program, &arguments))
}

/// A number of 0 to 1 that `index` chooses.
fn unit(index: u32) -> f64 {
    f64::from(hash(index)) / 4_294_967_296.0
}

/// "pcg3d" as its paper has it.
fn pcg3d(mut v: [u32; 3]) -> [u32; 3] {
    v = v.map(|word| word.wrapping_mul(1_664_525).wrapping_add(1_013_904_223));
    let stir = |v: &mut [u32; 3]| {
        v[0] = v[0].wrapping_add(v[1].wrapping_mul(v[2]));
        v[1] = v[1].wrapping_add(v[2].wrapping_mul(v[0]));
        v[2] = v[2].wrapping_add(v[0].wrapping_mul(v[1]));
    };
    stir(&mut v);
    v = v.map(|word| word ^ (word >> 16));
    stir(&mut v);
    v
}

#[test]
fn hashes_are_those_of_pcg3d_and_value_noise_mixes_them() {
    let source = text();
    let [hashed, value] = ["noise_hash", "noise_value"].map(|name| program(&source, name));
    for turn in 0..200 {
        let cell = [0, 1, 2].map(|axis| (hash(turn * 3 + axis) >> 20) as i32 - 2048);
        let seed = hash(turn ^ 0x5eed);
        let corner = |step: [i32; 3]| {
            let added = seed.wrapping_mul(0x9e37_79b9);
            pcg3d([0, 1, 2].map(|axis| ((cell[axis] + step[axis]) as u32).wrapping_add(added)))
        };
        let mut arguments: Vec<Word> = cell.iter().map(|&c| Word::from_i32(c)).collect();
        arguments.push(Word::from_u32(seed));
        let found: Vec<u32> = call(&hashed, &arguments)
            .iter()
            .map(|w| w.to_u32())
            .collect();
        assert_eq!(found, corner([0; 3]), "{cell:?} {seed}");
        let part = [0, 1, 2].map(|axis| unit(turn * 7 + axis));
        let mut mean = 0.0;
        for index in 0..8 {
            let step = [index & 1, index >> 1 & 1, index >> 2];
            let weight: f64 = (0..3)
                .map(|axis| {
                    let t = part[axis];
                    let fade = t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
                    if step[axis] == 1 { fade } else { 1.0 - fade }
                })
                .product();
            mean += weight * f64::from(corner(step)[0] >> 8) / 16_777_216.0;
        }
        let place = [0, 1, 2].map(|axis| f64::from(cell[axis]) + part[axis]);
        let found = at(&value, place, seed)[0];
        assert!(
            (found - mean).abs() < 1e-9,
            "{found} for {mean} at {place:?}"
        );
    }
}

#[test]
fn values_keep_to_their_ranges_and_use_them() {
    let source = text();
    for (name, ranges) in NOISES {
        let program = program(&source, name);
        let mut ends = vec![[f64::INFINITY, f64::NEG_INFINITY]; ranges.len()];
        for turn in 0..6000 {
            let place = [0, 1, 2].map(|axis| 200.0 * unit(turn * 3 + axis) - 100.0);
            for ((value, range), end) in at(&program, place, turn / 100)
                .iter()
                .zip(ranges)
                .zip(&mut ends)
            {
                assert!((range[0]..=range[1]).contains(value), "{name} {value}");
                *end = [end[0].min(*value), end[1].max(*value)];
            }
        }
        for (range, end) in ranges.iter().zip(ends) {
            let used = (end[1] - end[0]) / (range[1] - range[0]);
            assert!(used > 0.55, "{name} uses {end:?} of {range:?}");
        }
    }
}

/// Where cells meet: whole coordinates, and for simplex noise also where two parts of a skewed
/// place are equal, which a line along an axis crosses everywhere.
#[test]
fn nothing_shows_where_cells_meet() {
    const STEP: f64 = 1e-6;
    let source = text();
    for (name, ranges) in NOISES {
        let program = program(&source, name);
        let smooth = if name == "noise_cellular" {
            2
        } else {
            ranges.len()
        };
        for turn in 0..1500 {
            let axis = turn as usize % 3;
            let mut place = [0, 1, 2].map(|axis| 20.0 * unit(turn * 5 + axis) - 10.0);
            if turn % 2 == 0 {
                place[axis] = place[axis].round();
            } else {
                place[axis] = place[(axis + 1) % 3];
            }
            let beside = |by: f64| {
                let mut place = place;
                place[axis] += by;
                at(&program, place, 3)
            };
            let (before, after) = (beside(-STEP), beside(STEP));
            for i in 0..smooth {
                let jump = (after[i] - before[i]).abs();
                assert!(jump < 40.0 * STEP, "{name} jumps by {jump} at {place:?}");
            }
        }
    }
}

#[test]
fn single_precision_tells_the_same_to_a_thousandth_near_the_origin() {
    let source = text();
    for (name, ranges) in NOISES {
        let (double, single) = (program(&source, name), single(&source, name));
        for turn in 0..500 {
            let place =
                [0, 1, 2].map(|axis| f64::from((200.0 * unit(turn * 3 + axis) - 100.0) as f32));
            let (a, b) = (at(&double, place, turn), at(&single, place, turn));
            for i in 0..ranges.len().min(2) {
                assert!(
                    (a[i] - b[i]).abs() < 1e-3,
                    "{name} {a:?} {b:?} at {place:?}"
                );
            }
        }
    }
}
