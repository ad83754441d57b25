//! Upper limits of everything that a model file can demand.
//!
//! The constants hold for every model. [`Limits`] grow with the memory budget and with the bytes of
//! the files, so that a small file never takes much memory, and a large one is loaded where the
//! machine has room for it.

use super::error::LoadError;
use crate::scene::{draw, memory::MemoryBudget};

const MIB: u64 = 1 << 20;
/// Size of the JSON.
pub const JSON_BYTES: u64 = 64 * MIB;
/// JSON objects; each may need hundreds of bytes once parsed.
pub const JSON_OBJECTS: usize = 1_000_000;
/// Commas of the JSON, which separate its values; each value may need 64 bytes once parsed.
pub const JSON_VALUES: usize = 10_000_000;
/// Joints of all skins.
pub const ALL_JOINTS: usize = 1_000_000;
/// Morph weights of all nodes.
pub const WEIGHTS: usize = 4_000_000;
/// Channels of all clips.
pub const CHANNELS: usize = 262_144;
/// Key times and values of all clips.
pub const KEY_NUMBERS: usize = 16_000_000;
/// Width and height of an image in texels.
pub const IMAGE_SIDE: u32 = 8192;

/// Largest side of an image that is read, and halved until it has [`IMAGE_SIDE`].
pub const LARGEST_IMAGE_SIDE: u32 = 4 * IMAGE_SIDE;
/// Messages to the user.
pub const NOTES: usize = 32;

/// Decoded bytes for each byte of the files, beyond what every model may take: a higher compression
/// is none that is in use.
const MOST_GROWTH: u64 = 32;

/// What an instance takes once it is open: some 300 bytes in the scene, and as many for each view
/// that draws it.
const INSTANCE_BYTES: u64 = 1024;

/// What an instance takes in a file, at least: a place, which may be compressed.
const LEAST_INSTANCE_BYTES: u64 = 4;

/// Instances that every model may have.
const FEW_INSTANCES: usize = 262_144;

/// Limits that follow from the memory budget and from the size of the files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Limits {
    /// Size of the model file, and of each file that it refers to.
    pub file_bytes: u64,
    /// Total size of all files of a model, and of all that is compressed in them once it is
    /// decoded.
    pub total_bytes: u64,
    /// Size of the attributes of all primitives, and of their index lists.
    pub buffer_bytes: u64,
    /// Vertices of all primitives, each counted once however often it is instanced.
    pub vertices: u64,
    /// Triangles of all primitives, each counted once however often it is instanced.
    pub triangles: u64,
    /// Instances of primitives.
    instances: usize,
    /// What to do where there are more instances.
    instances_remedy: Remedy,
    /// What to do where a limit is exceeded; nothing where every model has it.
    remedy: Remedy,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Remedy {
    /// Raise the budget.
    Budget(MemoryBudget),
    /// None: the files have only so many bytes.
    Growth(u64),
}

impl Limits {
    /// Limits that hold while the sizes of the files are unknown.
    pub fn of_files(budget: MemoryBudget) -> Self {
        Self::of(budget.decoded(), Remedy::Budget(budget))
    }

    /// Limits of a model whose files have so many bytes.
    pub fn of_model(budget: MemoryBudget, files: u64) -> Self {
        let whole = Self::of_files(budget);
        let grown = files.saturating_mul(MOST_GROWTH);
        if grown >= budget.decoded() {
            return whole;
        }
        let (remedy, placed) = (Remedy::Growth(files), files / LEAST_INSTANCE_BYTES);
        let placed = usize::try_from(placed)
            .unwrap_or(usize::MAX)
            .max(FEW_INSTANCES);
        let (instances, instances_remedy) = if placed < whole.instances {
            (placed, remedy)
        } else {
            (whole.instances, whole.instances_remedy)
        };
        Self {
            file_bytes: whole.file_bytes,
            instances,
            instances_remedy,
            ..Self::of(grown, remedy)
        }
    }

    /// As much as `decoded` bytes allow, and no less than every model may have. A list of triangles
    /// has at least two bytes for each.
    fn of(decoded: u64, remedy: Remedy) -> Self {
        // Kernels address bytes of a buffer with 32 bits.
        let addressable = (1 << 32) - 4;
        Self {
            file_bytes: decoded.max(256 * MIB),
            total_bytes: decoded.max(512 * MIB),
            buffer_bytes: decoded.clamp(128 * MIB, addressable),
            vertices: (decoded / 12).clamp(4_000_000, draw::MAX_TRIANGLES),
            triangles: (decoded / 6).clamp(10_000_000, draw::MAX_TRIANGLES / 3),
            instances: usize::try_from(decoded / INSTANCE_BYTES)
                .unwrap_or(usize::MAX)
                .max(FEW_INSTANCES),
            instances_remedy: remedy,
            remedy,
        }
    }

    /// # Errors
    /// There are more instances than these limits allow; `what` begins the sentence.
    pub fn check_instances(
        &self,
        instances: usize,
        what: impl FnOnce() -> String,
    ) -> Result<(), LoadError> {
        if instances <= self.instances {
            return Ok(());
        }
        let limits = Self {
            remedy: self.instances_remedy,
            ..*self
        };
        Err(limits.exceeded(what(), self.instances as u64))
    }

    /// `what` exceeds `most`, a limit of these.
    pub fn exceeded(&self, what: impl std::fmt::Display, most: u64) -> LoadError {
        LoadError::end(match self.remedy {
            Remedy::Budget(budget) => {
                format!("{what}; allowed: at most {most} {}", budget.remedy())
            }
            Remedy::Growth(files) => format!(
                "{what}; allowed: at most {most}, because its files have only {files} bytes"
            ),
        })
    }
}
