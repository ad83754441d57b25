//! Sweeps: one or two values of a preset, each in several steps, as the cells of a contact sheet.

use super::{PresetFile, set};

/// Most cells of a sheet.
pub const MAX_CELLS: usize = 1024;

/// Most columns of a sheet with one varied value.
const MAX_COLUMNS: usize = 6;

/// A value and what it is set to, one after another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Variation {
    /// As in `--set`: `facet.amount`.
    pub path: String,
    /// As in `--set`: at least two texts.
    pub values: Vec<String>,
}

impl Variation {
    /// Reads `facet.amount=0..1:5`, five values from 0 to 1, or `facet.pattern=uniform,sweep`.
    ///
    /// # Errors
    /// In a sentence that says what to write.
    pub fn parse(text: &str) -> Result<Self, String> {
        let wrong = |why: &str| {
            format!(
                "{text:?} {why}; write PATH=FROM..TO:STEPS, for instance facet.amount=0..1:5, or PATH=A,B,C"
            )
        };
        let (path, values) = text.split_once('=').ok_or_else(|| wrong("has no values"))?;
        let (path, values) = (path.trim(), values.trim());
        if path.is_empty() {
            return Err(wrong("names no value"));
        }
        let Some((from, rest)) = values.split_once("..") else {
            let values: Vec<String> = values
                .split(',')
                .map(|value| value.trim().to_owned())
                .collect();
            return match values.iter().any(String::is_empty) || values.len() < 2 {
                true => Err(wrong("needs at least two values")),
                false => Self {
                    path: path.into(),
                    values,
                }
                .checked(),
            };
        };
        let (to, steps) = rest
            .split_once(':')
            .ok_or_else(|| wrong("does not say in how many steps"))?;
        let number = |text: &str| {
            text.trim()
                .parse::<f64>()
                .ok()
                .filter(|number| number.is_finite())
        };
        let (Some(from), Some(to)) = (number(from), number(to)) else {
            return Err(wrong("has an end that is no number"));
        };
        let steps = steps
            .trim()
            .parse::<usize>()
            .map_err(|_| wrong("has a number of steps that is no whole number"))?;
        if !(2..=MAX_CELLS).contains(&steps) {
            return Err(format!("{text:?} has {steps} steps; take 2 to {MAX_CELLS}"));
        }
        Self::range(path, [from, to], steps).checked()
    }

    /// `steps` values, at least two, from one number to another, both included.
    pub fn range(path: &str, [from, to]: [f64; 2], steps: usize) -> Self {
        let steps = steps.max(2);
        let at = |step: usize| {
            let t = step as f64 / (steps - 1) as f64;
            number_text(from * (1.0 - t) + to * t)
        };
        Self {
            path: path.into(),
            values: (0..steps).map(at).collect(),
        }
    }

    fn checked(self) -> Result<Self, String> {
        match self.values.len() {
            0..=MAX_CELLS => Ok(self),
            count => Err(format!(
                "{} has {count} values; take at most {MAX_CELLS}",
                self.path
            )),
        }
    }
}

/// A number in nine digits, without those that rounding leaves behind: `0.3`, not
/// `0.30000000000000004`.
fn number_text(number: f64) -> String {
    format!("{number:.8e}").parse::<f64>().map_or_else(
        |_| number.to_string(),
        |rounded| (rounded + 0.0).to_string(),
    )
}

/// A preset of a sheet, and the values that make it.
#[derive(Clone, Debug)]
pub struct Cell {
    /// Path and value of each variation.
    pub values: Vec<(String, String)>,
    pub preset_file: PresetFile,
}

impl Cell {
    /// `amount=0.25 spacing=3`: the values without the names of their effects.
    pub fn caption(&self) -> String {
        let short = |path: &str| path.rsplit('.').next().unwrap_or(path).to_owned();
        self.values
            .iter()
            .map(|(path, value)| format!("{}={value}", short(path)))
            .collect::<Vec<_>>()
            .join(" ")
    }
}

/// A contact sheet: the first variation runs along the rows, the second from row to row.
#[derive(Clone, Debug)]
pub struct Sheet {
    pub columns: usize,
    /// Row by row.
    pub cells: Vec<Cell>,
}

