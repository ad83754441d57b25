//! Shadows: the shadow map in f64, and the fraction of a directional light that arrives at a
//! sample.
//!
//! The map holds, for the center of every texel, the depth of the nearest triangle as the light
//! sees the scene. A tap finds a texel lit if the plane of the sample's triangle, at the center of
//! that texel and moved towards the light by bias + slope · tan, is not behind the depth in the
//! map; tan, of the angle between light and normal, counts up to [`MAX_SHADOW_SLOPE`]. With n taps
//! a side the sample uses those round its own texel; the weights of the outermost are 1 - f and f,
//! where f is the sample's position in its texel, and those of the others 1.
//!
//! In f32 the sample's position has an error, so it may meet another texel or pass a depth
//! comparison by a hair. A perturbation to either side gives the least and the most light that may
//! then arrive.

use glam::{DVec2, DVec3};

use super::{
    super::{arithmetic::depth_key::depth_key, shot::Shot},
    coverage::nearest_depths,
    project::project,
    rays::Rays,
    sample_rules::SampleTests,
    sample_setup::sample_setups,
    triangles::triangles,
    work_limits::check_samples,
};
use crate::{
    effects::{
        Stack,
        hooks::ROUNDING,
        shadow::{MAX_SHADOW_SLOPE, Shadow},
    },
    frame::{Geometry, ShadowMap},
    scene::{Scene, draw::DrawError, shadow_resolution::ShadowResolution, view::View},
};

/// The shadow map of `scene` for the light of `stack`; none if no effect needs one, or if shadows
/// are traced.
pub fn shadow_map(
    scene: &Scene,
    view: &View,
    stack: &Stack,
) -> Result<Option<Box<ShadowMap>>, DrawError> {
    let Some(view) = stack.shadow_map_view(scene, view) else {
        return Ok(None);
    };
    let casting = stack.shadow_casters();
    let draws = casting.draws(scene, &view)?;
    let shot = Shot::new(scene, &draws, &view, &casting);
    let mut geometry = project(&shot)?;
    geometry.sample_setups = sample_setups(&shot, &geometry);
    let (triangles, _) = triangles(&shot, &geometry)?;
    let tests = SampleTests::new(&shot, &geometry);
    check_samples("shadow map", &triangles, &tests, &view)?;
    let depths = nearest_depths(&tests, &triangles, &view)?;
    let keys = depths
        .iter()
        .map(|depth| {
            if depth.is_finite() {
                depth_key(*depth)
            } else {
                0
            }
        })
        .collect();
    Ok(Some(Box::new(ShadowMap {
        depth_keys: keys,
        geometry,
    })))
}

/// A sample whose illumination is computed.
#[derive(Clone, Copy, Debug)]
pub struct LitPoint {
    /// On the ray of its pixel, whichever way corners have snapped.
    pub on_ray: DVec3,
    /// On its triangle.
    pub on_triangle: DVec3,
    /// Unit normal of the triangle's plane.
    pub flat_normal: DVec3,
    /// Bound of the position's error in f32.
    pub error_m: f64,
}

/// A directional light with its shadows.
pub enum Light<'a> {
    Mapped(Box<ShadowLookup<'a>>),
    Traced(Rays),
}

impl<'a> Light<'a> {
    /// The light of the shot's stack, whose map is in `geometry`.
    pub fn of(shot: &Shot, geometry: &'a Geometry) -> Option<Self> {
        if shot.view.precision.shadow == ShadowResolution::TRACED {
            return Rays::of(shot).map(Self::Traced);
        }
        ShadowLookup::of(shot, geometry).map(|lookup| Self::Mapped(Box::new(lookup)))
    }

    /// Fraction of the light that arrives at a sample of the triangle `id`: the least that f32 may
    /// find if `step` is negative, the most if it is positive.
    pub fn arrives(&self, point: &LitPoint, id: u32, step: f64) -> f64 {
        match self {
            Self::Mapped(lookup) => lookup.arrives(point, step),
            Self::Traced(rays) => f64::from(u8::from(rays.reach(point.on_triangle, id))),
        }
    }
}

/// Lookups in a shadow map.
pub struct ShadowLookup<'a> {
    keys: &'a [u32],
    view: View,
    params: Shadow,
    /// Texels along a side of the map.
    side: i64,
    /// Taps on each side of the middle one.
    reach: i64,
    /// Meters from texel to texel.
    texel_m: f64,
    /// Meters from depth 0 to depth 1.
    depth_range_m: f64,
    /// Unit vectors to the right and down in the map, and towards the light.
    axes: [DVec3; 3],
}

