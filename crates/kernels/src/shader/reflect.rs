//! What naga says of a module: errors with a file and a line, bindings by name, struct layouts.

use naga::{
    AddressSpace, Module, StorageAccess, TypeInner,
    valid::{Capabilities, ModuleInfo, ValidationFlags, Validator},
};

use super::link::Linked;

/// A module that naga read and validated.
pub struct Reflected {
    pub module: Module,
    pub info: ModuleInfo,
}

/// What a resource of an entry point is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BindingKind {
    Uniform,
    Storage {
        read_only: bool,
    },
    /// Whole numbers, read texel by texel, in one layer or in several.
    Texture {
        layered: bool,
    },
}

/// One resource that an entry point really uses.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Binding {
    pub name: String,
    pub index: u32,
    pub kind: BindingKind,
}

/// A member of a WGSL struct.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Member {
    pub name: String,
    pub offset: usize,
    /// The type as WGSL writes it, for instance `vec4<f32>`.
    pub kind: String,
}

/// Shader text that naga refuses; the first line begins with file and line.
#[derive(Debug, thiserror::Error)]
#[error("{origin}: {message}")]
pub struct ShaderError {
    pub origin: String,
    pub message: String,
}

/// What every device offers to shaders. Half floats in words are part of WGSL, and naga counts them
/// among what a device may lack.
pub fn capabilities() -> Capabilities {
    Capabilities::default() | Capabilities::SHADER_FLOAT16_IN_FLOAT32
}

/// Reads and validates a linked module; 64-bit atomics only where `int64` says so.
pub fn reflect(linked: &Linked, int64: bool) -> Result<Reflected, ShaderError> {
    let text = &linked.text;
    let fault = |place: Option<naga::SourceLocation>, message| ShaderError {
        origin: linked.origin(place.map_or(1, |place| place.line_number)),
        message,
    };
    let module = naga::front::wgsl::parse_str(text)
        .map_err(|error| fault(error.location(text), error.emit_to_string(text)))?;
    let mut capabilities = capabilities();
    if int64 {
        capabilities |= Capabilities::SHADER_INT64
            | Capabilities::SHADER_INT64_ATOMIC_MIN_MAX
            | Capabilities::SHADER_INT64_ATOMIC_ALL_OPS;
    }
    let info = Validator::new(ValidationFlags::all(), capabilities)
        .validate(&module)
        .map_err(|error| fault(error.location(text), error.emit_to_string(text)))?;
    Ok(Reflected { module, info })
}

impl Reflected {
    /// Resources of group 0 that `entry` uses, by binding number.
    pub fn bindings(&self, entry: &str) -> Vec<Binding> {
        let Some(index) = self
            .module
            .entry_points
            .iter()
            .position(|e| e.name == entry)
        else {
            return Vec::new();
        };
        let uses = self.info.get_entry_point(index);
        let mut bindings: Vec<_> = self
            .module
            .global_variables
            .iter()
            .filter(|(handle, _)| !uses[*handle].is_empty())
            .filter_map(|(_, variable)| {
                let kind = match variable.space {
                    AddressSpace::Uniform => BindingKind::Uniform,
                    AddressSpace::Storage { access } => BindingKind::Storage {
                        read_only: !access.contains(StorageAccess::STORE),
                    },
                    AddressSpace::Handle => match self.module.types[variable.ty].inner {
                        TypeInner::Image { arrayed, .. } => {
                            BindingKind::Texture { layered: arrayed }
                        }
                        _ => return None,
                    },
                    _ => return None,
                };
                let binding = variable
                    .binding
                    .as_ref()
                    .filter(|binding| binding.group == 0)?;
                Some(Binding {
                    name: variable.name.clone()?,
                    index: binding.binding,
                    kind,
                })
            })
            .collect();
        bindings.sort_by_key(|binding| binding.index);
        bindings
    }

    /// Size in bytes and members of a struct.
    pub fn layout(&self, name: &str) -> Option<(usize, Vec<Member>)> {
        let (_, ty) = self
            .module
            .types
            .iter()
            .find(|(_, ty)| ty.name.as_deref() == Some(name))?;
        let TypeInner::Struct { members, span } = &ty.inner else {
            return None;
        };
        let member = |m: &naga::StructMember| Member {
            name: m.name.clone().unwrap_or_default(),
            offset: m.offset as usize,
            kind: kind_name(&self.module, m.ty),
        };
        // An array that takes the rest of its buffer belongs to no record.
        let is_open = |m: &&naga::StructMember| {
            matches!(
                self.module.types[m.ty].inner,
                TypeInner::Array {
                    size: naga::ArraySize::Dynamic,
                    ..
                }
            )
        };
        Some((
            *span as usize,
            members.iter().filter(|m| !is_open(m)).map(member).collect(),
        ))
    }
}

fn scalar_name(scalar: naga::Scalar) -> String {
    let letter = match scalar.kind {
        naga::ScalarKind::Float => "f",
        naga::ScalarKind::Sint => "i",
        naga::ScalarKind::Uint => "u",
        _ => "?",
    };
    format!("{letter}{}", scalar.width * 8)
}

fn kind_name(module: &Module, ty: naga::Handle<naga::Type>) -> String {
    match &module.types[ty].inner {
        TypeInner::Scalar(scalar) | TypeInner::Atomic(scalar) => scalar_name(*scalar),
        TypeInner::Vector { size, scalar } => {
            format!("vec{}<{}>", *size as u8, scalar_name(*scalar))
        }
        TypeInner::Matrix {
            columns,
            rows,
            scalar,
        } => format!(
            "mat{}x{}<{}>",
            *columns as u8,
            *rows as u8,
            scalar_name(*scalar)
        ),
        TypeInner::Struct { .. } => module.types[ty].name.clone().unwrap_or_default(),
        _ => "?".into(),
    }
}
