//! Animation: parameters that follow the clock by keyframes.
//!
//! A [`Track`] holds the keyframes of one parameter, sorted by time, each time once, every value
//! inside the hard range of its field. Before the first and after the last keyframe its value
//! holds. All arithmetic is f64, and the result is clamped before it is rounded to the parameter's
//! type, so that a track gives only values that a file may have.

use std::{fmt, sync::Arc};

use crate::{
    effects::{
        Effect, Stack,
        particles::{self, affects_only_appearance},
    },
    params::{Field, ValueError, format_number},
};

/// Largest number of keyframes of a track.
pub const MAX_KEYFRAMES: usize = 256;

/// Largest absolute time of a keyframe, seconds; as for `clock.time_s`.
pub const MAX_TIME_S: f64 = 1e9;

/// How a value goes from its keyframe to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Easing {
    Hold,
    Linear,
    /// Starts and ends at rest: 3 s² - 2 s³, the smoothstep.
    #[default]
    Smooth,
    /// Starts at rest: s².
    In,
    /// Ends at rest: s (2 - s).
    Out,
}

impl Easing {
    pub const ALL: [Self; 5] = [Self::Hold, Self::Linear, Self::Smooth, Self::In, Self::Out];

    /// The word in presets and menus.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hold => "hold",
            Self::Linear => "linear",
            Self::Smooth => "smooth",
            Self::In => "in",
            Self::Out => "out",
        }
    }

    /// A description for menus.
    pub const fn about(self) -> &'static str {
        match self {
            Self::Hold => "stays, then jumps",
            Self::Linear => "at one speed",
            Self::Smooth => "starts slowly and ends slowly",
            Self::In => "starts slowly",
            Self::Out => "ends slowly",
        }
    }

    /// The eased fraction, 0 to 1, for the fraction `s` of the time between two keyframes, 0 to 1.
    pub fn ease(self, s: f64) -> f64 {
        match self {
            Self::Hold => 0.0,
            Self::Linear => s,
            Self::Smooth => s * s * (3.0 - 2.0 * s),
            Self::In => s * s,
            Self::Out => s * (2.0 - s),
        }
    }
}

/// A value at a time.
#[derive(Clone, Debug, PartialEq)]
pub struct Keyframe {
    pub time_s: f64,
    /// The components of the value, rounded as the field stores them; a flag is 0 or 1, a choice
    /// its index.
    pub value: Vec<f64>,
    /// How the value goes to the next keyframe.
    pub easing: Easing,
}

/// Why a keyframe is refused.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum KeyframeError {
    #[error("value {0}")]
    Value(#[from] ValueError),
    #[error("time_s takes -1e9 to 1e9, not {}", format_number(*.0))]
    Time(f64),
    #[error("there is already a keyframe at time_s {0}")]
    Taken(f64),
    #[error("a parameter has 1 to {MAX_KEYFRAMES} keyframes, not {0}")]
    Count(usize),
    #[error(
        "easing must be hold, not {0}: whole numbers, flags and words have no values in between"
    )]
    Steps(&'static str),
}

/// The keyframes of one parameter of one effect; at least one.
#[derive(Clone)]
pub struct Track {
    effect: Arc<Effect>,
    field: Arc<Field>,
    keys: Vec<Keyframe>,
}

impl PartialEq for Track {
    fn eq(&self, other: &Self) -> bool {
        self.effect == other.effect
            && self.field.name == other.field.name
            && self.keys == other.keys
    }
}

impl fmt::Debug for Track {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} {:?}", self.path(), self.keys)
    }
}

impl Track {
    /// A track with these keyframes, in any order.
    /// Errors: no keyframe or more than [`MAX_KEYFRAMES`]; a time that occurs twice or lies outside
    /// ±[`MAX_TIME_S`]; a value that the field refuses; an easing other than hold for a field
    /// without fractions.
    pub fn new(
        effect: &Arc<Effect>,
        field: &Arc<Field>,
        keys: Vec<Keyframe>,
    ) -> Result<Self, KeyframeError> {
        if keys.is_empty() || keys.len() > MAX_KEYFRAMES {
            return Err(KeyframeError::Count(keys.len()));
        }
        let mut track = Self {
            effect: effect.clone(),
            field: field.clone(),
            keys: Vec::with_capacity(keys.len()),
        };
        for key in keys {
            if track.at(key.time_s).is_some() {
                return Err(KeyframeError::Taken(key.time_s));
            }
            track.set(key)?;
        }
        Ok(track)
    }