impl Sheet {
    /// The cells of one or two variations of `base`.
    ///
    /// # Errors
    /// In a sentence: another number of variations, the same value twice, too many cells, or a
    /// value that the preset cannot have.
    pub fn new(base: &PresetFile, variations: &[Variation]) -> Result<Self, String> {
        let (first, second) = match variations {
            [first] => (first, None),
            [first, second] if first.path == second.path => {
                return Err(format!("{} is varied twice; vary two values", first.path));
            }
            [first, second] => (first, Some(second)),
            _ => {
                return Err(format!(
                    "a sheet varies one or two values, and there are {}",
                    variations.len()
                ));
            }
        };
        let count = first.values.len() * second.map_or(1, |second| second.values.len());
        if count > MAX_CELLS {
            return Err(format!(
                "the sheet has {count} cells; take at most {MAX_CELLS}"
            ));
        }
        let columns = match second {
            Some(_) => first.values.len(),
            None if first.values.len() <= MAX_COLUMNS => first.values.len(),
            None => (first.values.len() as f64).sqrt().ceil() as usize,
        };
        let rows = second.map_or_else(
            || vec![None],
            |second| {
                second
                    .values
                    .iter()
                    .map(|value| Some((second, value)))
                    .collect()
            },
        );
        let mut cells = Vec::new();
        for row in rows {
            for value in &first.values {
                let values = std::iter::once((first, value)).chain(row);
                let values: Vec<_> = values
                    .map(|(variation, value)| (variation.path.clone(), value.clone()))
                    .collect();
                let mut preset_file = base.clone();
                for (path, value) in &values {
                    set(&mut preset_file, path, value).map_err(|error| error.to_string())?;
                }
                cells.push(Cell {
                    values,
                    preset_file,
                });
            }
        }
        Ok(Self { columns, cells })
    }

    pub fn rows(&self) -> usize {
        self.cells.len().div_ceil(self.columns.max(1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::preset_file::{Folders, open};

    fn values(text: &str) -> Vec<String> {
        Variation::parse(text).expect("a variation").values
    }

    #[test]
    fn a_range_has_both_ends_and_no_remains_of_rounding() {
        assert_eq!(
            values("facet.amount=0..1:5"),
            ["0", "0.25", "0.5", "0.75", "1"]
        );
        assert_eq!(values("a.b=0..0.3:4"), ["0", "0.1", "0.2", "0.3"]);
        assert_eq!(values("a.b=1..-1:3"), ["1", "0", "-1"]);
        assert_eq!(
            values("facet.pattern = uniform, sweep"),
            ["uniform", "sweep"]
        );
    }

    #[test]
    fn what_is_no_variation_is_refused_with_what_to_write() {
        for (text, why) in [
            ("facet.amount", "has no values"),
            ("=0..1:5", "names no value"),
            ("facet.amount=0.5", "needs at least two values"),
            ("facet.amount=0..1", "does not say in how many steps"),
            ("facet.amount=0..one:5", "has an end that is no number"),
            (
                "facet.amount=0..1:few",
                "has a number of steps that is no whole number",
            ),
            ("facet.amount=0..1:1", "has 1 steps"),
            ("facet.amount=0..inf:3", "has an end that is no number"),
        ] {
            let error = Variation::parse(text).expect_err(text);
            assert!(error.contains(why), "{error}");
        }
    }

    #[test]
    fn the_first_value_runs_along_the_rows() {
        let base = open("facet-sweep", &Folders::default()).expect("a built-in preset");
        let vary = |texts: &[&str]| {
            let variations: Vec<_> = texts
                .iter()
                .map(|text| Variation::parse(text).expect("a variation"))
                .collect();
            Sheet::new(&base, &variations)
        };
        let sheet = vary(&["facet.amount=0..1:3", "facet.front=0.2,0.8"]).expect("a sheet");
        assert_eq!((sheet.columns, sheet.rows(), sheet.cells.len()), (3, 2, 6));
        assert_eq!(sheet.cells[4].caption(), "amount=0.5 front=0.8");
        let words = |cell: &Cell| {
            cell.preset_file
                .preset
                .stack
                .get("facet")
                .expect("it is enabled")
                .words
                .clone()
        };
        assert!(
            words(&sheet.cells[0]) != words(&sheet.cells[1])
                && words(&sheet.cells[0]) != words(&sheet.cells[3])
        );
        assert_eq!(
            vary(&["facet.amount=0..1:10"]).map(|sheet| (sheet.columns, sheet.rows())),
            Ok((4, 3))
        );
        let many = ["facet.amount=0..1:100", "facet.front=0..1:100"];
        let error = vary(&many).expect_err("too many cells");
        assert!(error.contains("at most 1024"), "{error}");
    }
}
