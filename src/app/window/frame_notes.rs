//! Frame notes: lines in the file of the log that say how long the window took for its frames and
//! how long a picture was waited for.

use eframe::egui;

use crate::{
    app::shell::{
        state::State,
        ui_frames::{Noted, UiFrames},
    },
    measure::timing::percentile,
};

/// A note covers at least this much time, seconds.
const SPAN_S: f64 = 1.0;

/// When the next note is due.
#[derive(Debug, Default)]
pub struct FrameNotes {
    /// When the first frame began that no note tells of, seconds; none after a note.
    since_s: Option<f64>,
}

impl FrameNotes {
    /// Writes a note if one is due. Nothing without a file, and nothing while the window rests.
    pub fn follow(&mut self, ctx: &egui::Context, state: &mut State) {
        if !state.log.is_kept() {
            return;
        }
        let now_s = state.now_s;
        let left_s = SPAN_S - (now_s - *self.since_s.get_or_insert(now_s));
        if left_s > 0.0 {
            return ctx.request_repaint_after_secs(left_s as f32 + 0.01);
        }
        self.since_s = None;
        if let Some(noted) = ctx
            .with_plugin(UiFrames::take_noted)
            .filter(|noted| noted.frames > 0)
        {
            state.log.note_timing(&line(&noted, now_s));
        }
    }
}

/// `12.3 s, 31 frames, longest 58 ms (panels 12, painting 40, waiting 6), 3 pictures after their
/// inputs: median 50 ms, slowest 84 ms`.
fn line(
    Noted {
        frames,
        longest,
        latencies_ms: [drawn, compiled],
    }: &Noted,
    now_s: f64,
) -> String {
    let of = |latencies: &[f64], what: &str| match [0.5, 1.0].map(|p| percentile(latencies, p)) {
        [Some(median), Some(slowest)] => {
            format!(
                ", {} {what} after their inputs: median {median:.0} ms, slowest {slowest:.0} ms",
                latencies.len()
            )
        }
        _ => String::new(),
    };
    format!(
        "{now_s:.1} s, {frames} frames, longest {:.0} ms (panels {:.0}, painting {:.0}, waiting {:.0}){}{}",
        longest.total(),
        longest.panels,
        longest.painting,
        longest.waiting,
        of(drawn, "pictures"),
        of(compiled, "compiled pictures"),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::shell::ui_frames::FrameTime;

    #[test]
    fn a_note_is_one_line_of_numbers() {
        let longest = FrameTime {
            panels: 12.2,
            painting: 40.0,
            waiting: 5.6,
        };
        let noted = Noted {
            frames: 31,
            longest,
            latencies_ms: [vec![30.0, 84.3, 50.0], vec![]],
        };
        let quiet = "12.3 s, 31 frames, longest 58 ms (panels 12, painting 40, waiting 6)";
        assert_eq!(
            line(&noted, 12.34),
            format!("{quiet}, 3 pictures after their inputs: median 50 ms, slowest 84 ms")
        );
        let noted = Noted {
            latencies_ms: [vec![], vec![900.0]],
            ..noted
        };
        assert_eq!(
            line(&noted, 12.34),
            format!(
                "{quiet}, 1 compiled pictures after their inputs: median 900 ms, slowest 900 ms"
            )
        );
    }
}
