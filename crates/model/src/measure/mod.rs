//! Error reports and statistics of timings. No time is reported without the error of the picture
//! beside it.

pub mod compare;
pub mod error_map;
pub mod timing;

/// How far a picture is from the oracle. Counts are pixels unless stated otherwise.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct ErrorReport {
    /// Pixels of the picture.
    pub pixels: u64,
    /// Pixels whose triangle id is wrong outside every named band.
    pub wrong_triangles: u64,
    /// Of those, pixels whose triangle covers the sample but is not the nearest that does.
    pub wrong_nearest: u64,
    /// Pixels that differ from the oracle's own picture only because vertices snapped apart,
    /// within their bounds.
    pub explained_by_snap: u64,
    /// Pixels that differ from the oracle's own picture although no snap explains it.
    pub unexplained: u64,
    /// Pixels where two triangle ids are right: depths closer than the float key's bound.
    pub depth_band_pixels: u64,
    /// Pixels so near a step of color that f32 and f64 may fall on different sides, where either
    /// answer is right.
    pub step_band_pixels: u64,
    /// Different sets of right colors among them: a flat area on a step is one.
    pub step_band_colors: u64,
    /// Pixels whose color only the errors of places and of interpolated normals and depths
    /// explain.
    #[serde(skip_serializing_if = "is_zero")]
    pub interpolation_pixels: u64,
    /// Samples that a triangle covers and that were not drawn.
    pub holes: u64,
    /// Samples that were drawn more often than they are covered.
    pub double_hits: u64,
    /// Pixels with a depth but no triangle id.
    pub depth_without_id: u64,
    /// Queue entries that were lost; the picture is incomplete unless this is 0.
    pub overflow: u64,
    /// Pixels whose depth key lies outside its relative bound.
    pub key_outside_bound: u64,
    /// Vertices of all draws.
    pub vertices: u64,
    /// Vertices whose position depends on rounding alone; they are not judged.
    pub ill_conditioned: u64,
    /// Vertices that snapped more than their forward error bound away from the oracle's, or with
    /// other flags.
    pub snap_outside_bound: u64,
    /// Vertices that snapped more than one unit away, whether their bound allows it or not.
    pub snap_over_one_unit: u64,
    /// Vertices whose depth or 1/w lies outside its forward error bound.
    pub attribute_outside_bound: u64,
    /// Largest distance between a snapped vertex and the oracle's, in units of 1/256 px, among
    /// well-conditioned vertices.
    pub max_snap_delta: u32,
    /// Vertices that joints or morph targets deform.
    pub deformed_vertices: u64,
    /// Deformed vertices whose position or normal lies outside its forward error bound.
    pub deformed_outside_bound: u64,
    /// Largest distance between a deformed vertex and the oracle's, in units of the last place of
    /// its largest coordinate.
    pub max_deform_ulp: f64,
    /// The same in the picture, in pixels, of vertices behind the near plane.
    pub max_deform_px: f64,
    /// Particles of the picture.
    pub particles: u64,
    /// Particles whose last step, or whose disc, lies outside its forward error bound.
    pub particles_outside_bound: u64,
    /// Particles more than a pixel away from the ones that the oracle simulates from the first
    /// frame. The flow is chaotic, so this is not judged.
    pub particles_diverged: u64,
    /// Largest of these distances, in pixels.
    pub max_divergence_px: f64,
    /// Mean of these distances in the scene, in meters.
    pub mean_divergence_m: f64,
    /// Clipped triangles that run against the others of their fan, or whose outline is not the
    /// oracle's.
    #[serde(skip_serializing_if = "is_zero")]
    pub clips_wrong: u64,
    /// Sample setups outside their bound, or with words that do not follow from the first.
    pub sample_setups_wrong: u64,
    /// Dots of all lines.
    #[serde(skip_serializing_if = "is_zero")]
    pub dots: u64,
    /// Dots that lie outside their forward error bound.
    #[serde(skip_serializing_if = "is_zero")]
    pub dots_outside_bound: u64,
    /// Pixels whose strongest dot does not follow from the records of all dots.
    #[serde(skip_serializing_if = "is_zero")]
    pub dot_pixels_wrong: u64,
    /// Pixels whose number of layers, or sum of their weights, is wrong.
    pub layer_counts_wrong: u64,
    /// Pixels of layers with several right colors, because a weight or the depth window lies at a
    /// step.
    pub ambiguous_layer_pixels: u64,
    /// Pixels where a race lost the nearest triangle; 0 without the effect `race`.
    pub race_pixels: u64,
    /// Counters of rejected and degenerate triangles that differ from the oracle's.
    pub counters_wrong: u64,
    /// Largest difference of a color channel from the nearest right answer, of 255.
    pub max_color_delta: u8,
    /// Pixels whose color is one step of 255 away, which rounding alone does to few.
    pub rounding_pixels: u64,
    /// Root mean square of the difference over all channels, of 255.
    pub rms_color_delta: f64,
}

