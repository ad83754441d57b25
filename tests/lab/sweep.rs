//! Promise: a sweep draws one or two parameters as a contact sheet in the window, and a click on a
//! picture takes its values; random values can be locked, kept near, and gone back to.

use egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable as _;

use crate::harness::*;

#[test]
fn a_click_on_a_picture_of_the_sheet_takes_its_values_in_one_step() {
    draw_pictures();
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    press(&mut lab, Modifiers::SHIFT, Key::S);
    choose(&mut lab, "Parameter along the rows", "facet.amount");
    choose(&mut lab, "Parameter from row to row", "facet.pattern");
    let draws = lab.state().draws();
    click(&mut lab, Role::Button, "Draw the sheet");
    assert_eq!(
        lab.state().sweep_pictures(),
        5 * 4,
        "{}",
        lab.state().log_text()
    );
    assert_eq!(
        (lab.state().draws(), lab.state().undo_steps()),
        (draws, 0),
        "neither picture nor preset changes"
    );
    click(&mut lab, Role::Button, "Take amount=0.25 pattern=radial");
    assert_eq!(
        (
            value(&lab, "facet", "amount"),
            value(&lab, "facet", "pattern")
        ),
        (vec![0.25], vec![2.0])
    );
    assert_eq!(lab.state().undo_steps(), 1);
    assert!(
        lab.query_by_label_contains("Drawn from an earlier picture")
            .is_some()
    );
    undo(&mut lab);
    assert_eq!(lab.state().undo_steps(), 0);
    // One parameter fills rows of its own.
    choose(&mut lab, "Parameter from row to row", "none");
    click(&mut lab, Role::Button, "Draw the sheet");
    assert_eq!(lab.state().sweep_pictures(), 5);
    assert!(
        lab.query_by_role_and_label(Role::Button, "Take amount=1")
            .is_some()
    );
    assert!(error_lines(&lab).is_empty());
}

#[test]
fn locked_values_stay_and_seeds_can_be_gone_back_to() {
    let Some(mut lab) = lab("facet-sweep") else {
        return;
    };
    let amount = |lab: &Lab| value(lab, "facet", "amount");
    let before = (amount(&lab), lab.state().preset_file().preset.stack.clone());
    press(&mut lab, Modifiers::SHIFT, Key::R);
    assert!(
        lab.query_by_label_contains("The last twelve seeds")
            .is_some()
    );
    click(&mut lab, Role::CheckBox, "Vary facet.amount");
    click(&mut lab, Role::Button, "Randomize now");
    let first = lab.state().preset_file().preset.stack.clone();
    assert!(
        amount(&lab) == before.0 && first != before.1,
        "the others vary"
    );
    click(&mut lab, Role::CheckBox, "Vary facet.amount");
    click(&mut lab, Role::Button, "Randomize now");
    let second = lab.state().preset_file().preset.stack.clone();
    assert!(amount(&lab) != before.0 && second != first);
    assert_eq!(lab.state().undo_steps(), 2);
    click(&mut lab, Role::Button, "Seed 1");
    assert_eq!(
        (
            &lab.state().preset_file().preset.stack,
            lab.state().undo_steps()
        ),
        (&first, 3)
    );
    click(&mut lab, Role::Button, "Seed 2");
    assert_eq!(lab.state().preset_file().preset.stack, second);
    undo(&mut lab);
    assert_eq!(lab.state().preset_file().preset.stack, first);
    assert!(error_lines(&lab).is_empty());
}
