//! Materials: how surfaces are shaded.

use super::texture::Texture;

/// How a surface is shaded. Colors are linear.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    pub name: String,
    /// Linear RGBA, each in [0, 1].
    pub base_color: [f32; 4],
    /// Multiplies the base color. Its alpha is used only with an `alpha_cutoff`, and where the
    /// material blends.
    pub base_texture: Option<Texture>,
    /// Samples are drawn only where the alpha of the base texture is at least this. From 0 up;
    /// nothing is drawn above 1.
    pub alpha_cutoff: Option<f32>,
    /// What lies behind is seen through it: alpha is the fraction that its color covers.
    pub is_blended: bool,
    /// 0: not a metal; 1: a metal, which reflects its base color.
    pub metallic: f32,
    /// Perceptual roughness: 0 a mirror, 1 matt.
    pub roughness: f32,
    /// What it reflects where it is no metal: linear RGB of light that meets it straight on, and
    /// the part of light that grazes it. Each 0 to 1.
    pub specular: [f32; 4],
    /// Emitted light, linear RGB, from 0 up.
    pub emission: [f32; 3],
    /// Multiplies the emission.
    pub emission_texture: Option<Texture>,
    /// Lights do not change its color.
    pub unlit: bool,
    /// Back faces are drawn too, with the normal flipped towards the viewer.
    pub double_sided: bool,
}

impl Material {
    /// The textures of the base color and of the emission.
    pub fn textures(&self) -> [Option<&Texture>; 2] {
        [self.base_texture.as_ref(), self.emission_texture.as_ref()]
    }

    /// The smallest alpha that is drawn, in units of 2^-16 / 255. `None` where alpha discards
    /// nothing.
    pub fn alpha_threshold(&self) -> Option<u32> {
        let alpha_cutoff = self.alpha_cutoff.filter(|_| self.base_texture.is_some())?;
        // A cutoff of k/255 is rounded to f32, which may lift it by half a unit; an alpha byte of k
        // must still pass.
        Some((f64::from(alpha_cutoff) * 255.0 * 65_536.0 - 0.5).ceil() as u32)
    }

    /// Returns true if the material has a base color and nothing else: no texture, no emission,
    /// affected by light.
    pub fn is_plain(&self) -> bool {
        self.textures() == [None, None] && self.emission == [0.0; 3] && !self.unlit
    }
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: "default".into(),
            base_color: [1.0; 4],
            base_texture: None,
            alpha_cutoff: None,
            is_blended: false,
            metallic: 0.0,
            roughness: 0.5,
            // Glass, plastic and most else that is no metal: a refractive index of 1.5.
            specular: [0.04, 0.04, 0.04, 1.0],
            emission: [0.0; 3],
            emission_texture: None,
            unlit: false,
            double_sided: false,
        }
    }
}