fn is_zero(count: &u64) -> bool {
    *count == 0
}

/// How far the light by a shadow map is from traced light, over the pixels that face the light.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct ShadowErrors {
    pub pixels: u64,
    /// Pixels with an error of more than half of the light.
    pub wrong: u64,
    /// Root mean square of the error, as a fraction of the light.
    pub rms: f64,
}

/// The errors that a bench row states; none means "not measured", never 0.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize)]
pub struct ErrorStats {
    pub wrong_triangles: Option<u64>,
    pub explained_by_snap: Option<u64>,
    pub holes: Option<u64>,
    pub double_hits: Option<u64>,
    /// Pixels drawn where the oracle has none.
    pub extra: Option<u64>,
    pub depth_without_id: Option<u64>,
    pub overflow: Option<u64>,
    /// Of 255; where both drew.
    pub max_color_delta: Option<u8>,
    /// Of 255; where both drew.
    pub rms_color_delta: Option<f64>,
    /// Largest error of a deformed vertex, in pixels; none if nothing deforms.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_deform_px: Option<f64>,
    /// The same in units of the last place.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_deform_ulp: Option<f64>,
    /// Largest distance of a particle from the simulated one, in pixels; none without particles.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_divergence_px: Option<f64>,
    /// Fraction of the particles that are more than a pixel away from it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diverged_fraction: Option<f64>,
}

impl From<&ErrorReport> for ErrorStats {
    fn from(a: &ErrorReport) -> Self {
        Self {
            wrong_triangles: Some(a.wrong_triangles),
            explained_by_snap: Some(a.explained_by_snap),
            holes: Some(a.holes),
            double_hits: Some(a.double_hits),
            extra: None,
            depth_without_id: Some(a.depth_without_id),
            overflow: Some(a.overflow),
            max_color_delta: Some(a.max_color_delta),
            rms_color_delta: Some(a.rms_color_delta),
            max_deform_px: (a.deformed_vertices > 0).then_some(a.max_deform_px),
            max_deform_ulp: (a.deformed_vertices > 0).then_some(a.max_deform_ulp),
            max_divergence_px: (a.particles > 0).then_some(a.max_divergence_px),
            diverged_fraction: (a.particles > 0)
                .then(|| a.particles_diverged as f64 / a.particles as f64),
        }
    }
}

impl ErrorStats {
    /// Returns true if everything was measured and is exact, and colors differ by at most 1 of 255.
    pub fn is_exact(&self) -> bool {
        let exact = [
            self.wrong_triangles,
            self.holes,
            self.double_hits,
            self.depth_without_id,
            self.overflow,
        ];
        exact.iter().all(|count| *count == Some(0))
            && self.max_color_delta.is_some_and(|delta| delta <= 1)
    }
}

/// The result of judging a picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Verdict {
    pub report: ErrorReport,
    /// What the oracle draws from the same snapped vertices; in the step band, the right answer
    /// nearest to the picture.
    pub expected: crate::frame::Frame,
    /// Pixels in the step band; empty if no effect has steps.
    pub step_band: Vec<bool>,
    /// What is wrong at each pixel.
    pub error_map: error_map::ErrorMap,
}

/// The exact pictures against which accuracy options are measured.
#[derive(Clone, Debug, Default)]
pub struct References {
    /// For every render scale, the exact picture and its geometry.
    pub pictures: Vec<(f64, crate::frame::Frame, crate::frame::Geometry)>,
    /// The exact picture with eight by eight samples per pixel; none if there is only one render
    /// scale.
    pub smooth: Option<Vec<[u8; 4]>>,
}

impl References {
    /// The picture and geometry at a render scale.
    pub fn at(&self, factor: f64) -> Option<(&crate::frame::Frame, &crate::frame::Geometry)> {
        self.pictures
            .iter()
            .find(|(known, ..)| *known == factor)
            .map(|(_, frame, geometry)| (frame, geometry))
    }
}

