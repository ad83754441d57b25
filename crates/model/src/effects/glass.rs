//! Glass: parts of the scene through which others are seen, layer behind layer.
//!
//! A layer passes a fraction of each channel of what lies behind it and adds light of its own, so
//! layers are affine maps of a color. They compose from back to front, in linear light, in the order
//! of depth. A material that blends is a layer too: it passes 1 − alpha and adds alpha times its
//! color. One that transmits light also passes, where it covers, what it does not reflect
//! (Schlick 1994), tinted by its base color (glTF's thin surfaces, without refraction).

use glam::DVec3;

use super::{
    BuiltIn, Effect, Surface, SurfaceInput,
    hooks::tone::rgb,
};
use crate::words;

words! {
    pub struct Glass of "glass" {
        tint: [f32; 4],
        mirrored: [f32; 4],
        thickness: f32,
        fresnel: f32,
        frost: f32,
    }
}

pub static EFFECT: BuiltIn = BuiltIn::new(|| {
    Effect::declared::<Glass>()
    .with_glass()
    .reading(&[
        SurfaceInput::Color,
        SurfaceInput::Normal,
        SurfaceInput::View,
    ])
    .into()
});

/// Reflectance of glass seen face on.
const FACE_ON: f64 = 0.04;
/// Least cosine at which a line of sight grows longer: it breaks as it enters, and stays steeper.
const STEEPEST: f64 = 0.66;

/// What a layer does to the linear color behind it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GlassLayer {
    /// Fraction that passes, each from 0 to 1.
    pub passed: DVec3,
    /// Light that is added, each from 0 to 1.
    pub added: DVec3,
}

impl GlassLayer {
    /// Nothing between.
    pub const CLEAR: Self = Self {
        passed: DVec3::ONE,
        added: DVec3::ZERO,
    };

    /// Of a shaded surface whose material blends or transmits light.
    pub fn blended(s: &Surface) -> Self {
        let alpha = s.color.w.clamp(0.0, 1.0);
        let slant = 1.0 - s.normal.dot(s.view).abs().min(1.0);
        let [straight, grazing] = [s.finish.specular.truncate(), DVec3::splat(s.finish.specular.w)];
        let reflected = straight.lerp(grazing, slant.powi(5));
        Self {
            passed: DVec3::splat(1.0 - alpha) + clamped(s.passed * (1.0 - reflected)) * alpha,
            added: clamped(s.color.truncate()) * alpha,
        }
    }

    /// Two layers as one, this one before `back`.
    pub fn merged(&self, back: &Self) -> Self {
        Self {
            passed: self.passed * back.passed,
            added: self.passed * back.added + self.added,
        }
    }

    /// What is seen of a linear color behind it.
    pub fn over(&self, behind: DVec3) -> DVec3 {
        self.passed * behind + self.added
    }

    /// Alpha of what covers the background, with this alpha behind it.
    pub fn alpha_over(&self, behind: f64) -> f64 {
        1.0 + (behind - 1.0) * self.passed.dot(DVec3::splat(1.0 / 3.0))
    }
}

impl Glass {
    /// The layer of a shaded surface.
    pub fn layer(&self, s: &Surface) -> GlassLayer {
        let cosine = s.normal.dot(s.view).abs().min(1.0);
        let path = f64::from(self.thickness) / cosine.max(STEEPEST);
        let tint = clamped(rgb(self.tint)).max(DVec3::splat(1e-6));
        let tinted = DVec3::from(tint.to_array().map(|channel| libm::pow(channel, path)));
        let slant = 1.0 - cosine;
        let mirrored =
            f64::from(self.fresnel) * (FACE_ON + (1.0 - FACE_ON) * slant.powi(5));
        let clear = 1.0 - f64::from(self.frost);
        GlassLayer {
            passed: tinted * ((1.0 - mirrored) * clear),
            added: clamped(rgb(self.mirrored)) * (mirrored * clear)
                + clamped(s.color.truncate()) * f64::from(self.frost),
        }
    }
}

fn clamped(color: DVec3) -> DVec3 {
    color.clamp(DVec3::ZERO, DVec3::ONE)
}

/// Which draws are glass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GlassDraws {
    /// None: another effect counts or orders all samples alike.
    Nothing,
    /// Those whose material blends.
    Blended,
    /// Those, and the ones that lie in this scope of the stack.
    Scope(u32),
    /// All.
    Everything,
}

impl GlassDraws {
    /// Is a draw with these scopes glass?
    pub const fn has(self, is_blended: bool, scopes: u32) -> bool {
        match self {
            Self::Nothing => false,
            Self::Blended => is_blended,
            Self::Scope(bit) => is_blended || scopes >> bit & 1 == 1,
            Self::Everything => true,
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec4;

    use super::{super::hooks::Transmission, *};

    #[test]
    fn a_layer_never_brightens_beyond_white_and_blending_is_a_weighted_mean() {
        let mut s = Surface::example(DVec3::new(0.2, 0.9, 3.0), 0);
        for (frost, thickness) in [(0.0, 0.0), (1.0, 2.0), (0.5, 100.0)] {
            let glass = Glass {
                frost,
                thickness,
                ..Glass::default()
            };
            for slant in [0.0, 0.3, 1.0] {
                s.normal = DVec3::new(slant, 0.0, 1.0 - slant).normalize();
                let seen = glass.layer(&s).over(DVec3::ONE);
                assert!(seen.max_element() <= 1.0 + 1e-12, "{seen}");
            }
        }
        s.color.w = 0.25;
        let seen = GlassLayer::blended(&s).over(DVec3::splat(0.4));
        assert!((seen - DVec3::new(0.35, 0.525, 0.55)).length() < 1e-12, "{seen}");
        s.color.w = 0.0;
        assert_eq!(GlassLayer::blended(&s).over(DVec3::X), DVec3::X);
    }

    #[test]
    fn clear_glass_tints_what_passes_and_mirrors_the_rest_more_where_it_glances() {
        let clear = Transmission {
            amount: 0.5,
            attenuated: DVec3::new(0.5, 0.25, 0.0),
            is_opaque: true,
            is_by_alpha: false,
        };
        let mut s = Surface::example(DVec3::new(0.2, 0.8, 0.4), 0);
        (s.finish.metallic, s.finish.specular) = (0.0, DVec4::new(0.1, 0.1, 0.1, 1.0));
        s.normal = s.view;
        let layer = GlassLayer::blended(&clear.through(s));
        assert!((layer.passed - 0.9 * DVec3::new(0.1, 0.2, 0.0)).length() < 1e-12, "{layer:?}");
        assert!((layer.added - DVec3::new(0.1, 0.4, 0.2)).length() < 1e-12, "{layer:?}");
        s.normal = s.view.any_orthonormal_vector();
        assert!(GlassLayer::blended(&clear.through(s)).passed.length() < 1e-12);
        s.finish.metallic = 1.0;
        s.normal = s.view;
        assert_eq!(GlassLayer::blended(&clear.through(s)).passed, DVec3::ZERO);
    }
}
