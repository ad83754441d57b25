//! The table: the same points as the plot in numbers, the dominated ones too.

use eframe::egui::{self, RichText, Ui};

use crate::{
    accuracy::Axis,
    app::{
        sweep::point::{Metric, Point, front},
        text::short,
        theme,
    },
};

/// Returns the index of the point that was clicked.
pub fn table_ui(ui: &mut Ui, points: &[Point], axes: &[&'static Axis], metric: Metric, current: &dyn Fn(&Point) -> bool) -> Option<usize> {
    let mut clicked = None;
    let (front, metrics) = (front(points, metric), Metric::of(points));
    let mut order: Vec<usize> = (0..points.len()).collect();
    let ms = |i: &usize| points[*i].ms.map_or(f64::INFINITY, |[p50, _]| p50);
    order.sort_by(|a, b| ms(a).total_cmp(&ms(b)));
    egui::ScrollArea::both().id_salt("sweep table").auto_shrink(false).show(ui, |ui| {
        egui::Grid::new("sweep table").num_columns(4 + metrics.len()).spacing([14.0, 3.0]).show(ui, |ui| {
            let options = if let [one] = axes { one.name.replace('_', " ") } else { "options".to_owned() };
            let errors = ["wrong ppm", "color", "holes+doubles", "light ppm"];
            for heading in
                [options.as_str(), "ms", "95 %"].into_iter().chain(metrics.iter().map(|metric| errors[*metric as usize])).chain([""])
            {
                ui.label(theme::weak(heading).size(11.0));
            }
            ui.end_row();
            for i in order {
                if row_ui(ui, &points[i], axes, &metrics, (front.contains(&i), current(&points[i]))) {
                    clicked = Some(i);
                }
                ui.end_row();
            }
        });
    });
    clicked
}

fn row_ui(ui: &mut Ui, point: &Point, axes: &[&'static Axis], metrics: &[Metric], (is_front, is_current): (bool, bool)) -> bool {
    let words: Vec<&str> = axes.iter().filter_map(|axis| Some(axis.words[point.pins.get(axis)?])).collect();
    let ink = match (point.ms.is_some(), is_current, is_front) {
        (false, ..) => theme::text_weak(),
        (_, true, _) => theme::amber(),
        (_, _, true) => theme::text_strong(),
        _ => theme::text(),
    };
    let name = RichText::new(words.join(" · ")).size(12.0).color(ink);
    let button = ui.add_enabled(point.ms.is_some(), egui::Button::new(name).small().frame(false));
    let button = button.on_hover_text(format!("Switch the preset to {}", point.pins.words()));
    let clicked = button.accessible_name(format!("Use {}", point.pins.words())).clicked();
    let cell = |ui: &mut Ui, value: Option<f64>| {
        let text = value.map_or_else(|| "not measured".into(), short);
        ui.label(RichText::new(text).monospace().size(11.5).color(if value.is_some() { theme::text() } else { theme::text_weak() }));
    };
    [0, 1].into_iter().for_each(|i| cell(ui, point.ms.map(|ms| ms[i])));
    metrics.iter().for_each(|metric| cell(ui, point.error(*metric)));
    let remark = match (&point.note, is_current, is_front) {
        (_, true, _) => RichText::new("this preset").color(theme::amber()),
        (_, _, true) => RichText::new("on the front").color(theme::accent()),
        _ if point.is_dominated => theme::weak("dominated"),
        _ if point.ms.is_none() => theme::weak("not timed"),
        _ => RichText::new(""),
    };
    let remark = ui.label(remark.size(11.5));
    if let Some(note) = &point.note {
        remark.on_hover_text(note);
    }
    clicked
}
