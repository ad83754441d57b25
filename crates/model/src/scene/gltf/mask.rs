//! Alpha masks of primitives: an image's alpha is compared with a cutoff. Alpha that vertices have
//! becomes the coordinates of an image of our own, a ramp, so that nothing else must know of it.

use super::document;
use crate::{
    scene::{
        accessor::Accessor,
        material::{Material, TEXTURE_SLOTS},
        model::{Primitive, Scene},
        texture::{Filter, Image, MipFilter, Texture, Wrap},
    },
    work::{Canceled, map_parts},
};

/// How a primitive's material differs from that of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Variant {
    /// The [`TextureSlot`](crate::scene::material::TextureSlot)s whose textures it keeps.
    pub textures: [bool; TEXTURE_SLOTS],
    /// The texture of the base color is the ramp.
    pub is_ramp: bool,
    /// Bits of the alpha cutoff.
    pub cutoff: Option<u32>,
}

impl Variant {
    /// That of a material as the file has it.
    pub fn of_material(plain: &Material) -> Self {
        Self {
            textures: plain.textures().map(|texture| texture.is_some()),
            is_ramp: false,
            cutoff: plain.alpha_cutoff.map(f32::to_bits),
        }
    }

    /// The material that `plain` becomes. The ramp is added to `images` where it is not there.
    pub fn made_of(self, plain: Material, images: &mut Vec<Image>) -> Material {
        let mut made = plain.with_textures(self.textures);
        if self.is_ramp {
            made.base_texture = Some(ramp_texture(images));
        }
        made.alpha_cutoff = self.cutoff.map(f32::from_bits);
        made
    }
}

/// The range of the alpha of vertices.
#[derive(Clone, Copy, Debug)]
pub struct Alphas([f64; 2]);

impl Alphas {
    /// Those of colors; 1 where they have none.
    pub fn of(scene: &Scene, colors: Option<&Accessor>) -> Result<Self, Canceled> {
        let Some(colors) = colors.filter(|colors| colors.components == 4) else {
            return Ok(Self([1.0; 2]));
        };
        let ranges = map_parts(colors.count, |part| {
            part.fold(
                [f64::INFINITY, f64::NEG_INFINITY],
                |[least, most], vertex| {
                    let alpha = colors.value(&scene.vertex_bytes, vertex, 3).clamp(0.0, 1.0);
                    [least.min(alpha), most.max(alpha)]
                },
            )
        })?;
        let join = |[a, b]: [f64; 2], [c, d]: [f64; 2]| [a.min(c), b.max(d)];
        Ok(Self(ranges.into_iter().reduce(join).unwrap_or([1.0; 2])))
    }

    pub fn is_uniform(self) -> bool {
        self.0[0] == self.0[1]
    }
}

/// What alpha masking does with a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Masked {
    /// Nothing is cut out.
    Whole,
    /// Everything is.
    Nothing,
    /// Where the alpha of its image is below this.
    Image { cutoff: f32 },
    /// Where the alpha of its vertices is below this.
    Ramp { cutoff: f32 },
}

/// What masking by `about` does with a primitive whose base color has an image, or not.
pub fn masked(about: &document::Material, has_image: bool, alphas: Alphas) -> Masked {
    let [least, most] = alphas.0;
    // The alpha that everything is multiplied by.
    let mut factor = f64::from(about.plain.base_color[3]);
    if alphas.is_uniform() {
        factor *= least;
    }
    let wanted = f64::from(about.alpha_cutoff);
    let cutoff = ((wanted / factor) as f32).min(2.0);
    match (wanted > 0.0, has_image, alphas.is_uniform()) {
        (false, ..) => Masked::Whole,
        (true, true, _) => Masked::Image { cutoff },
        (true, false, true) if factor >= wanted => Masked::Whole,
        (true, false, true) => Masked::Nothing,
        (true, false, false) if factor * least >= wanted => Masked::Whole,
        (true, false, false) if factor * most < wanted => Masked::Nothing,
        (true, false, false) => Masked::Ramp { cutoff },
    }
}

/// Texels of the ramp, from alpha 0 to 1.
const RAMP: u32 = 256;
const RAMP_NAME: &str = "alpha of the vertices";

/// White, with an alpha that rises from the left to the right.
fn ramp_texture(images: &mut Vec<Image>) -> Texture {
    let known = images.iter().position(|image| image.name == RAMP_NAME);
    let image = known.unwrap_or_else(|| {
        let texels = (0..=255).map(|alpha| [255, 255, 255, alpha]).collect();
        images.push(Image::new(RAMP_NAME, [RAMP, 1], texels));
        images.len() - 1
    });
    Texture {
        wrap: [Wrap::Clamp; 2],
        mag_filter: Filter::Linear,
        min_filter: Filter::Linear,
        mip_filter: MipFilter::Unused,
        ..Texture::plain(image)
    }
}

/// Where the alpha of each vertex lies in the ramp.
pub fn ramp_texcoords(scene: &Scene, primitive: &Primitive) -> Vec<[f32; 2]> {
    let alpha = |vertex| match primitive.colors.filter(|colors| colors.components == 4) {
        Some(colors) => colors.value(&scene.vertex_bytes, vertex, 3).clamp(0.0, 1.0),
        None => 1.0,
    };
    let place = |alpha: f64| [((alpha * 255.0 + 0.5) / f64::from(RAMP)) as f32, 0.5];
    (0..primitive.vertex_count())
        .map(|vertex| place(alpha(vertex)))
        .collect()
}
