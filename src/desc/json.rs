//! Reads JSON into typed structures. Every error gives an exact path, and the line of a path in the text can be found.

use serde::de::{self, Deserializer, IntoDeserializer, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;
use std::fmt;

use crate::{Error, ErrorKind, Result};

/// Reads a JSON object into a structure. The structure defines which keys are allowed.
///
/// `path` is the path of `raw` in its file; the paths of errors extend it.
pub(super) fn object<'a, T: Deserialize<'a>>(raw: &'a RawValue, path: &str) -> Result<T> {
    expect_object(raw.get(), path)?;
    value(raw, path)
}

/// Reads a JSON object as [`object`] does, and calls `unknown` with each key that the structure does not have.
pub(super) fn object_lenient<'a, T: Deserialize<'a>>(
    raw: &'a RawValue,
    path: &str,
    mut unknown: impl FnMut(String),
) -> Result<T> {
    expect_object(raw.get(), path)?;
    let mut reader = serde_json::Deserializer::from_str(raw.get());
    let mut track = serde_path_to_error::Track::new();
    let tracked = serde_path_to_error::Deserializer::new(&mut reader, &mut track);
    let mut ignored = |key: serde_ignored::Path<'_>| unknown(key.to_string());
    T::deserialize(serde_ignored::Deserializer::new(tracked, &mut ignored))
        .map_err(|error| complaint(&error, &join(path, &track.path().to_string())))
}

/// Reads any JSON value.
pub(super) fn value<'a, T: Deserialize<'a>>(raw: &'a RawValue, path: &str) -> Result<T> {
    let mut reader = serde_json::Deserializer::from_str(raw.get());
    serde_path_to_error::deserialize(&mut reader)
        .map_err(|error| complaint(error.inner(), &join(path, &error.path().to_string())))
}

/// Calls `read` with the path and the text of each element of an array, one after the other. A missing array counts as
/// empty. No element is stored, so the first invalid element ends the reading however long the array is.
pub(super) fn each(raw: Option<&RawValue>, path: &str, read: impl FnMut(&str, &RawValue) -> Result<()>) -> Result<()> {
    struct Each<'a, F> {
        path: &'a str,
        read: F,
        failed: &'a mut Option<Error>,
    }
    impl<'de, F: FnMut(&str, &RawValue) -> Result<()>> Visitor<'de> for Each<'_, F> {
        type Value = ();
        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("an array")
        }
        fn visit_seq<A: SeqAccess<'de>>(mut self, mut seq: A) -> Result<(), A::Error> {
            let mut index = 0_usize;
            while let Some(raw) = seq.next_element::<&RawValue>()? {
                if let Err(error) = (self.read)(&format!("{}[{index}]", self.path), raw) {
                    *self.failed = Some(error);
                    return Err(de::Error::custom("an element is bad"));
                }
                index += 1;
            }
            Ok(())
        }
    }
    let Some(raw) = raw else { return Ok(()) };
    let mut failed = None;
    let mut reader = serde_json::Deserializer::from_str(raw.get());
    let done = reader.deserialize_seq(Each { path, read, failed: &mut failed });
    done.map_err(|error| failed.take().unwrap_or_else(|| complaint(&error, path)))
}

/// Splits a whole file at its outermost object. Every byte of the file is checked to be JSON here.
pub(super) fn document(text: &str) -> Result<&RawValue> {
    let raw: &RawValue = serde_json::from_str(text).map_err(|error| {
        let line = error.line();
        complaint(&error, "").in_file(None, line)
    })?;
    expect_object(raw.get(), "")?;
    Ok(raw)
}

/// Refuses a value that is not an object. Derived structures also accept arrays of their fields, which no file intends.
fn expect_object(text: &str, path: &str) -> Result<()> {
    let found = kind(text);
    if found == "an object" {
        return Ok(());
    }
    Err(Error::invalid(path, format!("expected an object, found {found}")))
}

/// Returns the kind of value of a JSON text, by its first character.
pub(super) fn kind(text: &str) -> &'static str {
    match text.trim_start().as_bytes().first() {
        Some(b'{') => "an object",
        Some(b'[') => "an array",
        Some(b'"') => "a string",
        Some(b't' | b'f') => "a boolean",
        Some(b'n') => "null",
        Some(_) => "a number",
        None => "nothing",
    }
}

/// Extends `base` by a path below it. Serde denotes the value itself by a single dot.
pub(super) fn join(base: &str, below: &str) -> String {
    match (base, below) {
        (base, "" | ".") => base.to_owned(),
        ("", below) => below.to_owned(),
        (base, below) if below.starts_with('[') => format!("{base}{below}"),
        (base, below) => format!("{base}.{below}"),
    }
}

