//! Costs: time of a frame on a rung as a share of its time on the usual one, as measured (README, the price of exactness).
//! Only what is cheaper by more than the noise of a measurement stands here; the rest gains nothing and is never chosen.

use super::Caps;
use crate::ladder::Axis;

/// Axis, rung, share on a CPU adapter, share on a graphics card.
const MEASURED: &[(&str, &str, f64, f64)] = &[];

/// Share of the usual time.
pub(super) fn of(axis: &Axis, place: usize, caps: &Caps) -> f64 {
    let is_it = |row: &&(&str, &str, f64, f64)| (row.0, row.1) == (axis.name, axis.words[place]);
    MEASURED.iter().find(is_it).map_or(1.0, |&(_, _, software, card)| if caps.software { software } else { card })
}

/// Is the rung worth leaving `from` for?
pub(super) fn saves(axis: &Axis, place: usize, from: usize, caps: &Caps) -> bool {
    of(axis, place, caps) < of(axis, from, caps)
}

#[cfg(test)]
mod tests {
    use super::MEASURED;
    use crate::ladder::Axis;

    #[test]
    fn every_cost_is_of_a_rung_and_below_the_usual() {
        for &(axis, rung, software, card) in MEASURED {
            let axis = Axis::find(axis).unwrap_or_else(|| panic!("no axis {axis}"));
            assert!(axis.words.contains(&rung), "no rung {rung} on {}", axis.name);
            assert!((0.0..=1.0).contains(&software) && (0.0..=1.0).contains(&card), "{rung}");
        }
    }
}
