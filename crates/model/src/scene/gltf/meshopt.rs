//! EXT_meshopt_compression: decodes the three modes of its bitstream and undoes its three filters.
//!
//! The format is that of the extension's specification, version 0 of attributes and indices and
//! version 1 of triangles. Sizes are checked before anything is allocated, and every read is
//! checked, since a file may be cut off or hostile.

use serde::Deserialize;

use super::error::LoadError;

/// A compressed buffer view.
#[derive(Clone, Debug, Deserialize)]
#[serde(rename_all = "camelCase")]
pub struct CompressedView {
    pub buffer: usize,
    #[serde(default)]
    pub byte_offset: u64,
    pub byte_length: u64,
    /// Bytes of each element.
    pub byte_stride: usize,
    /// Number of elements.
    pub count: usize,
    pub mode: Mode,
    #[serde(default)]
    pub filter: Filter,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Mode {
    Attributes,
    Triangles,
    Indices,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "UPPERCASE")]
pub enum Filter {
    #[default]
    None,
    Octahedral,
    Quaternion,
    Exponential,
}

impl CompressedView {
    /// Size of the decoded view, bytes; none beyond what can be counted.
    pub fn decoded_bytes(&self) -> Option<u64> {
        (self.count as u64).checked_mul(self.byte_stride as u64)
    }

    /// The elements that `bytes` hold.
    ///
    /// # Errors
    /// The stream is malformed or cut off, or its parameters do not fit each other.
    pub fn decode(&self, bytes: &[u8]) -> Result<Vec<u8>, LoadError> {
        let stride = self.byte_stride;
        let wrong_stride = |allowed: &str| {
            LoadError::new(format!(
                "byteStride is {stride}; {:?} allows {allowed}",
                self.mode
            ))
        };
        let mut decoded = match self.mode {
            Mode::Attributes if stride == 0 || stride > 256 || !stride.is_multiple_of(4) => {
                return Err(wrong_stride("multiples of 4 up to 256"));
            }
            Mode::Attributes => attributes(bytes, self.count, stride)?,
            Mode::Triangles | Mode::Indices if stride != 2 && stride != 4 => {
                return Err(wrong_stride("2 or 4"));
            }
            Mode::Triangles if !self.count.is_multiple_of(3) => {
                return Err(LoadError::new(format!(
                    "count is {}; TRIANGLES needs a multiple of 3",
                    self.count
                )));
            }
            Mode::Triangles => indices_as(&triangles(bytes, self.count)?, stride)?,
            Mode::Indices => indices_as(&sequence(bytes, self.count)?, stride)?,
        };
        match (self.filter, self.mode, stride) {
            (Filter::None, ..) => {}
            (Filter::Octahedral, Mode::Attributes, 4) => {
                decoded.chunks_exact_mut(4).for_each(octahedral8)
            }
            (Filter::Octahedral, Mode::Attributes, 8) => {
                decoded.chunks_exact_mut(8).for_each(octahedral16)
            }
            (Filter::Quaternion, Mode::Attributes, 8) => {
                decoded.chunks_exact_mut(8).for_each(quaternion)
            }
            (Filter::Exponential, Mode::Attributes, _) => {
                decoded.chunks_exact_mut(4).for_each(exponential)
            }
            (filter, mode, _) => {
                return Err(LoadError::new(format!(
                    "the filter {filter:?} does not fit mode {mode:?} with byteStride {stride}"
                )));
            }
        }
        Ok(decoded)
    }
}

fn cut_off() -> LoadError {
    LoadError::new("its compressed data is cut off")
}

/// Takes `count` bytes from the front.
fn take<'a>(from: &mut &'a [u8], count: usize) -> Result<&'a [u8], LoadError> {
    let (taken, rest) = from.split_at_checked(count).ok_or_else(cut_off)?;
    *from = rest;
    Ok(taken)
}

fn check_header(from: &mut &[u8], expected: u8) -> Result<(), LoadError> {
    match take(from, 1)? {
        [header] if *header == expected => Ok(()),
        header => Err(LoadError::new(format!(
            "its compressed data begins with {header:02x?}; this version begins with {expected:02x}"
        ))),
    }
}

