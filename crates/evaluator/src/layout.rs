//! How values are flattened into words.

use std::borrow::Cow;

use naga::{ArraySize, Handle, Module, ScalarKind, Type, TypeInner};

/// Why a type has no words.
pub(crate) enum NoLayout {
    /// What it is, as the source would say.
    Unsupported(String),
    /// More words than the limit.
    TooLarge,
    /// The length of an array is a constant that is not known here.
    Pending(Handle<naga::Override>),
}

/// Words of every type of a module, computed when asked for.
pub(crate) struct Layout<'m> {
    module: &'m Module,
    limit: usize,
    words: Vec<Option<u32>>,
    /// Lengths of arrays that override constants give.
    pub lengths: Vec<(Handle<naga::Override>, u32)>,
}

impl<'m> Layout<'m> {
    pub(crate) fn new(module: &'m Module, limit: usize) -> Layout<'m> {
        Layout {
            module,
            limit: limit.min(i32::MAX as usize),
            words: vec![None; module.types.len()],
            lengths: Vec::new(),
        }
    }

    pub(crate) fn words_of(&mut self, ty: Handle<Type>) -> Result<u32, NoLayout> {
        if let Some(words) = self.words[ty.index()] {
            return Ok(words);
        }
        let module = self.module;
        let words = self.words(&module.types[ty].inner)?;
        self.words[ty.index()] = Some(words);
        Ok(words)
    }

    pub(crate) fn words(&mut self, inner: &TypeInner) -> Result<u32, NoLayout> {
        let words = match inner {
            TypeInner::Scalar(scalar) => {
                supported(*scalar)?;
                1
            }
            TypeInner::Vector { size, scalar } => {
                supported(*scalar)?;
                *size as u64
            }
            TypeInner::Matrix {
                columns,
                rows,
                scalar,
            } => {
                supported(*scalar)?;
                *columns as u64 * *rows as u64
            }
            TypeInner::Array { base, size, .. } => {
                let element = u64::from(self.words_of(*base)?);
                element * u64::from(self.length(*size)?)
            }
            TypeInner::Struct { members, .. } => {
                let mut sum = 0;
                for member in members {
                    sum += u64::from(self.words_of(member.ty)?);
                }
                sum
            }
            TypeInner::Atomic(_) => return Err(NoLayout::Unsupported("an atomic".to_owned())),
            TypeInner::Pointer { .. } | TypeInner::ValuePointer { .. } => {
                return Err(NoLayout::Unsupported("a pointer as a value".to_owned()));
            }
            TypeInner::Image { .. } | TypeInner::BindingArray { .. } => {
                return Err(NoLayout::Unsupported("a texture".to_owned()));
            }
            TypeInner::Sampler { .. } => return Err(NoLayout::Unsupported("a sampler".to_owned())),
            TypeInner::AccelerationStructure { .. } | TypeInner::RayQuery { .. } => {
                return Err(NoLayout::Unsupported("ray tracing".to_owned()));
            }
            TypeInner::CooperativeMatrix { .. } => {
                return Err(NoLayout::Unsupported("a cooperative matrix".to_owned()));
            }
        };
        match u32::try_from(words) {
            Ok(words) if words as usize <= self.limit => Ok(words),
            _ => Err(NoLayout::TooLarge),
        }
    }

    fn length(&self, size: ArraySize) -> Result<u32, NoLayout> {
        match size {
            ArraySize::Constant(length) => Ok(length.get()),
            ArraySize::Pending(constant) => {
                let known = self.lengths.iter().find(|(handle, _)| *handle == constant);
                known
                    .map(|&(_, length)| length)
                    .ok_or(NoLayout::Pending(constant))
            }
            ArraySize::Dynamic => Err(NoLayout::Unsupported(
                "an array without a length".to_owned(),
            )),
        }
    }

    /// Type behind a pointer; the type itself if it is none.
    pub(crate) fn pointee<'a>(&self, inner: &'a TypeInner) -> Cow<'a, TypeInner>
    where
        'm: 'a,
    {
        match *inner {
            TypeInner::Pointer { base, .. } => Cow::Borrowed(&self.module.types[base].inner),
            TypeInner::ValuePointer {
                size: Some(size),
                scalar,
                ..
            } => Cow::Owned(TypeInner::Vector { size, scalar }),
            TypeInner::ValuePointer {
                size: None, scalar, ..
            } => Cow::Owned(TypeInner::Scalar(scalar)),
            _ => Cow::Borrowed(inner),
        }
    }

    /// First word and number of words of part `index` of a composite; the last part for an index
    /// beyond.
    pub(crate) fn part(&mut self, inner: &TypeInner, index: u32) -> Result<(u32, u32), NoLayout> {
        if let TypeInner::Struct { members, .. } = inner {
            let mut offset = 0;
            for (at, member) in members.iter().enumerate() {
                let words = self.words_of(member.ty)?;
                if at as u32 == index {
                    return Ok((offset, words));
                }
                offset += words;
            }
            return Err(NoLayout::Unsupported(
                "a member that its struct does not have".to_owned(),
            ));
        }
        let (count, stride) = self.elements(inner)?;
        Ok((index.min(count.saturating_sub(1)) * stride, stride))
    }

    /// Number of elements of an array, columns of a matrix or components of a vector, and words of
    /// each.
    pub(crate) fn elements(&mut self, inner: &TypeInner) -> Result<(u32, u32), NoLayout> {
        match inner {
            TypeInner::Vector { size, .. } => Ok((*size as u32, 1)),
            TypeInner::Matrix { columns, rows, .. } => Ok((*columns as u32, *rows as u32)),
            TypeInner::Array { base, size, .. } => {
                // The whole must be within the limit, so that offsets into it are.
                self.words(inner)?;
                Ok((self.length(*size)?, self.words_of(*base)?))
            }
            _ => Err(NoLayout::Unsupported(
                "an index into a value without elements".to_owned(),
            )),
        }
    }
}

fn supported(scalar: naga::Scalar) -> Result<(), NoLayout> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Bool, _) | (ScalarKind::AbstractInt | ScalarKind::AbstractFloat, _) => Ok(()),
        (_, 4) => Ok(()),
        (ScalarKind::Float, width) => Err(NoLayout::Unsupported(format!(
            "floats of {} bits",
            8 * u32::from(width)
        ))),
        (_, width) => Err(NoLayout::Unsupported(format!(
            "integers of {} bits",
            8 * u32::from(width)
        ))),
    }
}
