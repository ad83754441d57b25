//! The axis of a file that is up, and the turn that makes it +y, which is up in every scene.

use glam::{DMat4, DVec3, DVec4};

use super::{
    bounds::Bounds,
    framing::FramingPoints,
    model::{Scene, SceneCamera},
};

/// The axis of a file that is up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum UpAxis {
    /// As glTF has it.
    #[default]
    Y,
    Z,
    X,
    NegY,
    NegZ,
    NegX,
    /// Found when the scene is loaded: as its format says, or guessed where that says nothing.
    Auto,
}

impl UpAxis {
    pub const ALL: [Self; 7] = [
        Self::Y,
        Self::Z,
        Self::X,
        Self::NegY,
        Self::NegZ,
        Self::NegX,
        Self::Auto,
    ];
    /// The words in files.
    pub const WORDS: &[&str] = &["y", "z", "x", "-y", "-z", "-x", "auto"];

    /// The word in files.
    pub const fn word(self) -> &'static str {
        Self::WORDS[self as usize]
    }

    /// This axis, or `other` where none is named.
    #[must_use]
    pub const fn or(self, other: Self) -> Self {
        if matches!(self, Self::Auto) {
            other
        } else {
            self
        }
    }

    /// The turn that makes this axis +y, without rounding.
    pub const fn turn(self) -> DMat4 {
        let [x, y, z] = match self {
            Self::Y | Self::Auto => [DVec4::X, DVec4::Y, DVec4::Z],
            Self::Z => [DVec4::X, DVec4::NEG_Z, DVec4::Y],
            Self::X => [DVec4::Y, DVec4::NEG_X, DVec4::Z],
            Self::NegY => [DVec4::NEG_X, DVec4::NEG_Y, DVec4::Z],
            Self::NegZ => [DVec4::X, DVec4::Z, DVec4::NEG_Y],
            Self::NegX => [DVec4::NEG_Y, DVec4::X, DVec4::Z],
        };
        DMat4::from_cols(x, y, z, DVec4::W)
    }

    /// The axis that is up in a file of meshes, which says nothing of it. `bounds` is its box,
    /// `names` are those of the file and its parts, `heights` is [`Scene::height_axis`], `foot` is
    /// [`Scene::foot_axis`], and `usual` is the axis of the format.
    ///
    /// The first of these that holds decides: a name says `y-up` or `z-up`; the box lies far away along
    /// two axes and not along the third, as coordinates of a map do; the model is a terrain; it stands on
    /// the plane through the origin and rises above it by at least a quarter of its size; it has a foot.
    /// Else it is `usual`.
    pub fn guessed<'a>(
        bounds: &Bounds,
        names: impl IntoIterator<Item = &'a str>,
        (heights, foot): (impl FnOnce() -> Option<Self>, impl FnOnce() -> Option<Self>),
        usual: Self,
    ) -> Self {
        for name in names {
            let name = name.to_lowercase();
            let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
            let says = |axis: &str, both: &str| {
                words.contains(&both) || words.windows(2).any(|pair| *pair == [axis, "up"])
            };
            match (says("y", "yup"), says("z", "zup")) {
                (true, false) => return Self::Y,
                (false, true) => return Self::Z,
                _ => {}
            }
        }
        let extent = bounds.max - bounds.min;
        let size = extent.max_element();
        if bounds.is_empty() || size <= 0.0 {
            return usual;
        }
        // Farther than models are drawn from their origin, and than their own size.
        let away = bounds.center().abs() / size.max(FAR_M);
        let [x, y, z] = away.to_array().map(|away| away > 4.0);
        match [x, y, z] {
            [true, true, false] => return Self::Z,
            [true, false, true] => return Self::Y,
            _ => {}
        }
        if let Some(axis) = heights() {
            return axis;
        }
        let stands =
            |axis: usize| bounds.min[axis].abs() <= FLAT * size && extent[axis] >= RISES * size;
        match (stands(1), stands(2)) {
            (true, false) => Self::Y,
            (false, true) => Self::Z,
            _ => foot().unwrap_or(usual),
        }
    }
}

/// Coordinates of a map are at least some times as large, meters.
const FAR_M: f64 = 1e3;

/// The least height of what stands, of its largest extent.
const RISES: f64 = 0.25;