/// Elements in blocks; in a block the deltas of the first bytes of all elements, then those of the
/// second bytes, and so on.
fn attributes(mut bytes: &[u8], count: usize, stride: usize) -> Result<Vec<u8>, LoadError> {
    const GROUP: usize = 16;
    check_header(&mut bytes, 0xa0)?;
    // The element that the first one is a difference to stands at the end.
    let tail = bytes
        .len()
        .checked_sub(stride.max(32))
        .ok_or_else(cut_off)?;
    let (mut bytes, tail) = bytes.split_at(tail);
    let mut last = tail[tail.len() - stride..].to_vec();
    // Each group of elements needs at least two bits for each byte of an element, so that a short
    // stream cannot claim many.
    if (count.div_ceil(GROUP) as u64) * stride as u64 > 4 * bytes.len() as u64 {
        return Err(cut_off());
    }
    let block = ((8192 / stride) & !(GROUP - 1)).min(256);
    let mut decoded = vec![0; count * stride];
    for elements in decoded.chunks_mut(block * stride) {
        let in_block = elements.len() / stride;
        let groups = in_block.div_ceil(GROUP);
        for byte in 0..stride {
            let modes = take(&mut bytes, groups.div_ceil(4))?;
            for group in 0..groups {
                let mode = (modes[group / 4] >> (2 * (group % 4))) & 3;
                let deltas = deltas(&mut bytes, mode)?;
                for (i, delta) in deltas
                    .into_iter()
                    .enumerate()
                    .take(in_block - group * GROUP)
                {
                    last[byte] = last[byte].wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg());
                    elements[(group * GROUP + i) * stride + byte] = last[byte];
                }
            }
        }
    }
    Ok(decoded)
}

/// Sixteen deltas: zeros, or of 2 or 4 bits with a byte of its own for each that has all bits set,
/// or bytes.
fn deltas(bytes: &mut &[u8], mode: u8) -> Result<[u8; 16], LoadError> {
    let mut deltas = [0; 16];
    let bits = match mode {
        0 => return Ok(deltas),
        1 => 2,
        2 => 4,
        _ => {
            deltas.copy_from_slice(take(bytes, 16)?);
            return Ok(deltas);
        }
    };
    let (packed, sentinel, in_byte) = (take(bytes, 2 * bits)?, (1u8 << bits) - 1, 8 / bits);
    for (i, delta) in deltas.iter_mut().enumerate() {
        // The highest bits come first.
        let short = (packed[i / in_byte] >> (8 - bits * (1 + i % in_byte))) & sentinel;
        *delta = if short == sentinel {
            take(bytes, 1)?[0]
        } else {
            short
        };
    }
    Ok(deltas)
}

/// A number of 7 bits a byte, the lowest first, whose lowest bit is its sign, added to `last`.
fn index(bytes: &mut &[u8], last: u32) -> Result<u32, LoadError> {
    let delta = varint(bytes)?;
    Ok(last.wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg()))
}

fn varint(bytes: &mut &[u8]) -> Result<u32, LoadError> {
    let mut value = 0;
    for shift in (0..35).step_by(7) {
        let byte = take(bytes, 1)?[0];
        value |= u32::from(byte & 127).checked_shl(shift).unwrap_or(0);
        if byte < 128 {
            return Ok(value);
        }
    }
    Err(LoadError::new(
        "its compressed data holds a number of more than five bytes",
    ))
}

/// The latest sixteen entries; 0 is the latest.
struct Fifo<T> {
    entries: [T; 16],
    next: usize,
}

impl<T: Copy> Fifo<T> {
    fn new(empty: T) -> Self {
        Self {
            entries: [empty; 16],
            next: 0,
        }
    }

    fn push(&mut self, entry: T) {
        self.entries[self.next % 16] = entry;
        self.next = self.next.wrapping_add(1);
    }

    fn get(&self, age: usize) -> T {
        self.entries[self.next.wrapping_sub(1 + age) % 16]
    }
}

/// A triangle list: each triangle shares an edge or vertices with those before it.
fn triangles(mut bytes: &[u8], count: usize) -> Result<Vec<u32>, LoadError> {
    check_header(&mut bytes, 0xe1)?;
    // A table of codes for two vertices stands at the end.
    let table = bytes.len().checked_sub(16).ok_or_else(cut_off)?;
    let (mut bytes, table) = bytes.split_at(table);
    let codes = take(&mut bytes, count / 3)?;
    let (mut edges, mut vertices) = (Fifo::new([0u32; 2]), Fifo::new(0u32));
    let (mut next, mut last) = (0u32, 0u32);
    let new = |next: &mut u32| {
        let vertex = *next;
        *next = next.wrapping_add(1);
        vertex
    };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        if code < 0xf0 {
            let ([a, b], vertex) = (edges.get(usize::from(code >> 4)), code & 15);
            let c = match vertex {
                0 => new(&mut next),
                1..13 => vertices.get(usize::from(vertex)),
                13 => last.wrapping_sub(1),
                14 => last.wrapping_add(1),
                _ => index(&mut bytes, last)?,
            };
            if vertex >= 13 {
                last = c;
            }
            if vertex == 0 || vertex >= 13 {
                vertices.push(c);
            }
            edges.push([c, b]);
            edges.push([a, c]);
            indices.extend([a, b, c]);
            continue;
        }
        let pair = if code < 0xfe {
            table[usize::from(code & 15)]
        } else {
            take(&mut bytes, 1)?[0]
        };
        if code >= 0xfe && pair == 0 {
            next = 0;
        }
        let [fea, feb, fec] = [if code == 0xff { 15 } else { 0 }, pair >> 4, pair & 15];
        // The fifo is read as it was before this triangle, and new vertices are numbered before any
        // is read from the stream.
        let mut known = |code: u8, is_long: bool| match code {
            0 => new(&mut next),
            15 if is_long => 0,
            age => vertices.get(usize::from(age) - 1),
        };
        let is_long = code >= 0xfe;
        let [mut a, mut b, mut c] = [
            known(fea, is_long),
            known(feb, is_long),
            known(fec, is_long),
        ];
        for (code, vertex) in [(fea, &mut a), (feb, &mut b), (fec, &mut c)] {
            if code == 15 && is_long {
                (last, *vertex) = (index(&mut bytes, last)?, 0);
                *vertex = last;
            }
        }
        vertices.push(a);
        for (code, vertex) in [(feb, b), (fec, c)] {
            if code == 0 || (code == 15 && is_long) {
                vertices.push(vertex);
            }
        }
        for edge in [[b, a], [c, b], [a, c]] {
            edges.push(edge);
        }
        indices.extend([a, b, c]);
    }
    Ok(indices)
}

