//! The ball in the corner of the picture: it is lit from the direction of the preset's light, and a
//! drag turns that light.

use egui::{self, Color32, Mesh, Pos2, Rect, Sense, Stroke, Ui, Vec2, vec2};
use glam::{DQuat, DVec3};

use crate::{
    app::{
        editing::session::Session,
        shell::command::{Commands, Edit, Parameter},
        widgets::{panel::describe, theme},
    },
    effects::{Stack, shadow},
    math::srgb_byte,
    params::{Stored as _, Value, ValueType},
    scene::{camera::Camera, camera_moves},
};

/// Radius of the ball, and its distance from the corner, points.
const RADIUS: f32 = 36.0;
const MARGIN: f32 = 14.0;

/// Rings and spokes of the ball's mesh.
const RINGS: u32 = 8;
const SPOKES: u32 = 40;

/// Name of the parameter by which an effect without shadows says where its light comes from: the
/// built-in Lambert, and effects of the user's own that have the same parameter.
const DIRECTION: &str = "sun_direction";

/// The light that the ball turns.
struct Light {
    /// Unit vector, world space.
    toward: DVec3,
    /// Linear.
    color: [f32; 4],
    turns: Turns,
}

/// What turns a light.
enum Turns {
    /// The angles of the light that casts shadows.
    Angles,
    /// A parameter that holds a direction of any length.
    Direction(Parameter),
}

impl Light {
    /// The light that casts shadows, else the first sun of the stack.
    fn of(stack: &Stack) -> Option<Self> {
        if let Some(shadow) = stack.light() {
            return Some(Self {
                toward: shadow.toward(),
                color: shadow.light,
                turns: Turns::Angles,
            });
        }
        stack.0.iter().find_map(|enabled| {
            let effect = &enabled.effect;
            let field = effect
                .field(DIRECTION)
                .filter(|field| field.value_type == ValueType::Point)?;
            let [x, y, z] = <[f64; 3]>::try_from(field.get(&enabled.words)).ok()?;
            // As the effect does, which takes a light from straight above where the direction has
            // no length.
            let toward = DVec3::new(x, y, z).normalize_or(DVec3::Y);
            let sun = effect
                .field("sun")
                .map_or_else(Vec::new, |field| field.get(&enabled.words));
            let color =
                [0, 1, 2, 3].map(|channel| sun.get(channel).map_or(1.0, |&value| value as f32));
            Some(Self {
                toward,
                color,
                turns: Turns::Direction((effect.clone(), field.clone())),
            })
        })
    }

    /// What turns the light towards this direction.
    fn turn(&self, toward: DVec3, commands: &Commands) {
        match &self.turns {
            Turns::Angles => {
                for (name, degrees) in ["azimuth_deg", "elevation_deg"]
                    .into_iter()
                    .zip(angles(toward))
                {
                    if let Some(field) = shadow::EFFECT.field(name) {
                        commands.edit(Edit::Parameter(
                            (shadow::EFFECT.clone(), field.clone()),
                            Value::number(degrees),
                        ));
                    }
                }
            }
            Turns::Direction(parameter) => {
                commands.edit(Edit::Parameter(parameter.clone(), toward.to_value()))
            }
        }
    }
}

/// The ball at the lower right of the picture at `at`, if the preset has a light.
pub fn light_ui(ui: &mut Ui, session: &Session, commands: &Commands, at: Rect) {
    let (Some(light), Some(camera)) = (Light::of(&session.visible_stack()), session.camera())
    else {
        return;
    };
    let center = at.right_bottom() - Vec2::splat(RADIUS + MARGIN);
    if at.width().min(at.height()) < 6.0 * RADIUS {
        return;
    }
    let rect = Rect::from_center_size(center, Vec2::splat(2.0 * RADIUS));
    let response = ui.interact(rect, egui::Id::unique("light direction"), Sense::drag());
    describe(&response, egui::Role::Slider, "Light direction");
    let toward = light.toward;
    ball_ui(
        ui,
        center,
        &light,
        &camera,
        response.hovered() || response.dragged(),
    );
    let drag = response.drag_delta();
    if drag != Vec2::ZERO {
        let [right, down] = [drag.x, drag.y].map(|points| f64::from(points / RADIUS));
        light.turn(turn_direction(toward, &camera, right, down), commands);
    }
    let [azimuth, elevation] = angles(toward);
    response.on_hover_text(format!(
        "Drag to turn the light\nazimuth {azimuth:.1}°, elevation {elevation:.1}°"
    ));
}

