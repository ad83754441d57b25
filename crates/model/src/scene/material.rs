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
    /// Fraction of the light that its color, where it is no metal, does not scatter but lets through,
    /// 0 to 1: a thin wall that does not refract.
    pub transmission: f32,
    /// The alpha of the base texture is the part of that fraction that counts at a place.
    pub transmits_by_alpha: bool,
    /// What of that light is left behind its thickness: linear RGB, each 0 to 1.
    pub attenuation: [f32; 3],
    /// Emitted light, linear RGB, from 0 up.
    pub emission: [f32; 3],
    /// Multiplies the emission.
    pub emission_texture: Option<Texture>,
    /// Data, not color: its green multiplies the roughness, its blue `metallic`.
    pub finish_texture: Option<Texture>,
    /// Data: its red is the fraction of the light from all sides that arrives.
    pub occlusion_texture: Option<Texture>,
    /// How much of the occlusion counts, 0 to 1.
    pub occlusion_strength: f32,
    /// Data: normals relative to the surface, -1 to 1 as bytes: along its tangent, across it and
    /// outward.
    pub normal_texture: Option<Texture>,
    /// Multiplies the first two components of those normals.
    pub normal_scale: f32,
    /// Lights do not change its color.
    pub unlit: bool,
    /// Back faces are drawn too, with the normal flipped towards the viewer.
    pub double_sided: bool,
}

/// The textures that a material may have. The value is its place in [`Material::textures`] and in
/// `Primitive::texcoords`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TextureSlot {
    Base = 0,
    Emission = 1,
    Finish = 2,
    Occlusion = 3,
    Normal = 4,
}

impl TextureSlot {
    /// All of them, in order.
    pub const ALL: [Self; TEXTURE_SLOTS] = [
        Self::Base,
        Self::Emission,
        Self::Finish,
        Self::Occlusion,
        Self::Normal,
    ];

    /// Are the texels of its image numbers, not colors?
    pub const fn is_data(self) -> bool {
        !matches!(self, Self::Base | Self::Emission)
    }
}

/// The number of [`TextureSlot`]s.
pub const TEXTURE_SLOTS: usize = 5;

impl Material {
    /// The texture in each [`TextureSlot`].
    pub fn textures(&self) -> [Option<&Texture>; TEXTURE_SLOTS] {
        TextureSlot::ALL.map(|slot| self.texture(slot))
    }

    /// The texture in a slot.
    pub fn texture(&self, slot: TextureSlot) -> Option<&Texture> {
        match slot {
            TextureSlot::Base => &self.base_texture,
            TextureSlot::Emission => &self.emission_texture,
            TextureSlot::Finish => &self.finish_texture,
            TextureSlot::Occlusion => &self.occlusion_texture,
            TextureSlot::Normal => &self.normal_texture,
        }
        .as_ref()
    }

    /// The same material with the textures of these slots alone.
    pub fn with_textures(mut self, slots: [bool; TEXTURE_SLOTS]) -> Self {
        let textures = [
            &mut self.base_texture,
            &mut self.emission_texture,
            &mut self.finish_texture,
            &mut self.occlusion_texture,
            &mut self.normal_texture,
        ];
        for (texture, is_kept) in textures.into_iter().zip(slots) {
            *texture = texture.filter(|_| is_kept);
        }
        self
    }

    /// Has it a texture of its color: of the base color or of the emission?
    pub fn has_color_texture(&self) -> bool {
        self.base_texture.is_some() || self.emission_texture.is_some()
    }

    /// Do textures say how it reflects, where lights change its color?
    pub fn has_finish_maps(&self) -> bool {
        !self.unlit && (self.finish_texture.is_some() || self.occlusion_texture.is_some())
    }

    /// Does light pass through its color?
    pub fn transmits(&self) -> bool {
        self.transmission > 0.0 && !self.unlit
    }

    /// Is seen through it what lies behind?
    pub fn is_glass(&self) -> bool {
        self.is_blended || self.transmits()
    }

    /// Does a texture turn its normals?
    pub fn has_normal_map(&self) -> bool {
        self.normal_texture.is_some()
    }

    /// The smallest alpha that is drawn, in units of 2^-16 / 255. `None` where alpha discards
    /// nothing.
    pub fn alpha_threshold(&self) -> Option<u32> {
        let alpha_cutoff = self.alpha_cutoff.filter(|_| self.base_texture.is_some())?;
        // A cutoff of k/255 is rounded to f32, which may lift it by half a unit; an alpha byte of k
        // must still pass.
        Some((f64::from(alpha_cutoff) * 255.0 * 65_536.0 - 0.5).ceil() as u32)
    }

    /// Returns true if the color of the material is a base color and nothing else: no texture of
    /// its color, no emission, affected by light.
    pub fn is_plain(&self) -> bool {
        !self.has_color_texture() && self.emission == [0.0; 3] && !self.unlit
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
            transmission: 0.0,
            transmits_by_alpha: false,
            attenuation: [1.0; 3],
            emission: [0.0; 3],
            emission_texture: None,
            finish_texture: None,
            occlusion_texture: None,
            occlusion_strength: 1.0,
            normal_texture: None,
            normal_scale: 1.0,
            unlit: false,
            double_sided: false,
        }
    }
}
