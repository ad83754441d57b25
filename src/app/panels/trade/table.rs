//! The table: the same points as the plot in numbers, the dominated ones too.

use egui::{self, RichText, Ui};

use crate::{
    accuracy::Axis,
    app::{
        trade::point::{Metric, Point, Standing, standings},
        widgets::{text::short, theme},
    },
};

/// Returns the index of the point that was clicked.
pub fn table_ui(
    ui: &mut Ui,
    points: &[Point],
    axes: &[&'static Axis],
    metric: Metric,
    current: &dyn Fn(&Point) -> bool,
) -> Option<usize> {
    let mut clicked = None;
    let (standings, metrics) = (standings(points, metric), Metric::of(points));
    let mut order: Vec<usize> = (0..points.len()).collect();
    let ms = |i: &usize| points[*i].ms.map_or(f64::INFINITY, |ms| ms.p50);
    order.sort_by(|a, b| ms(a).total_cmp(&ms(b)));
    egui::ScrollArea::both()
        .id_salt("trade table")
        .auto_shrink(false)
        .show(ui, |ui| {
            egui::Grid::new("trade table")
                .num_columns(5 + metrics.len())
                .spacing([14.0, 3.0])
                .show(ui, |ui| {
                    let options = if let [one] = axes {
                        one.name.replace('_', " ")
                    } else {
                        "options".to_owned()
                    };
                    for heading in [options.as_str(), "verdict", "ms", "5 %", "95 %"] {
                        ui.label(theme::small(heading));
                    }
                    for metric in &metrics {
                        // Two lines, so that the columns fit into a small window.
                        let name = metric.name().replace("and ", "and\n");
                        let heading = match name.contains('\n') {
                            true => name,
                            false => name.replacen(' ', "\n", 1),
                        };
                        ui.label(theme::small(heading)).on_hover_text(format!(
                            "{}, {}",
                            metric.name(),
                            metric.unit()
                        ));
                    }
                    ui.end_row();
                    for i in order {
                        if row_ui(
                            ui,
                            &points[i],
                            axes,
                            &metrics,
                            (standings[i], current(&points[i])),
                        ) {
                            clicked = Some(i);
                        }
                        ui.end_row();
                    }
                });
        });
    clicked
}

fn row_ui(
    ui: &mut Ui,
    point: &Point,
    axes: &[&'static Axis],
    metrics: &[Metric],
    (standing, is_current): (Option<Standing>, bool),
) -> bool {
    let is_front = standing == Some(Standing::Front);
    let words: Vec<&str> = axes
        .iter()
        .filter_map(|axis| Some(axis.words[point.pins.get(axis)?]))
        .collect();
    let ink = match (point.ms.is_some(), is_current, is_front) {
        (false, ..) => theme::text_weak(),
        (_, true, _) => theme::amber(),
        (_, _, true) => theme::text_strong(),
        _ => theme::text(),
    };
    let name = RichText::new(words.join(" · ")).size(12.0).color(ink);
    let button = ui.add_enabled(
        point.ms.is_some(),
        egui::Button::new(name).small().frame(false),
    );
    let button = button.on_hover_text(format!("Switch the preset to {}", point.pins.words()));
    let clicked = button
        .accessible_name(format!("Use {}", point.pins.words()))
        .clicked();
    let remark = match standing {
        _ if is_current => RichText::new("this preset").color(theme::amber()),
        Some(Standing::Front) => RichText::new("on the front").color(theme::accent()),
        Some(Standing::Tied) => RichText::new("within the noise").color(theme::text()),
        Some(Standing::Dominated) => theme::weak("dominated"),
        None if point.ms.is_none() => theme::weak("not timed"),
        None => RichText::new(""),
    };
    let remark = ui.label(remark.size(11.5));
    if let Some(note) = &point.note {
        remark.on_hover_text(note);
    }
    let cell = |ui: &mut Ui, value: Option<f64>| {
        let text = value.map_or_else(|| "not measured".into(), short);
        ui.label(
            RichText::new(text)
                .monospace()
                .size(11.5)
                .color(if value.is_some() {
                    theme::text()
                } else {
                    theme::text_weak()
                }),
        );
    };
    [0, 1, 2]
        .into_iter()
        .for_each(|i| cell(ui, point.ms.map(|ms| [ms.p50, ms.p5, ms.p95][i])));
    metrics
        .iter()
        .for_each(|metric| cell(ui, point.error(*metric)));
    clicked
}
