//! Promise: what changes between two pictures leaves nothing stale behind, and who does not cull has
//! nothing of it. Needs an adapter.

use super::*;

#[test]
fn only_an_option_that_culls_has_passes_and_buffers_for_it() {
    const PASSES: [&str; 6] = [
        "cull",
        "cull early",
        "cull late",
        "project_meshlets",
        "depth_reduce",
        "advance_queues",
    ];
    const BUFFERS: [&str; 6] = [
        "culling",
        "instances",
        "meshlets",
        "meshlet_lists",
        "meshlet_visibility",
        "hiz",
    ];
    let split = PinnedOptions::of(Visibility::Split32);
    let of = |names: &[String], known: &[&str]| -> Vec<String> {
        names
            .iter()
            .filter(|name| known.contains(&name.as_str()))
            .cloned()
            .collect()
    };
    for (option, passes, buffers) in [
        (Culling::None, &[][..], &[][..]),
        (
            Culling::Frustum,
            &["cull", "project_meshlets"],
            &["culling", "instances", "meshlet_lists", "meshlets"],
        ),
        (
            Culling::Hiz,
            &["cull", "project_meshlets", "depth_reduce"],
            &["culling", "hiz", "instances", "meshlet_lists", "meshlets"],
        ),
        (
            Culling::TwoPass,
            &[
                "cull early",
                "project_meshlets",
                "depth_reduce",
                "advance_queues",
                "cull late",
                "project_meshlets",
                "advance_queues",
            ],
            &[
                "culling",
                "hiz",
                "instances",
                "meshlet_lists",
                "meshlet_visibility",
                "meshlets",
            ],
        ),
    ] {
        let Some((all_passes, all_buffers, _)) = explained(
            "field?count=8&triangles=200",
            &["lambert"],
            split.with(option),
        ) else {
            return;
        };
        assert_eq!(of(&all_passes, &PASSES), passes, "{}", option.name());
        assert_eq!(of(&all_buffers, &BUFFERS), buffers, "{}", option.name());
        assert_eq!(
            all_passes.contains(&"project".to_owned()),
            option == Culling::None,
            "{}: {all_passes:?}",
            option.name()
        );
    }
}

fn a_picture_that_cannot_be_culled_says_why_and_is_drawn(reach: Reach) {
    let query = "field?count=8&triangles=200";
    let refusals = [
        (
            &["explode"][..],
            Visibility::Split32,
            "none instead of two-pass: effects move meshes",
        ),
        (
            &["points"],
            Visibility::Split32,
            "none instead of two-pass: discs reach",
        ),
        (
            &["draw_order"],
            Visibility::Split32,
            "none instead of two-pass: a draw order counts",
        ),
        (
            &["race"],
            Visibility::Split32,
            "none instead of two-pass: a race",
        ),
        (
            &["xray"],
            Visibility::Split32,
            "frustum instead of two-pass: layers",
        ),
        (
            &["overdraw"],
            Visibility::Split32,
            "frustum instead of two-pass: layers",
        ),
        (
            &[],
            Visibility::Packed32,
            "frustum instead of two-pass: packed32",
        ),
        (&["dissolve"], Visibility::Split32, "two-pass: pinned"),
    ];
    for (effects, visibility, got) in reach.of(3, refusals) {
        let Some((.., why)) = explained(
            query,
            effects,
            PinnedOptions::of(visibility).with(Culling::TwoPass),
        ) else {
            return;
        };
        assert!(why.starts_with(got), "{effects:?}: {why}");
    }
    let Some((.., why)) = explained(
        query,
        &[],
        PinnedOptions::of(PositionFormat::Packed16).with(Culling::TwoPass),
    ) else {
        return;
    };
    assert!(
        why.starts_with("none instead of two-pass: packed positions"),
        "{why}"
    );
    let Some((.., why)) = explained(query, &[], PinnedOptions::default()) else {
        return;
    };
    assert!(
        why.starts_with("none: "),
        "culling gains nothing as a rule: {why}"
    );
}

fn effects_and_layers_keep_their_picture(reach: Reach) {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("field?count=27&triangles=400");
    let views = walk(&scene, &mut Rng(9), 4, SIZE);
    renderer.set_scene(&scene).block_on().expect("it fits");
    for effects in reach.of(
        2,
        [
            &["dissolve", "outline"][..],
            &["overdraw"],
            &["stipple", "lambert"],
            &["wireframe"],
            &["xray"],
            &["boxes"],
            &["facet", "fog"],
        ],
    ) {
        for view in &views {
            for visibility in reach.options(&renderer) {
                let mut draw = |option| {
                    let pins = PinnedOptions::of(visibility).with(option);
                    renderer
                        .capture_next(view, &stack(effects), &request(pins))
                        .block_on()
                        .unwrap_or_else(|error| panic!("{effects:?}: {error}"))
                };
                let culled = draw(Culling::TwoPass);
                let whole = draw(Culling::None);
                assert_same(
                    &culled.frame,
                    &whole.frame,
                    &format!("{effects:?} on {}", visibility.name()),
                );
                assert_eq!(
                    culled.frame.layer_sums,
                    whole.frame.layer_sums,
                    "{effects:?} on {}: layers",
                    visibility.name()
                );
            }
        }
    }
}

#[test]
fn the_picture_before_hides_what_has_come_out_since() {
    let Some(mut renderer) = loan() else { return };
    let scene = scene("field?count=216&triangles=400");
    renderer.set_scene(&scene).block_on().expect("it fits");
    let pins = PinnedOptions::of(Culling::Hiz).with(Visibility::Split32);
    let view = walk(&scene, &mut Rng(1), 1, SIZE).remove(0);
    let reference = whole(&renderer, &scene, &view, pins);
    // Nothing has moved since: nothing is missing.
    renderer.clear_history();
    let (first, all) = drawn(&mut renderer, &view, pins);
    let (second, fewer) = drawn(&mut renderer, &view, pins);
    assert_eq!(
        (&first.frame.triangle_id, &second.frame.triangle_id),
        (&reference.triangle_id, &reference.triangle_id)
    );
    assert!(
        all.hidden == 0 && fewer.hidden > 0 && fewer.drawn < all.drawn,
        "{all:?} {fewer:?}"
    );
    // Going sideways, something is.
    let mut lost = 0;
    for view in walk(&scene, &mut Rng(1), 12, SIZE) {
        let (cheap, _) = drawn(&mut renderer, &view, pins);
        lost += compare::triangle_ids(
            &cheap.frame.triangle_id,
            &whole(&renderer, &scene, &view, pins).triangle_id,
        )
        .different;
    }
    assert!(lost > 0, "the cheap option is as good as two passes");
}

few_and_all!(
    a_picture_that_cannot_be_culled_says_why_and_is_drawn,
    effects_and_layers_keep_their_picture,
);
