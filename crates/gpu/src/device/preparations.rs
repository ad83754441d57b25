//! Preparations: what pictures made the program prepare on a device. A picture that differs from
//! the one before in parameters of effects alone prepares nothing.

use std::sync::atomic::{AtomicU64, Ordering};

/// Something that is prepared for a picture and kept for the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Preparation {
    /// The draws of a scene in a view, and what they need.
    View,
    /// A plan.
    Plan,
    /// The text of a kernel.
    Text,
    Pipeline,
    Buffer,
    Texture,
    BindGroup,
    /// The passes and buffers of a picture in words.
    Explanation,
}

/// Counts of preparations.
#[derive(Debug, Default)]
pub struct Preparations([AtomicU64; Self::KINDS]);

/// How much of what was prepared.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Prepared {
    pub views: u64,
    pub plans: u64,
    pub texts: u64,
    pub pipelines: u64,
    pub buffers: u64,
    pub textures: u64,
    pub bind_groups: u64,
    pub explanations: u64,
}

impl Preparations {
    const KINDS: usize = Preparation::Explanation as usize + 1;

    pub fn count(&self, preparation: Preparation) {
        self.0[preparation as usize].fetch_add(1, Ordering::Relaxed);
    }

    /// The counts since the device was opened.
    pub fn so_far(&self) -> Prepared {
        let of = |preparation: Preparation| self.0[preparation as usize].load(Ordering::Relaxed);
        Prepared {
            views: of(Preparation::View),
            plans: of(Preparation::Plan),
            texts: of(Preparation::Text),
            pipelines: of(Preparation::Pipeline),
            buffers: of(Preparation::Buffer),
            textures: of(Preparation::Texture),
            bind_groups: of(Preparation::BindGroup),
            explanations: of(Preparation::Explanation),
        }
    }
}
