//! Polylines as text: points of three numbers, one per line or separated by semicolons.

/// Largest coordinate, meters.
const FARTHEST_M: f32 = 1e9;

/// Reads a polyline; an empty text has no points.
/// Errors: the first point that is malformed or repeats the one before. Completes a sentence that
/// begins with the setting's name.
pub fn parse(text: &str) -> Result<Vec<[f32; 3]>, String> {
    let mut points: Vec<[f32; 3]> = Vec::new();
    for written in text
        .split([';', '\n'])
        .map(str::trim)
        .filter(|written| !written.is_empty())
    {
        let number = points.len() + 1;
        let numbers: Vec<&str> = written
            .split([' ', '\t', ','])
            .filter(|number| !number.is_empty())
            .collect();
        let numbers: [&str; 3] = numbers.try_into().map_err(|numbers: Vec<&str>| {
            format!(
                "has {} numbers in point {number}, {written:?}; it needs 3",
                numbers.len()
            )
        })?;
        let mut point = [0.0; 3];
        for (coordinate, written) in point.iter_mut().zip(numbers) {
            let value: f32 = written
                .parse()
                .map_err(|_| format!("has {written:?} in point {number}, which is not a number"))?;
            if !value.is_finite() || value.abs() > FARTHEST_M {
                return Err(format!(
                    "has {written} in point {number}; coordinates must lie within -1e9..=1e9"
                ));
            }
            *coordinate = value;
        }
        if points.last() == Some(&point) {
            return Err(format!(
                "has point {number} equal to the one before, {written:?}; remove one of them"
            ));
        }
        points.push(point);
    }
    match points.len() {
        1 => Err("has one point; a line needs at least two".into()),
        _ => Ok(points),
    }
}

/// The text that [`parse`] reads back to the same bits.
pub fn to_text(points: &[[f32; 3]]) -> String {
    points
        .iter()
        .map(|[x, y, z]| format!("{x} {y} {z}"))
        .collect::<Vec<_>>()
        .join("; ")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polyline_reads_back_to_the_bit() {
        let points = [[0.1, -0.0, 1e-40], [1e9, 3.402_823, -7.0], [0.0, 0.0, 0.0]];
        let back = parse(&to_text(&points)).expect("a polyline");
        assert_eq!(
            back.iter()
                .flatten()
                .map(|v| v.to_bits())
                .collect::<Vec<_>>(),
            points
                .iter()
                .flatten()
                .map(|v| v.to_bits())
                .collect::<Vec<_>>()
        );
        assert_eq!(
            parse("\n 0 0 0\n1,2,3 ; 4 5\t6\n"),
            Ok(vec![[0.0; 3], [1.0, 2.0, 3.0], [4.0, 5.0, 6.0]])
        );
        assert_eq!(parse(" ; \n"), Ok(Vec::new()));
    }

    #[test]
    fn what_is_no_line_is_refused_by_the_point() {
        let refused = |text: &str, words: &str| {
            let error = parse(text).expect_err(text);
            assert!(error.contains(words), "{text}: {error}");
        };
        refused("0 0 0; nan 0 0", "has nan in point 2");
        refused("0 0 0; 1 inf 0", "within -1e9..=1e9");
        refused("0 0 0; 1e39 0 0", "point 2");
        refused(
            "0 0 0; x 0 0",
            "has \"x\" in point 2, which is not a number",
        );
        refused("0 0 0; 1 0", "has 2 numbers in point 2");
        refused("0 0 0; 1 0 0; 1 0 0", "point 3 equal to the one before");
        refused("0 0 0; -0 0 0", "point 2 equal to the one before");
        refused("0 0 0", "a line needs at least two");
    }
}