/// Returns a function that prefixes the path of an error with `base`.
pub(crate) fn below(base: &str) -> impl Fn(Error) -> Error {
    move |error| {
        let path = join(base, &error.location().json_path);
        error.at(path)
    }
}

/// Converts serde's message to the terms of a scene file.
fn complaint(error: &serde_json::Error, path: &str) -> Error {
    let mut message = error.to_string();
    if let Some(end) = message.rfind(" at line ") {
        message.truncate(end);
    }
    for (theirs, ours) in [
        ("missing field", "missing key"),
        ("unknown field", "unknown key"),
        ("unknown variant", "unknown name"),
        ("duplicate field", "key given twice:"),
        ("expected f64", "expected a number"),
        ("expected u32", "expected a whole number from 0 to 4294967295"),
        ("expected u64", "expected a whole number, zero or more"),
        ("expected a sequence", "expected an array"),
        ("invalid type: sequence", "invalid type: an array"),
        ("invalid type: map", "invalid type: an object"),
        ("invalid length", "wrong length"),
        ("number out of range", "the number is too large"),
        ("EOF while parsing a list", "the text ends inside an array"),
        ("EOF while parsing", "the text ends inside"),
    ] {
        message = message.replace(theirs, ours);
    }
    // Below the top level the text is known to be JSON, so this message can only mean an array with too many elements.
    if !path.is_empty() && message == "trailing characters" {
        message = "too many elements in the array".to_owned();
    }
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    let mut path = path.to_owned();
    if let Some((word, known)) = quoted.split_first() {
        if message.starts_with("key given twice") {
            path = join(&path, word);
        } else if message.starts_with("unknown key") || message.starts_with("unknown name") {
            // Serde quotes the known words after the unknown word.
            let hint = did_you_mean(word, known.iter().copied());
            message.push_str(&hint);
        }
    }
    Error::new(ErrorKind::InvalidScene, elided(&message)).at(path)
}

/// Shortens a message to a bounded length by leaving out its middle, because files can hold words of any length.
pub(crate) fn elided(text: &str) -> String {
    const ENDS: usize = 300;
    if text.len() <= 2 * ENDS {
        return text.to_owned();
    }
    // A character takes four bytes at most.
    let boundary = |at: usize| (at..at + 4).find(|at| text.is_char_boundary(*at)).unwrap_or(text.len());
    let (head, tail) = (boundary(ENDS), boundary(text.len() - ENDS));
    format!("{} ... {}", &text[..head], &text[tail..])
}

/// Returns "; did you mean 'x'?" for the known word nearest to `word`, or an empty text if none is near.
pub(super) fn did_you_mean<'a>(word: &str, known: impl IntoIterator<Item = &'a str>) -> String {
    // The time of the comparison is proportional to the product of both lengths, and nobody mistypes a word this long.
    const LONGEST: usize = 64;
    if word.len() > LONGEST {
        return String::new();
    }
    known
        .into_iter()
        .filter(|candidate| candidate.len() <= LONGEST)
        .map(|candidate| (strsim::normalized_damerau_levenshtein(word, candidate), candidate))
        .filter(|(likeness, _)| *likeness >= 0.5)
        // Of equally near words, the first in the alphabet is chosen, whatever their order.
        .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(a.1)))
        .map_or_else(String::new, |(_, candidate)| format!("; did you mean '{candidate}'?"))
}

/// Reads one of a set of names. Serde alone would also accept an object in place of a name.
pub(super) fn name<'de, D: Deserializer<'de>, T: Deserialize<'de>>(deserializer: D) -> Result<Option<T>, D::Error> {
    let name = Option::<String>::deserialize(deserializer)?;
    name.map(|name| T::deserialize(name.into_deserializer())).transpose()
}

/// Returns the value of a tag such as `"type"`. The tag is read before the rest so that errors in the rest keep their
/// path.
pub(super) fn tag(raw: &RawValue, path: &str, key: &'static str, known: &[&str]) -> Result<String> {
    expect_object(raw.get(), path)?;
    let tag = match key {
        "geometry" => value::<Geometry>(raw, path)?.geometry,
        _ => value::<Type>(raw, path)?.kind,
    };
    let tag =
        tag.ok_or_else(|| Error::invalid(path, format!("missing key `{key}`, expected one of {}", known.join(", "))))?;
    if known.contains(&tag.as_str()) {
        return Ok(tag);
    }
    let hint = did_you_mean(&tag, known.iter().copied());
    let message = format!("unknown {key} '{}', expected one of {}{hint}", elided(&tag), known.join(", "));
    Err(Error::invalid(join(path, key), message))
}

