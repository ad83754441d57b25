//! Promise: the glTF loader: what it accepts arrives exactly, what it refuses is refused with a
//! message, and nothing panics, hangs, or is read outside the model's folder. One file for each
//! part of the promise; all write their models with [`model::Model`].

mod accepted;
mod compressed;
mod corpus;
mod far;
mod files;
mod hostile;
mod instancing;
mod kinds;
mod lights;
mod maps;
mod materials;
mod mesh_files;
mod mesh_hostile;
mod model;
mod motion;
mod names;
mod passing;
mod refused;
mod scale;
mod tolerated;
mod variants;
