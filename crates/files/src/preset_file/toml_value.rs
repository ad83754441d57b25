//! Values as TOML: how each type is read, and how it is written so that it reads back to the bit.
//!
//! Floats are written as the shortest decimal that reads back to the same f32 (or f64), read in
//! their own precision, and refused when they would silently become infinite or zero.

use toml_edit::Value as Toml;

use crate::{
    math::{linear_of_srgb, srgb_byte},
    params::{Param, Value, ValueType, did_you_mean},
};

/// The text of a number as it stands in the file.
pub type NumberText<'a> = &'a dyn Fn(&Toml) -> String;

/// Reads a value of `param`'s type; `text_of` gives the text of a number. What stores the value
/// checks its range.
///
/// # Errors
/// The value has another type. Completes a sentence that begins with the parameter's name.
pub fn read(param: &Param, toml: &Toml, text_of: NumberText<'_>) -> Result<Value, String> {
    Ok(match &param.value_type {
        ValueType::Text { .. } => Value::Text(text(toml)?),
        ValueType::TextList { .. } => {
            let list = toml
                .as_array()
                .ok_or_else(|| format!("must be a list of texts, not {}", description(toml)))?;
            Value::TextList(list.iter().map(text).collect::<Result<_, _>>()?)
        }
        ValueType::Bool => Value::Bool(
            toml.as_bool()
                .ok_or_else(|| format!("must be true or false, not {}", description(toml)))?,
        ),
        ValueType::Choice(words) => Value::Choice(word(toml, words)?),
        ValueType::Color if toml.is_str() => {
            let written = toml.as_str().unwrap_or_default();
            Value::Numbers(
                color_of_hex(written)
                    .ok_or_else(|| not_a_color(written))?
                    .into(),
            )
        }
        numbers => match numbers.components() {
            1 => Value::Numbers(vec![number(toml, &text_of(toml), numbers)?]),
            count => {
                let list = toml.as_array().filter(|list| list.len() == count);
                let list = list.ok_or_else(|| {
                    let or_hex = match numbers {
                        ValueType::Color => ", in linear light, or #rrggbb",
                        _ => "",
                    };
                    format!(
                        "must be a list of {count} numbers{or_hex}, not {}",
                        description(toml)
                    )
                })?;
                Value::Numbers(
                    list.iter()
                        .map(|item| number(item, &text_of(item), numbers))
                        .collect::<Result<_, _>>()?,
                )
            }
        },
    })
}

/// A color as it is written for screens, `#rrggbb` or `#rrggbbaa` in sRGB, as linear RGBA; none if it
/// is no such text.
pub fn color_of_hex(written: &str) -> Option<[f64; 4]> {
    let digits = written.trim().strip_prefix('#')?;
    if !matches!(digits.len(), 6 | 8) || !digits.bytes().all(|c| c.is_ascii_hexdigit()) {
        return None;
    }
    let byte = |at: usize| u8::from_str_radix(digits.get(at..at + 2)?, 16).ok();
    let linear = |at| {
        Some(f64::from(
            linear_of_srgb(f64::from(byte(at)?) / 255.0) as f32
        ))
    };
    let alpha = byte(6).map_or(1.0, |alpha| f64::from(f32::from(alpha) / 255.0));
    Some([linear(0)?, linear(2)?, linear(4)?, alpha])
}

/// Linear RGBA as `#rrggbb` in sRGB, with two more digits unless alpha is 1.
pub fn hex_of_color([r, g, b, a]: [f64; 4]) -> String {
    let [r, g, b] = [r, g, b].map(srgb_byte);
    let alpha = (a.clamp(0.0, 1.0) * 255.0).round() as u8;
    match alpha {
        255 => format!("#{r:02x}{g:02x}{b:02x}"),
        alpha => format!("#{r:02x}{g:02x}{b:02x}{alpha:02x}"),
    }
}

fn not_a_color(written: &str) -> String {
    format!(
        "{written:?} is no color; write #rrggbb or #rrggbbaa as for a screen (sRGB), or four numbers of linear light, for instance [0.5, 0.5, 0.5, 1.0]"
    )
}

