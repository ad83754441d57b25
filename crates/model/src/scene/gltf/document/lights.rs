//! Lights of the extension KHR_lights_punctual.

use std::f64::consts::FRAC_PI_2;

use super::{
    Light, Part,
    fields::{Field, Object, needed},
    read::{LIGHTS, Lists},
};
use crate::scene::punctual::LightKind;

/// Most candela, lux and parts of a color, so that no sum leaves what f32 can hold.
const MOST: f64 = 1e9;

/// Angles may exceed their limits by so much, radians: writers round them.
const TOLERANCE: f64 = 1e-4;

/// The light of a node.
pub fn of_node(lists: &Lists, node: Object) -> Field<usize> {
    match node.extension(LIGHTS)? {
        Some(extension) => extension.index("light", "lights", lists.lights.len()),
        None => Ok(None),
    }
}

pub fn light(part: Object) -> Part<Light> {
    let kind = match needed("type", part.text("type"))? {
        "directional" => Some(LightKind::Directional),
        "point" => Some(LightKind::Point),
        "spot" => Some(spot(part)?),
        _ => None,
    };
    let strength = |key: &str, value: f32| match f64::from(value) {
        value if (0.0..=MOST).contains(&value) => Ok(value),
        value => Err(format!(
            "its {key} is {value}; it must be from 0 to {MOST:e}"
        )),
    };
    let intensity = strength("intensity", part.number("intensity")?.unwrap_or(1.0))?;
    let mut light = [0.0; 3];
    for (light, color) in light
        .iter_mut()
        .zip(part.vector("color")?.unwrap_or([1.0; 3]))
    {
        *light = intensity * strength("color", color)?;
    }
    let range_m = part.number("range")?.map(f64::from);
    if let Some(range) = range_m.filter(|range| *range <= 0.0) {
        return Err(format!("its range is {range}; it must be above 0"));
    }
    Ok(Light {
        name: part.text("name").ok().flatten().map(str::to_owned),
        kind,
        light,
        range_m,
    })
}

fn spot(part: Object) -> Part<LightKind> {
    let Some(spot) = part.object("spot")? else {
        return Ok(LightKind::SPOT);
    };
    let LightKind::Spot { inner, outer } = LightKind::SPOT else {
        return Ok(LightKind::SPOT);
    };
    let angle =
        |key: &str, default: f64| Ok::<_, String>(spot.number(key)?.map_or(default, f64::from));
    let (inner, outer) = (
        angle("innerConeAngle", inner)?,
        angle("outerConeAngle", outer)?,
    );
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
