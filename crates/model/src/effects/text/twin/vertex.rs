//! Vertex hooks whose text is evaluated, with bounds of what f32 makes of it.

use super::*;

/// A corner with its members moved by up to `bound` times `strength`, by a hash of `turn`.
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
    // The text is evaluated at inputs at the ends of their bounds and in f32. Twice the largest
    // difference is the bound.
    let error_bound = move |v: &Vertex, bound: ErrorBound, words: &[u32]| {
        let given: [Vertex; 14] = std::array::from_fn(|turn| match turn {
            0 => *v,
            1..7 => moved_within(v, &bound, turn as u32 - 1),
            7 => rounded(v),
            _ => rounded(&moved_within(v, &bound, turn as u32 - 8)),
        });
        let mut all = given;
        move_all(&double, &mut all[..7], words);
        move_all(&single, &mut all[7..], words);
        // What moves nothing adds nothing.
        let is_still = |given: &Vertex, moved: &Vertex| {
            given.offset == moved.offset && given.normal == moved.normal
        };
        if given
            .iter()
            .zip(&all)
            .all(|(given, moved)| is_still(given, moved))
        {
            return bound;
        }
        let [exact, others @ ..] = all;
        let apart = others.map(|other| other.offset - exact.offset);
        let normal = others
            .map(|other| (other.normal - exact.normal).abs().max_element())
            .into_iter()
            .fold(0.0, f64::max);
        let scale = v.position.abs().max_element() + exact.offset.abs().max_element();
        let (offset_m, along_m) = spread(&apart);
        ErrorBound {
            offset_m: 2.0 * offset_m + 16.0 * ROUNDING * scale,
            along_m: 2.0 * along_m,
            normal: 2.0 * normal + 16.0 * ROUNDING,
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

/// How far these lie from the origin, and the part of that in one direction where nearly all of it
/// is; no direction otherwise.
fn spread(places: &[DVec3]) -> (f64, DVec3) {
    let most = |of: &dyn Fn(&DVec3) -> f64| places.iter().map(of).fold(0.0, f64::max);
    let longest = most(&|place| place.length());
    let far = places.iter().find(|place| place.length() == longest);
    let direction = far.map_or(DVec3::ZERO, |far| far.normalize_or_zero());
    let aside = most(&|place| place.reject_from_normalized(direction).length());
    match 16.0 * aside < longest {
        true => (longest + aside, direction * longest),
        false => (most(&|place| place.abs().max_element()), DVec3::ZERO),
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
