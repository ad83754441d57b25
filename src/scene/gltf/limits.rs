//! Upper limits of everything that a model file can demand.

const MIB: u64 = 1 << 20;
/// Size of the model file, and of each file that it refers to.
pub const FILE_BYTES: u64 = 256 * MIB;
/// Total size of all files of a model.
pub const TOTAL_BYTES: u64 = 512 * MIB;
/// Size of the JSON.
pub const JSON_BYTES: u64 = 64 * MIB;
/// JSON objects; each may need hundreds of bytes once parsed.
pub const JSON_OBJECTS: usize = 1_000_000;
/// Commas of the JSON, which separate its values; each value may need 64 bytes once parsed.
pub const JSON_VALUES: usize = 10_000_000;
/// Size of the largest storage binding that every adapter supports.
pub const BINDING_BYTES: u64 = 128 * MIB;
/// Vertices of all primitives, each counted once however often it is instanced.
pub const VERTICES: u64 = 4_000_000;
/// Triangles of all primitives, each counted once however often it is instanced.
pub const TRIANGLES: u64 = 10_000_000;
/// Instances of primitives.
pub const INSTANCES: usize = 65_536;
/// Nodes from a root to a leaf.
pub const NODE_DEPTH: usize = 256;
/// Joints of a skin.
pub const JOINTS: usize = 256;
/// Joints of all skins.
pub const ALL_JOINTS: usize = 1_000_000;
/// Morph targets of a mesh.
pub const MORPH_TARGETS: usize = 256;
/// Morph weights of all nodes.
pub const WEIGHTS: usize = 4_000_000;
/// Channels of all clips.
pub const CHANNELS: usize = 262_144;
/// Key times and values of all clips.
pub const KEY_NUMBERS: usize = 16_000_000;
/// Width and height of an image in texels.
pub const IMAGE_SIDE: u32 = 8192;
/// Decoded size of all images, without mip levels.
pub const IMAGES_BYTES: u64 = 512 * MIB;
/// Messages to the user.
pub const NOTES: usize = 32;
