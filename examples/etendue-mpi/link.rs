//! Messages of a render by MPI.

use std::collections::VecDeque;
use std::ptr::NonNull;
use std::time::{Duration, Instant};

use etendue::render::{Event, Link};
use mpi::point_to_point::MatchedReceiveVec;
use mpi::request::{Request, StaticScope};
use mpi::topology::SimpleCommunicator;
use mpi::traits::*;

/// The tag of these messages.
const TAG: mpi::Tag = 1;

/// How long a process attends to what it sends before it does something else. Large messages go on only while both ends ask MPI about
/// them, and the other end does once it has looked for messages, about once a millisecond.
const ATTENTION: Duration = Duration::from_millis(10);

/// A message on its way.
struct Sending {
    request: Request<'static, [u8], StaticScope>,
    bytes: NonNull<[u8]>,
}

/// The link of a process with the first one, or of the first one with all others. A process that dies ends the job, so that none is ever
/// reported as lost.
pub struct MpiLink<'w> {
    world: &'w SimpleCommunicator,
    sending: VecDeque<Sending>,
    received: VecDeque<(usize, Event)>,
}

impl<'w> MpiLink<'w> {
    pub fn new(world: &'w SimpleCommunicator) -> Self {
        Self { world, sending: VecDeque::new(), received: VecDeque::new() }
    }

    /// Gives the memory of messages back that have been sent.
    fn reclaim(&mut self) {
        for _ in 0..self.sending.len() {
            let Some(Sending { request, bytes }) = self.sending.pop_front() else { return };
            match request.test() {
                // SAFETY: `bytes` is from a box, and the request, which is done, was the only one that read it.
                Ok(_) => drop(unsafe { Box::from_raw(bytes.as_ptr()) }),
                Err(request) => self.sending.push_back(Sending { request, bytes }),
            }
        }
    }

    /// Takes the messages that have arrived.
    fn take(&mut self) {
        while let Some(message) = self.world.any_process().immediate_matched_probe_with_tag(TAG) {
            let rank = message.1.source_rank();
            let (bytes, _) = message.matched_receive_vec::<u8>();
            self.received.push_back(((rank - 1).max(0) as usize, Event::Message(bytes)));
        }
    }

    /// Waits until all messages have been sent.
    pub fn flush(&mut self) {
        while !self.sending.is_empty() {
            self.reclaim();
            self.take();
            std::thread::sleep(Duration::from_micros(100));
        }
    }
}

impl Link for MpiLink<'_> {
    fn peers(&self) -> usize {
        if self.world.rank() == 0 { self.world.size() as usize - 1 } else { 1 }
    }

    fn send(&mut self, peer: usize, message: Vec<u8>) {
        let rank = if self.world.rank() == 0 { peer as mpi::Rank + 1 } else { 0 };
        let bytes = NonNull::from(Box::leak(message.into_boxed_slice()));
        // SAFETY: the box is given back only once the request is done, and nobody writes to it.
        let view: &'static [u8] = unsafe { bytes.as_ref() };
        let request = self.world.process_at_rank(rank).immediate_send_with_tag(StaticScope, view, TAG);
        self.sending.push_back(Sending { request, bytes });
        let start = Instant::now();
        loop {
            self.reclaim();
            // The other end may be doing the same.
            self.take();
            if self.sending.is_empty() || start.elapsed() > ATTENTION {
                return;
            }
            std::thread::yield_now();
        }
    }

    fn receive(&mut self) -> Option<(usize, Event)> {
        self.reclaim();
        self.take();
        self.received.pop_front()
    }
}

impl Drop for MpiLink<'_> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            // The job is about to be aborted, and MPI may still read what is on its way.
            std::mem::take(&mut self.sending).into_iter().for_each(std::mem::forget);
            return;
        }
        self.flush();
    }
}
