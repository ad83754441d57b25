//! New input from old: bytes, words and numbers changed, doubled, moved and left out, also inside
//! of what is packed.

use crate::{Target, corpus::MAX_INPUT};

/// Random numbers (xorshift64*), the same for the same seed.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    fn bits(&mut self) -> u64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// A number below `end`; 0 if `end` is 0.
    pub fn below(&mut self, end: usize) -> usize {
        ((self.bits() >> 32) as usize).checked_rem(end).unwrap_or(0)
    }

    fn pick<'a, T: ?Sized>(&mut self, of: &[&'a T]) -> Option<&'a T> {
        of.get(self.below(of.len())).copied()
    }
}

/// Numbers at the ends of types and ranges.
const NUMBERS: [&str; 22] = [
    "0",
    "-0.0",
    "1",
    "-1",
    "2",
    "3",
    "255",
    "256",
    "65535",
    "65536",
    "16777217",
    "2147483648",
    "4294967295",
    "4294967296",
    "9223372036854775807",
    "18446744073709551615",
    "1e-45",
    "1e38",
    "1e39",
    "-1e308",
    "1e999",
    "nan",
];

/// Words of every text.
const MARKS: [&str; 16] = [
    "\"", "'", "[", "]", "{", "}", ",", "=", ":", ".", "#", "\n", "\\u0000", "é", "\u{202e}", "\t",
];

const BYTES: [u8; 10] = [0, 1, 2, 3, 4, 0x7f, 0x80, 0xfe, 0xff, b' '];

/// `input` with one to three changes, most often one; `other` is another input of the same target,
/// for pieces. Three times of four, one of the target's views is changed where the input has it.
pub fn mutated(target: &Target, input: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    if !target.views.is_empty() && random.below(4) != 0 {
        let view = &target.views[random.below(target.views.len())];
        if let Some(inside) = (view.open)(input) {
            let other = (view.open)(other).unwrap_or_default();
            return (view.close)(input, &changed(target, inside, &other, random));
        }
    }
    changed(target, input.to_vec(), other, random)
}

fn changed(target: &Target, mut bytes: Vec<u8>, other: &[u8], random: &mut Random) -> Vec<u8> {
    for _ in 0..1 + random.below(3) * random.below(2) {
        let is_text = std::str::from_utf8(&bytes).is_ok();
        bytes = if is_text && random.below(4) != 0 {
            words_changed(target, &bytes, other, random)
        } else {
            bytes_changed(bytes, other, random)
        };
    }
    bytes.truncate(MAX_INPUT);
    bytes
}

/// One change that takes bytes for bytes.
fn bytes_changed(mut bytes: Vec<u8>, other: &[u8], random: &mut Random) -> Vec<u8> {
    let at = random.below(bytes.len().max(1));
    let length = (1 + random.below(8) * random.below(8)).min(bytes.len().saturating_sub(at));
    match random.below(9) {
        _ if bytes.is_empty() => bytes.extend_from_slice(&other[..other.len().min(64)]),
        0 | 1 => bytes[at] ^= 1 << random.below(8),
        2 => bytes[at] = BYTES[random.below(BYTES.len())],
        3 => bytes[at] = random.bits() as u8,
        4 => drop(bytes.drain(at..at + length)),
        5 => {
            let piece = bytes[at..at + length].to_vec();
            let times = 1 + random.below(8) * random.below(8);
            let to = random.below(bytes.len() + 1);
            bytes.splice(to..to, piece.repeat(times));
        }
        6 => {
            // A number of two, four or eight bytes.
            let wide = 2 << random.below(3);
            let value = NUMBERS[random.below(NUMBERS.len())]
                .parse::<u64>()
                .unwrap_or_else(|_| random.bits());
            let value = if random.below(2) == 0 {
                value.to_le_bytes()
            } else {
                value.to_be_bytes()
            };
            let value = if value[0] == 0 {
                &value[8 - wide..]
            } else {
                &value[..wide]
            };
            let end = (at + wide).min(bytes.len());
            bytes[at..end].copy_from_slice(&value[..end - at]);
        }
        7 => bytes.truncate(at),
        _ => {
            let from = random.below(other.len());
            let piece = &other[from..(from + 1 + random.below(256)).min(other.len()).max(from)];
            bytes.splice(at..at + length, piece.iter().copied());
        }
    }
    bytes
}

/// One change that takes text for words, numbers and marks.
fn words_changed(target: &Target, bytes: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let words = words(bytes);
    if words.is_empty() {
        return [bytes, random.pick(target.words).unwrap_or("").as_bytes()].concat();
    }
    let at = random.below(words.len());
    let end = (at + 1 + random.below(3) * random.below(6)).min(words.len());
    let (before, piece, after) = (words[..at].concat(), &words[at..end], words[end..].concat());
    let join = |middle: &[u8]| [&before, middle, &after].concat();
    match random.below(9) {
        0 => join(b""),
        1 => join(
            &piece
                .concat()
                .repeat(2 + random.below(12) * random.below(12)),
        ),
        2 | 3 => {
            let number = words
                .iter()
                .enumerate()
                .skip(at)
                .find(|(_, word)| word[0].is_ascii_digit())
                .map_or(at, |(number, _)| number);
            let value = NUMBERS[random.below(NUMBERS.len())];
            [
                words[..number].concat(),
                value.into(),
                words[number + 1..].concat(),
            ]
            .concat()
        }
        4 => join(MARKS[random.below(MARKS.len())].as_bytes()),
        5 | 6 => join(random.pick(target.words).unwrap_or(" ").as_bytes()),
        7 => {
            let to = words[random.below(words.len())];
            join(&[piece.concat(), to.to_vec()].concat())
        }
        _ => {
            let lines: Vec<&[u8]> = other.split_inclusive(|byte| *byte == b'\n').collect();
            join(&[piece.concat(), random.pick(&lines).unwrap_or(b"").to_vec()].concat())
        }
    }
}

/// The bytes as words, numbers, and marks of one byte each.
fn words(bytes: &[u8]) -> Vec<&[u8]> {
    let is_word = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte >= 0x80;
    bytes.chunk_by(|a, b| is_word(*a) && is_word(*b)).collect()
}
