//! Buffers and the bytes of buffer views: from the binary chunk, data URIs and files beside the document.

use std::cell::OnceCell;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use base64::Engine;
use base64::alphabet::{STANDARD, URL_SAFE};
use base64::engine::{DecodePaddingMode, GeneralPurpose, GeneralPurposeConfig};
use serde_json::value::RawValue;

use super::super::file::open;
use super::super::json::{self, elided};
use super::document::{Document, element, missing};
use crate::{Error, ErrorKind, Result};

/// Most bytes of all buffers and images of a document that are not in the document's own file.
const BYTES_LIMIT: u64 = 4 << 30;

/// The bytes of a document.
pub(super) struct Buffers<'a> {
    document: &'a Document<'a>,
    binary: Option<&'a [u8]>,
    base_dir: &'a Path,
    /// The buffers that were used so far, with the files that they came from.
    loaded: Vec<OnceCell<Vec<u8>>>,
    bytes_left: std::cell::Cell<u64>,
    files: std::cell::RefCell<Vec<PathBuf>>,
}

/// Where the bytes of a `uri` are.
pub(super) enum Uri {
    /// The bytes of a data URI.
    Data(Vec<u8>),
    /// A file.
    File(PathBuf),
}

impl<'a> Buffers<'a> {
    pub fn new(document: &'a Document<'a>, binary: Option<&'a [u8]>, base_dir: &'a Path) -> Self {
        Self {
            document,
            binary,
            base_dir,
            loaded: document.buffers.iter().map(|_| OnceCell::new()).collect(),
            bytes_left: std::cell::Cell::new(BYTES_LIMIT),
            files: std::cell::RefCell::new(Vec::new()),
        }
    }

    /// The files that were read.
    pub fn into_files(self) -> Vec<PathBuf> {
        self.files.into_inner()
    }

    /// The bytes of the buffer view that `path` names, and its stride if it has one.
    pub fn view(&self, path: &str, index: u64) -> Result<(&[u8], Option<u64>)> {
        let (number, view) = element(&self.document.buffer_views, "bufferViews", path, index)?;
        let at = format!("bufferViews[{number}]");
        if view.extensions.contains_key("EXT_meshopt_compression")
            || view.extensions.contains_key("KHR_meshopt_compression")
        {
            let message = format!("{at} is compressed (meshopt), which this library does not read");
            return Err(Error::new(ErrorKind::Unsupported, message).at(path));
        }
        let buffer = view.buffer.ok_or_else(|| missing(&at, "buffer"))?;
        let bytes = self.buffer(&format!("{at}.buffer"), buffer)?;
        let end = view.byte_offset.checked_add(view.byte_length);
        let range = end.and_then(|end| Some(usize::try_from(view.byte_offset).ok()?..usize::try_from(end).ok()?));
        let Some(bytes) = range.and_then(|range| bytes.get(range)) else {
            let message = format!(
                "the view of {} bytes from byte {} on ends beyond buffers[{buffer}], which has {} bytes",
                view.byte_length,
                view.byte_offset,
                bytes.len()
            );
            return Err(Error::invalid(at, message));
        };
        Ok((bytes, view.byte_stride))
    }

    fn buffer(&self, path: &str, index: u64) -> Result<&[u8]> {
        let (number, buffer) = element(&self.document.buffers, "buffers", path, index)?;
        let at = format!("buffers[{number}]");
        let short = |found: usize| {
            Error::invalid(&at, format!("the buffer has {found} bytes, its byteLength says {}", buffer.byte_length))
        };
        let Some(uri) = buffer.uri else {
            let binary = self.binary.filter(|_| number == 0).ok_or_else(|| {
                Error::invalid(&at, "the buffer has neither a uri nor the binary chunk of a .glb file")
            })?;
            // The chunk may be padded.
            let length = usize::try_from(buffer.byte_length).ok();
            return length.and_then(|length| binary.get(..length)).ok_or_else(|| short(binary.len()));
        };
        if let Some(bytes) = self.loaded[number].get() {
            return Ok(bytes);
        }
        let at_uri = format!("{at}.uri");
        let (mut bytes, file) = match self.uri(&at_uri, uri)? {
            Uri::Data(bytes) => (bytes, None),
            Uri::File(file) => (self.file(&at_uri, &file, buffer.byte_length)?, Some(file)),
        };
        let length = usize::try_from(buffer.byte_length).ok().filter(|length| *length <= bytes.len());
        bytes.truncate(length.ok_or_else(|| match file {
            Some(file) => Error::invalid(
                &at,
                format!(
                    "{} has {} bytes, the buffer's byteLength says {}",
                    file.display(),
                    bytes.len(),
                    buffer.byte_length
                ),
            ),
            None => short(bytes.len()),
        })?);
        Ok(self.loaded[number].get_or_init(|| bytes))
    }

