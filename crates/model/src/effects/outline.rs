//! Outline: lines where the integers of the picture change: at silhouettes, between objects, at
//! steps of depth.
//!
//! Triangle ids and depth keys alone decide, so a line is the same on every adapter that has the
//! same keys. The bits of a float are a piecewise linear logarithm: a relative step of depth is a
//! difference of depth keys.

use super::{
    BuiltIn, Effect,
    hooks::{ImageEffect, Picture, Pixel, tone::encoded},
};
use crate::{
    choice, params,
    params::{Color, Flag},
};

choice! {
    /// Which side of an edge the line lies on.
    pub enum Side {
        /// The farther: around what is in front.
        Outside = "outside",
        /// The nearer: within what is in front.
        Inside = "inside",
        /// Both, twice as wide.
        Both = "both",
    }
}

params! {
    pub struct Outline {
        /// Color of the line, linear; its alpha is the strength.
        color: Color = [0.004, 0.004, 0.008, 1.0];
        /// Width of the line.
        width_px: u32 = 2, hard 1.0..=64.0, soft 1.0..=8.0, unit "px";
        /// Which side of an edge the line lies on.
        side: Side = Side::Outside as u32;
        /// Lines between what is drawn and the background.
        silhouette: Flag = 1;
        /// Lines between objects.
        objects: Flag = 1;
        /// Lines between objects only where they meet: where their depths differ by less than a jump.
        intersections: Flag = 0;
        /// Lines where the depth jumps within an object.
        depth: Flag = 1;
        /// The least jump that counts, as a fraction of the distance.
        depth_threshold: f32 = 0.05, hard 0.0001..=1.0, soft 0.001..=0.5, log true;
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::new::<Outline>(
        "outline",
        "Outline",
        "lines at silhouettes, between objects and at steps of depth",
    )
    .on_image::<Outline>()
    .into()
});

/// Triangle id, depth key and draw of a pixel.
type Seen = (Option<u32>, u32, u32);

impl ImageEffect for Outline {
    fn finish(mut pixel: Pixel, picture: &Picture, p: &Self) -> Pixel {
        let (x, y) = (i64::from(pixel.x), i64::from(pixel.y));
        let here = picture.at(x, y);
        let (step, reach) = (i64::from(p.step()), i64::from(p.width_px));
        let steps = reach / step;
        let is_line = (-steps..=steps).any(|down| {
            (-steps..=steps).any(|right| {
                let (dx, dy) = (right * step, down * step);
                (1..=reach * reach).contains(&(dx * dx + dy * dy))
                    && picture.has(x + dx, y + dy)
                    && p.is_edge(here, picture.at(x + dx, y + dy), || {
                        picture
                            .has(x - dx, y - dy)
                            .then(|| picture.at(x - dx, y - dy))
                    })
            })
        });
        if is_line {
            let (ink, strength) = (encoded(p.color), f64::from(p.color[3]));
            pixel.color += (ink.truncate().extend(1.0) - pixel.color) * strength;
        }
        pixel
    }
}

impl Outline {
    /// Distance of two neighbors that are looked at, in pixels: a wide line looks at as many as one
    /// of 8 pixels.
    fn step(&self) -> u32 {
        self.width_px.div_ceil(8).max(1)
    }

    /// The least difference of depth keys that counts as a jump.
    fn jump(&self) -> i64 {
        (f64::from(self.depth_threshold) * f64::from(1 << 23)) as i64
    }

