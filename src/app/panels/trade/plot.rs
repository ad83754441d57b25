//! The plot: error over milliseconds, both logarithmic, with a line for exact pictures below.
//! egui_plot has no such axes, so points are plotted by their logarithms and ticks are labeled with
//! the values themselves.

use egui::{self, Color32, Painter, Pos2, Rect, Response, RichText, Sense, Ui, Vec2, vec2};
use egui_plot::{GridMark, HLine, Line, LineStyle, Plot, PlotPoint, PlotPoints};

use crate::app::{
    trade::point::{Metric, Point, Standing, standings},
    widgets::{panel::describe, text::short, theme},
};

/// Least distance of two points, so that each can be clicked, points of the screen.
const APART: f32 = 12.0;

/// How far below the least error zero is drawn, decades.
const DROP: f64 = 0.8;

/// The ranges of the axes, as logarithms.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Span {
    x: [f64; 2],
    y: [f64; 2],
    /// Position of the line of exact pictures.
    exact: f64,
}

impl Span {
    /// The ranges of points that stand at a time and an error; `bars` are the ends of their
    /// spreads.
    fn of(positions: &[[f64; 2]], bars: &[[f64; 2]]) -> Self {
        let ends = |values: &mut dyn Iterator<Item = f64>| {
            values.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            })
        };
        let widened = |[low, high]: [f64; 2], least: f64| {
            let air = (0.07 * (high - low)).max((least - (high - low)).max(0.0) / 2.0);
            [low - air, high + air]
        };
        let times = positions
            .iter()
            .map(|position| position[0])
            .chain(bars.iter().flatten().copied());
        let x = ends(&mut times.filter(|ms| *ms > 0.0).map(f64::log10));
        let errors = ends(
            &mut positions
                .iter()
                .filter(|position| position[1] > 0.0)
                .map(|position| position[1].log10()),
        );
        let [low, high] = if errors[0].is_finite() {
            errors
        } else {
            [0.0, 0.0]
        };
        let exact = low - DROP;
        Self {
            x: widened(x, 0.25),
            y: [
                exact - 0.12 * (high - exact).max(1.0),
                high + 0.12 * (high - exact).max(1.0),
            ],
            exact,
        }
    }

    fn at(&self, [ms, error]: [f64; 2]) -> [f64; 2] {
        [
            ms.log10(),
            if error > 0.0 {
                error.log10()
            } else {
                self.exact
            },
        ]
    }
}

/// Round values between two ends, at most eight.
fn ticks(low: f64, high: f64) -> Vec<f64> {
    let decades = |low: f64, high: f64| (low.log10().floor() as i32)..=(high.log10().ceil() as i32);
    let within = |v: &f64| (low..=high).contains(v);
    if high / low >= 3.0 {
        let digits: &[f64] = match high / low {
            ..12.0 => &[1.0, 2.0, 3.0, 5.0, 7.0],
            12.0..2e3 => &[1.0, 2.0, 5.0],
            _ => &[1.0],
        };
        return decades(low, high)
            .flat_map(|e| digits.iter().map(move |d| d * 10f64.powi(e)))
            .filter(within)
            .collect();
    }
    let rough = (high - low) / 4.0;
    let unit = 10f64.powf(rough.log10().floor());
    let step = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .map(|digit| digit * unit)
        .find(|step| *step >= rough)
        .unwrap_or(rough);
    let first = (low / step).ceil() as i64;
    (first..)
        .map(|k| k as f64 * step)
        .take_while(within)
        .collect()
}

fn marks(span: [f64; 2]) -> Vec<GridMark> {
    let step_size = (span[1] - span[0]) / 4.0;
    ticks(10f64.powf(span[0]), 10f64.powf(span[1]))
        .into_iter()
        .map(|v| GridMark {
            value: v.log10(),
            step_size,
        })
        .collect()
}

/// What a frame of the plot shows.
pub struct Shown<'a> {
    pub points: &'a [Point],
    pub metric: Metric,
    /// True for the combination that the picture uses.
    pub current: &'a dyn Fn(&Point) -> bool,
}

/// A point of the plot.
#[derive(Clone, Copy)]
struct Plotted {
    /// Its index among all points.
    i: usize,
    /// Milliseconds and error.
    at: [f64; 2],
    /// Milliseconds at 5 and 95 %.
    bar: [f64; 2],
}

