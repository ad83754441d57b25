//! Forms: what a key may hold, how TOML says it, and how it is written so that it reads back to the bit.
//!
//! Floats are written as the shortest decimal that reads back to the same f32 (or f64), read in their own precision,
//! and refused when they would silently become infinite or zero.

use toml_edit::Value as TomlValue;

use crate::params::{Field, Kind};

/// How exactly a number is kept.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Precision {
    Single,
    Double,
    /// No fraction.
    Whole,
}

/// What a key holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ValueType {
    /// A line or paragraph of at most so many characters, without control characters.
    Text { longest: usize },
    /// A list of such texts.
    Texts { most: usize, longest: usize },
    /// true or false.
    Flag,
    /// One of these words.
    Word(&'static [&'static str]),
    /// One number, or an array of `lanes`.
    Numbers { lanes: usize, low: f64, high: f64, precision: Precision },
}

/// A value in its form: a flag is 0 or 1, a word its index.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    Text(String),
    Texts(Vec<String>),
    Numbers(Vec<f64>),
}

impl Value {
    pub fn number(value: impl Into<f64>) -> Self {
        Self::Numbers(vec![value.into()])
    }

    /// The text of a `ValueType::Text`.
    pub fn into_text(self) -> String {
        match self {
            Self::Text(text) => text,
            other => unreachable!("{other:?} is no text"),
        }
    }

    /// The list of a `ValueType::Texts`.
    pub fn into_texts(self) -> Vec<String> {
        match self {
            Self::Texts(texts) => texts,
            other => unreachable!("{other:?} is no list of texts"),
        }
    }

    /// The lanes of a number, flag or word.
    pub fn lanes<const N: usize>(&self) -> [f64; N] {
        match self {
            Self::Numbers(lanes) => std::array::from_fn(|i| lanes[i]),
            other => unreachable!("{other:?} is no number"),
        }
    }

    pub fn first(&self) -> f64 {
        self.lanes::<1>()[0]
    }
}

impl ValueType {
    /// One number in double precision.
    pub const fn number(low: f64, high: f64) -> Self {
        Self::Numbers { lanes: 1, low, high, precision: Precision::Double }
    }

    /// `lanes` whole numbers.
    pub const fn whole(lanes: usize, high: f64) -> Self {
        Self::Numbers { lanes, low: 0.0, high, precision: Precision::Whole }
    }

    /// The form of an effect's parameter.
    pub fn of(field: &Field) -> Self {
        let [low, high] = field.hard;
        match field.kind {
            Kind::Bool => Self::Flag,
            Kind::Choice(words) => Self::Word(words),
            Kind::F32 | Kind::Color | Kind::Point => Self::Numbers { lanes: field.kind.lanes(), low, high, precision: Precision::Single },
            Kind::U32 | Kind::I32 => Self::Numbers { lanes: 1, low, high, precision: Precision::Whole },
        }
    }

    /// Reads a TOML value; `raw` gives the text of a float as it was written. The error completes a sentence that begins with the key.
    pub fn read(&self, value: &TomlValue, raw: &dyn Fn(&TomlValue) -> String) -> Result<Value, String> {
        match *self {
            Self::Text { longest } => Ok(Value::Text(text(value, longest)?)),
            Self::Texts { most, longest } => {
                let list = value.as_array().ok_or_else(|| format!("must be a list of texts, not {}", kind_of(value)))?;
                if list.len() > most {
                    return Err(format!("has {} entries; at most {most} are allowed", list.len()));
                }
                list.iter().map(|entry| text(entry, longest)).collect::<Result<_, _>>().map(Value::Texts)
            }
            Self::Flag => value.as_bool().map(Value::number).ok_or_else(|| format!("must be true or false, not {}", kind_of(value))),
            Self::Word(words) => word(value, words),
            Self::Numbers { lanes: 1, low, high, precision } => number(value, &raw(value), [low, high], precision).map(Value::number),
            Self::Numbers { lanes, low, high, precision } => {
                let list = value.as_array().filter(|list| list.len() == lanes);
                let list = list.ok_or_else(|| format!("must be a list of {lanes} numbers, not {}", kind_of(value)))?;
                list.iter().map(|v| number(v, &raw(v), [low, high], precision)).collect::<Result<_, _>>().map(Value::Numbers)
            }
        }
    }

