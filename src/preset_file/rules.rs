//! SampleTests: what the lanes of a key must be to one another; an error completes a sentence that begins with the key.

use super::{
    form::{Value, format_number},
    polyline,
};

pub fn rises(range: &Value) -> Result<(), String> {
    let [from, to] = range.lanes();
    if from < to { Ok(()) } else { Err(format!("must rise, but {} is not before {}", format_number(from), format_number(to))) }
}

pub fn is_polyline(text: &Value) -> Result<(), String> {
    polyline::parse(&text.clone().into_text()).map(drop)
}

pub fn encloses(room: &Value) -> Result<(), String> {
    match room.first() {
        room if room == 0.0 || room >= 1.0 => Ok(()),
        room => Err(format!("{} is narrower than the scene; it must be 0 or 1..=100", format_number(room))),
    }
}
