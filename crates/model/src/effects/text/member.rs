//! Members: what the attributes of one parameter say.

use std::{collections::BTreeSet, ops::Range};

use super::{
    attributes::Attribute,
    error::{EffectError, Text},
    tokens::Token,
};
use crate::{
    effects::{EMBEDDED_IMAGE, given::Given},
    params::{Field, Param, ValueType, WgslType},
};

/// Most members that are pictures.
const MAX_IMAGES: usize = 4;

/// One member of the struct.
pub struct Member<'a> {
    pub text: &'a Text<'a>,
    pub name: Token<'a>,
    /// Its type as it is written.
    pub kind: &'a str,
    pub attributes: &'a [Attribute<'a>],
}

impl<'a> Member<'a> {
    pub fn error(&self, message: impl Into<String>) -> EffectError {
        self.text.at(self.name, message)
    }

    pub fn attribute(&self, name: &str) -> Option<&'a Attribute<'a>> {
        self.attributes
            .iter()
            .find(|attribute| attribute.name == name)
    }

    /// The attribute that says which widget sets the parameter; exactly one of these.
    fn widget(&self, allowed: &[&str], usage: &str) -> Result<&'a Attribute<'a>, EffectError> {
        const WIDGETS: [&str; 5] = ["range", "color", "point", "toggle", "choice"];
        let mut widgets = self
            .attributes
            .iter()
            .filter(|attribute| WIDGETS.contains(&attribute.name));
        let Some(first) = widgets.next() else {
            return Err(self.error(format!(
                "{} is {}; it needs {usage}",
                self.name.text, self.kind
            )));
        };
        if let Some(second) = widgets.next() {
            return Err(second.error(
                self.text,
                format!("@{} and @{} exclude each other", first.name, second.name),
            ));
        }
        if !allowed.contains(&first.name) {
            return Err(first.error(
                self.text,
                format!(
                    "@{} does not fit {}; it needs {usage}",
                    first.name, self.kind
                ),
            ));
        }
        Ok(first)
    }

    /// Where the text names the picture that this member is, after `known` others.
    pub fn image(&self, image: &Attribute<'a>, known: usize) -> Result<Range<usize>, EffectError> {
        let is_other = |other: &&Attribute<'_>| other.name != "image";
        if let Some(other) = self.attributes.iter().find(is_other) {
            let message = format!("@{} and @image exclude each other", other.name);
            return Err(other.error(self.text, message));
        }
        if self.kind != "u32" {
            return Err(image.error(
                self.text,
                format!(
                    "@image does not fit {}; a picture is a u32, its number for the functions of lib/image_file",
                    self.kind
                ),
            ));
        }
        if known == MAX_IMAGES {
            let message = format!("an effect takes at most {MAX_IMAGES} pictures");
            return Err(image.error(self.text, message));
        }
        let whole = &self.text.text[image.begin..image.end];
        let place = whole.find('"').zip(whole.rfind('"'));
        let is_alone = image.arguments.len() == 1 || whole.contains(EMBEDDED_IMAGE);
        place
            .filter(|(first, last)| is_alone && first + 1 < *last)
            .filter(|(first, last)| !whole[first + 1..*last].contains('"'))
            .map(|(first, last)| image.begin + first..image.begin + last + 1)
            .ok_or_else(|| {
                image.error(
                    self.text,
                    "@image takes the name of a PNG in quotation marks, for instance @image(\"paper.png\")",
                )
            })
    }

    /// What the member is given.
    pub fn given(&self, given: &Attribute<'a>) -> Result<Given, EffectError> {
        if let Some(other) = self.attributes.iter().find(|other| other.name != "given") {
            let message = format!("@{} and @given exclude each other", other.name);
            return Err(other.error(self.text, message));
        }
        let mut all = Given::ALL.into_iter();
        let Some(found) = all.find(|known| given.arguments == [known.name()]) else {
            let names = Given::ALL.map(Given::name).join(", ");
            return Err(given.error(self.text, format!("@given takes one of {names}")));
        };
        let kind: String = self.kind.split_whitespace().collect();
        let wanted = found.wgsl().name();
        if kind != wanted && !(kind == "vec4f" && wanted == "vec4<f32>") {
            let message = format!("@given({}) is {wanted}, not {kind}", found.name());
            return Err(given.error(self.text, message));
        }
        Ok(found)
    }

