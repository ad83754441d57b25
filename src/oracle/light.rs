//! Light: the shadow map in f64, and the share of a directional light that arrives at a sample by it.
//!
//! The map holds, for the middle of every texel, the depth of the nearest triangle of the scene as the light sees it. A tap
//! finds a texel lit where the plane of the sample's triangle, at the middle of that texel and moved towards the light by
//! bias + slope · tan, is not behind what the map has there; tan, of the angle between light and normal, counts up to
//! [`MAX_SHADOW_SLOPE`]. With n taps a side the sample takes those round its own texel; the weights of the outermost are 1 - f
//! and f, f being how far the sample stands in its texel, and of the others 1.
//!
//! An f32 twin errs in where a sample lies, so it may meet another texel or pass a depth by a hair. Shading with a nudge to
//! either side gives the least and the most that may then arrive.

use glam::{DVec2, DVec3};

use super::{
    coverage::{cover_depths, depth_key, triangles},
    decide::{decide, wrong},
    judge::{judge_vertices, key_fits, vertex_faults},
    project::project_moved,
    rays::Rays,
    rules::SampleTests,
    surface::each_surface,
};
use crate::{
    effects::{
        Stack,
        shadow::{MAX_SHADOW_SLOPE, Shadow},
    },
    frame::{Geometry, LightMap},
    measure::{ErrorReport, ShadowErrors},
    scene::{
        Scene,
        draw::{Draw, DrawError, draws},
        shadow_resolution::ShadowResolution,
        view::View,
    },
};

/// Relative spacing of f32.
const ULP: f64 = f32::EPSILON as f64;

/// What the light of `stack` sees of `scene` as `view` shows it; none where no effect asks.
///
/// # Errors
/// When a placement or the number of triangles exceeds what the arithmetic holds.
pub fn shadow_map(scene: &Scene, view: &View, stack: &Stack) -> Result<Option<Box<LightMap>>, DrawError> {
    if view.precision.shadow == ShadowResolution::TRACED {
        return Ok(None);
    }
    let Some(view) = stack.light_view(scene, view) else { return Ok(None) };
    let casting = stack.casting();
    let draws = draws(scene, &view)?;
    let mut geometry = project_moved(scene, &draws, &view, &casting);
    geometry.sample_setups = decide(scene, &draws, &view, &casting, &geometry);
    let (triangles, _) = triangles(scene, &draws, &geometry);
    let rules = SampleTests::of(&casting, &geometry).masked(scene, &draws, &casting);
    let depths = cover_depths(&rules, &triangles, &view);
    let keys = depths.iter().map(|cell| if cell.depth.is_finite() { depth_key(cell.depth) } else { 0 }).collect();
    Ok(Some(Box::new(LightMap { keys, geometry })))
}

/// Where a sample lies, for the light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// On the ray of its pixel, however corners have snapped.
    pub position: DVec3,
    /// On its triangle.
    pub surface: DVec3,
    /// Of the plane of its triangle, a unit vector.
    pub flat_normal: DVec3,
    /// How far an f32 twin may put it from there.
    pub error_bound_m: f64,
}

/// A light, and what tells how much of it arrives.
pub(super) enum Light<'a> {
    Mapped(Box<Mapped<'a>>),
    Traced(Rays),
}

impl<'a> Light<'a> {
    /// The light of `stack`, whose map `geometry` holds.
    pub fn of(scene: &Scene, view: &View, stack: &Stack, geometry: &'a Geometry) -> Option<Self> {
        if view.precision.shadow == ShadowResolution::TRACED {
            return Rays::of(scene, view, stack).map(Self::Traced);
        }
        Mapped::of(scene, view, stack, geometry).map(|mapped| Self::Mapped(Box::new(mapped)))
    }

    /// Share of the light that arrives at a sample of the triangle `triangle id`; the least an f32 twin may find where `nudge` is
    /// below 0, the most where it is above.
    pub fn arrives(&self, place: &Place, triangle_id: u32, nudge: f64) -> f64 {
        match self {
            Self::Mapped(mapped) => mapped.arrives(place, nudge),
            Self::Traced(rays) => f64::from(u8::from(rays.reach(place, triangle_id))),
        }
    }
}

/// A light with its map.
pub(super) struct Mapped<'a> {
    keys: &'a [u32],
    view: View,
    params: Shadow,
    side: i64,
    reach: i64,
    /// Metres from texel to texel, and from depth 0 to depth 1.
    texel_m: f64,
    depth_range_m: f64,
    /// Unit vectors to the right and down in the map, and towards the light.
    axes: [DVec3; 3],
}