/// Reads a name, or an object whose `type` is the name. Also returns whether the value is an object with more keys.
pub(super) fn named(raw: &RawValue, path: &str, known: &[&str]) -> Result<(String, bool)> {
    if kind(raw.get()) != "a string" {
        return tag(raw, path, "type", known).map(|name| (name, true));
    }
    let name: String = value(raw, path)?;
    if known.contains(&name.as_str()) {
        return Ok((name, false));
    }
    let hint = did_you_mean(&name, known.iter().copied());
    Err(Error::invalid(path, format!("unknown name '{}', expected one of {}{hint}", elided(&name), known.join(", "))))
}

/// An object that has a type and no other key.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Plain {
    #[serde(rename = "type")]
    _type: String,
}

#[derive(Deserialize)]
struct Geometry {
    geometry: Option<String>,
}

#[derive(Deserialize)]
struct Type {
    #[serde(rename = "type")]
    kind: Option<String>,
}

/// A whole number, also where a file writes it as 7.0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema), schemars(transparent))]
pub(super) struct Whole(pub u64);

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Expecting;
        impl Visitor<'_> for Expecting {
            type Value = Whole;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a whole number, zero or more")
            }
            fn visit_u64<E: de::Error>(self, value: u64) -> Result<Whole, E> {
                Ok(Whole(value))
            }
            fn visit_i64<E: de::Error>(self, value: i64) -> Result<Whole, E> {
                u64::try_from(value).map(Whole).map_err(|_| E::invalid_value(Unexpected::Signed(value), &self))
            }
            fn visit_f64<E: de::Error>(self, value: f64) -> Result<Whole, E> {
                // Up to 2^53 every whole number is exact in double precision.
                if value.fract() == 0.0 && (0.0..=9_007_199_254_740_992.0).contains(&value) {
                    return Ok(Whole(value as u64));
                }
                Err(E::invalid_value(Unexpected::Float(value), &self))
            }
        }
        deserializer.deserialize_any(Expecting)
    }
}

/// A factor for all axes, or one per axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub(super) enum Scale {
    /// The same for all axes.
    Uniform(f64),
    /// One factor per axis.
    PerAxis([f64; 3]),
}

impl<'de> Deserialize<'de> for Scale {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Expecting;
        impl<'de> Visitor<'de> for Expecting {
            type Value = Scale;
            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a number or an array of 3 numbers")
            }
            fn visit_u64<E>(self, value: u64) -> Result<Scale, E> {
                Ok(Scale::Uniform(value as f64))
            }
            fn visit_i64<E>(self, value: i64) -> Result<Scale, E> {
                Ok(Scale::Uniform(value as f64))
            }
            fn visit_f64<E>(self, value: f64) -> Result<Scale, E> {
                Ok(Scale::Uniform(value))
            }
            fn visit_seq<A: SeqAccess<'de>>(self, seq: A) -> Result<Scale, A::Error> {
                <[f64; 3]>::deserialize(de::value::SeqAccessDeserializer::new(seq)).map(Scale::PerAxis)
            }
        }
        deserializer.deserialize_any(Expecting)
    }
}

/// Returns the one-based line on which `path` (such as `surfaces[3].material`) begins in `text`, which must be JSON.
/// Where the end of the path does not exist, the line is that of the last part that exists.
pub(super) fn line_of(text: &str, path: &str) -> usize {
    let mut walker = Walker { bytes: text.as_bytes(), at: 0 };
    let mut found = {
        walker.space();
        walker.at
    };
    for segment in segments(path) {
        let next = match segment {
            Segment::Key(key) => walker.member(key),
            Segment::Index(index) => walker.element(index),
        };
        match next {
            Some(start) => found = start,
            None => break,
        }
    }
    line_at(text.as_bytes(), found)
}

/// Returns the one-based line of a byte offset.
pub(super) fn line_at(bytes: &[u8], offset: usize) -> usize {
    1 + bytes.iter().take(offset).filter(|byte| **byte == b'\n').count()
}

/// Returns the text of the value at `path`, with paths as in [`line_of`]; `None` where there is no such value.
pub(super) fn value_at<'a>(text: &'a str, path: &str) -> Option<&'a str> {
    let mut walker = Walker { bytes: text.as_bytes(), at: 0 };
    walker.space();
    for segment in segments(path) {
        match segment {
            Segment::Key(key) => walker.member(key),
            Segment::Index(index) => walker.element(index),
        }?;
    }
    let start = walker.at;
    walker.skip();
    text.get(start..walker.at)
}

/// Reads `null` as a value that is present, instead of as an absent value.
pub(super) fn even_null<'de, T: Deserialize<'de>, D: Deserializer<'de>>(
    deserializer: D,
) -> Result<Option<T>, D::Error> {
    T::deserialize(deserializer).map(Some)
}