impl<'a> ShadowLookup<'a> {
    fn of(shot: &Shot, geometry: &'a Geometry) -> Option<Self> {
        let (params, keys) = (
            shot.stack.light()?,
            &geometry.shadow_map.as_ref()?.depth_keys,
        );
        let view = shot.stack.light_view(shot.scene, shot.view)?;
        assert_eq!(
            keys.len(),
            view.pixels(),
            "the shadow map is of another view"
        );
        let rows = [0, 1, 2].map(|row| view.clip_from_world.row(row).truncate());
        let [right, up, near] = rows.map(DVec3::normalize);
        Some(Self {
            keys,
            params,
            side: view.width.into(),
            reach: i64::from(view.precision.shadow.taps) / 2,
            texel_m: 2.0 / (rows[0].length() * f64::from(view.width)),
            depth_range_m: 1.0 / rows[2].length(),
            axes: [right, -up, near],
            view,
        })
    }

    fn arrives(&self, point: &LitPoint, step: f64) -> f64 {
        let clip = self.view.clip_from_world * point.on_ray.extend(1.0);
        let half = 0.5 * self.side as f64;
        let at = DVec2::new((1.0 + clip.x) * half, (1.0 - clip.y) * half);
        let [right, down, along] = self.axes.map(|axis| axis.dot(point.flat_normal));
        // The slope of a plane that the light sees edge-on is unbounded.
        let along = if along < 0.0 {
            along.min(-1e-3)
        } else {
            along.max(1e-3)
        };
        let slant = DVec2::new(right, down) / along;
        let tangent = slant.length();
        let slope = tangent.min(MAX_SHADOW_SLOPE);
        let texel_depth = self.texel_m / self.depth_range_m;
        let fall = if tangent > 0.0 {
            -slant * (slope / tangent * texel_depth)
        } else {
            DVec2::ZERO
        };
        let bias = f64::from(self.params.bias) + f64::from(self.params.slope) * slope;
        let depth = clip.z + bias * texel_depth;
        if step == 0.0 {
            return self.filtered(at, depth, fall);
        }
        // Rounding of the position and of the product with the matrix; that of the normal grows
        // with the square of the tangent.
        let across = point.error_m / self.texel_m + 4.0 * ROUNDING * self.side as f64;
        let deep = (point.error_m + self.texel_m * (1.0 + slope * slope) / f64::from(1 << 14))
            / self.depth_range_m
            + 4.0 * ROUNDING;
        let ends = [
            [-1.0, -1.0],
            [1.0, -1.0],
            [-1.0, 1.0],
            [1.0, 1.0],
            [0.0, 0.0],
        ];
        let fractions = ends.map(|[x, y]| {
            self.filtered(
                at + DVec2::new(x, y) * across,
                depth + step.signum() * deep,
                fall,
            )
        });
        let pick = if step < 0.0 { f64::min } else { f64::max };
        fractions.into_iter().reduce(pick).expect("five ends")
    }

    /// Weighted mean of the taps round a position in the map, in texels; `fall` is the slope of the
    /// triangle's depth there.
    fn filtered(&self, at: DVec2, depth: f64, fall: DVec2) -> f64 {
        let (first, reach) = (at.floor(), self.reach);
        let inside = at - first;
        let weight = |tap: i64, inside: f64| match tap {
            _ if reach == 0 => 1.0,
            tap if tap == reach => inside,
            tap if tap == -reach => 1.0 - inside,
            _ => 1.0,
        };
        let mut sum = 0.0;
        for y in -reach..=reach {
            for x in -reach..=reach {
                let offset = DVec2::new(x as f64, y as f64) + 0.5 - inside;
                if self.is_lit(
                    first.x as i64 + x,
                    first.y as i64 + y,
                    depth + fall.dot(offset),
                ) {
                    sum += weight(x, inside.x) * weight(y, inside.y);
                }
            }
        }
        let whole = (2 * reach).max(1) as f64;
        sum / (whole * whole)
    }

    /// Returns true if nothing in the texel is nearer to the light than this depth. Outside the map
    /// there is nothing.
    fn is_lit(&self, x: i64, y: i64, depth: f64) -> bool {
        if !(0..self.side).contains(&x) || !(0..self.side).contains(&y) {
            return true;
        }
        let key = self.keys[(y * self.side + x) as usize];
        key == 0 || depth >= f64::from(f32::from_bits(key))
    }
}

/// Returns true if an effect leaves samples out or shows only parts of triangles, of which rays
/// know nothing.
pub fn leaves_samples_out(stack: &Stack) -> bool {
    stack.each(|hooks| hooks.sample.as_ref()).next().is_some()
        || stack.particle_settings().is_some()
}