    /// The TOML value that [`ValueType::read`] takes back to the same bits.
    pub fn write(&self, plain: &Value) -> TomlValue {
        match (self, plain) {
            (_, Value::Text(text)) => text.as_str().into(),
            (_, Value::Texts(texts)) => texts.iter().map(String::as_str).collect(),
            (Self::Flag, plain) => (plain.first() != 0.0).into(),
            (Self::Word(words), plain) => words[plain.first() as usize].into(),
            (Self::Numbers { precision, .. }, Value::Numbers(lanes)) => match lanes[..] {
                [single] => numeral(single, *precision),
                _ => lanes.iter().map(|&lane| numeral(lane, *precision)).collect(),
            },
            (form, plain) => unreachable!("{plain:?} is not of the form {form:?}"),
        }
    }

    /// What is allowed, for listings: `0..=1`, `smooth | flat`, `4 numbers, each 0..=1`.
    pub fn allowed(&self) -> String {
        match *self {
            Self::Text { longest } => format!("text, at most {longest} characters"),
            Self::Texts { most, longest } => format!("at most {most} texts of {longest} characters"),
            Self::Flag => "true | false".into(),
            Self::Word(words) => words.join(" | "),
            Self::Numbers { lanes: 1, low, high, .. } => format!("{}..={}", format_number(low), format_number(high)),
            Self::Numbers { lanes, low, high, .. } => format!("{lanes} numbers, each {}..={}", format_number(low), format_number(high)),
        }
    }
}

/// A number for people: plain or with an exponent, whichever is shorter.
pub fn format_number(value: f64) -> String {
    let (plain, exponent) = (format!("{value}"), format!("{value:e}"));
    if exponent.len() < plain.len() { exponent } else { plain }
}

/// The shortest decimal that reads back to this value, as TOML.
fn numeral(value: f64, precision: Precision) -> TomlValue {
    let shortest = match precision {
        Precision::Whole => return (value as i64).into(),
        Precision::Single => format!("{:?}", value as f32),
        Precision::Double => format!("{value:?}"),
    };
    shortest.parse().unwrap_or_else(|_| value.into())
}

fn number(value: &TomlValue, raw: &str, [low, high]: [f64; 2], precision: Precision) -> Result<f64, String> {
    let as_written = match value {
        TomlValue::Integer(integer) if integer.value().unsigned_abs() <= 1 << 53 => *integer.value() as f64,
        TomlValue::Integer(integer) => return Err(format!("{} is too large", integer.value())),
        TomlValue::Float(float) => *float.value(),
        other => return Err(format!("must be a number, not {}", kind_of(other))),
    };
    if !as_written.is_finite() {
        return Err(format!("{raw} is not a finite number"));
    }
    if precision == Precision::Whole && as_written.fract() != 0.0 {
        return Err(format!("{raw} must be a whole number"));
    }
    let kept = if precision == Precision::Single { single(as_written, raw)? } else { as_written };
    if !(low..=high).contains(&kept) {
        return Err(format!("{raw} lies outside {}..={}", format_number(low), format_number(high)));
    }
    Ok(kept)
}

/// The f32 nearest to what is written, rounded once, as f64.
fn single(as_written: f64, raw: &str) -> Result<f64, String> {
    let nearest = raw.replace('_', "").parse().unwrap_or(as_written as f32);
    if nearest.is_infinite() {
        return Err(format!("{raw} is too large for a 32-bit float, which ends at 3.4028235e38"));
    }
    if nearest == 0.0 && as_written != 0.0 {
        return Err(format!("{raw} is too small for a 32-bit float, which would make it 0"));
    }
    // A bound such as 0.1 is no f32: the decimal decides unless it was rounded twice on its way through f64.
    Ok(if as_written as f32 == nearest { as_written } else { f64::from(nearest) })
}

fn text(value: &TomlValue, longest: usize) -> Result<String, String> {
    let text = value.as_str().ok_or_else(|| format!("must be a text in quotes, not {}", kind_of(value)))?;
    if text.chars().count() > longest {
        return Err(format!("is longer than {longest} characters"));
    }
    match text.chars().find(|c| c.is_control() && *c != '\n') {
        Some(control) => Err(format!("contains the control character {control:?}")),
        None => Ok(text.to_owned()),
    }
}

