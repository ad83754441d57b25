//! A field for a number: the number always fits into its box, and what is typed and cannot be taken
//! is said in words.

use std::cell::RefCell;

use egui::{self, DragValue, Response, Ui};

use super::theme;

/// What a field takes and shows.
pub struct NumberField<'a> {
    /// Lowest and highest value.
    pub range: [f64; 2],
    /// Change for each point of a drag.
    pub speed: f64,
    pub is_whole: bool,
    /// Most decimals that are shown.
    pub decimals: usize,
    /// Shown after the number where there is room; with its space.
    pub unit: &'a str,
}

/// Margin left and right of the number in its box, points.
const MARGIN: f32 = 4.0;

impl NumberField<'_> {
    /// Shows the field. Returns in words what was typed and not taken as it was.
    pub fn show(&self, ui: &mut Ui, width: f32, value: &mut f64) -> (Response, Option<String>) {
        let shown = self.text(*value, self.max_chars(ui, width));
        let (before, typed) = (*value, RefCell::new(None));
        let number = shown
            .strip_suffix(self.unit)
            .filter(|_| !self.unit.is_empty());
        let drag = DragValue::new(value)
            .range(self.range[0]..=self.range[1])
            .speed(self.speed)
            .update_while_editing(false)
            .suffix(if number.is_some() { self.unit } else { "" })
            .custom_formatter(|now, _| {
                if now == before {
                    number.unwrap_or(&shown).to_owned()
                } else {
                    rounded_text(now, self.decimals)
                }
            })
            .custom_parser(|text| {
                let text = text.trim();
                if text == number.unwrap_or(&shown) {
                    return Some(before); // What is shown may be rounded; to leave it alone changes nothing.
                }
                let parsed = parse_number(text, self.unit);
                *typed.borrow_mut() = Some((text.to_owned(), parsed));
                parsed
            });
        ui.spacing_mut().button_padding.x = MARGIN;
        let response = ui.add_sized([width, theme::ROW - 4.0], drag);
        if self.is_whole {
            *value = value.round();
        }
        let said = typed
            .into_inner()
            .and_then(|(text, parsed)| self.remark(&text, parsed, *value, before));
        (response, said)
    }

    /// What to say about `text`, after which the value is `now`.
    fn remark(&self, text: &str, parsed: Option<f64>, now: f64, before: f64) -> Option<String> {
        match parsed {
            None => Some(format!(
                "{text:?} is no number, so it stays {}",
                fixed_text(before, 6)
            )),
            Some(number) if number != now => Some(format!("{text} became {}", fixed_text(now, 6))),
            Some(_) => None,
        }
    }

    fn max_chars(&self, ui: &Ui, width: f32) -> usize {
        let font = ui.style().drag_value_text_style.resolve(ui.style());
        let ten = ui
            .painter()
            .layout_no_wrap("0123456789".into(), font, egui::Color32::PLACEHOLDER)
            .size()
            .x;
        ((width - 2.0 * MARGIN) * 10.0 / ten.max(1.0)).max(1.0) as usize
    }

    /// The number in at most `max_chars` characters: with fewer decimals, without its unit, as a
    /// power of ten.
    fn text(&self, number: f64, max_chars: usize) -> String {
        let decimals = if self.is_whole { 0 } else { self.decimals };
        let fits = |text: &String| text.chars().count() <= max_chars;
        let with_unit = (0..=decimals)
            .rev()
            .map(|decimals| format!("{}{}", rounded_text(number, decimals), self.unit))
            .find(fits);
        // A small number must not become 0.
        let is_true =
            |text: &String| number == 0.0 || text.contains(|c: char| ('1'..='9').contains(&c));
        // Rather no unit than 1 per m for 0.7.
        let is_near = |text: &String| {
            parse_number(text, self.unit)
                .is_some_and(|shown| (shown - number).abs() <= 0.02 * number.abs())
        };
        if let Some(text) = with_unit.filter(is_true).filter(is_near) {
            return text;
        }
        let without = (0..=decimals)
            .rev()
            .map(|decimals| rounded_text(number, decimals))
            .find(fits)
            .filter(is_true);
        let power = || {
            (0..4)
                .rev()
                .map(|digits| format!("{number:.digits$e}"))
                .find(fits)
        };
        without
            .or_else(power)
            .unwrap_or_else(|| format!("{number:.0e}"))
    }
}

