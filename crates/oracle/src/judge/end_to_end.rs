//! End to end: an adapter's picture against the oracle's own, from the matrix bits on. Only what
//! snapped vertices explain may differ.

use super::{
    super::{
        bounds::coverage::{BoundedCoverage, cover_claims},
        point::Shown,
        render::{
            draw_order::limited,
            mask::is_masked,
            sample_rules::{DrawLimit, SampleTests},
            sample_setup::{effects_with_setup, mask_records},
            snap::half_size,
            triangles::triangles,
        },
        shot::Shot,
    },
    freedom::Freedom,
    outline::{Drawn, Outline, SamplePosition},
    vertices::VertexError,
};
use crate::{
    effects::hooks::Shape,
    frame::{BitExact, Frame, Geometry},
    measure::ErrorReport,
    scene::draw::Draw,
    work::{Canceled, checkpoint},
};

/// An adapter's picture beside the oracle's own.
pub struct EndToEnd<'a> {
    pub shot: &'a Shot<'a>,
    /// The oracle's geometry.
    pub own: &'a Geometry,
    /// The adapter's geometry.
    pub adapter: &'a Geometry,
    /// Where the adapter's draw order stops.
    pub limit: Option<DrawLimit>,
    pub vertices: &'a [VertexError],
}

impl EndToEnd<'_> {
    /// Counts the pixels that differ from the oracle's own picture, explained by the snap or not.
    /// `coverage` is that of the adapter's geometry.
    pub fn judge(
        &self,
        report: &mut ErrorReport,
        coverage: &BoundedCoverage,
        frame: &Frame,
        freedom: Freedom,
    ) -> Result<(), Canceled> {
        if freedom.is_scheduled() {
            return Ok(());
        }
        let (triangles, _) = triangles(self.shot, self.own)?;
        let tests = limited(
            SampleTests::new(self.shot, self.own),
            self.shot.stack,
            &triangles,
            self.shot.view,
        )?;
        let own = cover_claims(&tests, &triangles, self.shot.view, &frame.triangle_id)?;
        let checkpoint = checkpoint();
        for (pixel, (reference, sample)) in own.samples.iter().zip(&coverage.samples).enumerate() {
            let triangle_id = frame.triangle_id[pixel];
            let is_right = reference.allows(triangle_id)
                && (!self.is_strict() || frame.depth_key[pixel] == reference.nearest.depth_key);
            // A triangle id that is wrong even for the adapter's own geometry has been counted
            // before.
            if is_right || !sample.allows(triangle_id) {
                continue;
            }
            checkpoint.pass()?;
            if !self.is_strict()
                && self.may_differ(
                    pixel,
                    reference.nearest.triangle_id,
                    triangle_id,
                    tests.limit(),
                )
            {
                report.explained_by_snap += 1;
            } else {
                report.unexplained += 1;
            }
        }
        Ok(())
    }

    /// Records and keys are the same everywhere, so nothing may differ.
    fn is_strict(&self) -> bool {
        self.own.bit_exact
            == BitExact {
                vertices: true,
                depth_keys: true,
            }
    }

    /// Returns true if the oracle may find triangle `own` at a pixel where the adapter finds
    /// `given`; `limit` is where the oracle's draw order stops.
    fn may_differ(&self, pixel: usize, own: u32, given: u32, limit: Option<DrawLimit>) -> bool {
        self.is_near_limit(given, limit)
            || self.is_near_limit(own, limit)
            || self.snap_explains(own, given, pixel)
    }

    /// Returns true for a triangle between the oracle's and the adapter's draw limit: one sample
    /// more or less moves the limit.
    fn is_near_limit(&self, triangle_id: u32, own: Option<DrawLimit>) -> bool {
        let boundaries = [self.limit, own].map(|limit| limit.map(|limit| limit.boundary_triangle));
        match boundaries {
            [Some(a), Some(b)] if self.limit != own => (a.min(b)..=a.max(b)).contains(&triangle_id),
            _ => false,
        }
    }

    /// Returns true if two triangles may take each other's place at a pixel because vertices moved:
    /// an outline passed over the sample, or the two surfaces cross there.
    fn snap_explains(&self, a: u32, b: u32, pixel: usize) -> bool {
        let at = SamplePosition::of(self.shot.view, pixel);
        let outlines: Vec<Outline> = [a, b]
            .into_iter()
            .filter_map(|id| self.outline(id))
            .collect();
        if outlines.iter().any(|outline| outline.may_pass(&at)) {
            return true;
        }
        // Sample effects and alpha masks test the inside of triangles, where a moved corner or
        // another setup may change the result.
        let has_sample_effects = self
            .shot
            .stack
            .each(|hooks| hooks.sample.as_ref())
            .next()
            .is_some();
        let is_tested = |id: u32| has_sample_effects || self.is_masked(id);
        let may_test_differently = |id: u32| {
            self.outline(id).is_some_and(|outline| outline.may_move()) || self.has_other_setup(id)
        };
        if [a, b]
            .into_iter()
            .any(|id| is_tested(id) && may_test_differently(id))
        {
            return true;
        }
        let depths: Option<Vec<[f64; 2]>> =
            outlines.iter().map(|outline| outline.depths(&at)).collect();
        matches!(depths.as_deref(), Some([a, b]) if a[0] <= b[1] && b[0] <= a[1])
    }

    /// Returns true if an alpha mask may leave out samples of a triangle.
    fn is_masked(&self, id: u32) -> bool {
        let scene = self.shot.scene;
        let material = |draw: &Draw| scene.primitives[draw.primitive].material;
        is_masked(scene, self.shot.stack)
            && self
                .shot
                .draw_of(id)
                .is_some_and(|draw| scene.materials[material(draw)].alpha_threshold().is_some())
    }

    /// Returns true if the adapter's sample setups of a triangle are not the oracle's.
    fn has_other_setup(&self, id: u32) -> bool {
        let setups = effects_with_setup(self.shot.stack).len()
            + mask_records(self.shot.scene, self.shot.stack);
        let of = |geometry: &Geometry| {
            geometry
                .sample_setups
                .get(id as usize * setups..(id as usize + 1) * setups)
                .map(<[_]>::to_vec)
        };
        of(self.adapter) != of(self.own)
    }

    /// Where a triangle is drawn and how far it may move: 1.5 times as far as its corners did (1.5
    /// is at least √2, for both axes); if it is clipped, the larger of one pixel and what the
    /// errors of its corners and of the cuts come to at the sample.
    fn outline(&self, id: u32) -> Option<Outline> {
        let draw = self.shot.draw_of(id)?;
        let records = self.shot.corner_records(draw, self.own, id);
        let errors = self
            .shot
            .corner_indices(draw, self.own, id)
            .map(|index| self.vertices[index]);
        let is_whole = records.iter().all(|record| record.flags == 0);
        let moved = f64::from(errors.iter().map(|error| error.delta).max().unwrap_or(0));
        let pixel = f64::from(self.shot.view.units_per_pixel());
        let reach = match errors.iter().any(|error| error.is_ill_conditioned) {
            true => f64::INFINITY,
            false if is_whole => 1.5 * moved,
            false => pixel,
        };
        // A point that three planes cut errs by its corners' errors and by those of three cuts:
        // each rounds a difference, a product, a sum and its own place on the edge, which
        // is about as much as four products and their sum, of which a corner is made.
        // Packed corners err so far that the depths between them do, too.
        let is_near = is_whole && self.adapter.packed_bits.is_none();
        let clip_error = if is_near {
            0.0
        } else {
            errors
                .iter()
                .map(|error| 8.0 * error.clip_error)
                .fold(0.0, f64::max)
        };
        // Corners whose depths alone moved, as under an orthographic camera, change which surface
        // is the nearest.
        let given = self.shot.corner_records(draw, self.adapter, id);
        let depths = records
            .iter()
            .zip(&given)
            .map(|(own, given)| f64::from((own.depth - given.depth).abs()));
        let depth_error = if is_whole {
            depths.fold(0.0, f64::max)
        } else {
            0.0
        };
        let half_picture = half_size(self.shot.view)
            .map(f64::from)
            .into_iter()
            .fold(0.0, f64::max);
        // The oracle's clipped triangles are sorted by parent.
        let clipped = &self.own.clipped_triangles;
        let fan =
            clipped.partition_point(|t| t.parent < id)..clipped.partition_point(|t| t.parent <= id);
        let (mut records, mut reach) = (records, reach);
        let point = |geometry: &Geometry, index: usize| {
            let bits = geometry.subpixel_bits;
            Shown::of(&geometry.vertices[index], draw, bits)
        };
        let shown = self.shot.draws_points(draw).then(|| {
            let [index, ..] = self.shot.corner_indices(draw, self.own, id);
            records = [self.own.vertices[index]; 3];
            let own = point(self.own, index);
            if own != point(self.adapter, index) {
                reach += pixel;
            }
            own
        });
        // Along which axis the sides of a line lie, too.
        if self.shot.draws_lines(draw) {
            let [from, _, to] = self.shot.corner_indices(draw, self.own, id);
            let is_flat = |geometry: &Geometry| {
                let [from, to] = [from, to].map(|index| &geometry.vertices[index]);
                (to.x - from.x).abs() >= (to.y - from.y).abs()
            };
            if is_flat(self.own) != is_flat(self.adapter) {
                reach += pixel;
            }
        }
        let drawn = match self.shot.stack.shape() {
            Shape::Triangles => match shown {
                Some(shown) => Drawn::Point(shown),
                None if self.own.particle_discs.contains(&id) => Drawn::Disc,
                None => Drawn::Inside,
            },
            Shape::Boxes => Drawn::Box,
            Shape::Points => Drawn::Points(self.shot.stack.point_radius().into()),
        };
        let triangles = if is_whole {
            vec![records]
        } else {
            clipped[fan]
                .iter()
                .map(|triangle| triangle.corners)
                .collect()
        };
        Some(Outline {
            drawn,
            triangles,
            reach,
            clip_error,
            depth_error,
            half_picture,
        })
    }
}
