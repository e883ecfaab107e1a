//! What the process that leads a render and its helpers say to each other.

use serde::{Deserialize, Serialize};

use super::super::ways::Ways;
use crate::error::{Error, ErrorKind, Result};

/// A message. Some have bytes beside.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) enum Message {
    /// To a helper: a run begins. Beside it is the state of the render, a checkpoint without samples.
    Begin,
    /// To a helper: the pixels are to get from `from` to `to` samples, with these ways to take them. What they need is to be prepared.
    Pass { number: u64, from: u32, to: u32, ways: Ways },
    /// To a helper: tiles to be rendered. Beside it are, of each tile, the goals of its pixels where they have some, and its state where
    /// it has samples.
    Tiles { pass: u64, tiles: Vec<(u32, bool)>, goals: bool },
    /// To a helper: nothing more is to be done for a pass. Tiles that are under way come back as they are.
    Stop { pass: u64 },
    /// To a helper: it is no longer needed.
    End,
    /// From a helper: it is there, with so many threads.
    Hello { threads: u32 },
    /// From a helper: a batch with the state of its tiles beside, where they have samples. `first`: index, row and column of samples
    /// that were not finite.
    Done { pass: u64, tiles: Vec<(u32, bool)>, is_complete: bool, rays: u64, first: Vec<(u32, u32, u32)> },
    /// From a helper: why it cannot help.
    Failed { reason: String },
}

impl Message {
    /// The message as bytes, with `beside` after it.
    pub fn bytes(&self, beside: &[u8]) -> Vec<u8> {
        let text = serde_json::to_vec(self).expect("numbers and texts can be written");
        let mut bytes = Vec::with_capacity(4 + text.len() + beside.len());
        bytes.extend((text.len() as u32).to_le_bytes());
        bytes.extend(text);
        bytes.extend(beside);
        bytes
    }

    /// A message, and the bytes beside it.
    pub fn read(bytes: &[u8]) -> Result<(Self, &[u8])> {
        let no_message = || Error::new(ErrorKind::Internal, "what was received is no message of a render");
        let (length, rest) = bytes.split_first_chunk().ok_or_else(no_message)?;
        let (text, beside) = rest.split_at_checked(u32::from_le_bytes(*length) as usize).ok_or_else(no_message)?;
        let message = serde_json::from_slice(text).map_err(|error| no_message().because(error))?;
        Ok((message, beside))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_come_back() {
        for message in [
            Message::Begin,
            Message::Tiles { pass: 7, tiles: vec![(3, true), (9, false)], goals: true },
            Message::Done { pass: u64::MAX, tiles: vec![], is_complete: false, rays: 5, first: vec![(1, 2, 3)] },
            Message::Failed { reason: "no \"memory\"\n".to_owned() },
        ] {
            let bytes = message.bytes(&[1, 2, 3]);
            let (again, beside) = Message::read(&bytes).unwrap();
            assert_eq!((again, beside), (message, &[1, 2, 3][..]));
            assert!(Message::read(&bytes[..bytes.len() - 4]).is_err());
        }
        assert!(Message::read(&[1]).is_err() && Message::read(&[0xff; 9]).is_err());
    }
}
