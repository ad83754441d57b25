//! Effects: pure functions with parameters, written twice. Here in f64, the truth; in `shaders/effects/` in f32,
//! in a file of the same name. Panel, preset keys, `--set`, uniform bytes, layout test, golden and bench row are
//! loops over [`EFFECTS`].

use glam::{DVec2, DVec3, DVec4};

use crate::params::{Field, Params};

/// THE list. Adding an effect is its two files and one word here.
macro_rules! effects {
    ($($name:ident),* $(,)?) => {
        $(pub mod $name;)*
        /// Every effect, in the order in which a look without a `stack` key applies them.
        pub const EFFECTS: &[&Effect] = &[$(&$name::EFFECT),*];
    };
}

effects![facet, triangle_id, normals, depth, lambert];

/// What the rasterizer knows about a visible sample; a surface effect changes it and passes it on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Surface {
    /// Linear RGBA so far; begins as the material's base colour times the vertex colour.
    pub color: DVec4,
    /// World space, metres.
    pub position: DVec3,
    /// Unit, towards the viewer's side: interpolated, then whatever earlier effects made of it.
    pub normal: DVec3,
    /// Unit normal of the triangle's plane, towards the same side.
    pub flat_normal: DVec3,
    /// Unit vector from the sample to the eye.
    pub view: DVec3,
    /// Mean of the triangle's corners, world space.
    pub center: DVec3,
    /// Where that mean stands in the picture: 0 left and top, 1 right and bottom.
    pub center_screen: DVec2,
    /// Where the sample stands in the picture.
    pub screen: DVec2,
    /// Distance from the eye along the viewing direction, metres.
    pub depth_m: f64,
    /// Mean of `depth_m` over the triangle's corners.
    pub flat_depth_m: f64,
    /// Nearest and farthest `depth_m` of the scene's box.
    pub range_m: DVec2,
    /// Global triangle id.
    pub owner: u32,
}

/// Where in the pipeline an effect acts, with its f64 function over its parameter words.
#[derive(Clone, Copy)]
pub enum Hook {
    /// What colour is it?
    Surface(fn(Surface, &[u32]) -> Surface),
}

impl Hook {
    /// The hook's name in listings and in WGSL.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Surface(_) => "surface",
        }
    }
}

/// One entry of the catalogue.
pub struct Effect {
    /// File stem, WGSL function, uniform member, preset table, `--set` prefix.
    pub name: &'static str,
    /// One line for listings and tooltips.
    pub about: &'static str,
    pub hook: Hook,
    pub fields: &'static [Field],
    /// Parameter words with every default.
    pub defaults: fn() -> Vec<u32>,
    /// Name of the WGSL struct.
    pub wgsl_struct: &'static str,
}

impl Effect {
    /// An effect on the surface hook.
    pub const fn surface<P: SurfaceEffect>(name: &'static str, wgsl_struct: &'static str, about: &'static str) -> Self {
        Self { name, about, hook: Hook::Surface(apply_surface::<P>), fields: P::FIELDS, defaults: defaults::<P>, wgsl_struct }
    }

    /// The effect called `name`.
    pub fn find(name: &str) -> Option<&'static Self> {
        EFFECTS.iter().copied().find(|effect| effect.name == name)
    }

    /// The field called `name`.
    pub fn field(&self, name: &str) -> Option<&'static Field> {
        self.fields.iter().find(|field| field.name == name)
    }

    /// Place in [`EFFECTS`].
    pub fn rank(&self) -> usize {
        EFFECTS.iter().position(|effect| effect.name == self.name).expect("every effect is listed")
    }
}

impl std::fmt::Debug for Effect {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.name)
    }
}

impl PartialEq for Effect {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

impl Eq for Effect {}

impl std::hash::Hash for Effect {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        self.name.hash(state);
    }
}

/// The f64 side of an effect on the surface hook.
pub trait SurfaceEffect: Params {
    fn apply(surface: Surface, params: &Self) -> Surface;
}

fn apply_surface<P: SurfaceEffect>(surface: Surface, words: &[u32]) -> Surface {
    P::apply(surface, &bytemuck::pod_read_unaligned(bytemuck::cast_slice(words)))
}

fn defaults<P: Params>() -> Vec<u32> {
    bytemuck::pod_collect_to_vec(&[P::default()])
}

/// An effect with its values.
#[derive(Clone, Debug, PartialEq)]
pub struct Enabled {
    pub effect: &'static Effect,
    /// Parameter words, laid out by `effect.fields`.
    pub words: Vec<u32>,
}

impl Enabled {
    pub fn new(effect: &'static Effect) -> Self {
        Self { effect, words: (effect.defaults)() }
    }
}

/// The enabled effects, in the order in which they apply.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Stack(pub Vec<Enabled>);

impl Stack {
    pub fn get(&self, name: &str) -> Option<&Enabled> {
        self.0.iter().find(|enabled| enabled.effect.name == name)
    }

    pub fn get_mut(&mut self, name: &str) -> Option<&mut Enabled> {
        self.0.iter_mut().find(|enabled| enabled.effect.name == name)
    }

    /// Puts `effect` in with defaults, in front of the first one that follows it in [`EFFECTS`]; keeps one already there.
    pub fn enable(&mut self, effect: &'static Effect) -> &mut Enabled {
        let at = match self.0.iter().position(|enabled| enabled.effect == effect) {
            Some(at) => at,
            None => {
                let at = self.0.iter().position(|enabled| enabled.effect.rank() > effect.rank()).unwrap_or(self.0.len());
                self.0.insert(at, Enabled::new(effect));
                at
            }
        };
        &mut self.0[at]
    }

    pub fn disable(&mut self, name: &str) {
        self.0.retain(|enabled| enabled.effect.name != name);
    }

    /// Do the effects stand in the order of [`EFFECTS`]?
    pub fn is_canonical(&self) -> bool {
        self.0.is_sorted_by_key(|enabled| enabled.effect.rank())
    }

    /// Applies every surface effect in order.
    pub fn shade(&self, surface: Surface) -> Surface {
        self.0.iter().fold(surface, |surface, enabled| match enabled.effect.hook {
            Hook::Surface(apply) => apply(surface, &enabled.words),
        })
    }
}
