//! One error type for the whole library: a kind to act on, a message to read, and where in which file it happened.

use std::fmt;
use std::path::{Path, PathBuf};

/// What went wrong, as far as a caller can act on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum ErrorKind {
    /// The scene, a parameter file or an option holds a value that cannot be rendered.
    InvalidScene,
    /// The input is well formed but asks for something this version does not do.
    Unsupported,
    /// A file could not be read or written.
    Io,
    /// Embree is missing, of the wrong version, or reported a failure.
    Device,
    /// A limit on memory was reached.
    OutOfMemory,
    /// The caller asked to stop.
    Cancelled,
    /// A broken promise of this library; please report it.
    Internal,
}

/// The place in a file that an error or a warning is about.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Location {
    /// The file, where the input came from one.
    pub file: Option<PathBuf>,
    /// One-based line in that file, 0 where it is not known.
    pub line: usize,
    /// JSON path such as `surfaces[3].material`, empty for the file as a whole.
    pub json_path: String,
}

impl fmt::Display for Location {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut separator = "";
        if let Some(file) = &self.file {
            write!(f, "{}", file.display())?;
            separator = ": ";
            if self.line > 0 {
                write!(f, ":{}", self.line)?;
            }
        } else if self.line > 0 {
            write!(f, "line {}", self.line)?;
            separator = ": ";
        }
        if !self.json_path.is_empty() {
            write!(f, "{separator}{}", self.json_path)?;
        }
        Ok(())
    }
}

/// Any failure of this library.
#[derive(Debug)]
pub struct Error {
    kind: ErrorKind,
    message: String,
    location: Location,
    source: Option<Box<dyn std::error::Error + Send + Sync>>,
}

/// `std::result::Result` with this library's [`Error`].
pub type Result<T, E = Error> = std::result::Result<T, E>;

impl Error {
    /// An error of `kind` with a message that names the bad value and what was expected.
    pub fn new(kind: ErrorKind, message: impl Into<String>) -> Self {
        Self { kind, message: message.into(), location: Location::default(), source: None }
    }

    /// An [`ErrorKind::InvalidScene`] at a JSON path.
    pub fn invalid(json_path: impl Into<String>, message: impl Into<String>) -> Self {
        Self::new(ErrorKind::InvalidScene, message).at(json_path)
    }

    /// An [`ErrorKind::Io`] about `file`, with the system's own reason.
    pub fn io(file: &Path, what: &str, source: std::io::Error) -> Self {
        Self {
            kind: ErrorKind::Io,
            message: format!("{what}: {source}"),
            location: Location { file: Some(file.to_owned()), ..Location::default() },
            source: Some(Box::new(source)),
        }
    }

    /// Sets the JSON path.
    #[must_use]
    pub fn at(mut self, json_path: impl Into<String>) -> Self {
        self.location.json_path = json_path.into();
        self
    }

    /// Sets file and one-based line (0: not known), unless a file is set already.
    #[must_use]
    pub fn in_file(mut self, file: Option<&Path>, line: usize) -> Self {
        if self.location.file.is_none() {
            self.location.file = file.map(Path::to_owned);
            self.location.line = line;
        }
        self
    }

    /// Keeps the error this one was caused by.
    #[must_use]
    pub fn because(mut self, source: impl Into<Box<dyn std::error::Error + Send + Sync>>) -> Self {
        self.source = Some(source.into());
        self
    }

    /// What a caller can act on.
    pub fn kind(&self) -> ErrorKind {
        self.kind
    }

    /// Where it happened.
    pub fn location(&self) -> &Location {
        &self.location
    }

    /// The message without its location.
    pub fn message(&self) -> &str {
        &self.message
    }
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let location = self.location.to_string();
        if location.is_empty() { f.write_str(&self.message) } else { write!(f, "{location}: {}", self.message) }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.source.as_ref().map(|source| source.as_ref() as _)
    }
}
