//! Words: the parameters of an effect as Rust reads them, where it has a side in Rust.

/// A struct of an effect's parameter words, declared by [`words!`](crate::words!).
pub trait Words: bytemuck::Pod {
    /// Name of the effect.
    const EFFECT: &'static str;
    /// Byte offset of every member.
    const MEMBERS: &'static [(&'static str, usize)];
}

/// Declares a choice, in the order of its words in the file of the effect.
#[macro_export]
macro_rules! choice {
    ($(#[$meta:meta])* pub enum $name:ident { $($(#[$vmeta:meta])* $variant:ident),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
        #[repr(u32)]
        pub enum $name { $($(#[$vmeta])* $variant),+ }

        impl $name {
            const ALL: &'static [Self] = &[$(Self::$variant),+];

            /// The choice with this index; an index out of range, which no checked value has, gives the first.
            pub fn of(index: u32) -> Self {
                Self::ALL.get(index as usize).copied().unwrap_or(Self::ALL[0])
            }
        }
    };
}

/// Declares the parameter words of an effect as its file lays them out, for what reads them in Rust.
/// What each of them means stands in the file.
#[macro_export]
macro_rules! words {
    ($(#[$meta:meta])* pub struct $name:ident of $effect:literal { $($field:ident : $ty:ty),+ $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        #[repr(C)]
        pub struct $name { $(pub $field: $ty),+ }

        impl Default for $name {
            fn default() -> Self {
                $crate::effects::read(&$crate::effects::Effect::named($effect).defaults)
            }
        }

        impl $crate::effects::Words for $name {
            const EFFECT: &'static str = $effect;
            const MEMBERS: &'static [(&'static str, usize)] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field))),+];
        }
    };
}
