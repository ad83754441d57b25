//! Scenes as plain data: meshes, materials, instances, cameras, skeletons and clips, and the bytes
//! that hold their attributes.
//!
//! Attribute and index bytes are never repacked. An [`Accessor`] says where a value lies, and the
//! vertex shaders and the oracle both read it from there. Attributes that a file lacks (normals)
//! are appended as more bytes by the loader.

pub mod accessor;
pub mod background;
pub mod bounds;
pub mod builtin;
pub mod camera;
pub mod camera_moves;
pub mod deformation;
pub mod draw;
pub mod framing;
pub mod gltf;
pub mod ground;
pub mod joint_transforms;
pub mod light;
pub mod lines;
pub mod material;
pub mod memory;
pub mod mesh_builder;
pub mod mesh_files;
pub mod meshlets;
pub mod model;
pub mod needs;
pub mod panorama;
pub mod particle_discs;
pub mod parts;
pub mod pick;
pub mod point_cloud;
pub mod pose;
pub mod punctual;
pub mod quaternion;
pub mod radiance;
pub mod rig;
mod room;
pub mod shadow_resolution;
pub mod sizes;
pub mod tangents;
pub mod texture;
pub mod up;
pub mod view;

pub use accessor::{Accessor, ComponentType};
pub use background::Background;
pub use bounds::Bounds;
pub use ground::{Ground, GroundShape};
pub use material::Material;
pub use model::{Instance, Primitive, Scene, SceneCamera, Topology};
pub use up::UpAxis;
