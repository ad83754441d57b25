//! Rules of settings that a range cannot say; an error completes a sentence that begins with the setting's name.

use super::polyline;
use crate::params::{Stored as _, Value, format_number};

pub fn rises(range: &Value) -> Result<(), String> {
    let [begin, end] = <[f64; 2]>::from_value(range).map_err(|error| error.to_string())?;
    let [shown_begin, shown_end] = [begin, end].map(format_number);
    if begin < end { Ok(()) } else { Err(format!("must rise, but {shown_begin} is not before {shown_end}")) }
}

pub fn encloses_scene(room: &Value) -> Result<(), String> {
    let room = f64::from_value(room).map_err(|error| error.to_string())?;
    if room == 0.0 || room >= 1.0 {
        return Ok(());
    }
    Err(format!("{} is narrower than the scene; it must be 0 or 1..=100", format_number(room)))
}

pub fn is_polyline(text: &Value) -> Result<(), String> {
    polyline::parse(&String::from_value(text).map_err(|error| error.to_string())?).map(drop)
}

pub fn is_file(path: &Value) -> Result<(), String> {
    let path = String::from_value(path).map_err(|error| error.to_string())?;
    if path.contains("://") { Err("must be a file, not an address".into()) } else { Ok(()) }
}
