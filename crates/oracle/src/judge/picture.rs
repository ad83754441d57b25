//! The verdict about one picture.
//!
//! Vertices are judged from the matrix bits with a forward error bound, coverage and triangle ids
//! from the adapter's snapped vertices and clipped triangles, colors from the adapter's triangle
//! ids. Finally the whole picture is compared with the oracle's own, where only what a snapped
//! vertex explains may differ.

use super::{
    super::{
        bounds::{
            colors::AcceptedColors,
            coverage::{BoundedCoverage, cover_claims},
            layers::{LayerBounds, layer_bounds},
        },
        budget::{self, Purpose},
        render::{
            dots::dot_strengths,
            draw_order::limited,
            layers::{LayerImage, LayerInput, LayerMode, layer_image},
            particles::{check_particles, scene_with_particles},
            project::project,
            resolve::ResolveInput,
            sample_rules::SampleTests,
            sample_setup::sample_setups,
            strict::project_strict,
            triangles::triangles,
            work_limits::check_samples,
        },
        shot::{Shot, drawn_view},
    },
    clips::wrong_clips,
    deform::judge_deformed,
    dots::judge_dots,
    end_to_end::EndToEnd,
    error_map::error_map,
    freedom::Freedom,
    glass::judge_glass,
    particles::judge_particles,
    passes::judge_passes,
    sample_setups::wrong_setups,
    samples::{judge_layers, judge_samples, judge_scheduled_layers},
    shadow::judge_shadow_map,
    vertices::{count_vertices, vertex_errors},
};
use crate::{
    effects::Stack,
    frame::{AdapterPicture, BitExact, Counters, Frame, Geometry},
    measure::{ErrorReport, Verdict, compare},
    scene::{Scene, draw::DrawError, view::View},
    work::{Canceled, stage},
};

/// Stages of [`judge`], as [`Work::stage`](crate::work::Work::stage) counts them.
pub const JUDGE_STAGES: u32 = 5;

/// Judges a picture that an adapter drew of `scene`.
///
/// # Panics
/// If an image or the geometry has another size than the view and the scene ask for.
pub fn judge(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    picture: &AdapterPicture,
) -> Result<Verdict, DrawError> {
    if !stack.has_passes() || view.pixels() == 0 {
        return judge_resolved(scene, view, stack, picture);
    }
    // What the passes read is judged like any picture.
    let resolved = Frame {
        color: picture.frame.resolved().to_vec(),
        resolved: None,
        ..picture.frame.clone()
    };
    let picture_before = AdapterPicture {
        frame: &resolved,
        ..*picture
    };
    let mut verdict = judge_resolved(scene, view, stack, &picture_before)?;
    let geometry = picture.geometry;
    let (view, stack) = (&drawn_view(view, geometry), &stack.scaled(geometry.scale));
    let particles = geometry.particle_readback.as_ref();
    let words = particles.map(|readback| readback.words.as_slice());
    let scene = &*scene_with_particles(scene, view, stack, words)?;
    let draws = stack.draws(scene, view)?;
    let shot = Shot::new(scene, &draws, view, stack);
    judge_passes(&mut verdict, &shot, picture.frame)?;
    Ok(verdict)
}

/// Judges the picture before the passes of image effects.
fn judge_resolved(
    scene: &Scene,
    view: &View,
    stack: &Stack,
    picture: &AdapterPicture,
) -> Result<Verdict, DrawError> {
    let geometry = picture.geometry;
    let (view, stack) = (&drawn_view(view, geometry), &stack.scaled(geometry.scale));
    if view.pixels() == 0 {
        stack.draws(scene, view)?;
        return Ok(Verdict {
            expected: Frame {
                width: view.width,
                height: view.height,
                ..Frame::default()
            },
            ..Verdict::default()
        });
    }
    let words = geometry
        .particle_readback
        .as_ref()
        .map(|readback| readback.words.as_slice());
    if words.is_none() {
        check_particles(view, stack)?;
    }
    let scene = &*scene_with_particles(scene, view, stack, words)?;
    let draws = stack.draws(scene, view)?;
    let shot = Shot::new(scene, &draws, view, stack);
    budget::check(&shot, Purpose::Judge)?;
    stage("vertices")?;
    let own = own_geometry(&shot, geometry.bit_exact)?;
    check_sizes(&shot, picture, &own);

    let mut report = ErrorReport {
        pixels: view.pixels() as u64,
        ..Default::default()
    };
    let vertices = vertex_errors(&shot, geometry, &own)?;
    count_vertices(&mut report, &vertices);
    let dots = dot_strengths(view, stack, &geometry.dots, &picture.frame.depth_key);
    report.clips_wrong = wrong_clips(view, geometry, &own, picture.frame.counters.flipped_clips);
    judge_geometry(&mut report, &shot, picture, &dots)?;

    stage("coverage")?;
    let (triangles, counters) = triangles(&shot, geometry)?;
    let tests = SampleTests::new(&shot, geometry);
    check_samples("picture", &triangles, &tests, view)?;
    let freedom = Freedom::of(&shot, &tests, &triangles)?;
    let tests = if freedom.is_scheduled() {
        tests
    } else {
        limited(tests, stack, &triangles, view)?
    };
    let coverage = cover_claims(&tests, &triangles, view, &picture.frame.triangle_id)?;
    let end_to_end = EndToEnd {
        shot: &shot,
        own: &own,
        adapter: geometry,
        limit: tests.limit(),
        vertices: &vertices,
    };
    judge_samples(&mut report, &coverage, picture, freedom);
    judge_counters(&mut report, &counters, picture.frame);
    stage("the whole picture")?;
    end_to_end.judge(&mut report, &coverage, picture.frame, freedom)?;

    let (triangle_ids, keys) = (&picture.frame.triangle_id, &picture.frame.depth_key);
    let layer_input = LayerInput {
        shot,
        geometry,
        tests: &tests,
        triangles: &triangles,
        triangle_ids,
        depth_keys: keys,
        glass: Some(&picture.frame.glass).filter(|layers| !layers.is_empty()),
    };
    stage("colors")?;
    let colors = JudgedColors::new(&layer_input, &coverage, picture, &dots, freedom)?;
    let nearest = colors.judge(&mut report, &shot, &coverage, picture, freedom);
    if shot.has_glass() {
        judge_glass(&mut report, &layer_input, picture.frame)?;
    }
    stage("the error map")?;
    let mut faults = error_map(&shot, &coverage, picture, &nearest, freedom);
    let step_band = colors.accepted.step_band();
    let (expected_colors, counted) = colors.expected(&shot, &coverage, picture, nearest)?;
    faults.compare_again(&picture.frame.color, &expected_colors);
    let expected = expected_frame(view, &coverage, expected_colors, counted, counters);
    Ok(Verdict {
        report,
        expected,
        step_band,
        error_map: faults,
    })
}

