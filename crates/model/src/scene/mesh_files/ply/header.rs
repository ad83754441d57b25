//! The header of PLY.

use crate::legible::text_of;
use crate::scene::{
    gltf::{LoadError, error::quoted},
    mesh_files::stream::{Stream, split},
};

/// Most elements and properties of a file.
const MOST_LINES: usize = 4096;

/// How numbers are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// A type of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Number {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

const NUMBERS: &[([&str; 2], Number)] = &[
    (["char", "int8"], Number::I8),
    (["uchar", "uint8"], Number::U8),
    (["short", "int16"], Number::I16),
    (["ushort", "uint16"], Number::U16),
    (["int", "int32"], Number::I32),
    (["uint", "uint32"], Number::U32),
    (["float", "float32"], Number::F32),
    (["double", "float64"], Number::F64),
];

impl Number {
    fn named(name: &str) -> Option<Self> {
        let found = NUMBERS.iter().find(|(names, _)| names.contains(&name));
        found.map(|(_, number)| *number)
    }

    pub fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The value of a color channel that is full.
    pub fn brightest(self) -> f64 {
        match self {
            Self::F32 | Self::F64 => 1.0,
            Self::I16 | Self::U16 => 65_535.0,
            _ => 255.0,
        }
    }
}

/// A property of the rows of an element.
#[derive(Debug)]
pub struct Property {
    pub name: String,
    /// Of the number of its values; none if it has one.
    pub count: Option<Number>,
    pub number: Number,
}

/// A table, for instance that of the vertices.
#[derive(Debug)]
pub struct Element {
    pub name: String,
    /// Rows.
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// The index of the property that has one of these names.
    pub fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties
            .iter()
            .position(|property| names.contains(&property.name.as_str()))
    }
}

/// What the header says.
#[derive(Debug)]
pub struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Names of images.
    pub textures: Vec<String>,
}

impl Header {
    /// Reads the header.
    ///
    /// # Errors
    /// It says not how to read what follows.
    pub fn read(stream: &mut Stream) -> Result<Self, LoadError> {
        let (mut line, mut encoding) = (Vec::new(), None);
        let (mut elements, mut textures) = (Vec::<Element>::new(), Vec::new());
        let mut lines = 0;
        loop {
            if !stream.line(&mut line)? {
                return Err(LoadError::new(
                    "its header has no end_header; the file is truncated",
                ));
            }
            let text = text_of(&line);
            let (keyword, rest) = split(&text);
            let mut words = rest.split_ascii_whitespace();
            let wrong = || {
                let text = quoted(text.trim());
                LoadError::new(format!("line {} of its header is {text}", stream.line))
            };
            match keyword {
                "end_header" => break,
                "format" => {
                    encoding = Some(match words.next() {
                        Some("ascii") => Encoding::Text,
                        Some("binary_little_endian") => Encoding::LittleEndian,
                        Some("binary_big_endian") => Encoding::BigEndian,
                        _ => return Err(wrong()),
                    })
                }
                "comment" => {
                    if let ("TextureFile", name) = split(rest) {
                        textures.push(name.trim_matches('"').to_owned());
                    }
                }
                "element" => {
                    let (name, count) = (words.next(), words.next());
                    let count = count.and_then(|count| count.parse().ok());
                    elements.push(Element {
                        name: name.ok_or_else(wrong)?.to_owned(),
                        count: count.ok_or_else(wrong)?,
                        properties: Vec::new(),
                    });
                }
                "property" => {
                    let properties = &mut elements.last_mut().ok_or_else(wrong)?.properties;
                    let mut number = || words.next().and_then(Number::named);
                    let count = match rest.starts_with("list") {
                        true => {
                            number();
                            Some(number().ok_or_else(wrong)?)
                        }
                        false => None,
                    };
                    let number = number().ok_or_else(wrong)?;
                    properties.push(Property {
                        name: words.next().ok_or_else(wrong)?.to_owned(),
                        count,
                        number,
                    });
                }
                _ => {}
            }
            lines += 1;
            if lines > MOST_LINES {
                return Err(LoadError::new(format!(
                    "its header has more than {MOST_LINES} lines"
                )));
            }
        }
        Ok(Self {
            encoding: encoding
                .ok_or_else(|| LoadError::new("its header has no line that says its format"))?,
            elements,
            textures,
        })
    }
}
