//! Promise: the error of the f32 side of an effect, and where an effect stops making colors, are
//! found where they are.

use std::sync::{Arc, atomic::AtomicBool};

use rasterlab::{
    effect_files::{
        ErrorPlace, Quantity, Unsound, crossings, has_f32_error, overreaching, precision, read,
    },
    effects::{EFFECTS, Effect, Stack},
    oracle, preset_file,
    scene::{Scene, view::View},
};

fn effect(body: &str) -> Arc<Effect> {
    let text = format!(
        "// A test.\n//@ use lib/surface\nstruct Probed {{\n    /// A.\n    @range(0, 4, 1) a: f32,\n    /// B.\n    @range(0, 4, 1) b: f32,\n}}\n\
         fn probed(surface: Surface, p: Probed) -> Surface {{\n    var s = surface;\n    {body}\n    return s;\n}}\n"
    );
    read("probed.wgsl", "probed", &text).unwrap_or_else(|error| panic!("{error}"))
}

/// A picture of the teapot with one effect, whose parameters have these values.
fn drawn(effect: &Arc<Effect>, values: impl IntoIterator<Item = f64>) -> (Scene, View, Stack) {
    let preset = preset_file::open("builtin:teapot", &preset_file::Folders::default())
        .expect("a preset")
        .preset;
    let scene = preset_file::load_scene(&preset, None).expect("a scene");
    let view = preset.view(&scene, [48, 36]);
    let mut stack = Stack::default();
    let words = &mut stack.enable(effect).words;
    for (name, value) in ["a", "b"].into_iter().zip(values) {
        effect
            .field(name)
            .expect("a parameter")
            .set(words, &[value])
            .expect("a value");
    }
    (Arc::unwrap_or_clone(scene), view, stack)
}

#[test]
fn the_largest_error_is_where_f32_loses_digits() {
    // Only right of the middle is anything lost.
    let effect = effect(
        "s.color = vec4f(select(0.5, (p.a * 1.0e6 + 0.3) - p.a * 1.0e6, s.screen.x > 0.5), 0.0, 0.0, 1.0);",
    );
    let (scene, view, stack) = drawn(&effect, [1.0, 1.0]);
    let measure = |cancelled: bool| {
        let cancelled = Arc::new(AtomicBool::new(cancelled));
        precision(&stack, &cancelled, |stack| {
            drop(oracle::render(&scene, &view, stack))
        })
        .expect("it is evaluated")
    };
    let found = measure(false);
    let [(measured, errors)] = &found[..] else {
        panic!("{}", found.len())
    };
    assert_eq!(measured.name, "probed");
    let [largest] = &errors[..] else {
        panic!("{errors:?}")
    };
    // 0.3 becomes 0.3125.
    assert!(
        largest.quantity == Quantity::Color && (1.0..4.0).contains(&largest.error),
        "{largest:?}"
    );
    assert!(
        matches!(largest.place, ErrorPlace::Pixel([x, _]) if x > 24.0),
        "{largest:?}"
    );
    assert!(
        measure(true).is_empty(),
        "a cancelled measurement has a result"
    );
    assert_eq!(measure(false), found, "a second measurement differs");
}

#[test]
fn a_crossing_names_the_effect_the_kind_and_the_parameter() {
    let cases = [
        (
            "s.color.x = sqrt(1.0 - p.b);",
            [1.0, 2.0],
            Unsound::NotANumber,
            Some("b"),
            false,
        ),
        (
            "s.color.x = 1.0 / abs(p.a - 2.0);",
            [2.0, 1.5],
            Unsound::Infinite,
            Some("a"),
            false,
        ),
        (
            "s.color.x = -p.a;",
            [1.0, 1.0],
            Unsound::Negative,
            None,
            false,
        ),
        (
            "s.color.x = exp2(60.0 * p.a) * exp2(60.0 * p.b) * 1.0e-30;",
            [1.0, 3.0],
            Unsound::Infinite,
            Some("b"),
            true,
        ),
    ];
    for (body, values, made, parameter, only_f32) in cases {
        let (scene, view, stack) = drawn(&effect(body), values);
        let (frame, found) = crossings(&stack, |stack| oracle::render(&scene, &view, stack))
            .expect("it is evaluated");
        let frame = frame.expect("a picture");
        assert_eq!(found.len(), frame.covered(), "{body}");
        let first = &found[0];
        assert_eq!(
            (first.effect.name.as_str(), first.made, first.only_f32),
            ("probed", made, only_f32),
            "{body}"
        );
        assert_eq!(
            first.parameter.as_ref().map(|field| field.name.as_str()),
            parameter,
            "{body}"
        );
        assert!(
            found.is_sorted_by_key(|crossing| [crossing.pixel[1], crossing.pixel[0]]),
            "{body}"
        );
    }
    let (scene, view, stack) = drawn(&effect("s.color = vec4f(p.a, p.b, 0.5, 1.0);"), [0.5, 0.5]);
    assert!(
        crossings(&stack, |stack| drop(oracle::render(&scene, &view, stack)))
            .expect("it is evaluated")
            .1
            .is_empty()
    );
}

