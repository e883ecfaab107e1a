//! The two containers of a glTF document: JSON text, and the binary file (`.glb`) of a JSON chunk and a binary chunk.

use crate::{Error, ErrorKind, Result};

const MAGIC: &[u8; 4] = b"glTF";
const JSON: [u8; 4] = *b"JSON";
const BIN: [u8; 4] = *b"BIN\0";

/// A document before its JSON is read.
#[derive(Debug)]
pub(super) struct Container<'a> {
    pub text: &'a str,
    /// The binary chunk, which is the first buffer of a document whose first buffer has no `uri`.
    pub binary: Option<&'a [u8]>,
    /// Whether the file is text, so that lines mean something.
    pub is_text: bool,
}

/// Whether these are the first bytes of a binary file.
pub(super) fn is_binary(bytes: &[u8]) -> bool {
    bytes.starts_with(MAGIC)
}

/// Divides a file into its parts.
pub(super) fn open(bytes: &[u8]) -> Result<Container<'_>> {
    if !is_binary(bytes) {
        let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        return Ok(Container { text: utf8(bytes)?, binary: None, is_text: true });
    }
    let broken = |message: String| Error::invalid("", message);
    let word = |at: usize| -> Option<u32> { Some(u32::from_le_bytes(bytes.get(at..at + 4)?.try_into().ok()?)) };
    let (Some(version), Some(length)) = (word(4), word(8)) else {
        return Err(broken(format!("the binary file ends in its header, after {} bytes", bytes.len())));
    };
    if version != 2 {
        let message = format!("the file is of glTF version {version}, this library reads version 2.0");
        return Err(Error::new(ErrorKind::Unsupported, message));
    }
    let Some(bytes) = bytes.get(..length as usize).filter(|bytes| bytes.len() >= 12) else {
        return Err(broken(format!("the binary file is {} bytes long, its header says {length}", bytes.len())));
    };
    let mut chunks = Chunks { rest: &bytes[12..] };
    let Some((JSON, text)) = chunks.take()? else {
        return Err(broken("the first chunk of the binary file is no JSON".to_owned()));
    };
    let binary = match chunks.take()? {
        Some((BIN, binary)) => Some(binary),
        // Chunks of other kinds are left out, as the specification asks.
        _ => None,
    };
    Ok(Container { text: utf8(text)?, binary, is_text: false })
}

struct Chunks<'a> {
    rest: &'a [u8],
}

impl<'a> Chunks<'a> {
    fn take(&mut self) -> Result<Option<([u8; 4], &'a [u8])>> {
        if self.rest.is_empty() {
            return Ok(None);
        }
        let (head, rest) = self
            .rest
            .split_first_chunk::<8>()
            .ok_or_else(|| Error::invalid("", "the binary file ends in the header of a chunk"))?;
        let [a, b, c, d, kind @ ..] = *head;
        let length = u32::from_le_bytes([a, b, c, d]);
        let Some((chunk, rest)) = rest.split_at_checked(length as usize) else {
            let message = format!(
                "a chunk is {length} bytes long, but the binary file ends {} bytes after its header",
                rest.len()
            );
            return Err(Error::invalid("", message));
        };
        self.rest = rest;
        Ok(Some((kind, chunk)))
    }
}

fn utf8(bytes: &[u8]) -> Result<&str> {
    std::str::from_utf8(bytes).map_err(|error| {
        Error::invalid("", format!("byte {} of the JSON is not UTF-8", error.valid_up_to() + 1)).because(error)
    })
}
