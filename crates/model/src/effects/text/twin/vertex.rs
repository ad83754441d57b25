//! Vertex hooks whose text is evaluated, with bounds of what f32 makes of it.

use super::*;

/// Corners at which all inputs are moved at once.
const TOGETHER: usize = 6;

/// A corner with its members moved by up to `bound`, by a hash of `turn`.
fn moved_within(v: &Vertex, bound: &ErrorBound, turn: u32) -> Vertex {
    let away = |values: DVec3, index: u32, by: f64| {
        let sign = |component: u32| {
            if hash(turn * 64 + index * 4 + component) & 1 == 0 {
                by
            } else {
                -by
            }
        };
        values + DVec3::new(sign(0), sign(1), sign(2))
    };
    let screen = away(v.center_screen.extend(0.0), 6, bound.center_screen);
    Vertex {
        position: away(v.position, 0, bound.position_m),
        offset: away(v.offset, 1, bound.offset_m),
        normal: away(v.normal, 2, bound.normal),
        flat_normal: away(v.flat_normal, 3, bound.flat_normal),
        center: away(v.center, 4, bound.center_m),
        arm: away(v.arm, 5, bound.arm_m),
        center_screen: screen.truncate(),
        triangle: v.triangle,
        cell_px: v.cell_px,
    }
}

/// Corners with one number moved to either end of its bound, for each that has one: in pairs.
fn moved_alone(v: &Vertex, bound: &ErrorBound) -> Vec<Vertex> {
    let bounds = [
        bound.position_m,
        bound.offset_m,
        bound.normal,
        bound.flat_normal,
        bound.center_m,
        bound.arm_m,
        bound.center_screen,
    ];
    let mut all = Vec::new();
    for (member, by) in bounds.into_iter().enumerate().filter(|(_, by)| *by > 0.0) {
        for step in DVec3::AXES
            .into_iter()
            .flat_map(|axis| [axis * by, -axis * by])
        {
            let mut moved = *v;
            match member {
                0 => moved.position += step,
                1 => moved.offset += step,
                2 => moved.normal += step,
                3 => moved.flat_normal += step,
                4 => moved.center += step,
                5 => moved.arm += step,
                _ => moved.center_screen += step.truncate(),
            }
            all.push(moved);
        }
    }
    all
}

/// A corner whose members are f32 values.
fn rounded(v: &Vertex) -> Vertex {
    Vertex {
        position: v.position.as_vec3().as_dvec3(),
        offset: v.offset.as_vec3().as_dvec3(),
        normal: v.normal.as_vec3().as_dvec3(),
        flat_normal: v.flat_normal.as_vec3().as_dvec3(),
        center: v.center.as_vec3().as_dvec3(),
        arm: v.arm.as_vec3().as_dvec3(),
        center_screen: v.center_screen.as_vec2().as_dvec2(),
        triangle: v.triangle,
        cell_px: v.cell_px,
    }
}

