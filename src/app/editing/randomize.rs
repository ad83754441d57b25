//! Random values for the parameters of the enabled effects: how far they vary, which are locked,
//! and the newest ones to go back to.

use std::collections::{BTreeSet, VecDeque};

use crate::{
    effects::{Effect, EnabledEffect, Stack},
    math::hash_unit,
    params::{Field, ValueType},
};

/// Seeds to go back to.
pub const KEPT: usize = 12;

/// The values that a seed gave.
#[derive(Clone, Debug, PartialEq)]
pub struct Seeded {
    pub seed: u32,
    pub stack: Stack,
}

/// Random values: their settings, which are no part of a preset, and the newest of them.
#[derive(Clone, Debug, PartialEq)]
pub struct Randomizer {
    /// How far a value may go from where it is, in percent of its soft range; at 100, anywhere in
    /// that range.
    pub vary_percent: f64,
    /// Effect and parameter.
    locked: BTreeSet<(String, String)>,
    /// The newest first.
    seeds: VecDeque<Seeded>,
    seed: u32,
}

impl Default for Randomizer {
    fn default() -> Self {
        Self {
            vary_percent: 100.0,
            locked: BTreeSet::new(),
            seeds: VecDeque::new(),
            seed: 0,
        }
    }
}

impl Randomizer {
    /// The newest seed; 0 before the first.
    pub fn seed(&self) -> u32 {
        self.seed
    }

    /// The newest seeds with their values, the newest first.
    pub fn seeds(&self) -> impl ExactSizeIterator<Item = &Seeded> {
        self.seeds.iter()
    }

    pub fn is_locked(&self, effect: &Effect, field: &Field) -> bool {
        self.locked
            .iter()
            .any(|(of, name)| *of == effect.name && *name == field.name)
    }

    /// Keeps a parameter as it is, or lets it vary again.
    pub fn lock(&mut self, effect: &Effect, field: &Field, is_locked: bool) {
        let name = (effect.name.clone(), field.name.clone());
        let _ = if is_locked {
            self.locked.insert(name)
        } else {
            self.locked.remove(&name)
        };
    }

    /// Gives every parameter of `stack` that is neither locked nor `animated` a random value, and
    /// remembers them. Returns the seed.
    pub fn randomize(
        &mut self,
        stack: &mut Stack,
        animated: impl Fn(&Effect, &Field) -> bool,
    ) -> u32 {
        self.seed = self.seed.wrapping_add(1);
        for EnabledEffect { effect, words, .. } in &mut stack.0 {
            for field in effect
                .fields
                .iter()
                .filter(|field| !self.is_locked(effect, field) && !animated(effect, field))
            {
                let values = random_values(
                    effect,
                    field,
                    &field.get(words),
                    self.seed,
                    self.vary_percent / 100.0,
                );
                // The soft range lies within the hard one, so this is never refused.
                let _ = field.set(words, &values);
            }
        }
        self.seeds.push_front(Seeded {
            seed: self.seed,
            stack: stack.clone(),
        });
        self.seeds.truncate(KEPT);
        self.seed
    }

    /// Gives the effects of `stack` the values of a seed again; effects that are new since then
    /// keep theirs. Returns false if the seed is not among the newest.
    pub fn recall(&self, stack: &mut Stack, seed: u32) -> bool {
        let Some(seeded) = self.seeds.iter().find(|seeded| seeded.seed == seed) else {
            return false;
        };
        for enabled in &mut stack.0 {
            let then = seeded
                .stack
                .0
                .iter()
                .find(|then| then.effect == enabled.effect);
            if let Some(then) = then {
                enabled.words.clone_from(&then.words);
            }
        }
        true
    }
}

/// The range of a component that is at `now` and may go so far, as a fraction of its soft range.
fn reach(now: f64, [low, high]: [f64; 2], fraction: f64) -> [f64; 2] {
    if fraction >= 1.0 || !now.is_finite() {
        return [low, high];
    }
    let far = fraction * (high - low);
    let reach = [(now - far).max(low), (now + far).min(high)];
    // From beyond the soft range a value goes no farther from it.
    if reach[0] <= reach[1] {
        reach
    } else {
        [now, now]
    }
}