enum Segment<'a> {
    Key(&'a str),
    Index(usize),
}

fn segments(path: &str) -> impl Iterator<Item = Segment<'_>> {
    path.split('.').filter(|part| !part.is_empty()).flat_map(|part| {
        let (key, indices) = part.split_at(part.find('[').unwrap_or(part.len()));
        let key = (!key.is_empty()).then_some(Segment::Key(key));
        let indices = indices.split(['[', ']']).filter_map(|index| index.parse().ok().map(Segment::Index));
        key.into_iter().chain(indices)
    })
}

/// Walks over JSON text that is known to be well formed. On other text it stops at the end.
struct Walker<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl Walker<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    fn space(&mut self) {
        while matches!(self.peek(), Some(b' ' | b'\t' | b'\r' | b'\n')) {
            self.at += 1;
        }
    }

    fn string(&mut self) {
        self.at += 1;
        while let Some(byte) = self.peek() {
            self.at += if byte == b'\\' { 2 } else { 1 };
            if byte == b'"' {
                break;
            }
        }
    }

    /// Skips one value of any kind, without recursion.
    fn skip(&mut self) {
        let mut depth = 0_usize;
        loop {
            self.space();
            match self.peek() {
                None => return,
                Some(b'"') => self.string(),
                Some(b'{' | b'[') => {
                    depth += 1;
                    self.at += 1;
                }
                Some(b'}' | b']') => {
                    depth = depth.saturating_sub(1);
                    self.at += 1;
                }
                Some(b',' | b':') => self.at += 1,
                Some(_) => {
                    while !matches!(self.peek(), None | Some(b',' | b':' | b'}' | b']' | b' ' | b'\t' | b'\r' | b'\n'))
                    {
                        self.at += 1;
                    }
                }
            }
            if depth == 0 {
                return;
            }
        }
    }

    /// Moves to the value of the last member named `key`. Returns where the member's name starts.
    fn member(&mut self, key: &str) -> Option<usize> {
        let mut found = None;
        if self.peek() != Some(b'{') {
            return None;
        }
        self.at += 1;
        loop {
            self.space();
            if self.peek() != Some(b'"') {
                break;
            }
            let start = self.at;
            self.string();
            let name = self.bytes.get(start..self.at).and_then(|name| serde_json::from_slice::<String>(name).ok());
            self.space();
            self.at += 1;
            self.space();
            if name.as_deref() == Some(key) {
                found = Some((start, self.at));
            }
            self.skip();
            self.space();
            if self.peek() != Some(b',') {
                break;
            }
            self.at += 1;
        }
        let (start, value) = found?;
        self.at = value;
        Some(start)
    }

    /// Moves to element `index` of an array. Returns where the element starts.
    fn element(&mut self, index: usize) -> Option<usize> {
        if self.peek() != Some(b'[') {
            return None;
        }
        self.at += 1;
        for _ in 0..index {
            self.skip();
            self.space();
            if self.peek() != Some(b',') {
                return None;
            }
            self.at += 1;
        }
        self.space();
        (!matches!(self.peek(), None | Some(b']'))).then_some(self.at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_path_is_found_on_its_line() {
        let text = "{\n \"a\": [1,\n  {\"b]\": \"}\\\"{\",\n   \"c\": [[],\n 3]}],\n \"\\u0064\": 1\n}";
        for (path, line) in
            [("", 1), ("a", 2), ("a[0]", 2), ("a[1]", 3), ("a[1].c", 4), ("a[1].c[1]", 5), ("d", 6), ("a[1].x", 3)]
        {
            assert_eq!(line_of(text, path), line, "{path}");
        }
        assert_eq!(line_of(text, "a[7].x"), 2);
        assert_eq!(line_of("[[[[", "[0][0][0][0]"), 1);
        assert_eq!(value_at(text, "a[1].c"), Some("[[],\n 3]"));
        assert_eq!(value_at(text, "a[1].x"), None);
    }

    #[test]
    fn near_words_are_suggested_and_far_ones_are_not() {
        assert_eq!(did_you_mean("gold", ["glod", "silver"]), "; did you mean 'glod'?");
        assert_eq!(did_you_mean("gold", ["concrete", "water"]), "");
    }

    #[test]
    fn whole_numbers_may_be_written_as_decimals() {
        assert_eq!(serde_json::from_str::<Whole>("7.0").ok(), Some(Whole(7)));
        for bad in ["7.5", "-1", "-1.0", "1e300", "\"7\"", "null"] {
            assert!(serde_json::from_str::<Whole>(bad).is_err(), "{bad}");
        }
    }
}
