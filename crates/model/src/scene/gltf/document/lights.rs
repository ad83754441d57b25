//! Lights of the extension KHR_lights_punctual.

use std::f64::consts::FRAC_PI_2;

use ::gltf::json::{
    extensions::scene::khr_lights_punctual::{Light as JsonLight, Spot, Type},
    validation::Checked,
};

use super::{Light, Part, element::Element};
use crate::scene::punctual::LightKind;

/// Most candela, lux and parts of a color, so that no sum leaves what f32 can hold.
const MOST: f64 = 1e9;

/// Angles may exceed their limits by so much, radians: writers round them.
const TOLERANCE: f64 = 1e-4;

pub fn light(mut part: Element) -> Part<Light> {
    // The crate keeps them as text, which a value that is parsed does not have.
    part.json.remove("extensions");
    let light: JsonLight = part.read(&["type", "intensity", "color", "range", "spot"])?;
    let kind = match light.type_ {
        Checked::Valid(Type::Directional) => Some(LightKind::Directional),
        Checked::Valid(Type::Point) => Some(LightKind::Point),
        Checked::Valid(Type::Spot) => Some(match light.spot {
            Some(cone) => spot(&part, &cone)?,
            None => LightKind::SPOT,
        }),
        Checked::Invalid => None,
    };
    let strength = |key: &str, value: f32| match f64::from(value) {
        value if (0.0..=MOST).contains(&value) => Ok(value),
        value => Err(format!(
            "its {key} is {value}; it must be from 0 to {MOST:e}"
        )),
    };
    let intensity = strength("intensity", light.intensity)?;
    let mut color = [0.0; 3];
    for (color, given) in color.iter_mut().zip(light.color) {
        *color = intensity * strength("color", given)?;
    }
    // Writers say 0 for a light without an end.
    let range_m = light.range.map(f64::from).filter(|range| *range != 0.0);
    if let Some(range) = range_m.filter(|range| *range < 0.0) {
        return Err(format!("its range is {range}; it must be above 0"));
    }
    Ok(Light {
        name: light.name,
        kind,
        light: color,
        range_m,
    })
}

fn spot(part: &Element, cone: &Spot) -> Part<LightKind> {
    let LightKind::Spot { inner, outer } = LightKind::SPOT else {
        return Ok(LightKind::SPOT);
    };
    // The crate's default is that of the extension, rounded.
    let is_given = |key: &str| {
        part.object(&["spot"])
            .is_some_and(|spot| spot.contains_key(key))
    };
    let angle = |key: &str, given: f32, default: f64| match is_given(key) {
        true => f64::from(given),
        false => default,
    };
    let inner = angle("innerConeAngle", cone.inner_cone_angle, inner);
    let outer = angle("outerConeAngle", cone.outer_cone_angle, outer);
    let is_cone = inner >= 0.0 && inner <= outer + TOLERANCE && outer <= FRAC_PI_2 + TOLERANCE;
    if !is_cone {
        return Err(format!(
            "its cones reach to {inner} and {outer} radians; the inner one must be from 0 to the outer one, and that at most pi / 2"
        ));
    }
    let outer = outer.min(FRAC_PI_2);
    Ok(LightKind::Spot {
        inner: inner.min(outer),
        outer,
    })
}