impl Shown<'_> {
    /// The points that have both a time and an error.
    fn plotted(&self) -> Vec<Plotted> {
        let found = self.points.iter().enumerate();
        let found = found.filter_map(|(i, point)| {
            let (ms, error) = point.position(self.metric)?;
            Some(Plotted {
                i,
                at: [ms.p50, error],
                bar: [ms.p5, ms.p95],
            })
        });
        found.collect()
    }
}

/// Color, whether it is filled, and radius of a mark.
fn style(standing: Option<Standing>) -> (Color32, bool, f32) {
    match standing {
        Some(Standing::Front) => (theme::accent(), true, 4.5),
        Some(Standing::Tied) => (theme::text(), true, 3.5),
        Some(Standing::Dominated) | None => (theme::text_weak(), false, 3.5),
    }
}

fn mark_ui(painter: &Painter, at: Pos2, (color, is_filled, radius): (Color32, bool, f32)) {
    match is_filled {
        true => painter.circle_filled(at, radius, color),
        false => painter.circle(at, radius, theme::panel(), (1.2, color)),
    };
}

/// Draws the plot into the available space. Returns the index of the point that was clicked.
pub fn plot_ui(ui: &mut Ui, shown: &Shown<'_>) -> Option<usize> {
    let plotted = shown.plotted();
    if plotted.is_empty() {
        let name = shown.metric.name();
        let text = format!("No combination has both a time and its {name}.");
        ui.centered_and_justified(|ui| ui.label(theme::weak(text)));
        return None;
    }
    let span = Span::of(
        &plotted.iter().map(|p| p.at).collect::<Vec<_>>(),
        &plotted.iter().map(|p| p.bar).collect::<Vec<_>>(),
    );
    let standings = standings(shown.points, shown.metric);
    let (frame, true_places) = lines_ui(ui, shown.metric, &plotted, &span, &standings);
    let places = spread(&true_places, frame);
    let painter = ui.painter_at(frame);
    let mut clicked = None;
    for ((p, &place), &true_place) in plotted.iter().zip(&places).zip(&true_places) {
        let style = style(standings[p.i]);
        painter.line_segment([true_place, place], (1.0, style.0.gamma_multiply(0.5)));
        mark_ui(&painter, place, style);
        if (shown.current)(&shown.points[p.i]) {
            painter.circle_stroke(place, 7.0, (1.5, theme::amber()));
        }
    }
    for (p, at) in plotted.iter().zip(places) {
        if point_ui(ui, shown, p.i, standings[p.i], at).clicked() {
            clicked = Some(p.i);
        }
    }
    clicked
}

/// A plot that shows what it is given, and answers no pointer.
pub fn still_plot(id: &str) -> Plot<'_> {
    Plot::new(id)
        .allow_drag(false)
        .allow_zoom(false)
        .allow_scroll(false)
        .allow_boxed_zoom(false)
        .allow_axis_zoom_drag(false)
        .allow_double_click_reset(false)
        .show_background(false)
        .show_x(false)
        .show_y(false)
        .grid_color(theme::line())
        .grid_fade(0.0)
        .sense(Sense::hover())
        .label_formatter(|_| None)
}