/// How far from a plane lies what is in it, of the largest extent.
const FLAT: f64 = 1e-3;

/// What lies in a plane is a foot from the first of these on and none below the second, of the area
/// of the box.
const FOOT: [f64; 2] = [0.25, 0.05];

/// How often the faces of a terrain cover its box, seen from above.
const COVERS: std::ops::RangeInclusive<f64> = 0.9..=1.1;

impl Scene {
    /// The one of +y and +z along which the model has heights, as a terrain: it is low, and seen along
    /// it the faces show one side and cover the box once.
    pub fn height_axis(&self) -> Option<UpAxis> {
        let extent = self.bounds().max - self.bounds().min;
        let heights = FLAT * extent.max_element()..RISES * extent.max_element();
        if ![extent.y, extent.z].iter().any(|e| heights.contains(e)) {
            return None;
        }
        let [mut sum, mut whole] = [DVec3::ZERO; 2];
        for instance in &self.instances {
            let primitive = &self.primitives[instance.primitive];
            if primitive.is_points() || primitive.is_lines() {
                return None;
            }
            for t in 0..primitive.triangle_count() {
                let [a, b, c] = primitive.corners(self, t).map(|vertex| {
                    let position = DVec3::from(primitive.position(self, vertex).map(f64::from));
                    instance.world_from_object.transform_point3(position)
                });
                let area = (b - a).cross(c - a) / 2.0;
                (sum, whole) = (sum + area, whole + area.abs());
            }
        }
        let is_height = |axis: usize| {
            let covered =
                [sum.abs(), whole].map(|areas| areas[axis] / (extent.x * extent[3 - axis]));
            heights.contains(&extent[axis]) && covered.iter().all(|times| COVERS.contains(times))
        };
        match [is_height(1), is_height(2)] {
            [true, _] => Some(UpAxis::Y),
            [_, true] => Some(UpAxis::Z),
            _ => None,
        }
    }

    /// The one of +y and +z along which the model has a foot: its vertices in the plane at the lower
    /// end span much of the box, and at least twice as much as those at the upper end, as of a pyramid,
    /// a chair, or a statue on its base. None if it has no foot, or something like it along both.
    pub fn foot_axis(&self) -> Option<UpAxis> {
        let bounds = self.bounds();
        let extent = bounds.max - bounds.min;
        let flat = FLAT * extent.max_element();
        let mut ends = [[Bounds::EMPTY; 2]; 2];
        for instance in &self.instances {
            let primitive = &self.primitives[instance.primitive];
            for vertex in 0..primitive.positions.count {
                let position = DVec3::from(primitive.position(self, vertex).map(f64::from));
                let place = instance.world_from_object.transform_point3(position);
                for (axis, ends) in ends.iter_mut().enumerate() {
                    for (end, plane) in ends.iter_mut().zip([bounds.min, bounds.max]) {
                        if (place[axis + 1] - plane[axis + 1]).abs() <= flat {
                            end.include(place);
                        }
                    }
                }
            }
        }
        let spans = |axis: usize, end: usize| {
            let found = &ends[axis][end];
            // Along x, and along the other one of y and z.
            [0, 2 - axis].map(|side| (found.max - found.min)[side].max(0.0) / extent[side])
        };
        let area = |axis, end| spans(axis, end).iter().product::<f64>();
        let is_foot = |axis: usize| {
            let foot = area(axis, 0);
            extent[axis + 1] >= RISES * extent.max_element()
                && foot >= FOOT[0]
                && 2.0 * area(axis, 1) <= foot
                && area(1 - axis, 0) < FOOT[1]
        };
        match [is_foot(0), is_foot(1)] {
            [true, _] => Some(UpAxis::Y),
            [_, true] => Some(UpAxis::Z),
            _ => None,
        }
    }

