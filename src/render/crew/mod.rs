//! A crew: processes that render one picture together. One of them leads, and the others help; each has the scene and threads of its
//! own.
//!
//! The leader has the film. It gives tiles to helpers with all that their pixels know, and they come back with more samples. Since
//! [a sample depends on nothing but seed, pixel and index](super), the film has the same bits whoever rendered what, and whichever
//! helper was slow or lost. How messages travel is left to a [`Link`]; `etendue-mpi` has one for MPI.

mod dispatch;
mod helper;
mod leader;
mod message;

pub use helper::help;
pub use leader::Crew;

/// What a link has received.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// A message, as it was sent.
    Message(Vec<u8>),
    /// The other process is no longer there. The reason, for people.
    Lost(String),
}

/// Carries messages between the process that leads a render and its helpers.
///
/// Messages from one process to another arrive in the order in which they were sent, and whole. None is longer than 2^30 bytes where a
/// film has tiles of less than 4 MiB.
pub trait Link {
    /// Number of other processes: of the leader all helpers, numbered from 0 on; of a helper 1, the leader.
    fn peers(&self) -> usize;

    /// Sends a message. It must not wait for the other process to receive it. What is sent to a process that is no longer there is
    /// lost.
    fn send(&mut self, peer: usize, message: Vec<u8>);

    /// What has arrived, and from whom; `None` where nothing has. It does not wait.
    fn receive(&mut self) -> Option<(usize, Event)>;
}
