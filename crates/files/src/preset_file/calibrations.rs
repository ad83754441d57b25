//! The calibrations of adapters, kept in the folder of the user's configuration: one file for each [`CalibrationKey`] and version of the program.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::{
    atomic::{Existing, write_atomically},
    error::PresetError,
    gallery::user_folder,
    hash::{Fnv, hex},
};
use crate::{
    accuracy::AXES,
    plan::{
        MEASURED_OPTIONS, MOST_SMALL_SAMPLES, Measured, OptionCosts,
        cost_model::{Unit, UnitCosts},
    },
    shader::library::Library,
};

/// Changes where work is counted, timed or fitted in another way, so that costs measured before hold no longer.
const COUNTING: u32 = 6;

/// What a calibration is for: it holds for nothing else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CalibrationKey {
    pub adapter: String,
    pub driver: String,
    /// Threads of the machine where they draw the pictures; 0 on a card.
    pub threads: u32,
    /// Hash of the shader files, whose operations the costs are for.
    pub shaders: u64,
}

/// What a calibration found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Calibration {
    /// Predicts milliseconds.
    pub units: UnitCosts,
    /// Plans pictures.
    pub measured: Measured,
}

/// A calibration that was kept, or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub enum Kept {
    Found(Box<Calibration>),
    /// There is no file.
    Nothing,
    /// There is a file that cannot be used, in one sentence.
    Broken(String),
}

/// The folder of calibrations: `calibrations` beside [`user_folder`].
pub fn calibrations_folder() -> Option<PathBuf> {
    Some(user_folder()?.with_file_name("calibrations"))
}

impl CalibrationKey {
    /// What the calibration of an adapter is kept under, with the shader files of this program.
    pub fn of(adapter: &str, driver: &str, is_software: bool) -> Self {
        let shaders = Library::from_env().texts().fold(Fnv::new(), |hash, text| hash.bytes(text.as_bytes()));
        let threads = if is_software { std::thread::available_parallelism().map_or(1, |threads| threads.get() as u32) } else { 0 };
        Self { adapter: adapter.into(), driver: driver.into(), threads, shaders: shaders.0 }
    }

    /// The calibration that was kept in the user's folder.
    pub fn kept(&self) -> Kept {
        calibrations_folder().map_or(Kept::Nothing, |folder| self.read(&folder))
    }

    /// What the kept calibration says for the planner; none without one that can be used.
    pub fn kept_measured(&self) -> Option<Measured> {
        if let Kept::Found(found) = self.kept() { Some(found.measured) } else { None }
    }

    /// The file of this calibration in `folder`.
    pub fn file(&self, folder: &Path) -> PathBuf {
        let hash = Fnv::new()
            .bytes(self.adapter.as_bytes())
            .bytes(&[0])
            .bytes(self.driver.as_bytes())
            .bytes(&[0])
            .bytes(env!("CARGO_PKG_VERSION").as_bytes())
            .words(&[COUNTING, self.threads])
            .bytes(&self.shaders.to_le_bytes());
        folder.join(format!("{}.json", hex(hash)))
    }

    /// The calibration that was kept in `folder`.
    pub fn read(&self, folder: &Path) -> Kept {
        let path = self.file(folder);
        let text = match std::fs::read_to_string(&path) {
            Ok(text) => text,
            Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Kept::Nothing,
            Err(error) => return Kept::Broken(format!("{} cannot be read: {error}", path.display())),
        };
        parsed(&text)
            .map_or_else(|why| Kept::Broken(format!("{} is no calibration: {why}", path.display())), |found| Kept::Found(Box::new(found)))
    }

    /// Keeps a calibration in `folder`, which is made if it is not there.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, folder: &Path, calibration: &Calibration) -> Result<PathBuf, PresetError> {
        let path = self.file(folder);
        let failed = |error: std::io::Error| PresetError::Write { file: path.display().to_string(), reason: error.to_string() };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let Calibration { units, measured } = calibration;
        let units: Map<String, Value> = Unit::ALL.iter().map(|(unit, name, _)| ((*name).to_owned(), json!(units.of(*unit)))).collect();
        let options = MEASURED_OPTIONS.iter().zip(&measured.options.options_ms).map(|(option, ms)| (word(*option), json!(ms)));
        let options: Map<String, Value> = options.chain([(DEFAULTS.to_owned(), json!(measured.options.defaults_ms))]).collect();
        let object = json!({
            "adapter": self.adapter, "driver": self.driver, "version": env!("CARGO_PKG_VERSION"), "ms_per_unit": units,
            "ms_of_options": options, "max_small_samples": measured.max_small_samples,
        });
        write_atomically(&path, format!("{object:#}\n").as_bytes(), Existing::Replace)?;
        Ok(path)
    }
}

/// The defaults among the options of a file.
const DEFAULTS: &str = "defaults";

/// The most milliseconds that a file may say of a unit or an option, and the least of an option.
const MOST_MS: f64 = 1e6;
const LEAST_OPTION_MS: f64 = 1e-6;

/// Characters of a wrong value that its refusal repeats.
const SHOWN_VALUE: usize = 60;

/// An option in a file: `coverage=fixed4`.
fn word((axis, option): (usize, usize)) -> String {
    format!("{}={}", AXES[axis].name, AXES[axis].words[option])
}

/// A value as a refusal shows it: its beginning where it is long.
fn shown(value: &Value) -> String {
    let text = value.to_string();
    if text.chars().count() > SHOWN_VALUE { text.chars().take(SHOWN_VALUE).chain("...".chars()).collect() } else { text }
}