    /// The scene, as its file has it, with this axis of the file up: what it shows, its cameras and
    /// its lights.
    #[must_use]
    pub fn turned_up(mut self, up: UpAxis) -> Self {
        self.up = up;
        if matches!(up, UpAxis::Y | UpAxis::Auto) {
            return self;
        }
        let turn = up.turn();
        self.rig.turn = Some(turn);
        for instance in &mut self.instances {
            if instance.skin.is_none() {
                instance.world_from_object = turn * instance.world_from_object;
            }
        }
        for SceneCamera { pose, .. } in &mut self.cameras {
            pose.eye = turn.transform_point3(pose.eye);
            pose.target = turn.transform_point3(pose.target);
            pose.up = turn.transform_vector3(pose.up);
        }
        for light in &mut self.lights {
            light.world_from_light = turn * light.world_from_light;
        }
        let motion = self.rig.motion_bounds;
        self.rig.motion_bounds = Bounds::EMPTY;
        self.rig
            .motion_bounds
            .include_transformed(&turn, &motion, 0.0);
        self.framing = FramingPoints::default();
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{
        builtin,
        pose::{Motion, Pose},
    };

    #[test]
    fn every_turn_makes_its_axis_up_and_keeps_the_handedness() {
        let axes = [
            DVec3::Y,
            DVec3::Z,
            DVec3::X,
            DVec3::NEG_Y,
            DVec3::NEG_Z,
            DVec3::NEG_X,
        ];
        for (up, axis) in UpAxis::ALL.into_iter().zip(axes) {
            assert_eq!(up.turn().transform_vector3(axis), DVec3::Y, "{up:?}");
            assert_eq!(up.turn().determinant(), 1.0, "{up:?}");
        }
    }

    #[test]
    fn what_moves_turns_as_what_stands_still_does() {
        for query in ["tentacle?tess=2", "teapot?tess=2", "finishes?lamps=3"] {
            let scene = builtin::build(query).expect("a scene");
            for up in UpAxis::ALL {
                let turned = scene.clone().turned_up(up);
                let places = |scene: &Scene| match Pose::at_rest(scene) {
                    Some(_) => Pose::at(
                        scene,
                        &Motion {
                            clip: Some(0),
                            time_s: 0.3,
                            ..Motion::default()
                        },
                    )
                    .bounds(scene),
                    None => scene.bounds(),
                };
                let mut expected = Bounds::EMPTY;
                expected.include_transformed(&up.turn(), &places(&scene), 0.0);
                let found = places(&turned);
                let off = (found.min - expected.min)
                    .abs()
                    .max((found.max - expected.max).abs());
                assert!(
                    off.max_element() < 1e-6,
                    "{query} {up:?}: {found:?}, not {expected:?}"
                );
                for (before, after) in scene.lights.iter().zip(&turned.lights) {
                    let [before, after] =
                        [before, after].map(|light| light.world_from_light.w_axis);
                    assert_eq!(up.turn() * before, after, "{query} {up:?}");
                }
            }
        }
    }

    #[test]
    fn the_axis_of_a_mesh_is_guessed_with_care() {
        // The box, the usual axis, the right one, and a name.
        let table = "
            -1 -1 -1  1 1 1  y z  Part_Z-UP
            -1 -1 -1  1 1 1  z y  castle yup
            -1 -1 -1  1 1 1  y y  zup and y-up
            -1 -1 -1  1 1 1  y y  Syzup
            -1 -1 -1  1 1 1  z z  nothing tells
            1 1 1  -1 -1 -1  z z  empty
            -1 -1 0  1 1 2   y z  stands
            -1 0 -1  1 2 1   z y  stands
            0 0 0  1 1 1     y y  stands either way
            10 0.5 0  11 1.5 1  y z  stands aside
            -1 -1 0  1 1 0.1 y y  a sign on a wall
            -1 0 -1  1 0.1 1 z z  a plate on the bed of a printer
            448250 5411930 90  448260 5411940 99    y z  east and north of a map
            448250 90 -5411940  448260 99 -5411930  z y  the same as y up has it";
        let axis = |word: &str| match word {
            "y" => UpAxis::Y,
            _ => UpAxis::Z,
        };
        for row in table.lines().skip(1) {
            let words: Vec<&str> = row.split_whitespace().collect();
            let number = |i: usize| words[i].parse::<f64>().expect("a number");
            let bounds = Bounds {
                min: DVec3::new(number(0), number(1), number(2)),
                max: DVec3::new(number(3), number(4), number(5)),
            };
            let name = words[8..].join(" ");
            let guessed = UpAxis::guessed(&bounds, [&*name], (|| None, || None), axis(words[6]));
            assert_eq!(guessed, axis(words[7]), "{row}");
        }
    }
}