impl<'a> Mapped<'a> {
    fn of(scene: &Scene, view: &View, stack: &Stack, geometry: &'a Geometry) -> Option<Self> {
        let (params, keys) = (stack.light()?, &geometry.light.as_ref()?.keys);
        let view = stack.light_view(scene, view)?;
        assert_eq!(keys.len(), view.pixels(), "the shadow map is of another view");
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

    fn arrives(&self, place: &Place, nudge: f64) -> f64 {
        let clip = self.view.clip_from_world * place.position.extend(1.0);
        let half = 0.5 * self.side as f64;
        let at = DVec2::new((1.0 + clip.x) * half, (1.0 - clip.y) * half);
        let [across, down, along] = self.axes.map(|axis| axis.dot(place.flat_normal));
        // A plane that the light sees edge-on falls without bound.
        let along = if along < 0.0 { along.min(-1e-3) } else { along.max(1e-3) };
        let slant = DVec2::new(across, down) / along;
        let tangent = slant.length();
        let held = tangent.min(MAX_SHADOW_SLOPE);
        let texel_depth = self.texel_m / self.depth_range_m;
        let fall = if tangent > 0.0 { -slant * (held / tangent * texel_depth) } else { DVec2::ZERO };
        let bias = f64::from(self.params.bias) + f64::from(self.params.slope) * held;
        let depth = clip.z + bias * texel_depth;
        if nudge == 0.0 {
            return self.filtered(at, depth, fall);
        }
        // Rounding of the place and of the product with the matrix; the normal's goes with the square of the tangent.
        let aside = place.error_bound_m / self.texel_m + 4.0 * ULP * self.side as f64;
        let deep = (place.error_bound_m + self.texel_m * (1.0 + held * held) / f64::from(1 << 14)) / self.depth_range_m + 4.0 * ULP;
        let ends = [[-1.0, -1.0], [1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [0.0, 0.0]];
        let shares = ends.map(|[x, y]| self.filtered(at + DVec2::new(x, y) * aside, depth + nudge.signum() * deep, fall));
        let pick = if nudge < 0.0 { f64::min } else { f64::max };
        shares.into_iter().reduce(pick).expect("five ends")
    }

    /// Taps round a place, weighted.
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
                if self.is_lit(first.x as i64 + x, first.y as i64 + y, depth + fall.dot(offset)) {
                    sum += weight(x, inside.x) * weight(y, inside.y);
                }
            }
        }
        let whole = (2 * reach).max(1) as f64;
        sum / (whole * whole)
    }

    /// Does nothing in the texel stand before this depth? Beyond the map stands nothing.
    fn is_lit(&self, x: i64, y: i64, depth: f64) -> bool {
        if !(0..self.side).contains(&x) || !(0..self.side).contains(&y) {
            return true;
        }
        let key = self.keys[(y * self.side + x) as usize];
        key == 0 || depth >= f64::from(f32::from_bits(key))
    }
}

/// How far an f32 twin may put a sample: weights of small triangles err by 9, of large ones by 15 steps, the place on the
/// ray by a few more; what clipping left, by 2^-16 of the distance.
pub(super) fn error_bound_m(view: &View, position: DVec3, is_cut: bool) -> f64 {
    let (away, out) = ((position - view.eye).length(), view.eye.length());
    if is_cut { (away + out) / f64::from(1 << 15) } else { (24.0 * away + 4.0 * out) * ULP }
}

/// Judges the map of an adapter from its own records, as a picture's depths are judged, and those records.
pub(super) fn judge(accuracy: &mut ErrorReport, scene: &Scene, view: &View, stack: &Stack, map: &LightMap) -> Result<(), DrawError> {
    let Some(view) = stack.light_view(scene, view) else { return Ok(()) };
    let casting = stack.casting();
    let draws = draws(scene, &view)?;
    let own = project_moved(scene, &draws, &view, &casting);
    assert_eq!(map.geometry.vertices.len(), own.vertices.len(), "the shadow map is of another scene or stack");
    let (triangles, _) = triangles(scene, &draws, &map.geometry);
    let rules = SampleTests::of(&casting, &map.geometry).masked(scene, &draws, &casting);
    for (cell, &key) in cover_depths(&rules, &triangles, &view).iter().zip(&map.keys) {
        let is_covered = cell.depth.is_finite();
        accuracy.holes += u64::from(is_covered && key == 0);
        accuracy.double_hits += u64::from(!is_covered && key != 0);
        accuracy.key_outside_bound += u64::from(is_covered && key != 0 && !key_fits(key, cell.interval));
    }
    judge_vertices(accuracy, &vertex_faults(scene, &draws, &view, &casting, &map.geometry, &own));
    accuracy.sample_setups_wrong += wrong(scene, &draws, &view, &casting, &map.geometry);
    Ok(())
}

/// How far the light that arrives by the map of `geometry` is from what rays say, over all pixels that face the light and
/// have an triangle id; none without a light, or where effects leave samples out, of which rays know nothing.
///
/// # Errors
/// When a placement or the number of triangles exceeds what the arithmetic holds.
pub fn shadow_errors(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    triangle_ids: &[u32],
    geometry: &Geometry,
) -> Result<Option<ShadowErrors>, DrawError> {
    let (view, stack) = (&view.scaled(geometry.scale), &stack.scaled(geometry.scale));
    let view = &view.with_grid(geometry.subpixel_bits, geometry.is_relative);
    let draws: Vec<Draw> = draws(scene, view)?;
    let (Some(mapped), false) = (Light::of(scene, view, stack, geometry), leaves_out(stack)) else { return Ok(None) };
    let (Some(rays), Some(light)) = (Rays::of(scene, view, stack), stack.light()) else { return Ok(None) };
    let toward = light.toward();
    let shares = each_surface((scene, &draws, view, stack), triangle_ids, geometry, [0.0; 3], |found| {
        let (triangle, surface) = found.filter(|(_, surface)| surface.normal.dot(toward) > 0.0)?;
        let place = triangle.place(view, &surface);
        let reference = f64::from(u8::from(rays.reach(&place, surface.triangle_id)));
        Some(mapped.arrives(&place, surface.triangle_id, 0.0) - reference)
    });
    let errors: Vec<f64> = shares.into_iter().flatten().collect();
    let squares: f64 = errors.iter().map(|error| error * error).sum();
    Ok(Some(ShadowErrors {
        pixels: errors.len() as u64,
        wrong: errors.iter().filter(|error| error.abs() > 0.5).count() as u64,
        rms: (squares / (errors.len() as f64).max(1.0)).sqrt(),
    }))
}

/// Does an effect leave samples out, or show but a part of a triangle?
pub(super) fn leaves_out(stack: &Stack) -> bool {
    stack.each(|hooks| hooks.sample).next().is_some() || stack.particle_settings().is_some()
}
