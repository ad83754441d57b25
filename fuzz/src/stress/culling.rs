//! Culling: what it leaves out is not seen, from anywhere.

use std::sync::Arc;

use glam::{DMat3, DMat4, DQuat, DVec3, EulerRot};

use super::{
    case::{Case, Expectation},
    checks::{EarlyEnd, check, same, same_nearest},
    context::CaseContext,
    scenes::{Rng, scene_of_meshes, triangle_soup},
};
use crate::{
    accuracy::{Culling, PinnedOptions, PositionFormat},
    effects::Stack,
    plan::AccuracyRequest,
    scene::{
        Scene,
        camera::{Camera, Projection},
        view::View,
    },
};

pub const CASES: &[Case] = &[
    Case {
        number: 34,
        name: "culled-cameras",
        about: "cameras anywhere in a scene, in any direction, with near planes up to the size of a mesh: culling loses nothing, and leaves out much",
        expectation: Expectation::Bounded(
            "the same triangle ids and depth keys as without culling",
        ),
        run: culled_cameras,
    },
    Case {
        number: 34,
        name: "slivers-at-the-border",
        about: "slivers along each border of the picture, far from the origin, where rounding moves them in or out, and spikes out of it: culling loses none",
        expectation: Expectation::Bounded(
            "the same triangle ids, depth keys and numbers of hits as without culling",
        ),
        run: slivers_at_the_border,
    },
];

/// A walk through a scene: small steps and turns, and now and then a jump.
pub fn walk(scene: &Scene, rng: &mut Rng, steps: usize, size: [u32; 2]) -> Vec<View> {
    let bounds = scene.bounds();
    let reach = bounds.radius().min(30.0);
    let (mut eye, mut turn) = (bounds.center() + DVec3::splat(0.2 * reach), 0.0);
    let mut views = Vec::new();
    let mut pitch = 0.1;
    for step in 0..steps {
        let [mut stride, mut swing] = [0.03 * reach, 0.2];
        if step % 5 == 4 {
            [stride, swing] = [0.7 * reach, 3.0];
        }
        eye += DVec3::new(
            rng.real(-stride, stride),
            rng.real(-stride, stride),
            rng.real(-stride, stride),
        );
        turn += rng.real(-swing, swing);
        if step % 3 == 2 {
            pitch = rng.real(-0.9, 0.9);
        }
        let way = DQuat::from_rotation_y(turn) * DVec3::new(0.0, pitch, -1.0);
        let projection = if step % 7 == 6 {
            Projection::Orthographic { height_m: reach }
        } else {
            Projection::Perspective { fov_y_deg: 70.0 }
        };
        let camera = Camera {
            eye,
            target: eye + way,
            up: DVec3::Y,
            projection,
            near_m: 0.02,
        };
        views.push(View::new(
            &camera,
            size[0],
            size[1],
            &bounds,
            DMat4::IDENTITY,
            [0.0; 4],
        ));
    }
    views
}

/// A camera inside or just outside a scene, in a random direction.
pub(super) fn camera_anywhere(scene: &Scene, rng: &mut Rng, step: usize) -> Camera {
    let bounds = scene.bounds();
    let mut random = |reach: f64| {
        DVec3::new(
            rng.real(-reach, reach),
            rng.real(-reach, reach),
            rng.real(-reach, reach),
        )
    };
    let radius = bounds.radius();
    let (eye, way, up) = (
        bounds.center() + random(0.7 * radius),
        random(1.0),
        random(1.0),
    );
    let projection = match step % 4 {
        3 => Projection::Orthographic {
            height_m: radius * rng.real(0.02, 1.5),
        },
        _ => Projection::Perspective {
            fov_y_deg: rng.real(10.0, 130.0),
        },
    };
    let near_m = [0.001, 0.02, 0.1, 0.3][rng.between(0, 3) as usize] * radius;
    Camera {
        eye,
        target: eye + way.normalize_or(DVec3::X),
        up,
        projection,
        near_m,
    }
}

/// What culling left out of the pictures of one view, with every option that culls.
#[derive(Default)]
pub(super) struct CulledPictures {
    /// Pixels that show a triangle.
    pub(super) covered: usize,
    /// Meshlets outside the picture, and meshlets that face away.
    pub(super) outside: u32,
    pub(super) backfacing: u32,
}

