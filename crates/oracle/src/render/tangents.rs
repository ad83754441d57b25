//! Tangents in f64: normals that a texture turns, as glTF 2.0 (section 3.9.3) defines them.

use glam::DVec3;

use super::super::shot::Shot;
use crate::scene::draw::Draw;

/// The tangents of the corners of a triangle, as `scene::tangents` explains them.
#[derive(Clone, Copy, Debug)]
pub struct Tangents {
    /// World space, of any length.
    pub corners: [DVec3; 3],
    /// Lengths of the edges of which each is made, to which rounding errors are proportional.
    pub lengths: [f64; 3],
    /// To which side of normal and tangent the image rises: -1 or 1.
    side: f64,
    /// -1 where the normal was turned because the triangle is seen from behind, else 1.
    facing: f64,
}

impl Tangents {
    /// Shortest part of a tangent, of the whole, that makes a direction on the surface.
    const SHORTEST: f64 = 1.0 / 1024.0;

    /// Of a triangle with these corners in object space.
    pub fn of(
        shot: &Shot,
        draw: &Draw,
        triangle: u32,
        object: [DVec3; 3],
        facing: f64,
    ) -> Option<Self> {
        let stored = shot.scene.primitives[draw.primitive].tangents?;
        let factors = [0, 1, 2]
            .map(|k| DVec3::from(stored.vector(&shot.scene.vertex_bytes, 3 * triangle + k)));
        let edges = [1, 2].map(|k| {
            draw.world_from_object
                .transform_vector3(object[k] - object[0])
        });
        let mirror = if draw.mirrored { -1.0 } else { 1.0 };
        Some(Self {
            corners: factors.map(|factor| edges[0] * factor.x + edges[1] * factor.y),
            lengths: factors.map(|factor| {
                edges[0].length() * factor.x.abs() + edges[1].length() * factor.y.abs()
            }),
            side: mirror * if factors[0].z < 0.0 { -1.0 } else { 1.0 },
            facing,
        })
    }

    /// The tangent at a sample, of any length.
    fn at(&self, weights: [f64; 3]) -> DVec3 {
        (0..3).map(|k| self.corners[k] * weights[k]).sum()
    }

    /// The part of a tangent across a normal, and the length by which it is divided.
    fn on_surface(tangent: DVec3, normal: DVec3) -> (DVec3, f64) {
        let aside = tangent - normal * normal.dot(tangent);
        let shortest = (Self::SHORTEST * tangent.length()).max(1e-30);
        (aside, aside.length().max(shortest))
    }

    /// The unit normal that a texture's normal makes of `normal`, which keeps it where that has no
    /// length.
    pub fn turned(&self, weights: [f64; 3], normal: DVec3, bump: DVec3) -> DVec3 {
        let outward = normal * self.facing;
        let (aside, length) = Self::on_surface(self.at(weights), outward);
        let along = aside / length;
        let across = outward.cross(along) * self.side;
        let turned = along * bump.x + across * bump.y + outward * bump.z;
        if turned.length_squared() > 1e-6 {
            turned.normalize() * self.facing
        } else {
            normal
        }
    }

    /// Of the tangent at a sample: its length, and that by which it is divided for the direction on
    /// the surface.
    pub fn reach(&self, weights: [f64; 3], normal: DVec3) -> [f64; 2] {
        let tangent = self.at(weights);
        [tangent.length(), Self::on_surface(tangent, normal).1]
    }
}