/// Axes, the front and the spreads. Returns where the plot is, and each of its points.
fn lines_ui(
    ui: &mut Ui,
    metric: Metric,
    plotted: &[Plotted],
    span: &Span,
    standings: &[Option<Standing>],
) -> (Rect, Vec<Pos2>) {
    let front = plotted
        .iter()
        .filter(|p| standings[p.i] == Some(Standing::Front));
    let mut front: Vec<[f64; 2]> = front.map(|p| p.at).collect();
    front.sort_by(|a, b| a[0].total_cmp(&b[0]));
    let along: Vec<_> = front
        .into_iter()
        .map(|position| span.at(position))
        .collect();
    let (exact, x, y) = (span.exact, span.x, span.y);
    let error = format!("{}, {}", metric.name(), metric.unit());
    let response = still_plot("trade plot")
        .x_axis_label(RichText::new("milliseconds, median").size(11.0))
        .y_axis_label(RichText::new(error).size(11.0))
        .x_grid_spacer(move |_| marks(x))
        .y_grid_spacer(move |_| {
            let mut marks = marks([exact + 0.5 * DROP, y[1]]);
            marks.push(GridMark {
                value: exact,
                step_size: 10.0,
            });
            marks
        })
        .x_axis_formatter(|mark, _| short(10f64.powf(mark.value)))
        .y_axis_formatter(move |mark, _| match (mark.value - exact).abs() < 1e-9 {
            true => "exact".into(),
            false => short(10f64.powf(mark.value)),
        })
        .y_axis_min_width(46.0)
        .show(ui, |plot| {
            plot.set_plot_bounds_x(x[0]..=x[1]);
            plot.set_plot_bounds_y(y[0]..=y[1]);
            let line = HLine::new("exact", exact)
                .color(theme::green().gamma_multiply(0.7))
                .width(1.0);
            plot.hline(line.style(LineStyle::dashed_dense()).allow_hover(false));
            let mut line = |name: &str, points: Vec<[f64; 2]>, color: Color32| {
                plot.line(
                    Line::new(name, PlotPoints::from(points))
                        .color(color)
                        .width(1.5)
                        .allow_hover(false),
                );
            };
            line("front", along, theme::accent().gamma_multiply(0.7));
            for p in plotted {
                let height = span.at(p.at)[1];
                let ends = p.bar.iter().map(|ms| [ms.log10(), height]).collect();
                line("", ends, style(standings[p.i]).0.gamma_multiply(0.6));
            }
        });
    let place = |p: &Plotted| {
        let [x, y] = span.at(p.at);
        response
            .transform
            .position_from_point(&PlotPoint::new(x, y))
    };
    (response.response.rect, plotted.iter().map(place).collect())
}

/// What takes the pointer over a point, and says what it is.
fn point_ui(
    ui: &Ui,
    shown: &Shown<'_>,
    i: usize,
    standing: Option<Standing>,
    at: Pos2,
) -> Response {
    let point = &shown.points[i];
    let area = Rect::from_center_size(at, Vec2::splat(APART));
    let handle = ui.interact(area, egui::Id::unique(("trade point", i)), Sense::click());
    describe(
        &handle,
        egui::Role::Button,
        format!("Point {}", point.pins.words()),
    );
    if handle.hovered() || handle.has_focus() {
        ui.painter()
            .circle_stroke(at, 7.0, (1.5, theme::text_strong()));
        ui.set_cursor_icon(egui::CursorIcon::PointingHand);
    }
    let role = match standing {
        _ if (shown.current)(point) => "used by this preset",
        Some(Standing::Front) => {
            "on the Pareto front: every point that is as exact is slower. Click to use it."
        }
        Some(Standing::Tied) => {
            "as quick as another that is as exact, within the noise. Click to use it."
        }
        _ => "dominated: another is as exact and quicker. Click to use it.",
    };
    handle.on_hover_ui(|ui| details_ui(ui, point, role))
}

/// Where points are shown that stand at `places`: those that would lie over each other are pushed
/// apart inside `frame`, so that each can be clicked. The first of them keeps its place.
fn spread(places: &[Pos2], frame: Rect) -> Vec<Pos2> {
    let mut shown: Vec<Pos2> = Vec::with_capacity(places.len());
    for &place in places {
        // Rings round the place, each with room for one more than the last; the first free place is
        // taken.
        let ring = |ring: u32| {
            (0..6 * ring).map(move |k| (ring, std::f32::consts::TAU * k as f32 / (6 * ring) as f32))
        };
        let around = (1..24)
            .flat_map(ring)
            .map(|(ring, angle)| place + ring as f32 * APART * Vec2::angled(angle));
        let is_free = |at: &Pos2| {
            let is_apart = |other: &Pos2| other.distance(*at) >= 0.98 * APART;
            frame.shrink(APART / 2.0).contains(*at) && shown.iter().all(is_apart)
        };
        let free = std::iter::once(place).chain(around).find(is_free);
        shown.push(free.unwrap_or(place));
    }
    shown
}

