//! Typing while a dialog opens: text that arrives before the text field of the dialog has the focus
//! waits for it, so that it is neither lost nor taken for shortcuts.

use egui::{self, Event};

/// Events that wait for a text field, in order.
#[derive(Default)]
pub struct HeldTyping {
    held: Vec<Event>,
    /// Since when they wait, seconds.
    since_s: f64,
}

/// The text field of a dialog has the focus after a frame or two; what waits longer is dropped,
/// seconds.
const PATIENCE_S: f64 = 2.0;

impl HeldTyping {
    /// Takes what is typed after the event at `index` of this frame out of it.
    pub fn hold_after(&mut self, ctx: &egui::Context, index: usize, now_s: f64) {
        let later = ctx.input_mut(|i| {
            let mut later = i.events.split_off((index + 1).min(i.events.len()));
            // The key that opened the dialog may be a character, too.
            if later
                .first()
                .is_some_and(|event| matches!(event, Event::Text(_)))
            {
                later.remove(0);
            }
            let (typed, others): (Vec<Event>, Vec<Event>) = later.into_iter().partition(is_typing);
            i.events.extend(others);
            typed
        });
        self.add(ctx, later, now_s);
    }

    /// While a field for text is open: holds what is typed until the field has the focus, and hands
    /// it over then.
    pub fn follow(&mut self, ctx: &egui::Context, is_awaited: bool, now_s: f64) {
        if !is_awaited || now_s - self.since_s > PATIENCE_S {
            self.held.clear();
        }
        if !is_awaited {
            return;
        }
        if ctx.text_edit_focused() {
            let held = std::mem::take(&mut self.held);
            ctx.input_mut(|i| drop(i.events.splice(0..0, held)));
        } else if ctx.memory(|memory| memory.focused().is_none()) {
            let typed = ctx.input_mut(|i| {
                let (typed, others) = std::mem::take(&mut i.events)
                    .into_iter()
                    .partition(is_typing);
                i.events = others;
                typed
            });
            self.add(ctx, typed, now_s);
        }
    }

    fn add(&mut self, ctx: &egui::Context, typed: Vec<Event>, now_s: f64) {
        if self.held.is_empty() {
            self.since_s = now_s;
        }
        self.held.extend(typed);
        if !self.held.is_empty() {
            ctx.request_repaint();
        }
    }
}

/// Is it a character, or a key that edits text? Escape closes the dialog even before it has the
/// focus.
fn is_typing(event: &Event) -> bool {
    match event {
        Event::Text(_) | Event::Paste(_) | Event::Ime(_) => true,
        Event::Key { key, modifiers, .. } => !modifiers.command && *key != egui::Key::Escape,
        _ => false,
    }
}