/// Draws a view without culling and with every option that culls; the pictures must show the same
/// triangles at the same depths.
pub(super) fn compare_culled(
    context: &mut CaseContext,
    scene: &Arc<Scene>,
    view: &View,
    what: &str,
) -> Result<CulledPictures, EarlyEnd> {
    let option = context.quick_option();
    let accuracy = |culling: Culling| AccuracyRequest {
        pins: PinnedOptions::of(culling).with(option),
        ..AccuracyRequest::default()
    };
    let reference = context.captured(
        scene,
        view,
        &Stack::default(),
        &accuracy(Culling::None),
        what,
    )?;
    let mut all = CulledPictures {
        covered: reference.frame.covered(),
        ..CulledPictures::default()
    };
    for culling in [Culling::Frustum, Culling::TwoPass] {
        let what = format!("{what}, culling {}", culling.name());
        let capture =
            context.captured(scene, view, &Stack::default(), &accuracy(culling), &what)?;
        same_nearest(&capture, &reference, &what)?;
        let culled = context.renderer.culled().unwrap_or_default();
        all.outside += culled.outside;
        all.backfacing += culled.backfacing;
    }
    Ok(all)
}

fn culled_cameras(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(0xca3);
    let (mut outside, mut backfacing, mut covered) = (0, 0, 0);
    let steps = if context.is_slow() { 8 } else { 32 };
    // Panels have two sides.
    for query in ["field?count=27&triangles=400", "town", "knot", "panels"] {
        let scene = context.scene(query)?;
        for step in 0..steps {
            let camera = camera_anywhere(&scene, &mut rng, step);
            let view = View::new(&camera, 64, 48, &scene.bounds(), DMat4::IDENTITY, [0.0; 4]);
            let culled = compare_culled(context, &scene, &view, &format!("{query}, {camera:?}"))?;
            covered += culled.covered;
            outside += culled.outside;
            backfacing += culled.backfacing;
        }
    }
    check!(
        outside > 1000 && backfacing > 50 && covered > 5_000,
        "{outside} meshlets were left out outside, {backfacing} as facing away, and {covered} pixels show others"
    );
    Ok(())
}

/// A view at a distance from the origin, and slivers along its borders.
struct BorderView {
    /// Rows: right, up and backward.
    axes: DMat3,
    eye: DVec3,
    size: [u32; 2],
    projection: Projection,
    near_m: f64,
}

impl BorderView {
    /// Side of a pixel at `distance` meters.
    fn pixel_m(&self, distance: f64) -> f64 {
        let height = match self.projection {
            Projection::Perspective { fov_y_deg } => {
                2.0 * libm::tan(0.5 * fov_y_deg.to_radians()) * distance
            }
            Projection::Orthographic { height_m } => height_m,
        };
        height / f64::from(self.size[1])
    }

    /// How far rounding moves a corner, at least, in meters.
    fn rounding_m(&self) -> f64 {
        self.eye.length() * f64::from(f32::EPSILON)
    }

    /// Triangles a few pixels long, each a mesh of its own: along the four borders and on the near
    /// plane, about as far from there on either side as rounding moves them, but a pixel at
    /// least.
    fn slivers(&self, rng: &mut Rng) -> Arc<Scene> {
        let half = self.size.map(|side| 0.5 * f64::from(side));
        let sliver = |i: usize| {
            let (aside, border) = (i % 2, i % 5);
            let distance = if border == 4 {
                self.near_m + rng.real(-1.0, 1.0) * (0.02 + self.rounding_m())
            } else {
                10.0
            };
            let pixel = self.pixel_m(distance.max(0.5 * self.near_m));
            let spread = 1.0 + self.rounding_m() / pixel;
            let across = match border {
                0 | 1 => half[aside] + rng.real(-spread, spread),
                2 | 3 => -half[aside] - rng.real(-spread, spread),
                _ => rng.real(-half[aside], half[aside]),
            };
            let along = rng.real(-half[1 - aside], half[1 - aside]);
            let corners = [[0.0, 0.0], [8.0, 0.3], [3.0, 0.9]].map(|[far, thick]| {
                let mut at = [0.0; 2];
                (at[aside], at[1 - aside]) = (across + thick, along + far);
                (self.eye + self.axes * DVec3::new(at[0] * pixel, at[1] * pixel, -distance))
                    .as_vec3()
                    .to_array()
            });
            triangle_soup(corners)
        };
        scene_of_meshes(&(0..120).map(sliver).collect::<Vec<_>>())
    }

