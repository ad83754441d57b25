//! Capabilities of an adapter, and how work is divided on it.

/// Kernels bind at most 8 storage buffers, and at most 2 more in place of uniforms or to clear what
/// a draw order counts. A resolve that reads a shadow map from a buffer binds one more.
pub(super) const MANY_STORAGE_BUFFERS: u32 = 10;

/// What an adapter can do for us.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Caps {
    /// 64-bit atomic maximum on storage buffers: visibility `packed64`.
    pub int64_atomics: bool,
    /// And 64-bit atomic addition.
    pub int64_additions: bool,
    /// GPU timestamps.
    pub timestamps: bool,
    pub max_storage_binding_bytes: u64,
    pub max_buffer_bytes: u64,
    pub max_texture_side: u32,
    /// Storage buffers that a kernel may bind.
    pub max_storage_buffers: u32,
    /// It runs on the CPU: pictures are right, times say nothing about a graphics card.
    pub software: bool,
    /// The atomic maximum costs far more than compare and exchange: SwiftShader calls a function
    /// for each.
    pub slow_atomic_maximum: bool,
}

impl Caps {
    /// More than any adapter has: what cannot be planned for it, none can draw.
    pub const ALL: Self = Self {
        int64_atomics: true,
        int64_additions: true,
        timestamps: true,
        max_storage_binding_bytes: u64::MAX,
        max_buffer_bytes: u64::MAX,
        max_texture_side: u32::MAX,
        max_storage_buffers: u32::MAX,
        software: false,
        slow_atomic_maximum: false,
    };

    /// `native-int64` or `portable`.
    pub fn class(&self) -> &'static str {
        if self.int64_atomics {
            "native-int64"
        } else {
            "portable"
        }
    }

    /// At which word the attributes of a scene are divided between two bindings, where so many bytes
    /// are more than one holds.
    pub fn attribute_split(&self, bytes: u64) -> Option<u32> {
        let most = self.max_storage_binding_bytes.min(self.max_buffer_bytes);
        // Room for the boxes of blocks of points.
        let is_large = bytes + bytes / 32 > most;
        is_large.then_some((most.min(u64::from(u32::MAX)) / 16 * 4) as u32)
    }

    /// How work is divided on this adapter. On a GPU a whole workgroup takes over early, since one
    /// slow invocation delays its neighbors; a CPU adapter runs invocations one after another,
    /// executes both sides of every branch, and gains nothing by it.
    pub fn tuning(&self) -> Tuning {
        let (max_small_samples, max_small_side) = if self.software {
            (MOST_SMALL_SAMPLES, 128)
        } else {
            (32, 32)
        };
        let group_size = if self.software { 64 } else { 256 };
        Tuning {
            max_small_samples,
            max_small_side,
            group_size,
            listed_tiles: self.software,
            early_load: self.software,
            exchanges_maximum: self.slow_atomic_maximum,
            queue_groups: if self.software { 0 } else { 8192 },
            dot_groups: if self.software { 1 } else { 1024 },
            interleaves_triangles: self.software,
            clears_in_passes: !self.software,
            hides_blocks: !self.software,
            stored_uniforms: self.software && self.max_storage_buffers >= MANY_STORAGE_BUFFERS,
            wide_loads: self.software && self.int64_atomics,
            buffered_shadow_map: self.max_storage_buffers > MANY_STORAGE_BUFFERS,
            glass_layers: MOST_GLASS_LAYERS,
            projects_points: true,
            specialized: true,
        }
    }
}

/// The most samples of a triangle that one invocation may walk.
pub const MOST_SMALL_SAMPLES: u32 = 128 * 128;

/// Bytes of a layer of glass.
pub const GLASS_LAYER_BYTES: u64 = 24;
/// Layers of glass that take 1 GiB: eight over each pixel at 2560x1440, and one band of pixels.
pub const MOST_GLASS_LAYERS: u32 = ((1 << 30) / GLASS_LAYER_BYTES) as u32;

/// How the kernels divide their work: it changes speed alone, never a picture. [`Caps::tuning`]
/// knows what suits an adapter; benches and tests try others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tuning {
    /// Most candidate samples of a triangle that one invocation walks, 1 to
    /// [`MOST_SMALL_SAMPLES`].
    pub max_small_samples: u32,
    /// Most pixels per side of such a triangle's box, 1 to 128.
    pub max_small_side: u32,
    /// Invocations in a workgroup of the passes over vertices and triangles, 1 to 256.
    pub group_size: u32,
    /// The resolve visits only tiles that a triangle's box touches, without branches.
    pub listed_tiles: bool,
    /// Load before the depth atomic (visibility `split32`; for discs, many of which lie on a
    /// pixel, always).
    pub early_load: bool,
    /// The largest word of a pixel is kept by compare and exchange instead of the atomic maximum
    /// (visibility `split32` and `packed32`).
    pub exchanges_maximum: bool,
    /// Workgroups of every pass over a queue, which share its entries, at most 65,535; 0: as many
    /// as the queue has entries, by an indirect dispatch (culled pictures always).
    pub queue_groups: u32,
    /// Workgroups among which few runs of dots are divided; more of them are divided 64 to a
    /// workgroup.
    pub dot_groups: u32,
    /// Workgroups take runs of neighboring triangles in turn instead of one long run each. On
    /// lavapipe one of two threads was done with its triangles in half the time of the other
    /// (Mesa 22.3): triangles that cost much often lie beside each other.
    pub interleaves_triangles: bool,
    /// The first pass clears counters and pixels beside its own work (pictures that are not
    /// culled).
    pub clears_in_passes: bool,
    /// Large and medium triangles skip blocks of pixels in which what was drawn hides them.
    pub hides_blocks: bool,
    /// What conditions read of draws, effects and particles lies in storage buffers instead of
    /// uniforms. lavapipe compiles a kernel anew, in every draw, with the values of the
    /// uniforms that its conditions read, and frees none of them: some 170 KB a draw
    /// (Mesa 22.3).
    pub stored_uniforms: bool,
    /// The resolve gathers two words at a time, as 64-bit integers, which the adapter must have.
    /// On lavapipe a gathered component of 64 bits costs about as much as one of 32; it was
    /// not tried on a card.
    pub wide_loads: bool,
    /// A shadow map is read from the buffer that the light's passes wrote, which is one storage
    /// buffer more in the resolve; else it is copied to a texture first.
    pub buffered_shadow_map: bool,
    /// Layers of glass that are in memory at a time, at least 1 and as far as there is memory: a
    /// picture that has more is drawn in bands of pixels.
    pub glass_layers: u32,
    /// Points are projected where they are drawn and shaded; else a pass writes the record of each,
    /// which the judge reads.
    pub projects_points: bool,
    /// Omit what the scene does not need; else keep every path and every branch.
    pub specialized: bool,
}