/// One random number per component, from the seed and the parameter's name, so that the order does
/// not matter.
fn random_values(
    effect: &Effect,
    field: &Field,
    now: &[f64],
    seed: u32,
    fraction: f64,
) -> Vec<f64> {
    let salt = effect
        .name
        .bytes()
        .chain(field.name.bytes())
        .fold(seed.wrapping_mul(0x9e37_79b9), |h, b| {
            h.rotate_left(5) ^ u32::from(b)
        });
    let value = |(component, &now): (usize, &f64)| {
        let salt = salt.wrapping_add((component as u32).wrapping_mul(0x85eb_ca6b));
        let t = hash_unit(salt);
        let [from, to] = field.soft;
        match field.value_type {
            ValueType::Color if component == 3 => {
                if fraction >= 1.0 {
                    1.0
                } else {
                    now
                }
            }
            // There is no way from one word to another: a part of the words changes.
            ValueType::Bool | ValueType::Choice(_) if hash_unit(salt ^ 0x5bd1_e995) >= fraction => {
                now
            }
            ValueType::Bool | ValueType::Choice(_) => {
                (from + t * (to - from + 1.0)).floor().min(to)
            }
            ValueType::U32 | ValueType::I32 => {
                let [from, to] = reach(now, [from, to], fraction);
                let [from, to] = if from == to {
                    [now, now]
                } else {
                    [from.ceil(), to.floor()]
                };
                (from + t * (to - from + 1.0))
                    .floor()
                    .clamp(from, to.max(from))
            }
            ValueType::F32 if field.log && from > 0.0 && now > 0.0 => {
                let [from, to] = reach(now.ln(), [from.ln(), to.ln()], fraction);
                (from + t * (to - from))
                    .exp()
                    .clamp(field.soft[0].min(now), field.soft[1].max(now))
            }
            ValueType::F32 if field.log && from > 0.0 => from * (to / from).powf(t),
            _ => {
                let [from, to] = reach(now, [from, to], fraction);
                from + t * (to - from)
            }
        }
    };
    now.iter().enumerate().map(value).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::EFFECTS;

    fn everything() -> Vec<Stack> {
        EFFECTS
            .iter()
            .map(|effect| Stack(vec![EnabledEffect::new(effect)]))
            .collect()
    }

    fn draw_values(stack: &Stack, randomizer: &mut Randomizer) -> Stack {
        let mut stack = stack.clone();
        randomizer.randomize(&mut stack, |_, _| false);
        stack
    }

    #[test]
    fn values_stay_in_their_soft_range_and_depend_on_the_seed_alone() {
        for stack in everything() {
            let name = &stack.0[0].effect.name;
            let [mut a, mut b] = [Randomizer::default(), Randomizer::default()];
            let first = draw_values(&stack, &mut a);
            assert_eq!(first, draw_values(&stack, &mut b), "{name}");
            let second = draw_values(&first, &mut a);
            // One flag alone may well be the same twice.
            let mut further = Randomizer::default();
            let is_varied = (0..24)
                .map(|_| draw_values(&stack, &mut further))
                .any(|other| other != first);
            assert!(is_varied || stack.0[0].effect.fields.is_empty(), "{name}");
            // At 100 % it does not matter where a value was.
            assert_eq!(second, draw_values(&stack, &mut b), "{name}");
            for enabled in &second.0 {
                for field in &enabled.effect.fields {
                    let [from, to] = field.soft;
                    assert!(
                        field
                            .get(&enabled.words)
                            .iter()
                            .all(|v| (from..=to).contains(v)),
                        "{name}.{}",
                        field.name
                    );
                }
            }
        }
    }

    #[test]
    fn values_vary_around_where_they_are() {
        for stack in everything() {
            let mut randomizer = Randomizer {
                vary_percent: 5.0,
                ..Randomizer::default()
            };
            let mut from_words_changed = 0;
            for _ in 0..40 {
                let after = draw_values(&stack, &mut randomizer);
                let (before, after) = (&stack.0[0], &after.0[0]);
                for field in &before.effect.fields {
                    let (was, is) = (field.get(&before.words), field.get(&after.words));
                    if matches!(field.value_type, ValueType::Bool | ValueType::Choice(_)) {
                        from_words_changed += usize::from(was != is);
                        continue;
                    }
                    let [low, high] = field.soft;
                    for (was, is) in was.iter().zip(&is) {
                        // Whole numbers vary evenly.
                        let is_log = field.log && field.value_type == ValueType::F32;
                        let distance = if is_log && low > 0.0 && *was > 0.0 {
                            (is / was).ln().abs() / (high / low).ln()
                        } else {
                            (is - was).abs() / (high - low)
                        };
                        assert!(
                            distance <= 0.0501,
                            "{}.{}: {was} to {is}",
                            before.effect.name,
                            field.name
                        );
                    }
                }
            }
            let words = stack.0[0]
                .effect
                .fields
                .iter()
                .filter(|f| matches!(f.value_type, ValueType::Bool | ValueType::Choice(_)))
                .count();
            assert!(
                from_words_changed <= 40 * words / 4,
                "{}: {from_words_changed} words changed",
                stack.0[0].effect.name
            );
        }
    }

    #[test]
    fn what_is_locked_or_animated_stays() {
        let facet = Effect::find("facet").expect("an effect");
        let stack = Stack(vec![EnabledEffect::new(facet)]);
        let mut randomizer = Randomizer::default();
        let [amount, width] =
            ["amount", "width"].map(|name| facet.field(name).expect("a parameter"));
        randomizer.lock(facet, amount, true);
        let mut after = stack.clone();
        randomizer.randomize(&mut after, |effect, field| {
            (effect.name.as_str(), field.name.as_str()) == ("facet", "width")
        });
        let same = |field: &Field| field.get(&stack.0[0].words) == field.get(&after.0[0].words);
        assert!(same(amount) && same(width) && after != stack);
        randomizer.lock(facet, amount, false);
        randomizer.randomize(&mut after, |_, _| false);
        assert_ne!(amount.get(&stack.0[0].words), amount.get(&after.0[0].words));
    }

    #[test]
    fn the_last_twelve_seeds_can_be_recalled() {
        let [facet, fog] =
            ["facet", "fog"].map(|name| EnabledEffect::new(Effect::find(name).expect("an effect")));
        let mut randomizer = Randomizer::default();
        let mut stack = Stack(vec![facet]);
        let history: Vec<Stack> = (0..15)
            .map(|_| {
                stack = draw_values(&stack, &mut randomizer);
                stack.clone()
            })
            .collect();
        assert_eq!(
            randomizer
                .seeds()
                .map(|seeded| seeded.seed)
                .collect::<Vec<_>>(),
            (4..=15).rev().collect::<Vec<_>>()
        );
        assert!(randomizer.recall(&mut stack, 6) && stack == history[5]);
        assert!(!randomizer.recall(&mut stack, 3) && stack == history[5]);
        stack.0.push(fog.clone());
        assert!(randomizer.recall(&mut stack, 9));
        assert_eq!(
            (&stack.0[0], &stack.0[1]),
            (&history[8].0[0], &fog),
            "an effect that is new keeps its values"
        );
    }
}