    pub fn effect(&self) -> &Arc<Effect> {
        &self.effect
    }

    pub fn field(&self) -> &Arc<Field> {
        &self.field
    }

    /// Sorted by time.
    pub fn keys(&self) -> &[Keyframe] {
        &self.keys
    }

    /// `facet.front`.
    pub fn path(&self) -> String {
        format!("{}.{}", self.effect.name, self.field.name)
    }

    /// Does the track change the steps of the particle simulation, so that their history counts?
    pub(super) fn changes_simulation(&self) -> bool {
        self.effect == *particles::EFFECT
            && self.keys.len() > 1
            && !affects_only_appearance(&self.field)
    }

    /// Index of the keyframe at exactly this time.
    pub fn at(&self, time_s: f64) -> Option<usize> {
        self.keys.iter().position(|key| key.time_s == time_s)
    }

    /// Adds a keyframe, or replaces the one at its time.
    /// Errors: as [`Track::new`]; then nothing is changed.
    pub fn set(&mut self, key: Keyframe) -> Result<(), KeyframeError> {
        let key = check_key(&self.effect, &self.field, key)?;
        match self.at(key.time_s) {
            Some(index) => self.keys[index] = key,
            None if self.keys.len() >= MAX_KEYFRAMES => {
                return Err(KeyframeError::Count(self.keys.len() + 1));
            }
            None => {
                let index = self.keys.partition_point(|other| other.time_s < key.time_s);
                self.keys.insert(index, key);
            }
        }
        Ok(())
    }

    /// Moves a keyframe in time and returns its new index. It stays where it is if there is a
    /// keyframe at `time_s` already, or if that is out of range.
    pub fn move_keyframe(&mut self, index: usize, time_s: f64) -> usize {
        let is_free = self.at(time_s).is_none() && time_s.abs() <= MAX_TIME_S;
        if !is_free || index >= self.keys.len() {
            return index;
        }
        let key = Keyframe {
            time_s,
            ..self.keys.remove(index)
        };
        let index = self.keys.partition_point(|other| other.time_s < time_s);
        self.keys.insert(index, key);
        index
    }

    /// Changes the easing of a keyframe; a field without fractions keeps hold.
    pub fn set_easing(&mut self, index: usize, easing: Easing) {
        if let Some(key) = self.keys.get_mut(index).filter(|_| !steps(&self.field)) {
            key.easing = easing;
        }
    }

    /// The track without one keyframe; none when that was the last.
    pub fn without(mut self, index: usize) -> Option<Self> {
        if index < self.keys.len() {
            self.keys.remove(index);
        }
        (!self.keys.is_empty()).then_some(self)
    }

    /// Components of the value at `time_s`: finite and inside the hard range for every time.
    pub fn value_at(&self, time_s: f64) -> Vec<f64> {
        let next = self.keys.partition_point(|key| key.time_s <= time_s);
        let (Some(a), Some(b)) = (
            next.checked_sub(1).map(|before| &self.keys[before]),
            self.keys.get(next),
        ) else {
            return self.keys[next.min(self.keys.len() - 1)].value.clone();
        };
        let fraction = ((time_s - a.time_s) / (b.time_s - a.time_s)).clamp(0.0, 1.0);
        let done = a.easing.ease(fraction);
        if done == 0.0 {
            return a.value.clone(); // Keeps the sign of -0.0, which -0.0 + 0.0 loses.
        }
        let [low, high] = self.field.hard;
        a.value
            .iter()
            .zip(&b.value)
            .map(|(a, b)| (a + (b - a) * done).clamp(low, high))
            .collect()
    }

    /// Writes the value at `time_s` into an effect's words.
    fn evaluate(&self, words: &mut [u32], time_s: f64) {
        let result = self.field.set(words, &self.value_at(time_s));
        debug_assert!(result.is_ok(), "{self:?} at {time_s}: {result:?}");
    }
}

/// Does a field jump from keyframe to keyframe, since it has no values in between?
pub fn steps(field: &Field) -> bool {
    !field.value_type.is_continuous()
}

/// The easing of a keyframe of `field` whose file has none.
pub fn default_easing(field: &Field) -> Easing {
    if steps(field) {
        Easing::Hold
    } else {
        Easing::default()
    }
}