/// Limits within which a picture passes. Everything that must be exact has no budget.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Budget {
    /// Largest difference of a color channel, of 255.
    pub max_color_delta: u8,
    /// Most pixels with a wrong triangle id, and most samples not drawn or drawn too often, for
    /// presets that are not exact.
    pub max_wrong_triangles: u64,
    /// Most pixels in the depth band.
    pub max_depth_band_pixels: u64,
    /// Most pixels explained by the snap.
    pub max_explained: u64,
    /// Most different colors in the step band, as a fraction of the pixels.
    pub max_step_band_fraction: f64,
    /// Most pixels whose color is one step away, as a fraction of the pixels, beside
    /// [`Budget::ROUNDING_PIXELS`].
    pub max_rounding_fraction: f64,
}

impl Default for Budget {
    /// One step of a channel and a small fraction of pixels in the step band; other bands are
    /// counted and not limited.
    fn default() -> Self {
        Self {
            max_color_delta: 1,
            max_wrong_triangles: 0,
            max_depth_band_pixels: u64::MAX,
            max_explained: u64::MAX,
            max_step_band_fraction: 0.03,
            max_rounding_fraction: 0.01,
        }
    }
}

impl Budget {
    /// Pixels of any picture, however small, whose color may be one step away.
    pub const ROUNDING_PIXELS: u64 = 8;
}

impl ErrorReport {
    /// Passes if everything that must be exact is, and the rest is within `budget`.
    /// Errors: a phrase for each limit that is exceeded, separated by semicolons.
    pub fn within(&self, budget: &Budget) -> Result<(), String> {
        let sentence = |&(count, limit, what): &(u64, u64, &str)| {
            (count > limit).then(|| {
                if limit == 0 {
                    format!("{count} {what}")
                } else {
                    format!("{count} {what} (at most {limit})")
                }
            })
        };
        let sentences: Vec<String> = self.limits(budget).iter().filter_map(sentence).collect();
        if sentences.is_empty() {
            Ok(())
        } else {
            Err(sentences.join("; "))
        }
    }

    /// What is counted, how much of it `budget` allows, and what a sentence calls it.
    fn limits(&self, budget: &Budget) -> [(u64, u64, &'static str); 22] {
        [
            (
                self.wrong_triangles,
                budget.max_wrong_triangles,
                "pixels have the wrong triangle id",
            ),
            (
                self.holes,
                budget.max_wrong_triangles,
                "covered samples were not drawn",
            ),
            (
                self.double_hits,
                budget.max_wrong_triangles,
                "samples were drawn more often than they are covered",
            ),
            (
                self.depth_without_id,
                0,
                "pixels have a depth but no triangle id",
            ),
            (self.overflow, 0, "queue entries were lost"),
            (
                self.key_outside_bound,
                0,
                "depth keys lie outside their bound",
            ),
            (
                self.snap_outside_bound,
                0,
                "vertices snapped outside their bound",
            ),
            (
                self.attribute_outside_bound,
                0,
                "vertices have a depth or 1/w outside its bound",
            ),
            (
                self.deformed_outside_bound,
                0,
                "deformed vertices lie outside their bound",
            ),
            (
                self.particles_outside_bound,
                0,
                "particles took a step outside its bound",
            ),
            (
                self.unexplained,
                budget.max_wrong_triangles,
                "pixels differ from the oracle's own picture without a reason",
            ),
            (
                self.clips_wrong,
                0,
                "clipped triangles are turned over, or have a wrong outline",
            ),
            (self.sample_setups_wrong, 0, "sample setups are wrong"),
            (self.dots_outside_bound, 0, "dots lie outside their bound"),
            (
                self.dot_pixels_wrong,
                0,
                "pixels have a wrong strength of dots",
            ),
            (
                self.layer_counts_wrong,
                0,
                "pixels have a wrong number of layers, or a wrong sum of weights",
            ),
            (
                self.counters_wrong,
                0,
                "counters of rejected or degenerate triangles are wrong",
            ),
            (
                self.explained_by_snap,
                budget.max_explained,
                "pixels differ because vertices snapped apart",
            ),
            (
                self.depth_band_pixels,
                budget.max_depth_band_pixels,
                "pixels lie in the depth band",
            ),
            (
                self.step_band_colors,
                (self.pixels as f64 * budget.max_step_band_fraction) as u64,
                "colors lie in the step band",
            ),
            (
                self.max_color_delta.into(),
                budget.max_color_delta.into(),
                "of 255 is the largest color difference",
            ),
            (
                self.rounding_pixels,
                Budget::ROUNDING_PIXELS
                    + (self.pixels as f64 * budget.max_rounding_fraction) as u64,
                "pixels have a color that is one step of 255 away",
            ),
        ]
    }
}
