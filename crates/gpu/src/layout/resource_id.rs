//! The resources that kernels bind: one table of every buffer and texture with its name in WGSL,
//! its usage, what it holds, and who clears it.

use wgpu::BufferUsages;

const STORAGE: BufferUsages = BufferUsages::STORAGE;
const UNIFORM: BufferUsages = BufferUsages::UNIFORM;
const INDIRECT: BufferUsages = BufferUsages::INDIRECT;

/// When a buffer is filled with zeros on the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClearedBy {
    /// Every byte that is read was written before.
    Nothing,
    /// Before the passes of a picture or of a shadow map.
    Picture,
    /// Before the passes of a picture, and again before the judge counts layers.
    PictureAndCount,
    /// When temporal history is lost.
    History,
}

macro_rules! buffers {
    ($($id:ident = $name:literal, $usage:expr, $cleared:ident, $purpose:literal;)*) => {
        /// A buffer that a pass reads or writes.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum BufferId {
            $(#[doc = $purpose] $id),*
        }

        impl BufferId {
            /// All of them, in the order of the table.
            pub const ALL: &'static [Self] = &[$(Self::$id),*];

            /// Name of the variable in WGSL, label on the device, name in `explain`.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$id => $name),* }
            }

            /// What kernels, draws and indirect dispatches do with it; copies are allowed from and to all.
            pub const fn usage(self) -> BufferUsages {
                match self { $(Self::$id => $usage),* }
            }

            /// What it holds, for `explain`; a [`super::frame_layout::FrameLayout`] may say it more exactly.
            pub const fn purpose(self) -> &'static str {
                match self { $(Self::$id => $purpose),* }
            }

            /// When it is cleared.
            pub const fn cleared_by(self) -> ClearedBy {
                match self { $(Self::$id => ClearedBy::$cleared),* }
            }
        }
    };
}

buffers! {
    Frame = "frame", UNIFORM, Nothing, "size, viewpoint, capacities";
    Draws = "draws", STORAGE.union(UNIFORM), Nothing, "matrices and attribute offsets, one record per instance";
    Shapes = "shapes", UNIFORM.union(STORAGE), Nothing, "what all instances of a primitive share: attribute offsets and base color";
    Effects = "effects", UNIFORM.union(STORAGE), Nothing, "parameters of the stack";
    PunctualLights = "punctual_lights", UNIFORM, Nothing, "lights that come with the scene";
    VertexBytes = "vertex_bytes", STORAGE.union(BufferUsages::VERTEX), Nothing, "attributes as the file has them";
    VertexBytesRest = "vertex_bytes_rest", STORAGE, Nothing, "attributes that are more than the adapter binds at once";
    IndexBytes = "index_bytes", STORAGE.union(BufferUsages::INDEX), Nothing, "index lists as the file has them";
    Deforms = "deforms", STORAGE, Nothing, "byte offsets of every mesh that joints or morph targets deform";
    Joints = "joints", STORAGE, Nothing, "joint transforms of every skin: three matrix rows each, or a dual quaternion and a scale";
    MorphTargets = "morph_targets", STORAGE, Nothing, "weights and byte offsets of morph targets";
    ParticleStates = "particle_states", STORAGE, Nothing, "particles before and after the last step";
    StepParams = "step_params", STORAGE, Nothing, "parameters of every particle step, and of how particles look";
    ParticleStep = "particle_step", UNIFORM.union(STORAGE), Nothing, "which steps the particles take";
    Vertices = "vertices", STORAGE, Nothing, "projected vertices, 16 bytes each";
    Counters = "counters", STORAGE, PictureAndCount, "demand of the queues, and what was not drawn";
    Queues = "queues", STORAGE, Nothing, "triangles waiting for clip, medium, large and tile kernels";
    DispatchArgs = "args", STORAGE.union(INDIRECT), Nothing, "dispatch sizes written on the GPU";
    ClippedTriangles = "clipped_triangles", STORAGE, Nothing, "triangles that clipping makes";
    Culling = "culling", UNIFORM, Nothing, "how many meshlets there are";
    Instances = "instances", STORAGE, Nothing, "bounding box of every instance, and from where it is seen";
    Meshlets = "meshlets", STORAGE, Nothing, "bounds of clusters of up to 64 triangles";
    MeshletLists = "meshlet_lists", STORAGE, Nothing, "triangles and vertices of every meshlet, then the visible meshlets";
    MeshletVisibility = "meshlet_visibility", STORAGE, History, "which meshlets were not hidden in the previous picture";
    Hiz = "hiz", STORAGE, History, "farthest depth of every 8 x 8 and every 64 x 64 pixels";
    DrawOrder = "order", STORAGE.union(UNIFORM), Nothing, "the sample at which drawing stops";
    SampleCounts = "sample_counts", STORAGE, PictureAndCount, "samples per triangle";
    BlockSums = "sums", STORAGE, Nothing, "samples before every block of 1,024 triangles";
    BoundarySamples = "boundary_samples", STORAGE, PictureAndCount, "samples of one triangle, a bit per pixel";
    DepthKeys = "depth_keys", STORAGE, Picture, "nearest depth key per pixel, 4 bytes";
    TriangleIds = "triangle_ids", STORAGE, Picture, "triangle id per pixel, 4 bytes";
    DepthAndId = "depth_and_id", STORAGE, Picture, "depth key and triangle id per pixel, 8 bytes";
    PackedDepthId = "packed", STORAGE, Picture, "part of the depth key and triangle id per pixel, 4 bytes";
    LayerCounts = "layers", STORAGE, PictureAndCount, "layers per pixel, 4 bytes";
    TileMask = "tile_mask", STORAGE, Nothing, "which 8 x 8 tiles this picture or the one before has drawn in";
    Color = "color", STORAGE, Picture, "the picture, 4 bytes per pixel";
    Background = "background", STORAGE, Nothing, "a few rows of background, copied all over the picture first";
    Previous = "previous", STORAGE, Nothing, "the previous picture, which an effect reads";
    ImageSource = "image_source", STORAGE, Nothing, "the picture in linear light, 16 bytes per pixel, that image passes read and write by turns";
    ImageBefore = "image_before", STORAGE, Nothing, "a second such picture";
    ImageTarget = "image_target", STORAGE, Nothing, "a third such picture";
    ImageKept = "image_kept", STORAGE, Nothing, "what the kept pass of an effect writes, 16 bytes per pixel of its own";
    ImageKeptBefore = "image_kept_before", STORAGE, Nothing, "what it wrote in the previous picture";
    Finished = "finished", STORAGE, Nothing, "the picture after image passes, 4 bytes per pixel";
    Scaling = "scaling", UNIFORM, Nothing, "size of what is shown";
    ScaledColor = "shown", STORAGE, Nothing, "the picture at the size that is shown, 4 bytes per pixel";
    ShadowMapView = "light", UNIFORM, Nothing, "maps positions to the shadow map";
    ShadowMapKeys = "shadow_map_keys", STORAGE, Nothing, "nearest depth key to the light per texel: the light's buffer of depth keys";
    DotFrame = "dot_frame", UNIFORM, Nothing, "size, spacing and color of dots";
    DotSegments = "dot_segments", STORAGE, Nothing, "both ends of every line segment that carries dots";
    DotRuns = "dot_runs", STORAGE, Nothing, "up to 64 dots of one segment each, 20 bytes";
    DotEnds = "dot_ends", STORAGE, Nothing, "ends of segments in clip space, 32 bytes";
    DotList = "dot_list", STORAGE, Nothing, "dots that may be visible, room for all, 8 bytes each";
    DotCount = "dot_count", STORAGE, Picture, "number of dots that may be visible";
    DotArgs = "dot_args", STORAGE.union(INDIRECT), Nothing, "dispatch size of dots, written on the GPU";
    DotRecords = "dot_records", STORAGE, Nothing, "projected dots, only while verifying";
    NaiveFrame = "naive", UNIFORM, Nothing, "matrix and size for the naive baseline";
    Corners = "corners", STORAGE.union(BufferUsages::VERTEX), Nothing, "triangle corners without indices, for a baseline";
    Channels = "channels", STORAGE, Nothing, "three minima per pixel, for the naive baseline";
}