/// The keyframe with its value rounded as the field stores it.
fn check_key(effect: &Effect, field: &Field, key: Keyframe) -> Result<Keyframe, KeyframeError> {
    let Keyframe {
        time_s,
        value,
        easing,
    } = key;
    // -0 and 0 are one time.
    let time_s = time_s + 0.0;
    if !(-MAX_TIME_S..=MAX_TIME_S).contains(&time_s) {
        return Err(KeyframeError::Time(time_s));
    }
    if steps(field) && easing != Easing::Hold {
        return Err(KeyframeError::Steps(easing.name()));
    }
    let mut words = effect.defaults.clone();
    field.set(&mut words, &value)?;
    Ok(Keyframe {
        time_s,
        value: field.get(&words),
        easing,
    })
}

/// The tracks of a preset, one per parameter, in the order of effects and fields.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Animation(Vec<Track>);

impl Animation {
    pub fn tracks(&self) -> &[Track] {
        &self.0
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    pub fn get(&self, effect: &str, field: &str) -> Option<&Track> {
        self.0
            .iter()
            .find(|track| track.effect.name == effect && track.field.name == field)
    }

    pub fn get_mut(&mut self, effect: &str, field: &str) -> Option<&mut Track> {
        self.0
            .iter_mut()
            .find(|track| track.effect.name == effect && track.field.name == field)
    }

    /// Adds a track, in place of one of the same parameter.
    pub fn put(&mut self, track: Track) {
        fn rank(track: &Track) -> (usize, &str, usize) {
            (track.effect.rank(), &track.effect.name, track.field.offset)
        }
        match self
            .0
            .binary_search_by(|other| rank(other).cmp(&rank(&track)))
        {
            Ok(index) => self.0[index] = track,
            Err(index) => self.0.insert(index, track),
        }
    }

    /// Removes the track of one parameter.
    pub fn remove(&mut self, effect: &str, field: &str) {
        self.0
            .retain(|track| track.effect.name != effect || track.field.name != field);
    }

    /// The tracks for which `is_kept` is true.
    pub fn only(&self, is_kept: impl Fn(&Track) -> bool) -> Self {
        Self(
            self.0
                .iter()
                .filter(|track| is_kept(track))
                .cloned()
                .collect(),
        )
    }

    /// Removes every track of an effect.
    pub fn remove_effect(&mut self, effect: &str) {
        self.0.retain(|track| track.effect.name != effect);
    }

    /// `stack` with the values at `time_s`. Tracks of effects that are not enabled do nothing.
    pub fn evaluate(&self, stack: &Stack, time_s: f64) -> Stack {
        let mut evaluated = stack.clone();
        for enabled in &mut evaluated.0 {
            enabled.words = self.evaluate_words(&enabled.effect.name, &enabled.words, time_s);
        }
        evaluated
    }

    /// The parameter words of one effect at `time_s`; `words` has the values that are not animated.
    pub fn evaluate_words(&self, effect: &str, words: &[u32], time_s: f64) -> Vec<u32> {
        let mut evaluated = words.to_vec();
        self.0
            .iter()
            .filter(|track| track.effect.name == effect)
            .for_each(|track| track.evaluate(&mut evaluated, time_s));
        evaluated
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn field<'a>(effect: &'a Effect, name: &str) -> &'a Arc<Field> {
        effect.field(name).expect("a field of the effect")
    }

    fn key(time_s: f64, value: f64, easing: Easing) -> Keyframe {
        Keyframe {
            time_s,
            value: vec![value],
            easing,
        }
    }

    fn amount(keys: &[(f64, f64, Easing)]) -> Track {
        let keys = keys
            .iter()
            .map(|&(time_s, value, easing)| key(time_s, value, easing))
            .collect();
        Track::new(
            Effect::named("facet"),
            field(Effect::named("facet"), "amount"),
            keys,
        )
        .expect("sound keys")
    }

    #[test]
    fn outside_its_keys_the_nearest_one_holds() {
        let track = amount(&[(2.0, 0.75, Easing::Linear), (1.0, 0.25, Easing::Linear)]);
        for (time_s, wanted) in [
            (-1e9, 0.25),
            (1.0, 0.25),
            (1.5, 0.5),
            (2.0, 0.75),
            (1e9, 0.75),
            (f64::INFINITY, 0.75),
        ] {
            assert_eq!(track.value_at(time_s), [wanted], "{time_s}");
        }
        assert!(track.value_at(f64::NAN)[0].is_finite());
    }

