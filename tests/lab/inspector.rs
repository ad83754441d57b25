//! Promise: in the inspector every value has a control with a name, a drag is one undo step, and
//! effects and clips are switched on and off.

use egui::{self, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable as _;

use crate::harness::*;

#[test]
fn every_widget_of_every_folder_and_dialog_has_a_name() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    for folder in ["Camera", "Clock", "Kernel", "Preset"] {
        // Opened folders push the next one below the end of the panel.
        lab.get_by_label(folder).scroll_to_me();
        lab.run_steps(3);
        lab.get_by_label(folder).click();
        lab.run_steps(3);
    }
    lab.check_accessibility();
    for tab in ["Scene", "Presets"] {
        click(&mut lab, Role::Button, tab);
    }
    for row in [
        "Animate facet.front",
        "Animate lambert.sun",
        "Show the curve of facet.front",
        "Key facet.front 0.000 s",
    ] {
        click(&mut lab, Role::Button, row);
    }
    lab.get_by_label("Key facet.front 0.000 s")
        .click_secondary();
    lab.run_steps(3);
    settle(&mut lab);
    press(&mut lab, Modifiers::NONE, Key::Escape);
    for (modifiers, key) in [
        (Modifiers::NONE, Key::F1),
        (Modifiers::NONE, Key::L),
        (Modifiers::COMMAND, Key::O),
        (Modifiers::NONE, Key::F12),
    ] {
        press(&mut lab, modifiers, key);
        press(&mut lab, Modifiers::NONE, Key::Escape);
    }
}

#[test]
fn a_slider_drag_is_one_undo_step() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let before = value(&lab, "lambert", "headlight");
    let rail = slider(&lab, "lambert.headlight").rect();
    drag(
        &mut lab,
        rail.left_center() + vec2(14.0, 0.0),
        rail.right_center() - vec2(10.0, 0.0),
    );
    let after = value(&lab, "lambert", "headlight");
    assert!(after[0] > before[0] + 0.2, "{before:?} {after:?}");
    assert_eq!(lab.state().undo_steps(), 1);
    undo(&mut lab);
    assert_eq!(
        (
            value(&lab, "lambert", "headlight"),
            lab.state().undo_steps()
        ),
        (before, 0)
    );
    press(&mut lab, Modifiers::COMMAND | Modifiers::SHIFT, Key::Z);
    assert_eq!(value(&lab, "lambert", "headlight"), after);
}

#[test]
fn enabling_an_effect_shows_its_sliders_and_disabling_hides_them() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    assert!(!has_slider(&lab, "facet.amount"));
    add_effect(&mut lab, "facet");
    assert!(has_slider(&lab, "facet.amount"));
    assert!(
        !has_slider(&lab, "facet.radius_m"),
        "only the radial pattern has a radius"
    );
    assert_eq!(lab.state().undo_steps(), 1);
    click(&mut lab, Role::CheckBox, "facet");
    assert!(!has_slider(&lab, "facet.amount"));
}

#[test]
fn a_changed_value_has_a_reset_button_that_leads_to_its_default() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    assert!(lab.query_by_label("Reset lambert.headlight").is_none());
    let default = value(&lab, "lambert", "headlight");
    let rail = slider(&lab, "lambert.headlight").rect();
    drag(
        &mut lab,
        rail.left_center() + vec2(14.0, 0.0),
        rail.center(),
    );
    assert_ne!(value(&lab, "lambert", "headlight"), default);
    click(&mut lab, Role::Button, "Reset lambert.headlight");
    assert_eq!(value(&lab, "lambert", "headlight"), default);
    assert!(lab.query_by_label("Reset lambert.headlight").is_none());
}

#[test]
fn muting_changes_the_picture_and_not_the_preset() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let (preset, draws) = (
        lab.state().preset_file().preset.clone(),
        lab.state().draws(),
    );
    click(&mut lab, Role::Button, "Mute lambert");
    assert!(lab.state().draws() > draws);
    assert_eq!(lab.state().preset_file().preset, preset);
    assert_eq!(lab.state().undo_steps(), 0);
}

