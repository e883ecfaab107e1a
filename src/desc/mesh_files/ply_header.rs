//! The header of a PLY file: which elements follow, and which properties each of them has.

use std::collections::HashSet;
use std::io::BufRead;

use super::shortened;

/// Length of the longest header, and so of any line in it.
const HEADER_LIMIT: usize = 1 << 20;

/// How numbers are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Text,
    LittleEndian,
    BigEndian,
}

/// The type of a number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    fn of_name(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes that a number takes in a binary file.
    pub fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// Least and greatest number of the type; `None` for types with a fraction.
    pub fn range(self) -> Option<[f64; 2]> {
        Some(match self {
            Self::I8 => [i8::MIN.into(), i8::MAX.into()],
            Self::U8 => [0.0, u8::MAX.into()],
            Self::I16 => [i16::MIN.into(), i16::MAX.into()],
            Self::U16 => [0.0, u16::MAX.into()],
            Self::I32 => [i32::MIN.into(), i32::MAX.into()],
            Self::U32 => [0.0, u32::MAX.into()],
            Self::F32 | Self::F64 => return None,
        })
    }
}

/// A property of an element: a number, or a list of numbers with their count before them.
#[derive(Debug)]
pub(super) struct Property {
    pub name: String,
    /// The type of the count, for a list.
    pub count: Option<Scalar>,
    pub kind: Scalar,
}

/// A kind of element, such as all vertices.
#[derive(Debug)]
pub(super) struct Element {
    pub name: String,
    pub count: u64,
    pub properties: Vec<Property>,
}

impl Element {
    /// The fewest bytes that all elements of this kind can take.
    pub fn least_bytes(&self, encoding: Encoding) -> u128 {
        let each: usize = match encoding {
            // A digit and what separates it from the next.
            Encoding::Text => 2 * self.properties.len(),
            _ => self.properties.iter().map(|property| property.count.unwrap_or(property.kind).size()).sum(),
        };
        u128::from(self.count) * each as u128
    }
}

/// A whole header.
#[derive(Debug)]
pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// The first line that means nothing.
    pub unknown: Option<usize>,
    /// Lines and bytes that the header takes.
    pub lines: usize,
    pub bytes: u64,
}

impl Header {
    /// Reads a header up to and with `end_header`. The outer error is one of reading the file; the inner one has the line.
    pub fn read(reader: &mut impl BufRead) -> std::io::Result<Result<Self, (usize, String)>> {
        let mut parser = Parser::default();
        let (mut bytes, mut text) = (0, Vec::new());
        let mut line = 0;
        loop {
            line += 1;
            text.clear();
            let room = HEADER_LIMIT - bytes + 1;
            bytes += std::io::Read::take(&mut *reader, room as u64).read_until(b'\n', &mut text)?;
            if bytes > HEADER_LIMIT {
                return Ok(Err((line, format!("the header is longer than {HEADER_LIMIT} bytes"))));
            }
            if text.last() != Some(&b'\n') && !text.trim_ascii().ends_with(b"end_header") {
                let message = if text.contains(&b'\r') {
                    "lines end with a carriage return alone, expected a line feed"
                } else {
                    "the file ends inside the header, expected end_header"
                };
                return Ok(Err((line, message.to_owned())));
            }
            match parser.line(line, &String::from_utf8_lossy(&text)) {
                Ok(true) => {}
                Err(message) => return Ok(Err((line, message))),
                Ok(false) => {
                    let Parser { encoding: Some(encoding), elements, unknown, .. } = parser else {
                        return Ok(Err((line, "the header has no line 'format'".to_owned())));
                    };
                    return Ok(Ok(Self { encoding, elements, unknown, lines: line, bytes: bytes as u64 }));
                }
            }
        }
    }
}

#[derive(Default)]
struct Parser {
    encoding: Option<Encoding>,
    elements: Vec<Element>,
    /// Names of the elements, and of the properties of the last one: a header of a megabyte may have many.
    element_names: HashSet<String>,
    property_names: HashSet<String>,
    unknown: Option<usize>,
}

impl Parser {
    /// Reads a line. Returns false for the last one.
    fn line(&mut self, number: usize, text: &str) -> Result<bool, String> {
        let words: Vec<&str> = text.split_ascii_whitespace().collect();
        if number == 1 {
            return match *words {
                ["ply"] => Ok(true),
                _ => Err("the file does not begin with 'ply'; is it a PLY file?".to_owned()),
            };
        }
        match *words {
            [] | ["comment" | "obj_info", ..] => {}
            ["end_header"] => return Ok(false),
            ["format", encoding, version] => {
                if self.encoding.is_some() {
                    return Err("the format is given twice".to_owned());
                }
                if version != "1.0" {
                    return Err(format!("the file is of version '{}', expected 1.0", shortened(version)));
                }
                self.encoding = Some(match encoding {
                    "ascii" => Encoding::Text,
                    "binary_little_endian" => Encoding::LittleEndian,
                    "binary_big_endian" => Encoding::BigEndian,
                    other => {
                        let expected = "ascii, binary_little_endian or binary_big_endian";
                        return Err(format!("unknown format '{}', expected {expected}", shortened(other)));
                    }
                });
            }
            ["element", name, count] => {
                let count = count
                    .parse()
                    .map_err(|_| format!("'{}' is not a number of elements '{}'", shortened(count), shortened(name)))?;
                if !self.element_names.insert(name.to_owned()) {
                    return Err(format!("the element '{}' is given twice", shortened(name)));
                }
                self.property_names.clear();
                self.elements.push(Element { name: name.to_owned(), count, properties: Vec::new() });
            }
            ["property", kind, name] => self.property(None, kind, name)?,
            ["property", "list", count, kind, name] => self.property(Some(count), kind, name)?,
            // Some programs write comments without the word. Behind an element the line may be a property, without which all
            // numbers would be taken for others.
            [word, ..] if self.elements.is_empty() && !["format", "element", "property"].contains(&word) => {
                self.unknown.get_or_insert(number);
            }
            [word, ..] => {
                let expected = "format, comment, obj_info, element, property or end_header";
                return Err(format!("'{}' is no line of a PLY header, expected {expected}", shortened(word)));
            }
        }
        Ok(true)
    }

    fn property(&mut self, count: Option<&str>, kind: &str, name: &str) -> Result<(), String> {
        let scalar = |word: &str| {
            Scalar::of_name(word).ok_or_else(|| {
                let expected = "char, uchar, short, ushort, int, uint, float or double";
                format!("'{}' of the property '{}' is no type, expected {expected}", shortened(word), shortened(name))
            })
        };
        let (count, kind) = (count.map(scalar).transpose()?, scalar(kind)?);
        if count.is_some_and(|count| count.range().is_none()) {
            return Err(format!("the count of the list '{}' is not of an integer type", shortened(name)));
        }
        let Some(element) = self.elements.last_mut() else {
            return Err(format!("the property '{}' comes before any element", shortened(name)));
        };
        if !self.property_names.insert(name.to_owned()) {
            return Err(format!("the element '{}' has the property '{}' twice", element.name, shortened(name)));
        }
        element.properties.push(Property { name: name.to_owned(), count, kind });
        Ok(())
    }
}
