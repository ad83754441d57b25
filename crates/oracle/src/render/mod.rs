//! Draws exact pictures. Files in the order of the pipeline: vertices, triangles, samples, colors,
//! pictures.

pub mod deform;
pub mod particles;
pub mod snap;
pub mod vertex;

pub mod clip;
pub mod project;
pub mod records;
pub mod strict;
pub mod triangles;

pub mod coverage;
pub mod draw_order;
pub mod mask;
pub mod sample_rules;
pub mod sample_setup;
pub mod screen;
pub mod work_limits;

pub mod background;
pub mod dots;
pub mod glass;
pub mod layers;
pub mod material;
pub mod passes;
pub mod rays;
pub mod resolve;
pub mod shading;
pub mod shadow;
pub mod surface;
pub mod tangents;
pub mod weights;

pub mod picture;
pub mod references;
pub mod resample;