/// Azimuth and elevation of a direction, degrees.
fn angles(toward: DVec3) -> [f64; 2] {
    [
        toward.x.atan2(toward.z).to_degrees(),
        toward.y.clamp(-1.0, 1.0).asin().to_degrees(),
    ]
}

/// A direction turned like a ball that is dragged right and down, radians.
fn turn_direction(toward: DVec3, camera: &Camera, right: f64, down: f64) -> DVec3 {
    let (x, y) = camera_moves::axes(camera);
    (DQuat::from_axis_angle(x, down) * (DQuat::from_axis_angle(y, right) * toward))
        .normalize_or(toward)
}

/// The ball as the camera sees it, with a mark in the direction of the light: a disc in front, a
/// ring behind.
fn ball_ui(ui: &Ui, center: Pos2, light: &Light, camera: &Camera, is_active: bool) {
    let (x, y) = camera_moves::axes(camera);
    let (back, toward) = (-camera.forward(), light.toward);
    let tint = |brightness: f64, alpha: u8| {
        let [r, g, b] =
            [0, 1, 2].map(|channel| srgb_byte(f64::from(light.color[channel]) * brightness));
        Color32::from_rgba_unmultiplied(r, g, b, alpha)
    };
    let position = |right: f64, up: f64| center + vec2(right as f32, -up as f32) * RADIUS;
    let mut ball = Mesh::default();
    for ring in 0..=RINGS {
        for spoke in 0..SPOKES {
            // Finer towards the rim, where the normal changes fast.
            let radius = (f64::from(ring) / f64::from(RINGS) * std::f64::consts::FRAC_PI_2).sin();
            let (sin, cos) =
                (f64::from(spoke) / f64::from(SPOKES) * std::f64::consts::TAU).sin_cos();
            let normal = x * (radius * cos)
                + y * (radius * sin)
                + back * (1.0 - radius * radius).max(0.0).sqrt();
            ball.colored_vertex(
                position(radius * cos, radius * sin),
                tint(0.06 + 0.9 * normal.dot(toward).max(0.0), 235),
            );
            if ring > 0 {
                let (a, b) = (
                    (ring - 1) * SPOKES + spoke,
                    (ring - 1) * SPOKES + (spoke + 1) % SPOKES,
                );
                ball.add_triangle(a, b, a + SPOKES);
                ball.add_triangle(b, b + SPOKES, a + SPOKES);
            }
        }
    }
    let painter = ui.painter();
    painter.add(ball);
    let rim = if is_active {
        theme::accent()
    } else {
        theme::line()
    };
    painter.circle_stroke(center, RADIUS, Stroke::new(1.5, rim));
    let mark = position(toward.dot(x), toward.dot(y));
    let ink = if is_active {
        theme::accent()
    } else {
        theme::text_strong()
    };
    if toward.dot(back) >= 0.0 {
        painter.circle_filled(mark, 5.0, tint(1.0, 255));
    }
    painter.circle_stroke(mark, 5.0, Stroke::new(1.5, ink));
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::shadow::Shadow;

    #[test]
    fn a_ball_follows_the_pointer_and_angles_read_back() {
        let camera = Camera {
            eye: DVec3::new(1.0, 2.0, 5.0),
            ..Camera::default()
        };
        let (x, y) = camera_moves::axes(&camera);
        let front = -camera.forward();
        assert!(
            turn_direction(front, &camera, 0.1, 0.0).dot(x) > 0.09
                && turn_direction(front, &camera, 0.0, 0.1).dot(y) < -0.09
        );
        for (azimuth_deg, elevation_deg) in [(30.0, 40.0), (-150.0, -10.0), (90.0, 89.0)] {
            let [azimuth, elevation] = angles(
                Shadow {
                    azimuth_deg,
                    elevation_deg,
                    ..Shadow::default()
                }
                .toward(),
            );
            assert!(
                (azimuth - f64::from(azimuth_deg)).abs() < 1e-6
                    && (elevation - f64::from(elevation_deg)).abs() < 1e-6
            );
        }
    }
}