#[test]
fn typing_a_number_does_not_trigger_shortcuts() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let camera = lab.state().preset_file().preset.camera;
    let field = lab.get_by_label("lambert.headlight value");
    field.click();
    lab.run_steps(2);
    for text in ["0", ".", "7"] {
        lab.event(egui::Event::Text(text.into()));
        lab.key_press(if text == "7" { Key::Num7 } else { Key::Num0 });
        lab.step();
    }
    lab.key_press(Key::Enter);
    lab.run_steps(3);
    settle(&mut lab);
    assert_eq!(
        lab.state().preset_file().preset.camera,
        camera,
        "7 is the key of the top view"
    );
    assert_eq!(value(&lab, "lambert", "headlight"), [f64::from(0.7f32)]);
}

#[test]
fn randomize_stays_within_soft_ranges_and_is_one_undo_step() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let before = lab.state().preset_file().preset.clone();
    press(&mut lab, Modifiers::NONE, Key::R);
    let after = lab.state().preset_file().preset.clone();
    assert_ne!(before.stack, after.stack);
    assert!(lab.state().log_text().contains("seed 1"));
    for enabled in &after.stack.0 {
        for field in &enabled.effect.fields {
            let components = field.get(&enabled.words);
            assert!(
                components
                    .iter()
                    .all(|value| (field.soft[0]..=field.soft[1]).contains(value)),
                "{}.{}",
                enabled.effect.name,
                field.name
            );
        }
    }
    undo(&mut lab);
    assert_eq!(lab.state().preset_file().preset, before);
}

#[test]
fn a_second_effect_of_a_slot_takes_the_place_of_the_first_which_is_said() {
    let Some(mut lab) = lab("xray") else { return };
    let has = |lab: &Lab, name: &str| lab.state().preset_file().preset.stack.get(name).is_some();
    add_effect(&mut lab, "overdraw");
    assert!(!has(&lab, "xray") && has(&lab, "overdraw"));
    let sentence = "overdraw replaced xray: both take the same slot of the rasterizer";
    assert!(
        lab.state().log_text().contains(sentence),
        "{}",
        lab.state().log_text()
    );
    assert!(slider(&lab, "overdraw.max_layers").rect().width() > 0.0);
    undo(&mut lab);
    assert!(has(&lab, "xray") && !has(&lab, "overdraw"), "one step");
}

#[test]
fn an_effect_is_added_by_a_button_with_values_that_show_and_the_folders_are_within_reach() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    click(&mut lab, Role::Button, "Add effect");
    assert!(
        lab.query_by_role_and_label(Role::Button, "Effect hatch")
            .is_some()
            && lab
                .query_by_role_and_label(Role::Button, "Effect lambert")
                .is_none(),
        "what is in the stack is not offered"
    );
    click(&mut lab, Role::Button, "Effect dither");
    assert!(lab.query_by_label("Search effects to add").is_none());
    assert_eq!(
        value(&lab, "dither", "levels"),
        [4.0],
        "256 levels show nothing"
    );
    undo(&mut lab);
    for effect in ["facet", "toon", "hatch", "outline", "fog", "dissolve"] {
        add_effect(&mut lab, effect);
    }
    for (title, control) in [("Camera", "Frame scene"), ("Accuracy", "Tier draft")] {
        click(&mut lab, Role::Button, &format!("Go to {title}"));
        lab.run_steps(30);
        let at = lab.get_by_role_and_label(Role::Button, control).rect();
        assert!((60.0..720.0).contains(&at.center().y), "{title}: {at:?}");
    }
}