    /// Opens a file beside the document, to read `length` bytes of it or all.
    pub fn open(&self, path: &str, file: &Path, length: Option<u64>) -> Result<io::Take<File>> {
        let left = self.bytes_left.get();
        let named = |error: Error| error.at(path);
        let handle = open(file, u64::MAX).map_err(named)?;
        let size = handle.metadata().map_err(|error| named(Error::io(file, "cannot read the file", error)))?.len();
        let wanted = length.unwrap_or(size).min(size);
        if wanted > left {
            let message = format!("the files beside the document are too large, expected {BYTES_LIMIT} bytes at most");
            return Err(Error::invalid(path, message));
        }
        self.bytes_left.set(left - wanted);
        let mut files = self.files.borrow_mut();
        if !files.iter().any(|known| known == file) {
            files.push(file.to_owned());
        }
        Ok(handle.take(wanted))
    }

    fn file(&self, path: &str, file: &Path, length: u64) -> Result<Vec<u8>> {
        let mut bytes = Vec::new();
        let read = self.open(path, file, Some(length))?.read_to_end(&mut bytes);
        read.map_err(|error| Error::io(file, "cannot read the file", error).at(path))?;
        Ok(bytes)
    }

    /// Reads a data URI, or finds the file that a URI names.
    pub fn uri(&self, path: &str, raw: &RawValue) -> Result<Uri> {
        let uri: std::borrow::Cow<'_, str> = json::value(raw, path)?;
        if let Some(data) = uri.strip_prefix("data:") {
            return self.data(path, data);
        }
        let scheme = uri.split_once(':').map(|(scheme, _)| scheme);
        if let Some(scheme) = scheme.filter(|it| it.len() > 1 && it.bytes().all(|byte| byte.is_ascii_alphanumeric())) {
            let message = format!("the uri is one of {}:, expected a file beside this one or data", elided(scheme));
            return Err(Error::new(ErrorKind::Unsupported, message).at(path));
        }
        let name = percent_encoding::percent_decode_str(&uri)
            .decode_utf8()
            .map_err(|error| Error::invalid(path, format!("the uri '{}' is no UTF-8", elided(&uri))).because(error))?;
        if name.is_empty() || name.contains('\0') {
            return Err(Error::invalid(path, "the uri names no file"));
        }
        // Some exporters write blanks and percent signs of names as they are.
        let as_written = self.base_dir.join(&*uri);
        let decoded = self.base_dir.join(&*name);
        Ok(Uri::File(if !decoded.exists() && as_written.exists() { as_written } else { decoded }))
    }

    fn data(&self, path: &str, data: &str) -> Result<Uri> {
        let (head, body) = data.split_once(',').ok_or_else(|| Error::invalid(path, "the data URI has no comma"))?;
        let spend = |bytes: usize| {
            let left = self.bytes_left.get().checked_sub(bytes as u64);
            left.map(|left| self.bytes_left.set(left)).ok_or_else(|| {
                Error::invalid(path, format!("the data is too large, expected {BYTES_LIMIT} bytes at most"))
            })
        };
        spend(body.len())?;
        if !head.ends_with(";base64") {
            let bytes = percent_encoding::percent_decode_str(body).collect();
            return Ok(Uri::Data(bytes));
        }
        let config = GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent);
        let body = percent_encoding::percent_decode_str(body).decode_utf8_lossy();
        let alphabet = if body.contains(['-', '_']) { URL_SAFE } else { STANDARD };
        let bytes = GeneralPurpose::new(&alphabet, config).decode(body.as_bytes());
        let bytes = bytes
            .map_err(|error| Error::invalid(path, format!("the base64 data is broken: {error}")).because(error))?;
        Ok(Uri::Data(bytes))
    }
}
