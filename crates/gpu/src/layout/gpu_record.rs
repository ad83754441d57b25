//! Structs shared with the kernels: each lists the name, offset and WGSL type of its members, so
//! that `tests/house/layout.rs` can compare it with what naga reads from the shaders.

/// A Rust type that WGSL has too, by the name that naga gives it.
pub trait WgslType {
    const NAME: &'static str;
}

macro_rules! wgsl_types {
    ($($rust:ty => $wgsl:literal),* $(,)?) => { $(impl WgslType for $rust { const NAME: &'static str = $wgsl; })* };
}

wgsl_types! {
    f32 => "f32",
    u32 => "u32",
    i32 => "i32",
    [f32; 2] => "vec2<f32>",
    [f32; 4] => "vec4<f32>",
    [u32; 2] => "vec2<u32>",
    [u32; 4] => "vec4<u32>",
    [[f32; 4]; 4] => "mat4x4<f32>",
}

/// A member of a shared struct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordMember {
    pub name: &'static str,
    /// Bytes from the start of the struct.
    pub offset: usize,
    /// Type as naga names it, for instance `vec4<f32>`.
    pub kind: &'static str,
}

/// What a shared struct looks like on the Rust side.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordLayout {
    /// Name of the struct in WGSL.
    pub wgsl: &'static str,
    /// Bytes.
    pub size: usize,
    pub members: &'static [RecordMember],
}

/// A struct that is declared in Rust and in WGSL.
pub trait GpuRecord: WgslType + bytemuck::Pod {
    const LAYOUT: RecordLayout;
}

/// Declares a struct of plain words together with its [`RecordLayout`]. The literal is its name in
/// WGSL.
macro_rules! gpu_record {
    ($(#[$meta:meta])* pub struct $name:ident = $wgsl:literal { $($(#[$member_meta:meta])* pub $member:ident : $ty:ty,)* }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        pub struct $name { $($(#[$member_meta])* pub $member: $ty,)* }

        impl $crate::layout::gpu_record::WgslType for $name {
            const NAME: &'static str = $wgsl;
        }

        impl $crate::layout::gpu_record::GpuRecord for $name {
            const LAYOUT: $crate::layout::gpu_record::RecordLayout = $crate::layout::gpu_record::RecordLayout {
                wgsl: $wgsl,
                size: size_of::<$name>(),
                members: &[$($crate::layout::gpu_record::RecordMember {
                    name: stringify!($member),
                    offset: std::mem::offset_of!($name, $member),
                    kind: <$ty as $crate::layout::gpu_record::WgslType>::NAME,
                }),*],
            };
        }
    };
}

pub(crate) use gpu_record;