    #[test]
    fn every_easing_rises_from_key_to_key_and_meets_both() {
        for easing in Easing::ALL {
            let track = amount(&[(0.0, 0.0, easing), (1.0, 1.0, Easing::Hold)]);
            let values: Vec<f64> = (0..=1000)
                .map(|i| track.value_at(f64::from(i) / 1000.0)[0])
                .collect();
            assert!(
                values.is_sorted() && values[0] == 0.0 && values[1000] == 1.0,
                "{easing:?}"
            );
            let middle = [0.0, 0.5, 0.5, 0.25, 0.75][easing as usize];
            assert_eq!(values[500], middle, "{easing:?}");
        }
    }

    #[test]
    fn values_without_fractions_hold() {
        let keys = vec![key(0.0, 3.0, Easing::Hold), key(1.0, 9.0, Easing::Hold)];
        let track = Track::new(
            Effect::named("facet"),
            field(Effect::named("facet"), "seed"),
            keys.clone(),
        )
        .expect("sound keys");
        assert_eq!(
            (track.value_at(0.999), track.value_at(1.0)),
            (vec![3.0], vec![9.0])
        );
        let smooth = Track::new(
            Effect::named("facet"),
            field(Effect::named("facet"), "seed"),
            vec![key(0.0, 3.0, Easing::Smooth)],
        );
        assert_eq!(smooth, Err(KeyframeError::Steps("smooth")));
    }

    #[test]
    fn what_no_file_could_say_no_track_holds() {
        let new = |keys| {
            Track::new(
                Effect::named("facet"),
                field(Effect::named("facet"), "amount"),
                keys,
            )
        };
        assert_eq!(new(vec![]), Err(KeyframeError::Count(0)));
        let many = (0..=MAX_KEYFRAMES as u32)
            .map(|i| key(i.into(), 0.0, Easing::Linear))
            .collect();
        assert_eq!(new(many), Err(KeyframeError::Count(MAX_KEYFRAMES + 1)));
        assert_eq!(
            new(vec![
                key(0.0, 0.0, Easing::Hold),
                key(-0.0, 1.0, Easing::Hold)
            ]),
            Err(KeyframeError::Taken(-0.0))
        );
        for time_s in [f64::NAN, f64::INFINITY, -1.1e9] {
            assert!(
                matches!(
                    new(vec![key(time_s, 0.0, Easing::Hold)]),
                    Err(KeyframeError::Time(_))
                ),
                "{time_s}"
            );
        }
        for value in [f64::NAN, 1.5, -0.1] {
            assert!(
                matches!(
                    new(vec![key(0.0, value, Easing::Hold)]),
                    Err(KeyframeError::Value(_))
                ),
                "{value}"
            );
        }
    }

    #[test]
    fn all_lanes_move_together_and_other_fields_stay() {
        let lambert = Effect::named("lambert");
        let sun = field(lambert, "sun");
        let keys = [
            (0.0, vec![0.0, 0.5, 1.0, 1.0]),
            (2.0, vec![1.0, 0.5, 0.0, 1.0]),
        ];
        let keys = keys
            .map(|(time_s, value)| Keyframe {
                time_s,
                value,
                easing: Easing::Linear,
            })
            .to_vec();
        let animation = Animation(vec![Track::new(lambert, sun, keys).expect("sound keys")]);
        let mut stack = Stack::default();
        stack.enable(lambert);
        let posed = animation.evaluate(&stack, 0.5);
        assert_eq!(sun.get(&posed.0[0].words), [0.25, 0.5, 0.75, 1.0]);
        let untouched = lambert.fields.iter().filter(|field| field.name != "sun");
        untouched.for_each(|field| {
            assert!(
                field.same(&posed.0[0].words, &stack.0[0].words),
                "{}",
                field.name
            )
        });
        assert_eq!(
            animation.evaluate(&Stack::default(), 0.5),
            Stack::default(),
            "a track enables nothing"
        );
    }

    #[test]
    fn a_key_moves_past_others_and_never_onto_one() {
        let mut track = amount(&[
            (0.0, 0.0, Easing::Hold),
            (1.0, 0.5, Easing::Hold),
            (2.0, 1.0, Easing::Hold),
        ]);
        assert_eq!(track.move_keyframe(0, 1.5), 1);
        assert_eq!(
            track
                .keys()
                .iter()
                .map(|key| key.time_s)
                .collect::<Vec<_>>(),
            [1.0, 1.5, 2.0]
        );
        assert_eq!(track.move_keyframe(0, 2.0), 0, "taken");
        assert_eq!(track.move_keyframe(0, f64::NAN), 0);
        let track = track
            .without(0)
            .and_then(|track| track.without(0))
            .expect("one key is left");
        assert_eq!(track.keys().len(), 1);
        assert!(track.without(0).is_none());
    }
}