    /// Triangles that begin in the picture and reach far along an axis of the scene, most of them
    /// out of it: each a mesh of its own, whose box is long along one axis.
    fn spikes(&self, rng: &mut Rng) -> Arc<Scene> {
        let distance = 10.0;
        let pixel = self.pixel_m(distance);
        let spike = |i: usize| {
            let [across, up] = self
                .size
                .map(|side| rng.real(-0.5, 0.5) * f64::from(side) * pixel);
            let begin = self.eye + self.axes * DVec3::new(across, up, -distance);
            let length = if i % 6 < 3 {
                4.0 * distance
            } else {
                -4.0 * distance
            };
            let corners = [
                DVec3::ZERO,
                self.axes * DVec3::new(4.0, 3.0, 0.0) * pixel,
                DVec3::AXES[i % 3] * length,
            ];
            triangle_soup(corners.map(|corner| (begin + corner).as_vec3().to_array()))
        };
        scene_of_meshes(&(0..60).map(spike).collect::<Vec<_>>())
    }

    fn view(&self, scene: &Scene) -> View {
        let Self {
            axes,
            eye,
            size,
            projection,
            near_m,
        } = *self;
        let camera = Camera {
            eye,
            target: eye - axes.z_axis,
            up: axes.y_axis,
            projection,
            near_m,
        };
        View::new(
            &camera,
            size[0],
            size[1],
            &scene.bounds(),
            DMat4::IDENTITY,
            [0.0; 4],
        )
    }
}

/// Draws with and without culling, which must be the same; returns how many meshes were culled and
/// how many pixels were drawn.
fn compare_positions(
    context: &mut CaseContext,
    scene: &Arc<Scene>,
    view: &View,
    what: &str,
) -> Result<(u32, usize), EarlyEnd> {
    let (mut outside, mut drawn) = (0, 0);
    for position in [PositionFormat::Stored, PositionFormat::Relative] {
        let option = context.quick_option();
        let accuracy = |culling: Culling| AccuracyRequest {
            pins: PinnedOptions::of(culling).with(position).with(option),
            ..AccuracyRequest::default()
        };
        let what = format!("{what}, {} positions", position.name());
        let reference = context.captured(
            scene,
            view,
            &Stack::default(),
            &accuracy(Culling::None),
            &what,
        )?;
        for culling in [Culling::Frustum, Culling::TwoPass] {
            let what = format!("{what}, culling {}", culling.name());
            let capture =
                context.captured(scene, view, &Stack::default(), &accuracy(culling), &what)?;
            same(&capture, &reference, &what)?;
            outside += context.renderer.culled().unwrap_or_default().outside;
        }
        drawn += reference.frame.covered();
    }
    Ok((outside, drawn))
}

fn slivers_at_the_border(context: &mut CaseContext) -> Result<(), EarlyEnd> {
    let mut rng = context.rng(0xb0d);
    let (mut outside, mut drawn) = (0, 0);
    let projections = [
        Projection::Perspective { fov_y_deg: 50.0 },
        Projection::Orthographic { height_m: 12.0 },
    ];
    // Boxes around slivers are tight where the view is aligned with the axes; elsewhere every term
    // of a bound counts.
    let turned = DMat3::from_euler(EulerRot::YXZ, 0.7, -0.5, 0.4);
    let opposite = DMat3::from_euler(EulerRot::YXZ, 0.7 + std::f64::consts::PI, 0.5, -0.4);
    let places = [
        (0.0, DMat3::IDENTITY),
        (0.0, turned),
        (1e4, turned),
        (1e6, DMat3::IDENTITY),
        (1e6, turned),
        (1e6, turned.transpose()),
        (1e6, opposite),
    ];
    for ((offset, axes), projection) in places
        .into_iter()
        .flat_map(|place| projections.map(|projection| (place, projection)))
    {
        let border = BorderView {
            axes,
            eye: DVec3::new(0.7, -0.6, 0.4) * offset,
            size: [64, 48],
            projection,
            near_m: 2.0,
        };
        let scene = border.slivers(&mut rng);
        let view = border.view(&scene);
        let (culled, pixels) = compare_positions(
            context,
            &scene,
            &view,
            &format!("{offset:e} m from the origin, {projection:?}"),
        )?;
        (outside, drawn) = (outside + culled, drawn + pixels);
    }
    for (axes, fov_y_deg) in [(turned, 15.0), (turned.transpose(), 15.0), (turned, 50.0)] {
        let projection = Projection::Perspective { fov_y_deg };
        let border = BorderView {
            axes,
            eye: DVec3::ZERO,
            size: [64, 48],
            projection,
            near_m: 2.0,
        };
        let scene = border.spikes(&mut rng);
        let view = border.view(&scene);
        let (_, pixels) =
            compare_positions(context, &scene, &view, &format!("spikes, {projection:?}"))?;
        check!(pixels > 500, "spikes, {projection:?}: {pixels} pixels");
    }
    check!(
        outside > 100 && drawn > 100,
        "{outside} slivers were culled, and {drawn} pixels show others"
    );
    Ok(())
}
