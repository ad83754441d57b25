//! Folding: a narrow page has room for one side panel at a time, beside the picture.

use egui::{Button, Ui, vec2};

use crate::app::settings::OpenPanels;

/// Below this width of the window the side panels fold, points.
const NARROW: f32 = 800.0;

/// What was folded.
#[derive(Debug, Default)]
pub struct Fold {
    /// Whether the left and the right panel were open before the window was narrow; none while it is
    /// wide.
    before: Option<[bool; 2]>,
    /// Whether they were open in the last frame.
    last: [bool; 2],
}

impl Fold {
    /// Closes the side panels of a window that has become narrow, and the older one where both are
    /// open then; opens them again where the window has become wide.
    pub fn follow(&mut self, width: f32, open: &mut OpenPanels) {
        match (width < NARROW, self.before) {
            (true, None) => {
                self.before = Some([open.left, open.right]);
                (open.left, open.right) = (false, false);
            }
            (false, Some([left, right])) => {
                self.before = None;
                (open.left, open.right) = (left, right);
            }
            (true, Some(_)) if open.left && open.right => {
                (open.left, open.right) = (!self.last[0], self.last[0]);
            }
            _ => {}
        }
        self.last = [open.left, open.right];
    }

    /// The panels as they are at the next start.
    pub fn kept(&self, open: OpenPanels) -> OpenPanels {
        let [left, right] = self.before.unwrap_or([open.left, open.right]);
        OpenPanels {
            left,
            right,
            ..open
        }
    }
}

/// The handles of the side panels in the window of a phone: each opens its panel and closes it.
pub fn handles_ui(ui: &mut Ui, open: &mut OpenPanels) {
    ui.columns(2, |columns| {
        let [left, right] = columns else { return };
        let handles = [
            (left, "Presets", &mut open.left),
            (right, "Effects", &mut open.right),
        ];
        for (ui, name, is_open) in handles {
            let handle = Button::selectable(*is_open, name);
            let handle = handle.frame_when_inactive(true);
            *is_open ^= ui
                .add_sized(vec2(ui.available_width(), 36.0), handle)
                .clicked();
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_narrow_window_has_one_side_panel_at_most_and_a_wide_one_those_of_before() {
        let (mut fold, mut open) = (Fold::default(), OpenPanels::default());
        let shown = |open: &OpenPanels| [open.left, open.right];
        fold.follow(1200.0, &mut open);
        assert_eq!(shown(&open), [true, true]);
        fold.follow(400.0, &mut open);
        assert_eq!(shown(&open), [false, false]);
        assert_eq!(
            shown(&fold.kept(open)),
            [true, true],
            "the next start is wide"
        );
        open.left = true;
        fold.follow(400.0, &mut open);
        open.right = true;
        fold.follow(400.0, &mut open);
        assert_eq!(shown(&open), [false, true], "the newer one stays");
        fold.follow(1200.0, &mut open);
        assert_eq!(shown(&open), [true, true]);
    }
}
