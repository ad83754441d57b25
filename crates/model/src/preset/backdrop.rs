//! The backdrop: what a preset shows where nothing is drawn.

use glam::DVec4;

use super::Preset;
use crate::{
    effects::{Effect, Surface},
    scene::{Background, parts::Scope},
};

impl Preset {
    /// What pixels without a triangle show: the background of the output, through the tone mapping
    /// that asks for it.
    pub fn backdrop(&self) -> Background {
        let mut backdrop = self.output.backdrop();
        for enabled in &self.evaluated_stack().0 {
            let original = enabled.effect.base.as_ref().unwrap_or(&enabled.effect);
            if original != Effect::named("tonemap") || enabled.on != Scope::default() {
                continue;
            }
            if let Some(shown) = &enabled.effect.hooks.surface
                && enabled.number("background") != 0.0
            {
                [backdrop.top, backdrop.bottom] = [backdrop.top, backdrop.bottom].map(|color| {
                    let color = DVec4::from_array(color.map(f64::from));
                    let seen = Surface {
                        color,
                        ..Surface::example(color.truncate(), 0)
                    };
                    shown(seen, &enabled.words).color.as_vec4().to_array()
                });
            }
        }
        backdrop
    }
}