    /// The registry's entry, the WGSL type, and the components of the default.
    pub fn param(&self, doc: &str) -> Result<(Param, WgslType, Vec<f64>), EffectError> {
        let kind: String = self.kind.split_whitespace().collect();
        let (value_type, wgsl, default) = match kind.as_str() {
            "f32" => {
                let (_, default) = self.range("@range(min, max, default)")?;
                (ValueType::F32, WgslType::F32, vec![default])
            }
            "i32" => {
                let (_, default) = self.range("@range(min, max, default)")?;
                (ValueType::I32, WgslType::I32, vec![default])
            }
            "u32" => self.whole()?,
            "vec4f" | "vec4<f32>" => {
                let widget = self.widget(
                    &["color", "point"],
                    "@color(red, green, blue) or @point(x, y, z)",
                )?;
                if widget.name == "color" {
                    let mut color = widget.numbers(
                        self.text,
                        (3, 4),
                        "red, green, blue and perhaps alpha, each 0 to 1",
                    )?;
                    color.resize(4, 1.0);
                    (ValueType::Color, WgslType::Vec4F32, color)
                } else {
                    let point = widget.numbers(self.text, (3, 3), "x, y and z")?;
                    (ValueType::Point, WgslType::Vec4F32, point)
                }
            }
            other => {
                let allowed = "f32, i32, u32 or vec4f";
                return Err(self.error(format!(
                    "{} is {other}; a parameter is {allowed}",
                    self.name.text
                )));
            }
        };
        let param = self.with_options(Param::new(self.name.text, doc, value_type))?;
        Ok((param, wgsl, default))
    }

    /// The parameter with what its other attributes say.
    fn with_options(&self, mut param: Param) -> Result<Param, EffectError> {
        let value_type = param.value_type.clone();
        if self.attribute("range").is_some() {
            let (range, _) = self.range("@range(min, max, default)")?;
            self.check_ends("range", range, &param)?;
            param = param.hard(range[0]..=range[1]).soft(range[0]..=range[1]);
        }
        if let Some(hard) = self.attribute("hard") {
            let ends = hard.numbers(
                self.text,
                (2, 2),
                "the least and the largest value that is allowed",
            )?;
            if !value_type.is_continuous() && !matches!(value_type, ValueType::U32 | ValueType::I32)
                || value_type == ValueType::Color
            {
                return Err(hard.error(self.text, "@hard belongs to a number or a point"));
            }
            let soft = if value_type == ValueType::Point {
                [ends[0], ends[1]]
            } else {
                param.soft
            };
            if !(ends[0] <= soft[0] && soft[1] <= ends[1] && ends[0] < ends[1]) {
                return Err(hard.error(
                    self.text,
                    "the range of @hard must be ascending and contain that of @range",
                ));
            }
            self.check_ends(
                "hard",
                [ends[0], ends[1]],
                &Param::new("", "", value_type.clone()),
            )?;
            (param.hard, param.soft) = ([ends[0], ends[1]], soft);
        }
        if let Some(soft) = self.attribute("soft") {
            let ends = soft.numbers(self.text, (2, 2), "the ends of the sliders of a point")?;
            let [low, high] = param.hard;
            if value_type != ValueType::Point
                || !(low <= ends[0] && ends[0] < ends[1] && ends[1] <= high)
            {
                return Err(soft.error(
                    self.text,
                    "@soft belongs to a point, and its range must be ascending and lie inside that of @hard",
                ));
            }
            param.soft = [ends[0], ends[1]];
        }
        if let Some(unit) = self.attribute("unit") {
            let [unit_text] = unit.arguments[..] else {
                return Err(unit.error(self.text, "@unit takes one unit, for instance m or px"));
            };
            let is_plain = !unit_text.contains("//")
                && !unit_text.contains("/*")
                && !unit_text.contains(char::is_control);
            if unit_text.is_empty() || unit_text.chars().count() > 8 || !is_plain {
                return Err(unit.error(
                    self.text,
                    "@unit takes a unit of at most 8 characters, for instance m or px",
                ));
            }
            param = param.unit(unit_text);
        }
        if let Some(log) = self.attribute("log") {
            let is_number = matches!(value_type, ValueType::F32 | ValueType::U32);
            if !is_number || param.soft[0] <= 0.0 || !log.arguments.is_empty() {
                return Err(log.error(
                    self.text,
                    "@log belongs to an f32 or u32 whose @range begins above 0, and takes nothing",
                ));
            }
            param = param.log(true);
        }
        for name in ["height", "depth"] {
            let Some(attribute) = self.attribute(name) else {
                continue;
            };
            if value_type != ValueType::F32
                || param.unit.is_empty()
                || !attribute.arguments.is_empty()
            {
                return Err(attribute.error(
                    self.text,
                    format!("@{name} belongs to an f32 with a @unit, and takes nothing"),
                ));
            }
            (param.height, param.depth) = (
                param.height || name == "height",
                param.depth || name == "depth",
            );
        }
        if let Some(default) = self.attribute("default")
            && !matches!(value_type, ValueType::Choice(_))
        {
            return Err(default.error(
                self.text,
                "@default belongs to @choice; other widgets take the default themselves",
            ));
        }
        Ok(param)
    }