#[test]
fn clips_are_chosen_held_and_blended_in_their_folder() {
    let Some(mut lab) = lab("builtin:tentacle?tess=3") else {
        return;
    };
    let play = |lab: &Lab| lab.state().preset_file().preset.playback.clone();
    let choose = |lab: &mut Lab, menu: &str, entry: &str| {
        click(lab, Role::ComboBox, menu);
        lab.get_by_role_and_label(Role::Button, entry).click();
        lab.run_steps(4);
        settle(lab);
    };
    assert_eq!(play(&lab).clip, "");
    assert!(
        lab.query_by_label("Hold the clip").is_none(),
        "at rest there is nothing to hold"
    );
    choose(&mut lab, "scene.clip", "Twist");
    assert_eq!(play(&lab).clip, "Twist");
    assert!(lab.state().preset_file().preset.is_moving());
    choose(&mut lab, "scene.second_clip", "Sway");
    assert_eq!(play(&lab).second_clip, "Sway");
    assert!(has_slider(&lab, "scene.clip_blend"));
    click(&mut lab, Role::CheckBox, "Hold the clip");
    assert!(play(&lab).clip_time_s.is_some() && has_slider(&lab, "scene.pose_s"));
    undo(&mut lab);
    assert_eq!(
        (play(&lab).clip_time_s, play(&lab).second_clip.as_str()),
        (None, "Sway")
    );

    // The picture follows, and is what the oracle says.
    let before = lab.state().draws();
    lab.state_mut().preset_mut().playback.clip_time_s = Some(1.0);
    settle(&mut lab);
    assert!(lab.state().draws() > before);
}

#[test]
fn the_scene_shows_its_images_and_lets_one_look_through_its_cameras() {
    draw_pictures();
    let Some(mut lab) = lab("builtin:grid?cell=16") else {
        return;
    };
    let chosen = |lab: &Lab| lab.state().preset_file().preset.scene_camera.clone();
    let choose = |lab: &mut Lab, entry: &str| {
        click(lab, Role::ComboBox, "scene.camera");
        lab.get_by_role_and_label(Role::Button, entry).click();
        lab.run_steps(4);
        settle(lab);
    };
    let before = lab.state().draws();
    choose(&mut lab, "pixels in perspective");
    assert!(chosen(&lab) == "pixels in perspective" && lab.state().draws() > before);
    choose(&mut lab, "pixels");
    assert_eq!(chosen(&lab), "", "the first needs no name");
    undo(&mut lab);
    assert_eq!(chosen(&lab), "pixels in perspective");

    let Some(lab) = self::lab("builtin:panels") else {
        return;
    };
    assert!(lab.query_by_label_contains("3 images, ").is_some());
    assert!(
        lab.query_by_label("scene.camera").is_none(),
        "a scene without cameras has no menu of them"
    );
}

/// A triangle whose material has two variants.
const VARIANTS: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
    "extensions":{"KHR_materials_variants":{"variants":[{"name":"leaf"},{"name":"sea"}]}},
    "materials":[{"name":"red"},{"name":"green"},{"name":"blue"}],
    "meshes":[{"primitives":[{"attributes":{"POSITION":0},"material":0,"extensions":{"KHR_materials_variants":{"mappings":[
        {"material":1,"variants":[0]},{"material":2,"variants":[1]}]}}}]}],
    "accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":3,"min":[0,0,0],"max":[1,1,0]}],
    "bufferViews":[{"buffer":0,"byteLength":36}],
    "buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}]}"#;

#[test]
fn a_menu_shows_the_scene_in_another_variant_of_its_materials() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let model = folder.path().join("flag.gltf");
    std::fs::write(&model, VARIANTS).expect("a file");
    let Some(mut lab) = lab(&model.display().to_string()) else {
        return;
    };
    let shown = |lab: &Lab| lab.state().preset_file().preset.parts.variant.clone();
    for (entry, variant) in [("sea", "sea"), ("leaf", "leaf"), ("no variant", "")] {
        let before = lab.state().draws();
        click(&mut lab, Role::ComboBox, "scene.variant");
        lab.get_by_role_and_label(Role::Button, entry).click();
        lab.run_steps(4);
        settle(&mut lab);
        assert_eq!(shown(&lab), variant);
        assert!(lab.state().draws() > before, "{entry}: it is drawn again");
    }
    undo(&mut lab);
    settle(&mut lab);
    assert_eq!(shown(&lab), "leaf");
    // The menu is that of the scene, which has the variants whichever it shows.
    assert!(lab.query_by_label("scene.variant").is_some());
}