/// A texture that a pass reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum TextureId {
    /// Materials of primitives and the levels of their images, as words.
    MaterialAtlas,
    /// Nearest depth key to the light per texel.
    ShadowMap,
    /// Pictures that effects take as inputs, as words.
    ImageFiles,
}

impl TextureId {
    pub const ALL: &'static [Self] = &[Self::MaterialAtlas, Self::ShadowMap, Self::ImageFiles];

    /// Name of the variable in WGSL, label on the device, name in `explain`.
    pub const fn name(self) -> &'static str {
        match self {
            Self::MaterialAtlas => "material_atlas",
            Self::ShadowMap => "shadow_map",
            Self::ImageFiles => "image_files",
        }
    }

    /// What it holds, for `explain`.
    pub const fn purpose(self) -> &'static str {
        match self {
            Self::MaterialAtlas => {
                "a texture of words: materials of primitives, and the levels of their images"
            }
            Self::ShadowMap => "nearest depth key to the light per texel, 4 bytes",
            Self::ImageFiles => "pictures that effects take as inputs, 4 bytes per texel",
        }
    }
}

/// Anything that a kernel binds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum ResourceId {
    Buffer(BufferId),
    Texture(TextureId),
}

impl ResourceId {
    /// The resource that a WGSL variable of this name binds; none where the table has no such name.
    pub fn of_binding(name: &str) -> Option<Self> {
        Self::all().find(|id| id.name() == name)
    }

    /// Every resource.
    pub fn all() -> impl Iterator<Item = Self> {
        BufferId::ALL
            .iter()
            .copied()
            .map(Self::Buffer)
            .chain(TextureId::ALL.iter().copied().map(Self::Texture))
    }

    /// Name of the variable in WGSL.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Buffer(id) => id.name(),
            Self::Texture(id) => id.name(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeSet;

    use super::*;

    #[test]
    fn every_name_is_unique_and_leads_back_to_its_resource() {
        let all: Vec<ResourceId> = ResourceId::all().collect();
        let names: BTreeSet<&str> = all.iter().map(|id| id.name()).collect();
        assert_eq!(names.len(), all.len(), "two resources share a name");
        assert!(
            all.iter()
                .all(|id| ResourceId::of_binding(id.name()) == Some(*id))
        );
        assert_eq!(ResourceId::of_binding("no such variable"), None);
    }
}
