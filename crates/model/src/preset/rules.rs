//! Rules of settings that a range cannot say; an error completes a sentence that begins with the
//! setting's name.

use super::{GoldenTest, Preset, polyline};
use crate::{
    params::{Stored as _, Value, format_number},
    scene::parts::Scope,
};

pub fn rises(range: &Value) -> Result<(), String> {
    let [begin, end] = <[f64; 2]>::from_value(range).map_err(|error| error.to_string())?;
    let [shown_begin, shown_end] = [begin, end].map(format_number);
    if begin < end {
        Ok(())
    } else {
        Err(format!(
            "must rise, but {shown_begin} is not before {shown_end}"
        ))
    }
}

pub fn encloses_scene(room: &Value) -> Result<(), String> {
    let room = f64::from_value(room).map_err(|error| error.to_string())?;
    if room == 0.0 || room >= 1.0 {
        return Ok(());
    }
    Err(format!(
        "{} is narrower than the scene; it must be 0 or 1..=100",
        format_number(room)
    ))
}

pub fn is_polyline(text: &Value) -> Result<(), String> {
    polyline::parse(&String::from_value(text).map_err(|error| error.to_string())?).map(drop)
}

pub fn are_patterns(list: &Value) -> Result<(), String> {
    Scope::of_texts(&Vec::from_value(list).map_err(|error| error.to_string())?).map(drop)
}

pub fn is_file(path: &Value) -> Result<(), String> {
    let path = String::from_value(path).map_err(|error| error.to_string())?;
    if path.contains("://") {
        Err("must be a file, not an address".into())
    } else {
        Ok(())
    }
}

impl Preset {
    /// Is the budget of the test one that a file may state: explained where it is above the
    /// default, and without wrong triangles where every option is exact?
    /// Errors: the key that is at fault, and the rest of a sentence that begins with it.
    pub fn check_budget(&self) -> Result<(), [&'static str; 2]> {
        let (Some(test), default) = (&self.test, GoldenTest::default()) else {
            return Ok(());
        };
        if test.max_wrong_triangles > 0 && !self.accuracy.may_err() {
            let reason = "must be 0 here; it needs a pinned option that is not exact, or the tier draft or fast";
            return Err(["test.max_wrong_triangles", reason]);
        }
        let is_wider = test.max_channel > default.max_channel
            || test.max_pixels > default.max_pixels
            || test.max_wrong_triangles > 0;
        if is_wider && test.why.trim().is_empty() {
            return Err(["test.why", "must say why the budget is above the default"]);
        }
        Ok(())
    }
}