/// `0.500`: so many decimals, so that the digits stand still while the number changes.
fn rounded_text(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    match text.strip_prefix('-') {
        Some(zero) if zero.chars().all(|c| matches!(c, '0' | '.')) => zero.to_owned(),
        _ => text,
    }
}

/// `0.5`: at most so many decimals, no zeros at the end.
fn fixed_text(number: f64, decimals: usize) -> String {
    let text = rounded_text(number, decimals);
    if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.').to_owned()
    } else {
        text
    }
}

/// A number that was typed, or the quotient of two.
pub fn parse_quotient(text: &str) -> Option<f64> {
    let (number, by) = text.split_once('/').unwrap_or((text, "1"));
    let quotient = parse_number(number, "")? / parse_number(by, "")?;
    quotient.is_finite().then_some(quotient)
}

/// The number that was typed, perhaps with its unit.
fn parse_number(text: &str, unit: &str) -> Option<f64> {
    let text = text
        .trim()
        .strip_suffix(unit.trim())
        .filter(|_| !unit.trim().is_empty())
        .unwrap_or(text);
    let text: String = text
        .chars()
        .filter(|c| !c.is_whitespace() && *c != '_')
        .map(|c| if c == '\u{2212}' { '-' } else { c })
        .collect();
    let number = text
        .parse::<f64>()
        .or_else(|_| text.replace(',', ".").parse());
    number.ok().filter(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: NumberField<'static> = NumberField {
        range: [-1e9, 1e9],
        speed: 1.0,
        is_whole: false,
        decimals: 3,
        unit: " °/s",
    };

    #[test]
    fn a_number_fits_into_its_box() {
        let text = |number| FIELD.text(number, 8);
        assert_eq!(
            [0.5, 12.25, 123.456, -180.0].map(text),
            ["0.50 °/s", "12.2 °/s", "123 °/s", "-180 °/s"]
        );
        assert_eq!(
            [0.0, 0.001, -1234.5].map(text),
            ["0.00 °/s", "0.001", "-1234.50"]
        );
        let per_meter = NumberField {
            unit: " per m",
            ..FIELD
        };
        assert_eq!(
            [0.7, 2.0, 0.06].map(|number| per_meter.text(number, 8)),
            ["0.700", "2 per m", "0.060"]
        );
        for number in [
            123_456_789.0,
            -987_654_321.5,
            1e300,
            -1e-300,
            f64::MAX,
            0.000_123,
        ] {
            for max_chars in 7..12 {
                let text = FIELD.text(number, max_chars);
                assert!(
                    text.chars().count() <= max_chars,
                    "{number} in {max_chars}: {text}"
                );
            }
        }
    }

    #[test]
    fn numbers_are_read_with_units_commas_and_typographic_minus() {
        assert_eq!(
            ["12", " -1.5 ", "12 °/s", "\u{2212}3", "1 000", "0,5", "1e3"]
                .map(|text| parse_number(text, " °/s").unwrap_or(f64::NAN)),
            [12.0, -1.5, 12.0, -3.0, 1000.0, 0.5, 1000.0]
        );
        assert_eq!(
            ["", "abc", "inf", "NaN", "1 m"].map(|text| parse_number(text, " °/s")),
            [None; 5]
        );
    }

    #[test]
    fn what_is_not_taken_as_typed_is_said() {
        let field = NumberField {
            range: [0.0, 1.0],
            ..FIELD
        };
        assert_eq!(
            field.remark("7", Some(7.0), 1.0, 0.5),
            Some("7 became 1".into())
        );
        assert_eq!(
            field.remark("abc", None, 0.5, 0.5),
            Some("\"abc\" is no number, so it stays 0.5".into())
        );
        assert_eq!(field.remark("0.25", Some(0.25), 0.25, 0.5), None);
    }
}