    /// Is there a line at a pixel because of its neighbor `there`? `beyond` is the neighbor on the
    /// opposite side.
    fn is_edge(&self, here: Seen, there: Seen, beyond: impl Fn() -> Option<Seen>) -> bool {
        let side = Side::of(self.side);
        if here.0.is_none() || there.0.is_none() {
            let is_right_side = side == Side::Both || here.0.is_none() == (side == Side::Outside);
            return self.silhouette != 0 && here.0 != there.0 && is_right_side;
        }
        if here.2 != there.2 {
            // Equal keys: the later object counts as behind.
            let is_behind = (here.1, there.2) < (there.1, here.2);
            let meets = || i64::from(there.1).abs_diff(here.1.into()) <= self.jump().unsigned_abs();
            return (self.objects != 0 || self.intersections != 0 && meets())
                && (side == Side::Both || is_behind == (side == Side::Outside));
        }
        let Some(beyond) =
            beyond().filter(|beyond| self.depth != 0 && beyond.0.is_some() && beyond.2 == here.2)
        else {
            return false;
        };
        // The second difference: a constant slope is no jump.
        let curvature = i64::from(there.1) + i64::from(beyond.1) - 2 * i64::from(here.1);
        let jump = self.jump();
        match side {
            Side::Outside => curvature > jump,
            Side::Inside => curvature < -jump,
            Side::Both => curvature.abs() > jump,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::*;

    /// Is a line drawn at any pixel of a row that shows two objects of four pixels each?
    fn has_line(keys: [u32; 8], p: &Outline) -> bool {
        let picture = Picture {
            width: 8,
            height: 1,
            triangle_ids: &[0, 0, 0, 0, 1, 1, 1, 1],
            keys: &keys,
            draws: &[0, 1],
            previous: None,
            background: &[[0; 4]],
        };
        (0..8).any(|x| {
            let pixel = Pixel {
                color: DVec4::ONE,
                x,
                y: 0,
                step_offset: 0.0,
            };
            Outline::finish(pixel, &picture, p) != pixel
        })
    }

    #[test]
    fn objects_meet_where_their_depths_agree() {
        let near = 0.5f32.to_bits();
        let step = 1 << 16; // A fraction of 2^-7 of the distance.
        let meeting = std::array::from_fn(|x| near + step * (x as u32).abs_diff(4));
        let apart = std::array::from_fn(|x| near - if x < 4 { 0 } else { 1 << 20 });
        let lines = |objects: u32, intersections: u32, depth_threshold: f32| {
            let p = Outline {
                objects,
                intersections,
                depth: 0,
                depth_threshold,
                width_px: 1,
                ..Outline::default()
            };
            [meeting, apart].map(|keys| has_line(keys, &p))
        };
        assert_eq!(lines(0, 0, 0.05), [false, false]);
        assert_eq!(lines(0, 1, 0.05), [true, false]);
        assert_eq!(lines(1, 0, 0.05), [true, true]);
        assert_eq!(lines(0, 1, 0.001), [false, false]);
        assert_eq!(lines(0, 1, 0.5), [true, true]);
    }

    /// The pixels of a wedge that points to the left, row-major, its tip in the middle of the picture.
    fn wedge(side: u32, half_angle: f64) -> Vec<u32> {
        let middle = f64::from(side / 2) + 0.5;
        let inside = |x: u32, y: u32| {
            let (across, down) = (f64::from(x) + 0.5 - middle, f64::from(y) + 0.5 - middle);
            across >= 0.0 && down.abs() <= across * half_angle.tan()
        };
        let pixels = (0..side * side).map(|i| inside(i % side, i / side));
        pixels.map(|is_inside| if is_inside { 0 } else { u32::MAX }).collect()
    }

    #[test]
    fn a_thick_line_goes_round_corners_without_a_gap() {
        const SIDE: u32 = 64;
        for (width_px, half_angle_deg) in [6, 8, 12, 16]
            .into_iter()
            .flat_map(|width| [15.0, 30.0, 45.0, 75.0].map(|angle| (width, angle)))
        {
            let half_angle = f64::to_radians(half_angle_deg);
            let triangle_ids = wedge(SIDE, half_angle);
            let picture = Picture {
                width: SIDE,
                height: SIDE,
                triangle_ids: &triangle_ids,
                keys: &vec![0.5f32.to_bits(); triangle_ids.len()],
                draws: &[0],
                previous: None,
                background: &[[0; 4]; SIDE as usize],
            };
            let p = Outline {
                width_px,
                ..Outline::default()
            };
            // A neighbor is looked for at every step, so a tip begins where it is as wide as one.
            let tip_px = 1.0 + f64::from(p.step()) / half_angle.sin();
            for i in 0..SIDE * SIDE {
                let (x, y) = (i % SIDE, i / SIDE);
                let pixel = Pixel {
                    color: DVec4::ONE,
                    x,
                    y,
                    step_offset: 0.0,
                };
                let is_line = Outline::finish(pixel, &picture, &p) != pixel;
                let [across, down] = [x, y].map(|at| f64::from(at) - f64::from(SIDE / 2));
                let from_tip = across.hypot(down);
                let is_outside = triangle_ids[i as usize] == u32::MAX;
                let is_near = from_tip + tip_px <= f64::from(width_px);
                assert!(
                    is_line || !is_outside || !is_near,
                    "{width_px} px, {half_angle_deg}°: a gap at {x}, {y}"
                );
                // Nothing of the wedge is nearer than its tip.
                let is_ahead = down.abs() * half_angle.tan() <= -across;
                let is_beyond = is_ahead && from_tip > f64::from(width_px);
                assert!(!is_line || !is_beyond, "{width_px} px: a spike at {x}, {y}");
            }
        }
    }
}
