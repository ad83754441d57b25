//! Values of parameters and their types: what a parameter may hold, for every way of setting it.

use glam::DVec3;

/// The type of a parameter's value. It decides the control, the TOML form and the checks.
#[derive(Clone, Debug, PartialEq)]
pub enum ValueType {
    /// On or off.
    Bool,
    /// One of these words.
    Choice(Vec<String>),
    U32,
    I32,
    F32,
    F64,
    /// Width and height, each a `u32`.
    Size,
    /// Begin and end, each an `f64`.
    Interval,
    /// A point or direction in world space, three `f32`.
    Point,
    /// A point or direction in world space, three `f64`.
    Position,
    /// Linear RGBA, four `f32`.
    Color,
    /// Text of at most so many characters, without control characters but for line breaks.
    Text {
        max_chars: usize,
    },
    /// A list of such texts.
    TextList {
        max_entries: usize,
        max_chars: usize,
    },
}

impl ValueType {
    /// One of these words.
    pub fn choice(words: &[&str]) -> Self {
        Self::Choice(words.iter().map(|&word| word.into()).collect())
    }

    /// How many numbers a value has; a flag and a choice count as one, a text as none.
    pub const fn components(&self) -> usize {
        match self {
            Self::Bool | Self::Choice(_) | Self::U32 | Self::I32 | Self::F32 | Self::F64 => 1,
            Self::Size | Self::Interval => 2,
            Self::Point | Self::Position => 3,
            Self::Color => 4,
            Self::Text { .. } | Self::TextList { .. } => 0,
        }
    }

    /// What each component is called where they stand side by side; empty for a single one.
    pub const fn component_names(&self) -> &'static [&'static str] {
        match self {
            Self::Size => &["width", "height"],
            Self::Interval => &["begin", "end"],
            Self::Point | Self::Position => &["x", "y", "z"],
            Self::Color => &["red", "green", "blue", "alpha"],
            _ => &[],
        }
    }

    /// Are its numbers stored as `f32`?
    pub const fn is_single(&self) -> bool {
        matches!(self, Self::F32 | Self::Point | Self::Color)
    }

    /// Are its numbers real, so that there is a value between any two?
    pub const fn is_continuous(&self) -> bool {
        self.is_single() || matches!(self, Self::F64 | Self::Interval | Self::Position)
    }

    /// The hard and the soft range of a parameter that states none.
    pub(super) fn default_ranges(&self) -> ([f64; 2], [f64; 2]) {
        let hard = match self {
            Self::Bool | Self::Color => [0.0, 1.0],
            Self::Choice(words) => [0.0, (words.len() - 1) as f64],
            Self::U32 | Self::Size => [0.0, u32::MAX as f64],
            Self::I32 => [i32::MIN as f64, i32::MAX as f64],
            Self::F32 | Self::Point => [-1e6, 1e6],
            Self::F64 | Self::Interval | Self::Position => [-1e9, 1e9],
            Self::Text { .. } | Self::TextList { .. } => [0.0, 0.0],
        };
        let soft = match self {
            Self::F32 | Self::Point => [-1.0, 1.0],
            Self::U32 => [0.0, 100.0],
            Self::I32 => [-100.0, 100.0],
            _ => hard,
        };
        (hard, soft)
    }

    /// The value that these components make: as many as [`ValueType::components`] says. None for
    /// texts.
    pub fn value(&self, components: &[f64]) -> Option<Value> {
        match self {
            Self::Bool => Some(Value::Bool(*components.first()? != 0.0)),
            Self::Choice(_) => Some(Value::Choice(*components.first()? as usize)),
            Self::Text { .. } | Self::TextList { .. } => None,
            _ => Some(Value::Numbers(components.to_vec())),
        }
    }

    /// What the type asks for, to complete "must be …".
    fn expectation(&self) -> String {
        match self {
            Self::Bool => "true or false".into(),
            Self::Choice(words) => format!("one of {}", words.join(", ")),
            Self::Text { .. } => "a text".into(),
            Self::TextList { .. } => "a list of texts".into(),
            _ if self.components() == 1 => "a number".into(),
            _ => format!("a list of {} numbers", self.components()),
        }
    }

    /// Does `value` have this type and lie inside `range`? A value of an f32 type is compared as
    /// f32: a bound such as 0.1 is no f32, and its own rounding is not outside.
    /// Errors: completes a sentence that begins with the parameter's name.
    pub fn check(&self, value: &Value, range: [f64; 2]) -> Result<(), ValueError> {
        match (self, value) {
            (Self::Bool, Value::Bool(_)) => Ok(()),
            (Self::Choice(words), Value::Choice(index)) if *index < words.len() => Ok(()),
            (Self::Text { max_chars }, Value::Text(text)) => check_text(text, *max_chars),
            (
                Self::TextList {
                    max_entries,
                    max_chars,
                },
                Value::TextList(texts),
            ) => {
                if texts.len() > *max_entries {
                    return Err(ValueError::Entries {
                        found: texts.len(),
                        max: *max_entries,
                    });
                }
                texts
                    .iter()
                    .try_for_each(|text| check_text(text, *max_chars))
            }
            (Self::Bool | Self::Choice(_) | Self::Text { .. } | Self::TextList { .. }, _) => {
                Err(self.mismatch(value))
            }
            (_, Value::Numbers(numbers)) if numbers.len() == self.components() => numbers
                .iter()
                .try_for_each(|number| self.check_number(*number, range)),
            _ => Err(self.mismatch(value)),
        }
    }

    fn check_number(&self, number: f64, [low, high]: [f64; 2]) -> Result<(), ValueError> {
        if !self.is_continuous() && number.fract() != 0.0 && number.is_finite() {
            return Err(ValueError::Whole(number));
        }
        let is_inside = if self.is_single() {
            (number as f32).is_finite() && (low as f32..=high as f32).contains(&(number as f32))
        } else {
            (low..=high).contains(&number)
        };
        if is_inside {
            Ok(())
        } else {
            Err(ValueError::Range {
                value: number,
                low,
                high,
            })
        }
    }

    fn mismatch(&self, value: &Value) -> ValueError {
        ValueError::Type {
            expected: self.expectation(),
            found: value.description(),
        }
    }
}

