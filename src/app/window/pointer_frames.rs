//! Spreads quick gestures of the pointer over frames. egui takes no drag and no slider notices a
//! click that begins and ends within one frame, and a press is taken to be where the pointer is at
//! the frame's end. While a frame is slow, as on a software adapter, much happens in one.

use egui::{self, Event, Plugin, RawInput};

/// Ends the events of a frame after a press, and before a release that follows a motion; the others
/// wait for the next frame.
#[derive(Default)]
pub struct PointerFrames {
    waiting: Vec<Event>,
}

impl Plugin for PointerFrames {
    fn debug_name(&self) -> &'static str {
        "pointer frames"
    }

    fn input_hook(&mut self, ctx: &egui::Context, input: &mut RawInput) {
        let mut events = std::mem::take(&mut self.waiting);
        events.append(&mut input.events);
        self.waiting = events.split_off(end_of_frame(&events));
        input.events = events;
        if !self.waiting.is_empty() {
            ctx.request_repaint();
        }
    }
}

/// How many of `events` belong to one frame.
fn end_of_frame(events: &[Event]) -> usize {
    let is_pointer = |event: &Event| {
        matches!(
            event,
            Event::PointerMoved(_) | Event::PointerButton { .. } | Event::PointerGone
        )
    };
    let mut has_moved = false;
    for (at, event) in events.iter().enumerate() {
        match event {
            Event::PointerButton { pressed: true, .. }
                if events[at + 1..].iter().any(is_pointer) =>
            {
                return at + 1;
            }
            Event::PointerButton { pressed: false, .. } if has_moved => return at,
            Event::PointerMoved(_) => has_moved = true,
            _ => {}
        }
    }
    events.len()
}

#[cfg(test)]
mod tests {
    use egui::{Modifiers, PointerButton, Pos2, pos2};

    use super::*;

    fn moved(x: f32) -> Event {
        Event::PointerMoved(pos2(x, 0.0))
    }

    fn button(pressed: bool) -> Event {
        Event::PointerButton {
            pos: Pos2::ZERO,
            button: PointerButton::Primary,
            pressed,
            modifiers: Modifiers::NONE,
        }
    }

    /// The frames that `events`, all of one frame, are spread over.
    fn frames(mut events: Vec<Event>) -> Vec<Vec<Event>> {
        let mut frames = Vec::new();
        while !events.is_empty() {
            let rest = events.split_off(end_of_frame(&events));
            frames.push(std::mem::replace(&mut events, rest));
        }
        frames
    }

    #[test]
    fn a_click_takes_two_frames_and_a_drag_three() {
        assert_eq!(
            frames(vec![moved(1.0), button(true), button(false)]),
            [vec![moved(1.0), button(true)], vec![button(false)]]
        );
        let drag = vec![
            button(true),
            moved(2.0),
            moved(3.0),
            button(false),
            Event::Text("a".into()),
        ];
        let expected = [
            vec![button(true)],
            vec![moved(2.0), moved(3.0)],
            vec![button(false), Event::Text("a".into())],
        ];
        assert_eq!(frames(drag), expected);
    }

    #[test]
    fn every_event_stays_in_its_order() {
        let double_click = vec![
            button(true),
            button(false),
            Event::Copy,
            button(true),
            button(false),
        ];
        assert_eq!(frames(double_click.clone()).concat(), double_click);
        assert_eq!(
            frames(vec![moved(1.0), moved(2.0), Event::Copy]).len(),
            1,
            "only gestures are spread"
        );
        assert_eq!(frames(vec![Event::Copy, button(true)]).len(), 1);
    }
}
