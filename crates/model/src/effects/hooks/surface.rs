//! The surface hook: what color is it?

use glam::{DVec2, DVec3, DVec4};

use crate::scene::{material::Material, panorama::Panorama, punctual::PlacedLight};

/// What the rasterizer knows about a visible sample; a surface effect changes it and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Linear RGBA so far; begins as the material's base color times the vertex color and the
    /// texture, plus its emission.
    pub color: DVec4,
    /// The part of the color that no light changes: what the material emits, or all of it where it
    /// is unlit. An effect that paints over a fraction of the color removes the same fraction
    /// of this.
    pub glow: DVec3,
    /// World space, meters: on the ray of its pixel at `depth_m`, however the corners were
    /// snapped.
    pub position: DVec3,
    /// Unit, towards the viewer's side: interpolated, turned by the material's map, then as earlier
    /// effects have changed it.
    pub normal: DVec3,
    /// Unit normal of the triangle's plane, towards the same side.
    pub flat_normal: DVec3,
    /// Unit vector from the sample to the eye.
    pub view: DVec3,
    /// Mean of the triangle's corners, world space.
    pub center: DVec3,
    /// Position of that mean in the picture: 0 left and top, 1 right and bottom.
    pub center_screen: DVec2,
    /// Position of the sample in the picture.
    pub screen: DVec2,
    /// The same in pixels, right and down.
    pub pixel: DVec2,
    /// Barycentric coordinates of the sample, measured on the screen: 1 at the corner, 0 on the
    /// opposite edge. Of a clipped triangle, measured on its plane.
    pub barycentrics: DVec3,
    /// Distance of the sample from the edge opposite each corner, pixels.
    pub edge_distance_px: DVec3,
    /// Distance from the eye along the viewing direction, meters.
    pub depth_m: f64,
    /// Side of a pixel at the sample's depth, meters, across the view.
    pub pixel_size_m: f64,
    /// Mean of `depth_m` over the triangle's corners.
    pub flat_depth_m: f64,
    /// Nearest and farthest `depth_m` of the scene's box.
    pub depth_range_m: DVec2,
    /// Global triangle id.
    pub triangle_id: u32,
    /// Fraction of all samples that precede the triangle's first in a draw order; 0 without one.
    pub rank: f64,
    /// Fraction of the light that arrives, 0 to 1, where Shadow is in the stack; else 0.
    pub lit: f64,
    /// How the material reflects.
    pub finish: Finish,
    /// Where light passes through the material: the fraction of each channel that does straight on,
    /// of what it does not reflect; else 0.
    pub passed: DVec3,
    /// Added to each value that decides a step of color. It is 0 except for the judge, which finds
    /// with it the pixels so close to a step that either answer is right.
    pub step_offset: f64,
}

impl Surface {
    /// A surface of this color in the middle of a triangle that faces the viewer from two meters
    /// away.
    pub fn example(color: DVec3, triangle_id: u32) -> Self {
        Self {
            color: color.extend(1.0),
            glow: DVec3::ZERO,
            position: DVec3::ZERO,
            normal: DVec3::Z,
            flat_normal: DVec3::Z,
            view: DVec3::Z,
            center: DVec3::ZERO,
            center_screen: DVec2::splat(0.5),
            screen: DVec2::splat(0.5),
            pixel: DVec2::splat(50.5),
            barycentrics: DVec3::splat(1.0 / 3.0),
            edge_distance_px: DVec3::splat(9.0),
            depth_m: 2.0,
            pixel_size_m: 0.01,
            flat_depth_m: 2.0,
            depth_range_m: DVec2::new(1.0, 3.0),
            triangle_id,
            rank: 0.0,
            lit: 1.0,
            finish: Finish::default(),
            passed: DVec3::ZERO,
            step_offset: 0.0,
        }
    }
}

/// How a material reflects light, in the terms of glTF 2.0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Finish {
    /// What it reflects where it is no metal: linear RGB of light that meets it straight on, and
    /// the part of light that grazes it. Each 0 to 1.
    pub specular: DVec4,
    /// 0: not a metal; 1: a metal, which reflects its base color.
    pub metallic: f64,
    /// Perceptual roughness: 0 a mirror, 1 matt.
    pub roughness: f64,
    /// Fraction of the light from all sides that reaches it.
    pub occlusion: f64,
}