fn check_text(text: &str, max_chars: usize) -> Result<(), ValueError> {
    if text.chars().count() > max_chars {
        return Err(ValueError::Length(max_chars));
    }
    text.chars()
        .find(|c| c.is_control() && *c != '\n')
        .map_or(Ok(()), |control| Err(ValueError::Control(control)))
}

/// A value of a parameter.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Bool(bool),
    /// Index of the word.
    Choice(usize),
    /// The components of a number, size, point or color; every u32, i32 and f32 is an f64, too.
    Numbers(Vec<f64>),
    Text(String),
    TextList(Vec<String>),
}

impl Value {
    pub fn number(number: impl Into<f64>) -> Self {
        Self::Numbers(vec![number.into()])
    }

    /// The value as numbers: a flag is 0 or 1, a choice its index; a text has none.
    pub fn components(&self) -> Vec<f64> {
        match self {
            Self::Bool(on) => vec![f64::from(u8::from(*on))],
            Self::Choice(index) => vec![*index as f64],
            Self::Numbers(numbers) => numbers.clone(),
            Self::Text(_) | Self::TextList(_) => Vec::new(),
        }
    }

    /// What it is, to complete "must be …, not …".
    fn description(&self) -> String {
        match self {
            Self::Bool(_) => "true or false".into(),
            Self::Choice(_) => "a word".into(),
            Self::Numbers(numbers) if numbers.len() == 1 => "a number".into(),
            Self::Numbers(numbers) => format!("a list of {}", numbers.len()),
            Self::Text(_) => "a text".into(),
            Self::TextList(texts) => format!("a list of {}", texts.len()),
        }
    }
}

/// A value that a parameter refuses; completes a sentence that begins with the parameter's name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ValueError {
    #[error("takes {} to {}, not {}", format_number(*low), format_number(*high), format_number(*value))]
    Range { value: f64, low: f64, high: f64 },
    #[error("{} must be a whole number", format_number(*.0))]
    Whole(f64),
    #[error("must be {expected}, not {found}")]
    Type { expected: String, found: String },
    #[error("is longer than {0} characters")]
    Length(usize),
    #[error("has {found} entries; at most {max} are allowed")]
    Entries { found: usize, max: usize },
    #[error("contains the control character {0:?}")]
    Control(char),
    /// A rule of one setting.
    #[error("{0}")]
    Rule(String),
}

/// A number as text: plain, or with an exponent where that is shorter and plain is long.
pub fn format_number(number: f64) -> String {
    let (plain, exponent) = (format!("{number}"), format!("{number:e}"));
    if plain.trim_start_matches('-').len() > 6 && exponent.len() < plain.len() {
        exponent
    } else {
        plain
    }
}

/// A Rust type that a [`Value`] can be stored as.
pub trait Stored: Sized {
    fn to_value(&self) -> Value;

    fn from_value(value: &Value) -> Result<Self, ValueError>;
}

