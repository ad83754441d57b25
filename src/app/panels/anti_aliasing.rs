//! The menu of anti-aliasing in the top bar.

use egui::{ComboBox, RichText, Ui};

use crate::{
    accuracy::{AXES, Axis, AxisOption, PinnedOptions, RenderScale},
    app::{
        editing::apply::pin_options,
        picture::anti_aliasing::{AUTOMATIC, CHOICES, name},
        shell::{command::Commands, state::State},
    },
};

const AXIS: &Axis = &AXES[RenderScale::AXIS];

/// Shows what the picture is drawn with, and pins another number of samples or none.
pub fn anti_aliasing_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    let pinned: Option<RenderScale> = state.session.preset().accuracy.pins.option();
    let drawn = state
        .picture
        .screen
        .requested()
        .map(|inputs| inputs.accuracy.scale());
    let shown = name(pinned.or(drawn).unwrap_or_default());
    let menu = ComboBox::from_id_salt("anti-aliasing")
        .selected_text(RichText::new(format!("AA {shown}")).size(12.0))
        .width(64.0);
    let response = menu.show_ui(ui, |ui| {
        ui.set_min_width(150.0);
        let automatic = if state.picture.screen.gpu.caps.software {
            "off on this adapter"
        } else {
            name(AUTOMATIC)
        };
        if ui
            .selectable_label(pinned.is_none(), format!("Automatic ({automatic})"))
            .clicked()
            && pinned.is_some()
        {
            commands.step(|app| pin_options(&mut app.state, &PinnedOptions::default(), &[AXIS]));
        }
        for (option, name) in CHOICES {
            if ui.selectable_label(pinned == Some(option), name).clicked() && pinned != Some(option)
            {
                let pins = PinnedOptions::of(option);
                commands.step(move |app| pin_options(&mut app.state, &pins, &[AXIS]));
            }
        }
    });
    let hint = "Anti-aliasing: how many samples of each pixel are drawn and averaged in linear light. Off, 2×2 and 4×4 are saved in the \
                preset as accuracy.render_scale; Automatic is not saved, and draws 2×2 where a graphics card can afford it.";
    response
        .response
        .on_hover_text(hint)
        .accessible_name("Anti-aliasing");
}