/// The TOML that [`read`] takes back to the same bits. `value` must have this type.
pub fn write(value_type: &ValueType, value: &Value) -> Toml {
    match value {
        Value::Bool(on) => (*on).into(),
        Value::Choice(index) => match value_type {
            ValueType::Choice(words) => words.get(*index).map_or("", String::as_str).into(),
            _ => (*index as i64).into(),
        },
        Value::Numbers(numbers) => match numbers[..] {
            [single] => numeral(single, value_type),
            _ => numbers
                .iter()
                .map(|number| numeral(*number, value_type))
                .collect(),
        },
        Value::Text(text) => text.as_str().into(),
        Value::TextList(texts) => texts.iter().map(String::as_str).collect(),
    }
}

/// [`write()`] as text without surrounding space: what is copied, listed and pasted.
pub fn write_text(value_type: &ValueType, value: &Value) -> String {
    write(value_type, value).to_string().trim().to_owned()
}

/// The shortest decimal that reads back to this number.
fn numeral(number: f64, value_type: &ValueType) -> Toml {
    let shortest = if value_type.is_single() {
        format!("{:?}", number as f32)
    } else if value_type.is_continuous() {
        format!("{number:?}")
    } else {
        return (number as i64).into();
    };
    shortest.parse().unwrap_or_else(|_| number.into())
}

fn number(toml: &Toml, written: &str, value_type: &ValueType) -> Result<f64, String> {
    let number = match toml {
        Toml::Integer(integer) if integer.value().unsigned_abs() <= 1 << 53 => {
            *integer.value() as f64
        }
        Toml::Integer(integer) => return Err(format!("{} is too large", integer.value())),
        Toml::Float(float) => *float.value(),
        other => return Err(format!("must be a number, not {}", description(other))),
    };
    if !number.is_finite() {
        return Err(format!("{written} is not a finite number"));
    }
    if value_type.is_single() {
        single(number, written)
    } else {
        Ok(number)
    }
}

/// The f32 nearest to the decimal in the file, rounded once, as f64.
fn single(number: f64, written: &str) -> Result<f64, String> {
    let nearest = written.replace('_', "").parse().unwrap_or(number as f32);
    if nearest.is_infinite() {
        return Err(format!(
            "{written} is too large for a 32-bit float, which ends at 3.4028235e38"
        ));
    }
    if nearest == 0.0 && number != 0.0 {
        return Err(format!(
            "{written} is too small for a 32-bit float, which would make it 0"
        ));
    }
    // The f64 stays, for messages, unless rounding it to f32 would round the decimal twice.
    Ok(if number as f32 == nearest {
        number
    } else {
        f64::from(nearest)
    })
}

fn text(toml: &Toml) -> Result<String, String> {
    toml.as_str()
        .map(str::to_owned)
        .ok_or_else(|| format!("must be a text in quotes, not {}", description(toml)))
}

fn word(toml: &Toml, words: &[String]) -> Result<usize, String> {
    let written = toml.as_str().ok_or_else(|| {
        format!(
            "must be one of {}, not {}",
            words.join(", "),
            description(toml)
        )
    })?;
    words
        .iter()
        .position(|word| *word == written)
        .ok_or_else(|| {
            format!(
                "{written:?} is not one of {}{}",
                words.join(", "),
                did_you_mean(written, words.iter().map(String::as_str))
            )
        })
}

