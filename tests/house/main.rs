//! Promises that need no adapter: the rules of the code base, files and their formats, the command
//! line.

mod architecture;
mod cli;
mod dependencies;
mod effect_edges;
mod effect_files;
mod effect_inputs;
mod evaluator;
mod features;
mod formulas;
mod layout;
mod loader;
mod meshlets;
mod mutation_campaign;
mod mutations;
mod plans;
mod presets;
#[cfg(target_os = "linux")]
#[path = "../common/process.rs"]
mod process;
mod reflection;
mod registry;
#[path = "../common/rounds.rs"]
mod rounds;
mod scenes;
mod scopes;
mod shader_links;
#[path = "../common/shader_parts.rs"]
mod shader_parts;
mod shaders;
mod size;
mod surface_inputs;
mod twins;