/// The geometry that the oracle computes under the same promises.
fn own_geometry(shot: &Shot, exact: BitExact) -> Result<Geometry, Canceled> {
    let geometry = if exact.vertices {
        project_strict(shot)
    } else {
        project(shot)?
    };
    let geometry = Geometry {
        bit_exact: exact,
        ..geometry
    };
    Ok(Geometry {
        sample_setups: sample_setups(shot, &geometry),
        ..geometry
    })
}

fn check_sizes(shot: &Shot, picture: &AdapterPicture, own: &Geometry) {
    let (frame, geometry) = (picture.frame, picture.geometry);
    let sizes = [
        frame.triangle_id.len(),
        frame.depth_key.len(),
        frame.color.len(),
    ];
    assert_eq!(sizes, [shot.view.pixels(); 3], "the frame has another size");
    let records = |geometry: &Geometry| (geometry.vertices.len(), geometry.has_unshared_vertices);
    assert_eq!(
        records(geometry),
        records(own),
        "the geometry is of another scene or stack"
    );
    assert_eq!(
        geometry.shadow_map.is_some(),
        shot.stack.light().is_some(),
        "there is a shadow map if and only if there is a light"
    );
}

/// Judges everything between the scene and coverage except the vertex records.
fn judge_geometry(
    report: &mut ErrorReport,
    shot: &Shot,
    picture: &AdapterPicture,
    dots: &[u32],
) -> Result<(), DrawError> {
    let geometry = picture.geometry;
    if let Some(readback) = &geometry.particle_readback {
        judge_particles(report, shot.view, shot.stack, readback)?;
    }
    judge_deformed(report, shot, &geometry.deformed);
    judge_dots(report, shot, &geometry.dots, &picture.frame.dots, dots)?;
    // Setups that follow from packed positions are approximate too.
    report.sample_setups_wrong = if geometry.packed_bits.is_some() {
        0
    } else {
        wrong_setups(shot, geometry)
    };
    match &geometry.shadow_map {
        Some(map) => judge_shadow_map(report, shot, map),
        None => Ok(()),
    }
}

fn judge_counters(report: &mut ErrorReport, reference: &Counters, frame: &Frame) {
    let judged = |c: &Counters| [c.rejected_nonfinite, c.rejected_range, c.degenerate];
    report.counters_wrong = judged(reference)
        .iter()
        .zip(judged(&frame.counters))
        .filter(|(a, b)| *a != b)
        .count() as u64;
    report.overflow += u64::from(frame.counters.overflow);
    report.depth_without_id = report
        .depth_without_id
        .max(frame.counters.depth_without_id.into());
}

/// Pixels where the adapter's color or its count of layers is not among the right answers that are
/// known.
fn doubtful_pixels(accepted: &AcceptedColors, bounds: &LayerBounds, frame: &Frame) -> Vec<bool> {
    let is_counted_wrong = |i: usize| {
        let [least, most] = bounds.counted[i];
        !(least..=most).contains(&frame.layer_sums.get(i).map_or(least, |&count| count.into()))
    };
    let nearest = accepted.nearest(&frame.color);
    (0..nearest.len())
        .map(|i| nearest[i] != frame.color[i] || is_counted_wrong(i))
        .collect()
}