#[test]
fn a_pass_that_writes_what_is_not_finite_is_named_with_its_pixel() {
    let text = "struct Probed { @range(0, 4, 1) a: f32, @range(0, 4, 1) b: f32 }
fn probed(at: ImageAt, p: Probed) -> vec4f {
    let bad = at.x == 20 && at.y == 9;
    return vec4f(select(-1.0, 1.0 / (p.a - 2.0), bad), 0.0, 0.0, 1.0);
}";
    let effect = read("probed.wgsl", "probed", text).unwrap_or_else(|error| panic!("{error}"));
    let (scene, view, stack) = drawn(&effect, [2.0, 2.0]);
    let (frame, found) =
        crossings(&stack, |stack| oracle::render(&scene, &view, stack)).expect("it is evaluated");
    frame.expect("a picture");
    let [crossing] = &found[..] else {
        panic!("{} pixels", found.len())
    };
    let parameter = crossing.parameter.as_ref().map(|field| field.name.as_str());
    assert_eq!(
        (crossing.pixel, crossing.made, parameter),
        ([20, 9], Unsound::Infinite, Some("a"))
    );
}

#[test]
fn built_in_effects_are_measured_and_make_colors_of_colors() {
    let mut measured = 0;
    for effect in EFFECTS.iter().filter(|effect| has_f32_error(effect)) {
        let (scene, view, stack) = drawn(effect, []);
        let render = |stack: &Stack| drop(oracle::render(&scene, &view, stack));
        let found = precision(&stack, &Arc::default(), render)
            .unwrap_or_else(|error| panic!("{}: {error}", effect.name));
        for (_, errors) in &found {
            let is_finite = errors.iter().all(|error| error.error.is_finite());
            assert!(is_finite, "{}: {errors:?}", effect.name);
        }
        measured += found.len();
        let (_, crossed) = crossings(&stack, render).expect("it is evaluated");
        assert!(crossed.is_empty(), "{}: {:?}", effect.name, crossed[0]);
    }
    assert!(measured > 30, "{measured}");
}

#[test]
fn a_vertex_effect_that_goes_beyond_its_meters_is_told() {
    let text = |factor: f64| {
        format!(
            "// A test.\nstruct Far {{\n    /// A.\n    @range(0, 4, 1) @unit(m) a: f32,\n}}\n\
             fn far(vertex: Vertex, p: Far) -> Vertex {{\n    var v = vertex;\n    v.offset += v.normal * ({factor:?} * p.a);\n    return v;\n}}\n"
        )
    };
    for (factor, told) in [(1.0, None), (3.0, Some(3.0))] {
        let effect = read("far.wgsl", "far", &text(factor)).expect("it is valid");
        let (scene, view, stack) = drawn(&effect, [0.25]);
        let render = |stack: &Stack| drop(oracle::render(&scene, &view, stack));
        let (_, found) = overreaching(&stack, render);
        assert_eq!(
            found.first().map(|(_, factor)| factor.round()),
            told,
            "{found:?}"
        );
        let measured = precision(&stack, &Arc::default(), render).expect("it is evaluated");
        let reach = measured[0]
            .1
            .iter()
            .find(|error| error.quantity == Quantity::Reach);
        assert_eq!(reach.map(|error| error.error.round()), told);
    }
}
