//! A scene on a device: its attributes, draws, meshlets and materials.

mod packing;
mod point_boxes;

pub mod attributes;
pub mod deforms;
pub mod meshlets;

mod draw_records;
pub mod draws;

mod image_files;
mod material_atlas;
pub mod scene_resources;