fn word(value: &TomlValue, words: &'static [&'static str]) -> Result<Value, String> {
    let written = value.as_str().ok_or_else(|| format!("must be one of {}, not {}", words.join(", "), kind_of(value)))?;
    match words.iter().position(|word| *word == written) {
        Some(index) => Ok(Value::number(index as u32)),
        None => Err(format!("{written:?} is not one of {}{}", words.join(", "), did_you_mean(written, words.iter().copied()))),
    }
}

fn kind_of(value: &TomlValue) -> String {
    match value {
        TomlValue::Array(list) => format!("a list of {}", list.len()),
        TomlValue::InlineTable(_) => "a table".into(),
        TomlValue::String(_) => "a text".into(),
        TomlValue::Boolean(_) => "true or false".into(),
        TomlValue::Datetime(_) => "a date".into(),
        TomlValue::Integer(_) | TomlValue::Float(_) => "a number".into(),
    }
}

/// `; did you mean "facet"?`, or nothing when no candidate is close.
pub fn did_you_mean<'a>(written: &str, candidates: impl Iterator<Item = &'a str>) -> String {
    let lower = written.to_lowercase();
    let near = candidates.map(|c| (strsim::normalized_damerau_levenshtein(&lower, &c.to_lowercase()), c));
    match near.filter(|(likeness, _)| *likeness >= 0.55).max_by(|a, b| a.0.total_cmp(&b.0)) {
        Some((_, candidate)) => format!("; did you mean {candidate:?}?"),
        None => String::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ANY_F32: ValueType = ValueType::Numbers { lanes: 1, low: -3.5e38, high: 3.5e38, precision: Precision::Single };

    fn read(form: ValueType, text: &str) -> Result<f64, String> {
        let value: TomlValue = text.parse().expect("valid TOML");
        form.read(&value, &|_| text.to_owned()).map(|plain| plain.first())
    }

    #[test]
    fn every_f32_is_written_so_that_it_reads_back_to_the_bit() {
        let corners = [0.0, -0.0, 0.1, 0.2, 1e-40, f32::from_bits(1), f32::MIN_POSITIVE, f32::MAX, f32::MIN, 1e16, 16_777_216.0];
        let spread = (0..20_000u32).map(|i| f32::from_bits(crate::math::hash(i))).filter(|v| v.is_finite());
        for value in corners.into_iter().chain(spread) {
            let written = ANY_F32.write(&Value::number(value)).to_string();
            let back = read(ANY_F32, &written).unwrap_or_else(|e| panic!("{written}: {e}")) as f32;
            assert_eq!(back.to_bits(), value.to_bits(), "{value:?} was written {written}");
        }
    }

    #[test]
    fn every_f64_is_written_so_that_it_reads_back_to_the_bit() {
        let form = ValueType::number(f64::MIN, f64::MAX);
        for value in [0.1, -0.0, 1e-320, f64::MAX, 1.0 / 3.0, 1e300] {
            let written = form.write(&Value::number(value)).to_string();
            assert_eq!(read(form, &written).unwrap().to_bits(), value.to_bits(), "{written}");
        }
    }

    #[test]
    fn a_float_is_never_silently_infinite_or_zero() {
        assert!(read(ANY_F32, "1e39").unwrap_err().contains("1e39 is too large for a 32-bit float"));
        assert!(read(ANY_F32, "-1e39").unwrap_err().contains("too large"));
        assert!(read(ANY_F32, "1e-46").unwrap_err().contains("1e-46 is too small for a 32-bit float"));
        assert!(read(ANY_F32, "inf").unwrap_err().contains("not a finite number"));
        assert!(read(ANY_F32, "nan").unwrap_err().contains("not a finite number"));
    }

    #[test]
    fn a_decimal_bound_admits_its_own_decimal() {
        let form = ValueType::Numbers { lanes: 1, low: 0.1, high: 0.7, precision: Precision::Single };
        assert!(read(form, "0.1").is_ok() && read(form, "0.7").is_ok());
        assert_eq!(read(form, "0.71").unwrap_err(), "0.71 lies outside 0.1..=0.7");
    }

    #[test]
    fn a_near_miss_is_named() {
        assert_eq!(did_you_mean("fascet", ["facet", "depth"].into_iter()), "; did you mean \"facet\"?");
        assert_eq!(did_you_mean("zzz", ["facet", "depth"].into_iter()), "");
    }
}