    /// Refuses the ends of a range that the parameter's type does not have.
    fn check_ends(
        &self,
        attribute: &str,
        [low, high]: [f64; 2],
        param: &Param,
    ) -> Result<(), EffectError> {
        let is_whole = matches!(param.value_type, ValueType::I32 | ValueType::U32);
        let (least, most) = match param.value_type {
            ValueType::I32 => (f64::from(i32::MIN), f64::from(i32::MAX)),
            ValueType::U32 => (0.0, f64::from(u32::MAX)),
            _ => (f64::from(f32::MIN), f64::from(f32::MAX)),
        };
        let message = if is_whole && (low.fract() != 0.0 || high.fract() != 0.0) {
            format!(
                "the range of {} has whole numbers at its ends, because it is {}",
                self.name.text, self.kind
            )
        } else if low < least || high > most {
            format!(
                "the range of {} lies within {least} and {most}, because it is {}",
                self.name.text, self.kind
            )
        } else if !is_whole && low as f32 >= high as f32 {
            format!(
                "the range of {} is empty in f32; move its ends apart",
                self.name.text
            )
        } else {
            return Ok(());
        };
        Err(match self.attribute(attribute) {
            Some(place) => place.error(self.text, message),
            None => self.error(message),
        })
    }

    /// Range and default of `@range`.
    fn range(&self, usage: &str) -> Result<([f64; 2], f64), EffectError> {
        let widget = self.widget(&["range"], usage)?;
        let numbers = widget.numbers(self.text, (3, 3), "min, max, default and nothing else")?;
        let (low, high, default) = (numbers[0], numbers[1], numbers[2]);
        if low >= high {
            return Err(widget.error(
                self.text,
                format!(
                    "the range {low}..={high} is empty; the first number must be the smaller one"
                ),
            ));
        }
        if self.attribute("hard").is_none() && !(low..=high).contains(&default) {
            return Err(widget.error(
                self.text,
                format!("the default {default} lies outside {low}..={high}"),
            ));
        }
        Ok(([low, high], default))
    }

    /// A `u32`: a number, a flag or a choice.
    fn whole(&self) -> Result<(ValueType, WgslType, Vec<f64>), EffectError> {
        let usage = "@range(min, max, default), @toggle(0) or @choice(word, word)";
        let widget = self.widget(&["range", "toggle", "choice"], usage)?;
        match widget.name {
            "toggle" => match widget.arguments[..] {
                ["0" | "false"] => Ok((ValueType::Bool, WgslType::U32, vec![0.0])),
                ["1" | "true"] => Ok((ValueType::Bool, WgslType::U32, vec![1.0])),
                _ => Err(widget.error(self.text, "@toggle takes 0 or 1")),
            },
            "choice" => {
                let is_word = |word: &&str| {
                    let is_letter = |c: char| {
                        c.is_ascii_lowercase() || c.is_ascii_digit() || c == '-' || c == '_'
                    };
                    !word.is_empty()
                        && word.chars().count() <= 40
                        && word.starts_with(|c: char| c.is_ascii_lowercase() || c.is_ascii_digit())
                        && word.chars().all(is_letter)
                };
                let words = &widget.arguments;
                let is_repeated = words.iter().collect::<BTreeSet<_>>().len() < words.len();
                if !(2..=32).contains(&words.len()) || !words.iter().all(is_word) || is_repeated {
                    return Err(widget.error(
                        self.text,
                        "@choice takes 2 to 32 different words of small letters, digits, - and _",
                    ));
                }
                let chosen = match self.attribute("default") {
                    None => 0,
                    Some(default) => {
                        let position = words.iter().position(|word| default.arguments == [*word]);
                        position.ok_or_else(|| {
                            default.error(
                                self.text,
                                format!("@default takes one of {}", words.join(", ")),
                            )
                        })?
                    }
                };
                Ok((ValueType::choice(words), WgslType::U32, vec![chosen as f64]))
            }
            _ => {
                let (range, default) = self.range(usage)?;
                if range[0] < 0.0 {
                    return Err(widget.error(
                        self.text,
                        "the range of a u32 begins at 0 or above; use i32 for negative numbers",
                    ));
                }
                Ok((ValueType::U32, WgslType::U32, vec![default]))
            }
        }
    }
}

/// `@when(mode, word, …)`.
pub fn condition(
    text: &Text<'_>,
    when: &Attribute<'_>,
    fields: &[Field],
) -> Result<(String, Vec<String>), EffectError> {
    let usage = "@when takes the name of a choice and some of its words";
    let Some((name, words)) = when
        .arguments
        .split_first()
        .filter(|(_, words)| !words.is_empty())
    else {
        return Err(when.error(text, usage));
    };
    let choice = fields.iter().find(|field| field.name == *name);
    let Some(ValueType::Choice(allowed)) = choice.map(|field| &field.value_type) else {
        return Err(when.error(text, format!("{usage}; there is no choice {name}")));
    };
    let is_unknown = |word: &&&str| !allowed.iter().any(|known| known == **word);
    if let Some(unknown) = words.iter().find(is_unknown) {
        let message = format!(
            "{name} has no word {unknown}; it has {}",
            allowed.join(", ")
        );
        return Err(when.error(text, message));
    }
    let words = words.iter().map(|&word| word.into()).collect();
    Ok(((*name).into(), words))
}