#[test]
fn the_title_of_an_effect_folds_it_and_only_its_box_removes_it() {
    let Some(mut lab) = lab("facet-knot") else {
        return;
    };
    let enabled = |lab: &Lab| {
        lab.state()
            .preset_file()
            .preset
            .stack
            .get("facet")
            .is_some()
    };
    assert!(has_slider(&lab, "facet.amount"));
    click(&mut lab, Role::Button, "Fold facet");
    assert!(
        enabled(&lab) && !has_slider(&lab, "facet.amount"),
        "the title does not fold the effect"
    );
    click(&mut lab, Role::Button, "Unfold facet");
    assert!(enabled(&lab) && has_slider(&lab, "facet.amount"));
    assert_eq!(
        lab.state().undo_steps(),
        0,
        "folding is no change of the preset"
    );
    click(&mut lab, Role::CheckBox, "facet");
    assert!(!enabled(&lab));
}

#[test]
fn the_tick_of_the_gradient_adds_a_color_at_the_bottom_and_removes_it() {
    draw_pictures();
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let bottom = |lab: &Lab| lab.state().preset_file().preset.output.background_bottom;
    let corners = |lab: &mut Lab| {
        let seen = picture(lab);
        [[4, 4], [4, seen.height() - 5]].map(|[x, y]| *seen.get_pixel(x, y))
    };
    assert_eq!(bottom(&lab), None);
    assert!(lab.query_by_label("output.background_bottom").is_none());
    let [top, below] = corners(&mut lab);
    assert_eq!(top, below, "one color");

    click(&mut lab, Role::CheckBox, "gradient");
    settle(&mut lab);
    let preset = &lab.state().preset_file().preset;
    assert!(
        bottom(&lab).is_some_and(|bottom| bottom != preset.output.background),
        "a gradient that can be seen"
    );
    // The harness panics where a font lacks a sign.
    lab.get_by_label("output.background_bottom").click();
    lab.run_steps(3);
    press(&mut lab, Modifiers::NONE, Key::Escape);
    let [top_after, below_after] = corners(&mut lab);
    assert!(
        below_after != below && top_after.0[0].abs_diff(top.0[0]) < 12,
        "{top_after:?} {below_after:?}"
    );
    assert_eq!(lab.state().undo_steps(), 1);

    click(&mut lab, Role::CheckBox, "gradient");
    settle(&mut lab);
    assert_eq!((bottom(&lab), corners(&mut lab)), (None, [top, below]));
    undo(&mut lab);
    assert!(bottom(&lab).is_some());
}

#[test]
fn the_tick_of_the_ground_puts_one_under_the_scene_and_shows_its_rows() {
    let Some(mut lab) = lab("lambert") else {
        return;
    };
    let triangles = |lab: &Lab| lab.state().scene_triangles();
    let (before, camera) = (triangles(&lab), lab.state().preset_file().preset.camera);
    assert!(!has_slider(&lab, "ground.size"));
    click(&mut lab, Role::CheckBox, "ground");
    settle(&mut lab);
    let ground = lab
        .state()
        .preset_file()
        .preset
        .ground
        .expect("it has a ground");
    assert_eq!(ground, rasterlab::scene::Ground::default());
    assert_eq!(
        triangles(&lab),
        before + u64::from(6 * ground.cells * ground.cells)
    );
    assert_eq!(
        (
            lab.state().preset_file().preset.camera,
            lab.state().undo_steps()
        ),
        (camera, 1)
    );
    for row in ["ground.shape", "ground.color"] {
        lab.get_by_label(row);
    }
    assert!(has_slider(&lab, "ground.size") && has_slider(&lab, "ground.cells"));

    click(&mut lab, Role::CheckBox, "ground");
    settle(&mut lab);
    assert_eq!(
        (lab.state().preset_file().preset.ground, triangles(&lab)),
        (None, before)
    );
    undo(&mut lab);
    settle(&mut lab);
    assert_eq!(
        triangles(&lab),
        before + u64::from(6 * ground.cells * ground.cells)
    );
}
