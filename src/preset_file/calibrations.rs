//! The calibrations of adapters, kept in the folder of the user's configuration: one file per adapter, driver and version of the program.

use std::path::{Path, PathBuf};

use serde_json::{Map, Value, json};

use super::{
    atomic::{Existing, write_atomically},
    error::PresetError,
    gallery::user_folder,
    hash::{Fnv, hex},
};
use crate::plan::cost_model::{Unit, UnitCosts};

/// Changes where work is counted in another way, so that costs measured before hold no longer.
const COUNTING: u32 = 2;

/// What a calibration is for: it holds for nothing else.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct CalibrationKey {
    pub adapter: String,
    pub driver: String,
    /// Hash of the shader files, whose operations the costs are for.
    pub shaders: u64,
}

/// A calibration that was kept, or why there is none.
#[derive(Clone, Debug, PartialEq)]
pub enum Kept {
    Found(Box<UnitCosts>),
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
    /// The file of this calibration in `folder`.
    pub fn file(&self, folder: &Path) -> PathBuf {
        let hash = Fnv::new()
            .bytes(self.adapter.as_bytes())
            .bytes(&[0])
            .bytes(self.driver.as_bytes())
            .bytes(&[0])
            .bytes(env!("CARGO_PKG_VERSION").as_bytes())
            .words(&[COUNTING])
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
            .map_or_else(|why| Kept::Broken(format!("{} is no calibration: {why}", path.display())), |costs| Kept::Found(Box::new(costs)))
    }

    /// Keeps a calibration in `folder`, which is made if it is not there.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, folder: &Path, costs: &UnitCosts) -> Result<PathBuf, PresetError> {
        let path = self.file(folder);
        let failed = |error: std::io::Error| PresetError::Write { file: path.display().to_string(), reason: error.to_string() };
        std::fs::create_dir_all(folder).map_err(failed)?;
        let units: Map<String, Value> = Unit::ALL.iter().map(|(unit, name, _)| ((*name).to_owned(), json!(costs.of(*unit)))).collect();
        let object = json!({
            "adapter": self.adapter, "driver": self.driver, "version": env!("CARGO_PKG_VERSION"), "ms_per_unit": units,
        });
        write_atomically(&path, format!("{object:#}\n").as_bytes(), Existing::Replace)?;
        Ok(path)
    }
}

/// Reads the text of a file. Every unit must be there, with a finite number of milliseconds from 0 up.
fn parsed(text: &str) -> Result<UnitCosts, String> {
    let object: Value = serde_json::from_str(text).map_err(|error| error.to_string())?;
    let mut costs = UnitCosts::default();
    for (unit, name, _) in Unit::ALL {
        let value = &object["ms_per_unit"][*name];
        match value.as_f64() {
            Some(ms) if ms >= 0.0 && ms.is_finite() => costs.set(*unit, ms),
            _ => return Err(format!("ms_per_unit.{name} is {value}, not a number from 0 up")),
        }
    }
    Ok(costs)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn key(driver: &str) -> CalibrationKey {
        CalibrationKey { adapter: "card".into(), driver: driver.into(), shaders: 7 }
    }

    #[test]
    fn a_calibration_is_read_as_it_was_written_and_holds_for_its_driver_alone() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut costs = UnitCosts::default();
        Unit::ALL.iter().enumerate().for_each(|(i, (unit, ..))| costs.set(*unit, 1.5e-7 * i as f64));
        assert_eq!(key("1.0").read(folder.path()), Kept::Nothing);
        key("1.0").write(&folder.path().join("made"), &costs).expect("it can be written");
        let Kept::Found(found) = key("1.0").read(&folder.path().join("made")) else { panic!("it was kept") };
        for (unit, name, _) in Unit::ALL {
            assert!((found.of(*unit) - costs.of(*unit)).abs() <= 1e-12 * costs.of(*unit), "{name}");
        }
        assert_eq!(key("1.1").read(&folder.path().join("made")), Kept::Nothing);
        assert_eq!(CalibrationKey { shaders: 8, ..key("1.0") }.read(&folder.path().join("made")), Kept::Nothing);
    }

    #[test]
    fn a_broken_file_is_named_in_one_sentence() {
        let folder = tempfile::tempdir().expect("a folder");
        for (text, why) in [("{", "EOF"), ("{}", "ms_per_unit.frame is null"), (r#"{"ms_per_unit":{"frame":-1}}"#, "frame is -1")] {
            std::fs::write(key("1").file(folder.path()), text).expect("it can be written");
            let Kept::Broken(sentence) = key("1").read(folder.path()) else { panic!("{text} is broken") };
            assert!(sentence.contains(why) && sentence.contains("is no calibration") && !sentence.contains('\n'), "{sentence}");
        }
    }
}