/// An index list of any topology: each index is a difference to one of two before it.
fn sequence(mut bytes: &[u8], count: usize) -> Result<Vec<u32>, LoadError> {
    check_header(&mut bytes, 0xd1)?;
    let mut bytes = &bytes[..bytes.len().checked_sub(4).ok_or_else(cut_off)?];
    if count > bytes.len() {
        return Err(cut_off());
    }
    let mut last = [0u32; 2];
    let next = |_| {
        let value = varint(&mut bytes)?;
        let (baseline, delta) = ((value & 1) as usize, value >> 1);
        last[baseline] = last[baseline].wrapping_add((delta >> 1) ^ (delta & 1).wrapping_neg());
        Ok(last[baseline])
    };
    (0..count).map(next).collect()
}

/// Indices as 16- or 32-bit integers.
fn indices_as(indices: &[u32], stride: usize) -> Result<Vec<u8>, LoadError> {
    if stride == 4 {
        return Ok(indices
            .iter()
            .flat_map(|index| index.to_le_bytes())
            .collect());
    }
    let short = |index: &u32| {
        u16::try_from(*index)
            .map_err(|_| LoadError::new(format!("index {index} does not fit byteStride 2")))
    };
    Ok(indices
        .iter()
        .map(short)
        .collect::<Result<Vec<_>, _>>()?
        .into_iter()
        .flat_map(u16::to_le_bytes)
        .collect())
}

/// A unit vector from its octahedral map; `z` holds what 1 is in the map, and the result is scaled
/// to `most`.
fn unit([x, y, one]: [f32; 3], most: f32) -> [f32; 3] {
    let z = one - x.abs() - y.abs();
    // Points beyond the octahedron's equator are folded back.
    let fold = z.min(0.0);
    let [x, y] = [x, y].map(|v| if v >= 0.0 { v + fold } else { v - fold });
    let length = (x * x + y * y + z * z).sqrt();
    [x, y, z].map(|v| rounded(v * (most / length)))
}

/// Halves away from zero.
fn rounded(value: f32) -> f32 {
    (value + if value >= 0.0 { 0.5 } else { -0.5 }).trunc()
}

fn octahedral8(element: &mut [u8]) {
    let [x, y, z] = unit([0, 1, 2].map(|i| f32::from(element[i] as i8)), 127.0);
    [x, y, z]
        .into_iter()
        .zip(element)
        .for_each(|(v, byte)| *byte = v as i8 as u8);
}

fn octahedral16(element: &mut [u8]) {
    let vector = unit([0, 1, 2].map(|i| f32::from(short(element, i))), 32767.0);
    vector
        .into_iter()
        .enumerate()
        .for_each(|(i, v)| put_short(element, i, v as i16));
}

/// Three components and the place of the largest, which follows from them.
fn quaternion(element: &mut [u8]) {
    let last = short(element, 3);
    let scale = std::f32::consts::FRAC_1_SQRT_2 / f32::from(last | 3);
    let [x, y, z] = [0, 1, 2].map(|i| f32::from(short(element, i)) * scale);
    let w = (1.0 - x * x - y * y - z * z).max(0.0).sqrt();
    let largest = (last & 3) as usize;
    for (i, v) in [w, x, y, z].into_iter().enumerate() {
        put_short(element, (largest + i) % 4, rounded(v * 32767.0) as i16);
    }
}

/// A mantissa of 24 bits and an exponent of 8, both signed.
fn exponential(element: &mut [u8]) {
    let word = i32::from_le_bytes([element[0], element[1], element[2], element[3]]);
    let (exponent, mantissa) = (word >> 24, (word << 8) >> 8);
    let value = f64::from(mantissa) * f64::from(exponent).exp2();
    element.copy_from_slice(&(value as f32).to_le_bytes());
}

fn short(element: &[u8], i: usize) -> i16 {
    i16::from_le_bytes([element[2 * i], element[2 * i + 1]])
}

fn put_short(element: &mut [u8], i: usize, value: i16) {
    element[2 * i..2 * i + 2].copy_from_slice(&value.to_le_bytes());
}