/// Options and numbers of a point.
fn details_ui(ui: &mut Ui, point: &Point, role: &str) {
    let words = point.pins.words().replace(' ', "\n");
    ui.label(theme::strong(words).monospace());
    ui.label(point.ms.map_or_else(
        || "not timed".to_owned(),
        |ms| {
            let [median, low, high] = [ms.p50, ms.p5, ms.p95].map(short);
            let samples = point.samples;
            format!("{median} ms median, {low} to {high} ms from 5 to 95 %, {samples} samples")
        },
    ));
    for metric in Metric::of(std::slice::from_ref(point)) {
        let error = point.error(metric).map_or_else(
            || "not measured".into(),
            |error| format!("{} {}", short(error), metric.unit()),
        );
        ui.label(format!("{}: {error}", metric.name()));
    }
    for (name, value) in &point.more {
        ui.label(theme::weak(format!("{name}: {}", short(*value))));
    }
    if let Some(note) = &point.note {
        ui.label(RichText::new(note).color(theme::amber()));
    }
    ui.label(theme::weak(role));
}

/// The legend of the marks, from right to left.
pub fn legend_ui(ui: &mut Ui) {
    let marks = [
        ((theme::amber(), false, 6.0), "this preset"),
        (style(Some(Standing::Dominated)), "dominated"),
        (style(Some(Standing::Tied)), "within the noise"),
        (style(Some(Standing::Front)), "on the front"),
    ];
    ui.spacing_mut().item_spacing.x = 4.0;
    for (mark, text) in marks {
        ui.label(theme::small(text));
        let (rect, _) = ui.allocate_exact_size(vec2(14.0, 16.0), Sense::hover());
        mark_ui(ui.painter(), rect.center(), mark);
        ui.add_space(theme::HALF);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_few_and_inside() {
        assert_eq!(ticks(0.8, 130.0), [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0]);
        assert_eq!(ticks(66.0, 440.0), [70.0, 100.0, 200.0, 300.0]);
        assert_eq!(ticks(0.5, 20_000.0), [1.0, 10.0, 100.0, 1_000.0, 10_000.0]);
        for (low, high) in [
            (3.9, 5.3),
            (0.011, 0.012),
            (91.0, 180.0),
            (1.0, 11.0),
            (999.0, 1001.0),
        ] {
            let ticks = ticks(low, high);
            assert!(
                (2..=8).contains(&ticks.len()) && ticks.iter().all(|t| (low..=high).contains(t)),
                "{low}..{high}: {ticks:?}"
            );
        }
    }

    #[test]
    fn points_at_one_place_are_spread_and_others_stay() {
        let one = Pos2::new(40.0, 30.0);
        let places = [
            vec![one; 20],
            vec![Pos2::new(400.0, 30.0), Pos2::new(405.0, 31.0)],
        ]
        .concat();
        let frame = Rect::from_min_max(Pos2::new(0.0, 0.0), Pos2::new(420.0, 38.0));
        let shown = spread(&places, frame);
        assert_eq!(
            (shown.len(), shown[0], shown[20]),
            (22, places[0], places[20])
        );
        for (at, place) in shown.iter().enumerate() {
            assert!(place.distance(places[at]) <= 5.0 * APART, "{at}: {place}");
            assert!(frame.contains(*place), "{at}: {place}");
            for other in &shown[..at] {
                assert!(
                    place.distance(*other) >= 0.9 * APART,
                    "{place} and {other} lie over each other"
                );
            }
        }
    }

    #[test]
    fn exact_is_below_the_least_error_and_everything_is_finite() {
        for positions in [
            vec![[2.0, 0.0]],
            vec![[2.0, 0.0], [1.0, 50.0], [0.5, 9e5]],
            vec![[1e-3, 1e-9], [1e4, 1.0]],
        ] {
            let span = Span::of(&positions, &[[1e-3, 2.0]]);
            let ends = [span.x, span.y].concat();
            assert!(
                ends.iter().all(|v| v.is_finite())
                    && span.x[0] < span.x[1]
                    && span.y[0] < span.y[1],
                "{span:?}"
            );
            for position in positions {
                let [x, y] = span.at(position);
                assert!(span.x[0] < -3.0, "the bar is inside");
                assert!(
                    (span.x[0]..=span.x[1]).contains(&x) && (span.y[0]..=span.y[1]).contains(&y),
                    "{position:?} in {span:?}"
                );
                assert!(
                    position[1] == 0.0 && y == span.exact || y > span.exact,
                    "{position:?} in {span:?}"
                );
            }
        }
    }
}
