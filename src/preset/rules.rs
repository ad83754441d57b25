//! Rules: what the lanes of a key must be to one another; an error completes a sentence that begins with the key.

use super::{
    form::{Plain, brief},
    polyline,
};

pub fn rises(range: &Plain) -> Result<(), String> {
    let [from, to] = range.lanes();
    if from < to { Ok(()) } else { Err(format!("must rise, but {} is not before {}", brief(from), brief(to))) }
}

pub fn is_polyline(text: &Plain) -> Result<(), String> {
    polyline::parse(&text.clone().into_text()).map(drop)
}

pub fn encloses(room: &Plain) -> Result<(), String> {
    match room.first() {
        room if room == 0.0 || room >= 1.0 => Ok(()),
        room => Err(format!("{} is narrower than the scene; it must be 0 or 1..=100", brief(room))),
    }
}
