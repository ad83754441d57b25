//! Undo and redo: a list of whole states, one per gesture.
//!
//! A change opens a step; the step closes after [`REST_S`] without further change, or when the next
//! gesture begins. A pause in the middle of a drag keeps the step open. The caller passes the time
//! in.

use std::collections::VecDeque;

/// Steps that can be taken back.
pub const CAPACITY: usize = 100;

/// Seconds without a change after which a step is finished.
pub const REST_S: f64 = 0.3;

/// The states of a `T` through time. `T` must equal itself (no NaN), or every frame would look like
/// a change.
#[derive(Clone, Debug)]
pub struct History<T> {
    past: VecDeque<T>,
    /// The state at the last closed step.
    present: T,
    future: Vec<T>,
    open: Option<Open<T>>,
}

/// A step that is still being made.
#[derive(Clone, Debug)]
struct Open<T> {
    latest: T,
    changed_at_s: f64,
}

impl<T: Clone + PartialEq> History<T> {
    pub fn new(state: T) -> Self {
        Self {
            past: VecDeque::new(),
            present: state,
            future: Vec::new(),
            open: None,
        }
    }

    /// Takes the state of this frame at `now_s`; `is_held` while a pointer button is down.
    pub fn observe(&mut self, state: &T, now_s: f64, is_held: bool) {
        let changed = *state
            != *self
                .open
                .as_ref()
                .map_or(&self.present, |open| &open.latest);
        if changed || (is_held && self.open.is_some()) {
            self.open = Some(Open {
                latest: state.clone(),
                changed_at_s: now_s,
            });
        } else if self
            .open
            .as_ref()
            .is_some_and(|open| now_s - open.changed_at_s >= REST_S)
        {
            self.close();
        }
    }

    /// Closes the open step, if any: the next change begins another.
    pub fn close(&mut self) {
        let Some(Open { latest, .. }) = self.open.take() else {
            return;
        };
        if latest == self.present {
            return; // The drag ended where it began.
        }
        self.past
            .push_back(std::mem::replace(&mut self.present, latest));
        self.future.clear();
        if self.past.len() > CAPACITY {
            self.past.pop_front();
        }
    }

    /// The state before the last step.
    pub fn undo(&mut self) -> Option<T> {
        self.close();
        let before = self.past.pop_back()?;
        self.future
            .push(std::mem::replace(&mut self.present, before));
        Some(self.present.clone())
    }

    /// The state before the last undo.
    pub fn redo(&mut self) -> Option<T> {
        self.close();
        let after = self.future.pop()?;
        self.past
            .push_back(std::mem::replace(&mut self.present, after));
        Some(self.present.clone())
    }

    /// Changes every state, so that `change` itself is no step.
    pub fn change_all(&mut self, change: impl Fn(&mut T)) {
        let open = self.open.iter_mut().map(|open| &mut open.latest);
        self.past
            .iter_mut()
            .chain([&mut self.present])
            .chain(&mut self.future)
            .chain(open)
            .for_each(change);
    }

    pub fn can_undo(&self) -> bool {
        !self.past.is_empty()
            || self
                .open
                .as_ref()
                .is_some_and(|open| open.latest != self.present)
    }

    pub fn can_redo(&self) -> bool {
        !self.future.is_empty()
    }

    /// Number of steps that can be taken back, without the open one.
    pub fn steps(&self) -> usize {
        self.past.len()
    }

    /// Seconds until the open step closes if nothing changes; it must be observed again then.
    pub fn wake_in_s(&self, now_s: f64) -> Option<f64> {
        self.open
            .as_ref()
            .map(|open| (open.changed_at_s + REST_S - now_s).max(0.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feeds states a frame apart and lets the last one rest.
    fn gesture(history: &mut History<i32>, clock: &mut f64, states: impl IntoIterator<Item = i32>) {
        let mut last = 0;
        for state in states {
            *clock += 0.016;
            history.observe(&state, *clock, true);
            last = state;
        }
        *clock += REST_S + 0.001;
        history.observe(&last, *clock, false);
    }

    #[test]
    fn one_drag_is_one_step() {
        let (mut history, mut clock) = (History::new(0), 0.0);
        gesture(&mut history, &mut clock, 1..=50);
        assert_eq!(history.steps(), 1);
        assert_eq!(history.undo(), Some(0));
        assert_eq!(history.redo(), Some(50));
    }

    #[test]
    fn a_pause_within_a_drag_does_not_split_it() {
        let mut history = History::new(0);
        history.observe(&1, 0.0, true);
        history.observe(&1, 5.0, true);
        history.observe(&2, 5.1, true);
        history.observe(&2, 5.2, false);
        history.observe(&2, 5.6, false);
        assert_eq!(history.steps(), 1);
        assert_eq!(history.undo(), Some(0));
    }

    #[test]
    fn a_step_closes_by_rest_alone() {
        let mut history = History::new(0);
        history.observe(&1, 1.0, false);
        assert!((history.wake_in_s(1.1).unwrap() - (REST_S - 0.1)).abs() < 1e-12);
        history.observe(&1, 1.0 + REST_S, false);
        assert_eq!((history.steps(), history.wake_in_s(2.0)), (1, None));
    }

    #[test]
    fn undo_takes_back_a_step_that_is_still_open() {
        let mut history = History::new(0);
        history.observe(&1, 0.0, true);
        assert!(history.can_undo());
        assert_eq!(history.undo(), Some(0));
        assert_eq!(history.redo(), Some(1));
    }

    #[test]
    fn a_new_step_forgets_what_was_undone() {
        let (mut history, mut clock) = (History::new(0), 0.0);
        gesture(&mut history, &mut clock, [1]);
        gesture(&mut history, &mut clock, [2]);
        assert_eq!(history.undo(), Some(1));
        gesture(&mut history, &mut clock, [7]);
        assert_eq!(history.redo(), None);
        assert_eq!(history.undo(), Some(1));
    }

    #[test]
    fn a_state_dragged_back_to_where_it_was_is_no_step() {
        let (mut history, mut clock) = (History::new(0), 0.0);
        gesture(&mut history, &mut clock, [1, 2, 1, 0]);
        assert_eq!((history.steps(), history.can_undo()), (0, false));
    }

    #[test]
    fn the_oldest_of_more_than_a_hundred_steps_is_dropped() {
        let (mut history, mut clock) = (History::new(0), 0.0);
        for state in 1..=CAPACITY as i32 + 10 {
            gesture(&mut history, &mut clock, [state]);
        }
        assert_eq!(history.steps(), CAPACITY);
        let oldest = std::iter::from_fn(|| history.undo()).last();
        assert_eq!(oldest, Some(10));
    }
}
