//! Pictures of light around a scene.

use rasterlab::scene::radiance;

use super::{Outcome, Target, assert_told};
use crate::guard::Limit;

pub const TARGET: Target = Target {
    name: "light",
    about: "Radiance pictures of what surrounds a scene",
    views: &[],
    limit: Limit::new(5, 64),
    check,
};

fn check(bytes: &[u8]) -> Outcome {
    let picture = radiance::read(bytes).inspect_err(|error| assert_told(error))?;
    let [width, height] = picture.size;
    assert_eq!(picture.light.len(), width * height, "a cell is missing");
    let is_light = |value: f64| (0.0..=radiance::BRIGHTEST).contains(&value);
    for light in &picture.light {
        assert!(
            light.to_array().into_iter().all(is_light),
            "{light} is no light"
        );
    }
    Ok(())
}