/// Reads the text of a file. Every unit must be there, with milliseconds from 0 to [`MOST_MS`], and every measured option, with two numbers of them
/// from [`LEAST_OPTION_MS`] on.
fn parsed(text: &str) -> Result<Calibration, String> {
    let object: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let mut costs = UnitCosts::default();
    for (unit, name, _) in Unit::ALL {
        let value = &object["ms_per_unit"][*name];
        match value.as_f64() {
            Some(ms) if (0.0..=MOST_MS).contains(&ms) => costs.set(*unit, ms),
            _ => return Err(format!("ms_per_unit.{name} is {}, not a number from 0 to {MOST_MS}", shown(value))),
        }
    }
    let ms_of = |option: &str| {
        let value = &object["ms_of_options"][option];
        let ms = [0, 1].map(|at| value[at].as_f64().filter(|ms| (LEAST_OPTION_MS..=MOST_MS).contains(ms)));
        let why = || format!("ms_of_options.{option} is {}, not two numbers from {LEAST_OPTION_MS} to {MOST_MS}", shown(value));
        ms[0].zip(ms[1]).map(|(few, many)| [few, many]).ok_or_else(why)
    };
    let mut options = OptionCosts { defaults_ms: ms_of(DEFAULTS)?, options_ms: Default::default() };
    for (option, ms) in MEASURED_OPTIONS.iter().zip(&mut options.options_ms) {
        *ms = ms_of(&word(*option))?;
    }
    let samples = &object["max_small_samples"];
    let why = || format!("max_small_samples is {}, not a number from 1 to {MOST_SMALL_SAMPLES}", shown(samples));
    let max_small_samples = samples.as_u64().filter(|samples| (1..=MOST_SMALL_SAMPLES.into()).contains(samples)).ok_or_else(why)? as u32;
    Ok(Calibration { units: costs, measured: Measured { options, max_small_samples } })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(driver: &str) -> CalibrationKey {
        CalibrationKey { adapter: "card".into(), driver: driver.into(), threads: 0, shaders: 7 }
    }

    #[test]
    fn a_calibration_is_read_as_it_was_written_and_holds_for_its_driver_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut units = UnitCosts::default();
        Unit::ALL.iter().enumerate().for_each(|(i, (unit, ..))| units.set(*unit, 1.5e-7 * i as f64));
        let options_ms = std::array::from_fn(|i| [0.5 + i as f64, 0.25 + 2.0 * i as f64]);
        let measured = Measured { options: OptionCosts { defaults_ms: [1.0, 2.5], options_ms }, max_small_samples: 64 };
        let calibration = Calibration { units, measured };
        assert_eq!(key("1.0").read(folder.path()), Kept::Nothing);
        key("1.0").write(&folder.path().join("made"), &calibration).expect("it can be written");
        let Kept::Found(found) = key("1.0").read(&folder.path().join("made")) else { panic!("it was kept") };
        for (unit, name, _) in Unit::ALL {
            assert!((found.units.of(*unit) - units.of(*unit)).abs() <= 1e-12 * units.of(*unit), "{name}");
        }
        assert_eq!(found.measured, measured);
        assert_eq!(key("1.1").read(&folder.path().join("made")), Kept::Nothing);
        assert_eq!(CalibrationKey { shaders: 8, ..key("1.0") }.read(&folder.path().join("made")), Kept::Nothing);
        assert_eq!(CalibrationKey { threads: 2, ..key("1.0") }.read(&folder.path().join("made")), Kept::Nothing);
    }

    #[test]
    fn options_and_limits_out_of_range_are_refused() {
        let units: Map<String, Value> = Unit::ALL.iter().map(|(_, name, _)| ((*name).to_owned(), json!(1e-6))).collect();
        let options: Map<String, Value> = MEASURED_OPTIONS.iter().map(|option| (word(*option), json!([1.0, 2.0]))).collect();
        let mut object = json!({ "ms_per_unit": units, "ms_of_options": options, "max_small_samples": 32 });
        let refusal = |object: &Value| parsed(&object.to_string()).expect_err("it is refused");
        assert!(refusal(&object).contains("ms_of_options.defaults is null"));
        object["ms_of_options"]["defaults"] = json!([1.0, 0.0]);
        assert!(refusal(&object).contains("not two numbers from 0.000001 to 1000000"));
        object["ms_of_options"]["defaults"] = json!([1.0, 1e-300]);
        assert!(refusal(&object).contains("not two numbers"));
        object["ms_of_options"]["defaults"] = json!("x".repeat(1000));
        assert!(refusal(&object).len() < 200);
        object["ms_of_options"]["defaults"] = json!([1.0, 2.0]);
        assert!(parsed(&object.to_string()).is_ok());
        for samples in [json!(0), json!(16_385), json!("many"), json!(-1)] {
            object["max_small_samples"] = samples;
            assert!(refusal(&object).contains("not a number from 1 to 16384"), "{object}");
        }
    }

    #[test]
    fn a_broken_file_is_named_in_one_sentence() {
        let folder = tempfile::tempdir().expect("a folder");
        let broken = [
            ("{", "EOF"),
            ("{}", "ms_per_unit.frame is null"),
            (r#"{"ms_per_unit":{"frame":-1}}"#, "frame is -1, not a number from 0 to 1000000"),
            (r#"{"ms_per_unit":{"frame":1e308}}"#, "frame is 1e+308"),
        ];
        for (text, why) in broken {
            std::fs::write(key("1").file(folder.path()), text).expect("it can be written");
            let Kept::Broken(sentence) = key("1").read(folder.path()) else { panic!("{text} is broken") };
            assert!(sentence.contains(why) && sentence.contains("is no calibration") && !sentence.contains('\n'), "{sentence}");
        }
    }
}