impl From<&Material> for Finish {
    /// A material that lights do not change reflects nothing.
    fn from(material: &Material) -> Self {
        let (specular, metallic) = if material.unlit {
            ([0.0; 4], 0.0)
        } else {
            (material.specular, material.metallic)
        };
        Self {
            specular: DVec4::from_array(specular.map(f64::from)),
            metallic: metallic.into(),
            roughness: material.roughness.into(),
            occlusion: 1.0,
        }
    }
}

impl Default for Finish {
    fn default() -> Self {
        Self::from(&Material::default())
    }
}

/// What passes through a material that transmits light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transmission {
    /// Fraction of light that its color does not scatter but lets through.
    pub amount: f64,
    /// The same, behind its thickness: linear RGB.
    pub attenuated: DVec3,
    /// Its alpha is not read: it covers all that lies behind it.
    pub is_opaque: bool,
    /// Its alpha is how much of that passes at all.
    pub is_by_alpha: bool,
}

impl Transmission {
    /// That of a material; none where nothing passes.
    pub fn of(material: &Material) -> Option<Self> {
        let amount = f64::from(material.transmission);
        material.transmits().then(|| Self {
            amount,
            attenuated: amount * DVec3::from(material.attenuation.map(f64::from)),
            is_opaque: !material.is_blended,
            is_by_alpha: material.transmits_by_alpha,
        })
    }

    /// The surface of glass: what passes is tinted by its color, which scatters the rest. Metals let
    /// nothing through.
    pub fn through(&self, mut s: Surface) -> Surface {
        let alpha = if self.is_by_alpha { s.color.w } else { 1.0 };
        let through = (1.0 - s.finish.metallic) * alpha;
        let base = s.color.truncate() - s.glow;
        let scattered = base * (1.0 - self.amount * through) + s.glow;
        s.passed = base * self.attenuated * through;
        s.color = scattered.extend(if self.is_opaque { 1.0 } else { s.color.w });
        s
    }
}

/// A member of [`Surface`] that an effect reads. What no effect reads need not be computed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum SurfaceInput {
    Color,
    Glow,
    Position,
    Normal,
    FlatNormal,
    View,
    Center,
    CenterScreen,
    Screen,
    Pixel,
    Barycentrics,
    EdgeDistance,
    Depth,
    PixelSize,
    FlatDepth,
    DepthRange,
    TriangleId,
    Rank,
    Lit,
    Finish,
}

impl SurfaceInput {
    pub const ALL: [Self; 20] = [
        Self::Color,
        Self::Glow,
        Self::Position,
        Self::Normal,
        Self::FlatNormal,
        Self::View,
        Self::Center,
        Self::CenterScreen,
        Self::Screen,
        Self::Pixel,
        Self::Barycentrics,
        Self::EdgeDistance,
        Self::Depth,
        Self::PixelSize,
        Self::FlatDepth,
        Self::DepthRange,
        Self::TriangleId,
        Self::Rank,
        Self::Lit,
        Self::Finish,
    ];

    /// The member of the WGSL struct `Surface`.
    pub const fn member(self) -> &'static str {
        match self {
            Self::Color => "color",
            Self::Glow => "glow",
            Self::Position => "position",
            Self::Normal => "normal",
            Self::FlatNormal => "flat_normal",
            Self::View => "view",
            Self::Center => "center",
            Self::CenterScreen => "center_screen",
            Self::Screen => "screen",
            Self::Pixel => "pixel",
            Self::Barycentrics => "barycentrics",
            Self::EdgeDistance => "edge_distance_px",
            Self::Depth => "depth_m",
            Self::PixelSize => "pixel_size_m",
            Self::FlatDepth => "flat_depth_m",
            Self::DepthRange => "depth_range_m",
            Self::TriangleId => "triangle_id",
            Self::Rank => "rank",
            Self::Lit => "lit",
            Self::Finish => "finish",
        }
    }

    /// Is it computed from the plane and the corners of the triangle?
    pub const fn needs_planes(self) -> bool {
        matches!(self, Self::FlatNormal | Self::FlatDepth | Self::Center)
    }
}

/// The light that comes with a scene.
#[derive(Clone, Copy, Debug, Default)]
pub struct Lighting<'a> {
    /// The lights of the scene, where they are.
    pub lights: &'a [PlacedLight],
    /// The picture of what surrounds the scene.
    pub panorama: Option<&'a Panorama>,
}

impl Lighting<'_> {
    /// Does no light come with the scene?
    pub const fn is_none(&self) -> bool {
        self.lights.is_empty() && self.panorama.is_none()
    }
}
