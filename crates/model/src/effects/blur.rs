//! Blur: the picture out of focus, everywhere or away from a sharp band or disc.

use glam::{DVec2, DVec4};

use super::{
    BuiltIn, Effect,
    hooks::{ImageAt, PassEffect, tone::smooth},
};
use crate::{choice, words};

choice! {
    /// Where the picture is blurred.
    pub enum Area {
        /// All of it.
        Everywhere,
        /// Above and below a band, as a tilted lens does, which makes landscapes look like models.
        Band,
        /// Around a disc.
        Disc,
    }
}

words! {
    pub struct Blur of "blur" {
        area: u32,
        radius_px: f32,
        center_x: f32,
        center_y: f32,
        sharp: f32,
        soft: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Blur>()
    .on_passes::<Blur>()
    .into()
});

impl PassEffect for Blur {
    fn pass(index: usize, at: &ImageAt, p: &Self) -> DVec4 {
        let along = if index == 0 { [1, 0] } else { [0, 1] };
        let radius = f64::from(p.radius_px) * p.strength(at.middle(), at.picture_size());
        mean_along(at, along, radius)
    }
}

/// Weighted mean of what the last pass wrote along a direction, as far as `radius`, pixels.
fn mean_along(at: &ImageAt, along: [i64; 2], radius: f64) -> DVec4 {
    let reach = radius.ceil() as i64;
    let (mut sum, mut weights) = (DVec4::ZERO, 0.0);
    for i in -reach..=reach {
        let t = i as f64 / (radius + 1.0);
        let near = (1.0 - t * t).max(0.0);
        let weight = near * near * near;
        sum += weight * at.last(at.x + i * along[0], at.y + i * along[1]);
        weights += weight;
    }
    sum / weights
}

impl Blur {
    /// Fraction of the radius at a place.
    fn strength(&self, place: DVec2, size: DVec2) -> f64 {
        let center = DVec2::new(self.center_x.into(), self.center_y.into());
        let away = (place - center * size) / size.y;
        let distance = match Area::of(self.area) {
            Area::Everywhere => return 1.0,
            Area::Band => away.y.abs(),
            Area::Disc => away.length(),
        };
        smooth(0.0, 1.0, (distance - f64::from(self.sharp)) / f64::from(self.soft))
    }
}
