//! The tab of the scenes: the scene that is shown, and the built-in ones with their parameters.

use std::collections::HashMap;

use egui::{self, Align2, DragValue, Label, Sense, Ui, vec2};

use crate::{
    app::{
        editing::session::Session,
        shell::{
            action::Action,
            command::{Commands, Edit},
            state::State,
        },
        widgets::{
            text::{cut_middle, group_digits, with_own_paths},
            theme,
        },
    },
    preset::SceneSource,
    preset_file::ModelFormat,
    scene::{
        Primitive,
        builtin::{BUILTINS, Builtin},
    },
};

pub fn scenes_ui(ui: &mut Ui, state: &State, commands: &Commands) {
    shown_ui(ui, &state.session);
    ui.add_space(theme::HALF);
    if ui
        .button("Open model…")
        .on_hover_text(format!("A {} file", ModelFormat::names(" or ")))
        .clicked()
    {
        commands.perform(Action::Open);
    }
    let models = ModelFormat::names(", ");
    ui.label(theme::weak(format!(
        "Or drop a model ({models}), a preset (.toml) or an exported picture (.png) on the window."
    )));
    ui.add_space(theme::GAP);
    ui.label(theme::heading("Built in"));
    let query = match &state.session.preset().scene {
        SceneSource::Builtin(query) => query.as_str(),
        SceneSource::File(_) => "",
    };
    let open = query.split('?').next().unwrap_or_default();
    for builtin in BUILTINS {
        let is_open = builtin.name == open;
        let button = egui::Button::selectable(is_open, builtin.name)
            .min_size(vec2(ui.available_width(), theme::ROW));
        if ui.add(button).on_hover_text(builtin.about).clicked() && !is_open {
            commands.open(format!("builtin:{}", builtin.name));
        }
        if is_open && let Some(changed) = params_ui(ui, builtin, query) {
            commands.edit(Edit::BuiltinQuery(changed));
        }
    }
}

/// The scene that is shown: name, counts and warnings.
fn shown_ui(ui: &mut Ui, session: &Session) {
    let source = match &session.preset().scene {
        // Its parameters have fields below.
        SceneSource::Builtin(_) => session.preset_file.scene_name(),
        SceneSource::File(path) => with_own_paths(path.display().to_string()),
    };
    // A letter is some 8 points wide.
    let short = cut_middle(&source, (ui.available_width() / 8.0).max(8.0) as usize);
    ui.add(Label::new(theme::strong(short).strong()).truncate())
        .on_hover_text(&source);
    if session.scenes.is_loading() {
        ui.horizontal(|ui| {
            ui.add(egui::Spinner::new().size(12.0));
            ui.label(theme::weak("loading"));
        });
        return;
    }
    if session.scenes.has_failed() {
        theme::notice(ui, theme::red(), "This scene cannot be shown. See the log.");
        return;
    }
    let Some(scene) = session.scene() else { return };
    // Ground and room of the preset are not the scene's.
    let own = &scene.instances[..scene.instances.len() - scene.walls - scene.grounds];
    let primitives = || {
        own.iter()
            .map(|instance| &scene.primitives[instance.primitive])
    };
    let sum = |counts: &mut dyn Iterator<Item = u32>| group_digits(counts.map(u64::from).sum());
    ui.label(theme::weak(format!(
        "{} triangles · {} vertices",
        sum(&mut primitives().map(Primitive::triangle_count)),
        sum(&mut primitives().map(Primitive::vertex_count))
    )));
    if own.len() > 1 {
        let count = group_digits(own.len() as u64);
        ui.label(theme::weak(format!("{count} instances")));
    }
    if scene.triangle_count() == 0 {
        theme::notice(
            ui,
            theme::amber(),
            "This scene has no triangles, so the picture is only background.",
        );
    }
    session
        .preset()
        .notes_on(scene)
        .for_each(|note| theme::notice(ui, theme::amber(), note));
}

/// Fields for the parameters of a built-in scene. Returns the new query if one changed.
fn params_ui(ui: &mut Ui, builtin: &Builtin, query: &str) -> Option<String> {
    let mut values = values_of(builtin, query);
    let before = values.clone();
    egui::Frame::new()
        .inner_margin(egui::Margin {
            left: 12,
            right: 0,
            top: 2,
            bottom: 8,
        })
        .show(ui, |ui| {
            ui.label(theme::weak(builtin.about));
            for (param, value) in builtin.params.iter().zip(&mut values) {
                ui.horizontal(|ui| {
                    let (label, response) =
                        ui.allocate_exact_size(vec2(84.0, theme::ROW - 4.0), Sense::hover());
                    response.on_hover_text(param.doc);
                    let font = egui::TextStyle::Body.resolve(ui.style());
                    ui.painter_at(label).text(
                        label.left_center(),
                        Align2::LEFT_CENTER,
                        param.name,
                        font,
                        theme::text(),
                    );
                    let speed = if param.whole {
                        value.abs().max(10.0) * 0.02
                    } else {
                        value.abs().max(0.1) * 0.02
                    };
                    // Building a scene is slow, so a drag only shows the number and the scene is
                    // built on release.
                    let id = egui::Id::unique((builtin.name, param.name));
                    let mut shown = ui.data(|data| data.get_temp(id)).unwrap_or(*value);
                    let drag = DragValue::new(&mut shown)
                        .range(param.range.clone())
                        .speed(speed)
                        .max_decimals(if param.whole { 0 } else { 4 });
                    let response =
                        ui.add_sized([96.0, theme::ROW - 4.0], drag.update_while_editing(false));
                    if response.dragged() {
                        ui.data_mut(|data| data.insert_temp(id, shown));
                    } else {
                        ui.data_mut(|data| data.remove::<f64>(id));
                        *value = shown;
                    }
                    response
                        .on_hover_text(param.doc)
                        .accessible_name(format!("{} {}", builtin.name, param.name));
                });
            }
        });
    (values != before).then(|| query_of(builtin, &values))
}

/// The value of every parameter in `query`; the default where it has none.
fn values_of(builtin: &Builtin, query: &str) -> Vec<f64> {
    let pairs: HashMap<&str, &str> = query
        .split_once('?')
        .map_or("", |(_, pairs)| pairs)
        .split('&')
        .filter_map(|pair| pair.split_once('='))
        .collect();
    builtin
        .params
        .iter()
        .map(|param| {
            pairs
                .get(param.name)
                .and_then(|text| text.parse().ok())
                .unwrap_or(param.default)
        })
        .collect()
}

/// The query with the values that differ from the defaults.
fn query_of(builtin: &Builtin, values: &[f64]) -> String {
    let changed = builtin
        .params
        .iter()
        .zip(values)
        .filter(|(param, value)| param.default != **value);
    let pairs: Vec<String> = changed
        .map(|(param, value)| {
            format!(
                "{}={}",
                param.name,
                if param.whole { value.round() } else { *value }
            )
        })
        .collect();
    if pairs.is_empty() {
        builtin.name.into()
    } else {
        format!("{}?{}", builtin.name, pairs.join("&"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_query_says_only_what_differs_and_reads_back() {
        for builtin in BUILTINS {
            let mut values = values_of(builtin, builtin.name);
            assert_eq!(query_of(builtin, &values), builtin.name);
            if let (Some(value), Some(param)) = (values.first_mut(), builtin.params.first()) {
                *value = *param.range.start();
            }
            let query = query_of(builtin, &values);
            assert_eq!(values_of(builtin, &query), values, "{query}");
        }
    }
}