/// The vertex hook: `double` in f64, `single` with every operation rounded to f32.
/// `reach` says how far it moves a vertex, else the sum of the lengths does.
pub fn vertex(
    double: Function,
    single: Function,
    needs_triangle: bool,
    reach: Option<(Function, bool)>,
) -> VertexHook {
    let (moved, fields) = (moving(double.clone()), double.members.clone());
    let limit = move |radius_m: f64, words: &[u32]| match &reach {
        Some((function, takes_radius)) => function.reach_m(*takes_radius, radius_m, words),
        None => lengths(&fields)
            .map(|field| field.get(words)[0].abs())
            .sum(),
    };
    // The text is evaluated at inputs at the ends of their bounds, each alone and several at once, and
    // in f32. The bound is what all that are alone add up to, and twice what f32 makes of it; at least
    // twice the largest difference.
    let error_bound = move |v: &Vertex, bound: ErrorBound, words: &[u32]| {
        let together: [Vertex; TOGETHER] =
            std::array::from_fn(|turn| moved_within(v, &bound, turn as u32));
        let mut given = vec![*v];
        given.extend(together);
        let mut singles: Vec<Vertex> = given.iter().map(rounded).collect();
        given.extend(moved_alone(v, &bound));
        let mut all = given.clone();
        move_all(&double, &mut all, words);
        let rounded = singles.clone();
        move_all(&single, &mut singles, words);
        // What moves nothing adds nothing.
        let is_still = |(given, moved): (&Vertex, &Vertex)| {
            given.offset == moved.offset && given.normal == moved.normal
        };
        let (mut still, mut still_in_f32) = (given.iter().zip(&all), rounded.iter().zip(&singles));
        if still.all(is_still) && still_in_f32.all(is_still) {
            return bound;
        }
        let exact = all[0];
        let apart = |other: &Vertex| other.offset - exact.offset;
        let normal_apart = |other: &Vertex| (other.normal - exact.normal).abs();
        let largest = |apart: f64, other: &Vertex| apart.max(normal_apart(other).max_element());
        let (mut others, mut normal) = (Vec::new(), 0.0);
        for other in all[1..=TOGETHER].iter().chain(&singles) {
            others.push(2.0 * apart(other));
            normal = largest(normal, other);
        }
        // Inputs that err at once: their differences add up. A pair is of one input.
        let (mut inputs, mut input_normals) = (Vec::new(), DVec3::ZERO);
        for ends in all[1 + TOGETHER..].chunks(2) {
            let far = |a: DVec3, b: DVec3| if a.length() < b.length() { b } else { a };
            inputs.push(ends.iter().map(apart).fold(DVec3::ZERO, far));
            input_normals += ends.iter().map(normal_apart).fold(DVec3::ZERO, DVec3::max);
        }
        let of_f32 = |(exact, single): (&Vertex, &Vertex)| {
            let normal = (single.normal - exact.normal).abs().max_element();
            (single.offset - exact.offset, normal)
        };
        let f32s = all.iter().zip(&singles).map(of_f32);
        let (f32_apart, f32_normal) =
            f32s.fold((DVec3::ZERO, 0.0), |(far, most), (apart, normal)| {
                (
                    if far.length() < apart.length() {
                        apart
                    } else {
                        far
                    },
                    f64::max(most, normal),
                )
            });
        inputs.push(2.0 * f32_apart);
        let scale = v.position.abs().max_element() + exact.offset.abs().max_element();
        let (offset_m, along_m) = spread(&others, &inputs);
        ErrorBound {
            offset_m: offset_m + 16.0 * ROUNDING * scale,
            along_m,
            normal: (2.0 * normal).max(input_normals.max_element() + 2.0 * f32_normal)
                + 16.0 * ROUNDING,
            ..bound
        }
    };
    VertexHook {
        needs_triangle,
        moved,
        error_bound: Arc::new(error_bound),
        max_displacement_m: Arc::new(limit),
        unheld: None,
    }
}

/// What `function` does to vertices.
pub fn moving(function: Function) -> Arc<VertexFunction> {
    Arc::new(move |vertices: &mut [Vertex], words: &[u32]| move_all(&function, vertices, words))
}

/// How far from the origin any of `places` lies, and what the `steps` add up to, each forwards or
/// backwards: the larger one, and the part of that in one direction where nearly all of it is; no
/// direction otherwise.
fn spread(places: &[DVec3], steps: &[DVec3]) -> (f64, DVec3) {
    let most = |of: &dyn Fn(DVec3) -> f64| {
        let place = places.iter().map(|place| of(*place)).fold(0.0, f64::max);
        let steps: f64 = steps.iter().map(|step| of(*step)).sum();
        f64::max(place, steps)
    };
    let all = || places.iter().chain(steps);
    let longest = all().map(|place| place.length()).fold(0.0, f64::max);
    let far = all().find(|place| place.length() == longest);
    let direction = far.map_or(DVec3::ZERO, |far| far.normalize_or_zero());
    let along = most(&|place| place.dot(direction).abs());
    let aside = most(&|place| place.reject_from_normalized(direction).length());
    match 16.0 * aside < along {
        true => (along + aside, direction * along),
        false => {
            let axis = |axis: usize| most(&|place| place[axis].abs());
            (axis(0).max(axis(1)).max(axis(2)), DVec3::ZERO)
        }
    }
}

fn move_all(function: &Function, vertices: &mut [Vertex], words: &[u32]) {
    for together in vertices.chunks_mut(LANES) {
        function.run(
            together,
            words,
            &mut NoHost,
            |inputs| {
                inputs
                    .floats(|v| v.position.to_array())
                    .floats(|v| v.offset.to_array())
                    .floats(|v| v.normal.to_array())
                    .floats(|v| v.flat_normal.to_array())
                    .floats(|v| v.center.to_array())
                    .floats(|v| v.arm.to_array())
                    .floats(|v| v.center_screen.to_array())
                    .whole(|v| [v.triangle, v.cell_px]);
            },
            |outputs| {
                // What lies between is only read.
                outputs
                    .skip(3)
                    .floats(|v| v.offset.as_mut())
                    .floats(|v| v.normal.as_mut())
                    .skip(12)
                    .whole(|v| &mut v.cell_px);
            },
            |v| v.offset = DVec3::NAN,
        );
    }
}
