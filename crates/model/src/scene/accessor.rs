//! Accessors: where attributes and indices lie in a byte buffer, and how to read them.

/// Number format of one attribute component. The discriminant is glTF's `componentType`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[repr(u32)]
pub enum ComponentType {
    I8 = 5120,
    U8 = 5121,
    I16 = 5122,
    U16 = 5123,
    U32 = 5125,
    F32 = 5126,
}

impl ComponentType {
    /// Size of one component in bytes: 1, 2 or 4.
    pub const fn bytes(self) -> u32 {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }
}

/// Where the elements of an attribute or of an index list lie in a byte buffer.
///
/// Every constructor of a [`Scene`](super::model::Scene) guarantees (the glTF loader checks it)
/// that `offset` and `stride` are multiples of the component size and that the last element ends
/// inside the buffer. Reading past `count` panics or returns other bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Accessor {
    /// Byte at which element 0 begins, counted from the start of the buffer.
    pub offset: u32,
    /// Bytes from the start of one element to the start of the next.
    pub stride: u32,
    /// Number format of the components.
    pub component_type: ComponentType,
    /// Components per element: 1 to 4 in a scene (16 for the matrices that the loader reads).
    pub components: u32,
    /// Integers are mapped to [0, 1] (unsigned) or [-1, 1] (signed), as glTF 2.0, section 3.6.2.2,
    /// defines.
    pub normalized: bool,
    /// Number of elements.
    pub count: u32,
}

impl Accessor {
    /// `count` tightly packed f32 elements of `components` components each, which begin at byte
    /// `offset`.
    pub fn packed_f32(offset: usize, components: u32, count: usize) -> Self {
        Self {
            offset: offset as u32,
            stride: components * 4,
            component_type: ComponentType::F32,
            components,
            normalized: false,
            count: count as u32,
        }
    }

    #[inline]
    fn raw<const N: usize>(&self, bytes: &[u8], element: u32, component: u32) -> [u8; N] {
        let at =
            self.offset as usize + element as usize * self.stride as usize + component as usize * N;
        bytes[at..at + N]
            .try_into()
            .expect("an accessor lies inside its buffer")
    }

    /// The bits of an f32 component; of an integer component, the bits of its exact value as f32.
    /// Not normalized.
    pub fn f32_bits(&self, bytes: &[u8], element: u32, component: u32) -> u32 {
        match self.component_type {
            ComponentType::F32 => u32::from_le_bytes(self.raw(bytes, element, component)),
            _ => (self.integer(bytes, element, component) as f32).to_bits(),
        }
    }

    /// An integer component, not normalized. Of an f32 component it returns the bits.
    #[inline]
    pub fn integer(&self, bytes: &[u8], element: u32, component: u32) -> i64 {
        match self.component_type {
            ComponentType::I8 => i8::from_le_bytes(self.raw(bytes, element, component)).into(),
            ComponentType::U8 => u8::from_le_bytes(self.raw(bytes, element, component)).into(),
            ComponentType::I16 => i16::from_le_bytes(self.raw(bytes, element, component)).into(),
            ComponentType::U16 => u16::from_le_bytes(self.raw(bytes, element, component)).into(),
            ComponentType::U32 | ComponentType::F32 => {
                u32::from_le_bytes(self.raw(bytes, element, component)).into()
            }
        }
    }

    /// The first three components in f64, as [`Self::value`] gives them.
    #[inline]
    pub fn vector(&self, bytes: &[u8], element: u32) -> [f64; 3] {
        if self.component_type == ComponentType::F32 {
            // One bounds check for all three.
            let at = self.offset as usize + element as usize * self.stride as usize;
            let [x, y, z] = bytes[at..at + 12].as_chunks::<4>().0 else {
                panic!("twelve bytes are three words")
            };
            return [x, y, z].map(|word| f32::from_le_bytes(*word).into());
        }
        [0, 1, 2].map(|component| self.value(bytes, element, component))
    }

    /// A component in f64, normalized where the accessor says so.
    pub fn value(&self, bytes: &[u8], element: u32, component: u32) -> f64 {
        if self.component_type == ComponentType::F32 {
            return f32::from_bits(self.f32_bits(bytes, element, component)).into();
        }
        let integer = self.integer(bytes, element, component) as f64;
        match (self.normalized, self.component_type) {
            (false, _) => integer,
            (true, ComponentType::I8) => (integer / 127.0).max(-1.0),
            (true, ComponentType::U8) => integer / 255.0,
            (true, ComponentType::I16) => (integer / 32767.0).max(-1.0),
            (true, ComponentType::U16) => integer / 65535.0,
            (true, _) => integer / 4_294_967_295.0,
        }
    }
}
