//! A probed sample in words.

use std::fmt;

use super::{
    probe::{Outcome, ProbedSample, ProbedTriangle},
    render::coverage::EdgeAtSample,
};

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Shown => "shown",
            Self::Hidden => "behind",
            Self::Outside => "outside",
            Self::FacesAway => "faces away",
            Self::AfterDrawOrder => "after the draw order's end",
            Self::OutsideDisc => "outside its disc",
            Self::CutByMask => "cut out by its mask",
            Self::LeftOutBy(effect) => return write!(f, "left out by {effect}"),
        })
    }
}

impl EdgeAtSample {
    /// Distance of the sample from the line through the edge, in sub-pixel units; positive on the
    /// inner side, 0 for an edge without a length.
    pub fn distance(&self) -> f64 {
        let [dx, dy] = self.along.map(f64::from);
        let length = libm::hypot(dx, dy);
        if length > 0.0 {
            self.value as f64 / length
        } else {
            0.0
        }
    }

    fn word(&self, unit: f64) -> String {
        match (self.value, self.is_inside()) {
            (0, true) => "on, its own".into(),
            (0, false) => "on, another's".into(),
            _ => format!("{:+.4}", self.distance() / unit),
        }
    }
}

impl ProbedSample {
    /// What the sample shows, and a table of the triangles whose box holds it: what becomes of each,
    /// its depth key, how far the sample lies inside of each edge and where the corners are, pixels
    /// of a grid with so many bits of a fraction.
    pub fn text(&self, subpixel_bits: u32) -> String {
        let unit = f64::from(1u32 << subpixel_bits);
        let shows = match self.triangles.iter().find(|t| t.outcome == Outcome::Shown) {
            Some(shown) => format!(
                "triangle {} of {}, depth key {:#010x}",
                shown.id, shown.primitive, self.decided.depth_key
            ),
            None => "the background".into(),
        };
        let [x, y] = self.pixel;
        let layers = self.decided.layers;
        let mut text = format!(
            "drawn pixel {x},{y} shows {shows}; {layers} {}\n",
            if layers == 1 { "layer" } else { "layers" }
        );
        let heads = [
            "TRIANGLE",
            "OUTCOME",
            "DEPTH KEY",
            "EDGES",
            "",
            "",
            "CORNERS",
            "",
            "",
            "PART",
        ];
        let rows: Vec<[String; 10]> = [heads.map(str::to_owned)]
            .into_iter()
            .chain(self.triangles.iter().map(|triangle| row(triangle, unit)))
            .collect();
        if rows.len() == 1 {
            return text;
        }
        let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max();
        let widths: [usize; 10] = std::array::from_fn(|column| width(column).unwrap_or(0));
        for row in &rows {
            let cells = row.iter().zip(widths);
            let line: String = cells
                .map(|(cell, width)| format!("{cell:<width$}  "))
                .collect();
            text += line.trim_end();
            text.push('\n');
        }
        text
    }
}

fn row(triangle: &ProbedTriangle, unit: f64) -> [String; 10] {
    let id = triangle.id;
    let [e0, e1, e2] = triangle.edges.map(|edge| edge.word(unit));
    let [c0, c1, c2] = triangle.corners.map(|corner| {
        let [x, y] = [corner.x, corner.y].map(|at| f64::from(at) / unit);
        format!("{x:.3},{y:.3}")
    });
    [
        if triangle.is_clipped {
            format!("{id} clipped")
        } else {
            id.to_string()
        },
        triangle.outcome.to_string(),
        triangle
            .depth_key
            .map_or_else(|| "-".into(), |key| format!("{key:#010x}")),
        e0,
        e1,
        e2,
        c0,
        c1,
        c2,
        triangle.primitive.clone(),
    ]
}