fn mismatch(expected: &str, value: &Value) -> ValueError {
    ValueError::Type {
        expected: expected.into(),
        found: value.description(),
    }
}

impl Stored for bool {
    fn to_value(&self) -> Value {
        Value::Bool(*self)
    }

    fn from_value(value: &Value) -> Result<Self, ValueError> {
        if let Value::Bool(on) = value {
            Ok(*on)
        } else {
            Err(mismatch("true or false", value))
        }
    }
}

impl Stored for String {
    fn to_value(&self) -> Value {
        Value::Text(self.clone())
    }

    fn from_value(value: &Value) -> Result<Self, ValueError> {
        if let Value::Text(text) = value {
            Ok(text.clone())
        } else {
            Err(mismatch("a text", value))
        }
    }
}

impl Stored for Vec<String> {
    fn to_value(&self) -> Value {
        Value::TextList(self.clone())
    }

    fn from_value(value: &Value) -> Result<Self, ValueError> {
        if let Value::TextList(texts) = value {
            Ok(texts.clone())
        } else {
            Err(mismatch("a list of texts", value))
        }
    }
}

/// A number that an f64 holds exactly.
trait Number: Copy {
    fn to_f64(self) -> f64;
    fn from_f64(number: f64) -> Self;
}

macro_rules! numbers {
    ($($number:ty),*) => {$(
        impl Number for $number {
            fn to_f64(self) -> f64 {
                self as f64
            }

            fn from_f64(number: f64) -> Self {
                number as Self
            }
        }

        impl Stored for $number {
            fn to_value(&self) -> Value {
                Value::Numbers(vec![self.to_f64()])
            }

            fn from_value(value: &Value) -> Result<Self, ValueError> {
                <[Self; 1]>::from_value(value).map(|[number]| number)
            }
        }
    )*};
}

numbers![u8, u32, f32, f64];

impl<T: Number, const N: usize> Stored for [T; N] {
    fn to_value(&self) -> Value {
        Value::Numbers(self.iter().map(|number| number.to_f64()).collect())
    }

    fn from_value(value: &Value) -> Result<Self, ValueError> {
        let numbers = if let Value::Numbers(numbers) = value {
            <[f64; N]>::try_from(numbers.as_slice()).ok()
        } else {
            None
        };
        let expected = || {
            if N == 1 {
                "a number".to_owned()
            } else {
                format!("a list of {N} numbers")
            }
        };
        numbers
            .map(|numbers| numbers.map(T::from_f64))
            .ok_or_else(|| mismatch(&expected(), value))
    }
}

impl Stored for DVec3 {
    fn to_value(&self) -> Value {
        self.to_array().to_value()
    }

    fn from_value(value: &Value) -> Result<Self, ValueError> {
        <[f64; 3]>::from_value(value).map(Self::from)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bound_that_is_no_f32_admits_its_own_rounding() {
        let range = [0.1, 0.7];
        for inside in [0.1, f64::from(0.1f32), 0.7, f64::from(0.7f32)] {
            assert_eq!(ValueType::F32.check(&Value::number(inside), range), Ok(()));
        }
        for outside in [0.09, 0.71, f64::NAN, f64::INFINITY, 1e39] {
            assert!(
                ValueType::F32
                    .check(&Value::number(outside), range)
                    .is_err(),
                "{outside}"
            );
        }
        assert!(
            ValueType::F64
                .check(
                    &Value::number(f64::from(0.7f32)),
                    [0.1, f64::from(0.7f32) - 1e-9]
                )
                .is_err()
        );
    }

    #[test]
    fn a_value_of_another_type_is_refused_in_a_sentence() {
        let refused = |value_type: ValueType, value: Value| {
            value_type
                .check(&value, value_type.default_ranges().0)
                .unwrap_err()
                .to_string()
        };
        assert_eq!(
            refused(ValueType::Bool, Value::number(1)),
            "must be true or false, not a number"
        );
        assert_eq!(
            refused(ValueType::Color, Value::number(1)),
            "must be a list of 4 numbers, not a number"
        );
        assert_eq!(
            refused(ValueType::U32, Value::Text("1".into())),
            "must be a number, not a text"
        );
        assert_eq!(
            refused(ValueType::U32, Value::number(1.5)),
            "1.5 must be a whole number"
        );
        assert_eq!(
            refused(ValueType::Text { max_chars: 2 }, Value::Text("abc".into())),
            "is longer than 2 characters"
        );
        assert_eq!(
            <[u32; 2]>::from_value(&Value::number(1))
                .unwrap_err()
                .to_string(),
            "must be a list of 2 numbers, not a number"
        );
    }
}
