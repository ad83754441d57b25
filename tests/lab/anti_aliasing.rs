//! Promise: anti-aliasing is chosen in the top bar, draws the oracle's averaged picture, and is
//! saved only where it was chosen.

use rasterlab::{accuracy::RenderScale, oracle, preset_file};

use crate::harness::*;

fn pinned(lab: &Lab) -> Option<RenderScale> {
    lab.state().preset_file().preset.accuracy.pins.option()
}

/// Pixels of the window that are not the oracle's with `factor` samples along a side of each.
fn wrong_pixels(lab: &mut Lab, factor: f64) -> usize {
    lab.remove_cursor();
    lab.run_steps(2);
    let shown = picture(lab);
    let preset = lab.state().preset_file().preset.clone();
    let scene = preset_file::load_scene(&preset, None).expect("a built-in scene");
    let view = lab
        .state()
        .view([shown.width(), shown.height()])
        .expect("a scene is shown");
    let expected = oracle::render_scaled(&scene, &[(view, preset.evaluated_stack())], factor)
        .expect("a picture");
    // The buttons lie over the top of it, and what was just done is said below.
    let pairs = shown
        .pixels()
        .zip(&expected.color)
        .skip((shown.width() * 48) as usize);
    let pairs = pairs.take((shown.width() * (shown.height() - 208)) as usize);
    pairs
        .filter(|(a, b)| a.0.iter().zip(*b).any(|(a, b)| a.abs_diff(*b) > 2))
        .count()
}

#[test]
fn two_by_two_samples_are_the_oracles_averages_and_one_step() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let before = (pinned(&lab), lab.state().undo_steps());
    assert_eq!(before, (None, 0));
    let drawn = lab.state().drawn_scale();
    let automatic = if lab.state().gpu().caps.software {
        RenderScale::Full
    } else {
        RenderScale::Double
    };
    assert_eq!(
        drawn,
        Some(automatic),
        "a CPU adapter draws a sample for each pixel, a card four"
    );

    choose(&mut lab, "Anti-aliasing", "off");
    assert_eq!(
        (pinned(&lab), lab.state().drawn_scale()),
        (Some(RenderScale::Full), Some(RenderScale::Full))
    );
    let jagged = wrong_pixels(&mut lab, 2.0);
    choose(&mut lab, "Anti-aliasing", "2×2");
    assert_eq!(
        (pinned(&lab), lab.state().drawn_scale()),
        (Some(RenderScale::Double), Some(RenderScale::Double))
    );
    let smooth = wrong_pixels(&mut lab, 2.0);
    // A vertex may snap one unit apart, which moves a few edge pixels.
    assert!(
        smooth <= 100 && jagged > 4 * smooth.max(100),
        "{smooth} pixels are not the averages with, {jagged} without"
    );
    assert_eq!(lab.state().undo_steps(), 2);

    undo(&mut lab);
    assert_eq!(pinned(&lab), Some(RenderScale::Full));
    choose(&mut lab, "Anti-aliasing", "4×4");
    assert_eq!(pinned(&lab), Some(RenderScale::Quadruple));
    choose(
        &mut lab,
        "Anti-aliasing",
        &format!(
            "Automatic ({})",
            if automatic == RenderScale::Full {
                "off on this adapter"
            } else {
                "2×2"
            }
        ),
    );
    assert_eq!(
        (pinned(&lab), lab.state().drawn_scale()),
        (None, Some(automatic)),
        "the preset says nothing about it again"
    );
}