/// What a TOML value is, to complete "must be …, not …".
fn description(toml: &Toml) -> String {
    match toml {
        Toml::Array(list) => format!("a list of {}", list.len()),
        Toml::InlineTable(_) => "a table".into(),
        Toml::String(_) => "a text".into(),
        Toml::Boolean(_) => "true or false".into(),
        Toml::Datetime(_) => "a date".into(),
        Toml::Integer(_) | Toml::Float(_) => "a number".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn any_f32() -> Param {
        Param::new("any", "", ValueType::F32).hard(-3.402_823_5e38..=3.402_823_5e38)
    }

    fn any_f64() -> Param {
        Param::new("any", "", ValueType::F64).hard(f64::MIN..=f64::MAX)
    }

    fn read_number(param: &Param, text: &str) -> Result<f64, String> {
        let toml: Toml = text.parse().expect("valid TOML");
        let value = read(param, &toml, &|_| text.to_owned())?;
        param.check(&value).map_err(|error| error.to_string())?;
        Ok(value.components()[0])
    }

    fn written(param: &Param, number: f64) -> String {
        write_text(&param.value_type, &Value::number(number))
    }

    #[test]
    fn every_f32_is_written_so_that_it_reads_back_to_the_bit() {
        let corners = [
            0.0,
            -0.0,
            0.1,
            0.2,
            1e-40,
            f32::from_bits(1),
            f32::MIN_POSITIVE,
            f32::MAX,
            f32::MIN,
            1e16,
            16_777_216.0,
        ];
        let spread = (0..20_000u32)
            .map(|i| f32::from_bits(crate::math::hash(i)))
            .filter(|v| v.is_finite());
        for value in corners.into_iter().chain(spread) {
            let text = written(&any_f32(), value.into());
            let back =
                read_number(&any_f32(), &text).unwrap_or_else(|e| panic!("{text}: {e}")) as f32;
            assert_eq!(
                back.to_bits(),
                value.to_bits(),
                "{value:?} was written {text}"
            );
        }
    }

    #[test]
    fn every_f64_is_written_so_that_it_reads_back_to_the_bit() {
        for value in [0.1, -0.0, 1e-320, f64::MAX, 1.0 / 3.0, 1e300] {
            let text = written(&any_f64(), value);
            assert_eq!(
                read_number(&any_f64(), &text).unwrap().to_bits(),
                value.to_bits(),
                "{text}"
            );
        }
    }

    #[test]
    fn a_float_is_never_silently_infinite_or_zero() {
        assert!(
            read_number(&any_f32(), "1e39")
                .unwrap_err()
                .contains("1e39 is too large for a 32-bit float")
        );
        assert!(
            read_number(&any_f32(), "-1e39")
                .unwrap_err()
                .contains("too large")
        );
        assert!(
            read_number(&any_f32(), "1e-46")
                .unwrap_err()
                .contains("1e-46 is too small for a 32-bit float")
        );
        assert!(
            read_number(&any_f32(), "inf")
                .unwrap_err()
                .contains("not a finite number")
        );
        assert!(
            read_number(&any_f32(), "nan")
                .unwrap_err()
                .contains("not a finite number")
        );
    }

    #[test]
    fn a_color_of_a_screen_is_read_as_linear_light() {
        let read = |text: &str| {
            let param = Param::new("any", "", ValueType::Color).hard(0.0..=1.0);
            super::read(&param, &text.into(), &|_| text.to_owned())
        };
        let gray = f64::from(0.215_860_5_f32);
        let Ok(Value::Numbers(numbers)) = read("#80ff00") else {
            panic!("{:?}", read("#80ff00"))
        };
        assert!((numbers[0] - gray).abs() < 1e-6 && numbers[1..] == [1.0, 0.0, 1.0]);
        for hex in ["#000000", "#80ff00", "#0a0b0c80", "#ffffff00"] {
            assert_eq!(hex_of_color(color_of_hex(hex).expect("a color")), hex);
        }
        for wrong in ["#80ff0", "80ff00", "#80ff0g", "#", "red", "#ééé"] {
            let error = read(wrong).expect_err(wrong);
            assert!(error.contains("write #rrggbb"), "{error}");
        }
    }

    #[test]
    fn a_decimal_bound_admits_its_own_decimal() {
        let param = Param::new("any", "", ValueType::F32).hard(0.1..=0.7);
        assert!(read_number(&param, "0.1").is_ok() && read_number(&param, "0.7").is_ok());
        assert_eq!(
            read_number(&param, "0.71").unwrap_err(),
            "takes 0.1 to 0.7, not 0.71"
        );
    }
}