/// The colors that are right for a picture, given its triangle ids.
struct JudgedColors {
    accepted: AcceptedColors,
    /// Of a picture of layers.
    layers: Option<(LayerImage, LayerBounds)>,
}

impl JudgedColors {
    fn new(
        input: &LayerInput,
        coverage: &BoundedCoverage,
        picture: &AdapterPicture,
        dots: &[u32],
        freedom: Freedom,
    ) -> Result<Self, Canceled> {
        let resolve = ResolveInput {
            triangle_ids: input.triangle_ids,
            depth_keys: input.depth_keys,
            dots,
            previous: picture.previous,
        };
        let layers = || {
            coverage
                .samples
                .iter()
                .map(|sample| sample.nearest.layers)
                .collect()
        };
        let with_bounds = |image| layer_bounds(input, &image).map(|bounds| (image, bounds));
        let mut layers = layer_image(input, layers)?.map(with_bounds).transpose()?;
        let of_layers = |(image, bounds): &(LayerImage, LayerBounds)| {
            AcceptedColors::of_layers(&input.shot, &resolve, image, bounds)
        };
        let accepted = match &mut layers {
            Some(layers) => {
                let accepted = of_layers(layers)?;
                let doubtful = doubtful_pixels(&accepted, &layers.1, picture.frame);
                // The colors of layers that the scheduler chooses are not judged.
                if freedom.is_scheduled() || !doubtful.contains(&true) {
                    accepted
                } else {
                    layers.1.widen(input, &layers.0, &doubtful)?;
                    of_layers(layers)?
                }
            }
            None => AcceptedColors::of_surfaces(&input.shot, &resolve, input.geometry)?
                .with_interpolations(&input.shot, &resolve, input.geometry, &picture.frame.color)?,
        };
        Ok(Self { accepted, layers })
    }

    /// Judges the adapter's colors and returns the right ones nearest to them.
    fn judge(
        &self,
        report: &mut ErrorReport,
        shot: &Shot,
        coverage: &BoundedCoverage,
        picture: &AdapterPicture,
        freedom: Freedom,
    ) -> Vec<[u8; 4]> {
        let frame = picture.frame;
        // Only the adapter's scheduler knows which layers it drew.
        let nearest = if freedom.is_scheduled() && self.layers.is_some() {
            frame.color.clone()
        } else {
            self.accepted.nearest(&frame.color)
        };
        // Layers of glass are judged one by one.
        let summed = self
            .layers
            .as_ref()
            .filter(|(image, _)| !matches!(image.mode, LayerMode::Glass(_)));
        if let Some((_, bounds)) = summed {
            match freedom {
                Freedom::Scheduled { limit } => {
                    judge_scheduled_layers(report, bounds, picture, coverage, limit)
                }
                Freedom::Exact | Freedom::Racing => judge_layers(report, bounds, picture),
            }
        }
        let [delta, beyond] = [0, 1].map(|step| compare::pictures(&nearest, &frame.color, step));
        (report.max_color_delta, report.rms_color_delta) = (delta.max_delta, delta.rms);
        report.rounding_pixels = delta.pixels_over_tolerance - beyond.pixels_over_tolerance;
        report.interpolation_pixels = self.accepted.unsure_pixels();
        report.step_band_colors =
            self.accepted
                .step_band_colors(shot, picture.geometry, &frame.triangle_id);
        report.step_band_pixels = self
            .accepted
            .step_band()
            .iter()
            .filter(|is_band| **is_band)
            .count() as u64;
        nearest
    }

    /// Colors and counts of the picture with the oracle's triangle ids; `nearest` are the colors
    /// with the adapter's.
    fn expected(
        self,
        shot: &Shot,
        coverage: &BoundedCoverage,
        picture: &AdapterPicture,
        nearest: Vec<[u8; 4]>,
    ) -> Result<(Vec<[u8; 4]>, Vec<u32>), Canceled> {
        if let Some((image, _)) = self.layers {
            return Ok((self.accepted.exact(), image.counted));
        }
        let (triangle_ids, keys) = (&coverage.triangle_ids(), &coverage.depth_keys());
        if *triangle_ids == picture.frame.triangle_id {
            return Ok((nearest, Vec::new()));
        }
        let dots = &dot_strengths(shot.view, shot.stack, &picture.geometry.dots, keys);
        let input = ResolveInput {
            triangle_ids,
            depth_keys: keys,
            dots,
            previous: picture.previous,
        };
        let adapter = &picture.frame.color;
        let accepted = AcceptedColors::of_surfaces(shot, &input, picture.geometry)?;
        Ok((
            accepted
                .with_interpolations(shot, &input, picture.geometry, adapter)?
                .nearest(adapter),
            Vec::new(),
        ))
    }
}

fn expected_frame(
    view: &View,
    coverage: &BoundedCoverage,
    color: Vec<[u8; 4]>,
    counted: Vec<u32>,
    counters: Counters,
) -> Frame {
    let (triangle_id, key) = (coverage.triangle_ids(), coverage.depth_keys());
    Frame {
        width: view.width,
        height: view.height,
        triangle_id,
        depth_key: key,
        color,
        layer_sums: counted,
        counters,
        ..Frame::default()
    }
}
