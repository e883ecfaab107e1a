//! Who does the work: threads of our own, the caller, or threads of the host.

use std::cell::Cell;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::control::LOOK_UP;
use crate::error::{Error, ErrorKind, Result};

/// Most worker threads of a render.
pub const MAX_THREADS: usize = 1024;

/// How long one of our own threads works on one render before it gives way to others that share the threads.
const TURN: Duration = Duration::from_millis(10);

/// What is handed to a host's executor.
type HostJob = Box<dyn FnOnce() + Send + 'static>;

/// Threads that render; cheap to clone, and shared by any number of renders. No image depends on them.
#[derive(Clone)]
pub struct Workers(Arc<WorkerKind>);

enum WorkerKind {
    Pool(Pool),
    Calling,
    Host { threads: usize, submit: Box<dyn Fn(HostJob) + Send + Sync> },
}

impl fmt::Debug for Workers {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let kind = match &*self.0 {
            WorkerKind::Pool(_) => "pool",
            WorkerKind::Calling => "calling thread",
            WorkerKind::Host { .. } => "host",
        };
        write!(f, "Workers({kind}, {})", self.threads())
    }
}

/// A rayon pool whose threads are gone when it is.
struct Pool {
    pool: Option<rayon::ThreadPool>,
    threads: usize,
    handles: Mutex<Vec<JoinHandle<()>>>,
}

impl Drop for Pool {
    fn drop(&mut self) {
        drop(self.pool.take());
        let own = std::thread::current().id();
        let handles = std::mem::take(&mut *lock(&self.handles));
        for handle in handles {
            // The last clone may be dropped by a job of the pool itself, which cannot wait for itself to end.
            if handle.thread().id() != own {
                let _ = handle.join();
            }
        }
    }
}

impl Workers {
    /// A pool of its own of so many threads; 0 means one for each core. Renders that share it take turns.
    ///
    /// # Errors
    /// [`ErrorKind::InvalidScene`] for more than [`MAX_THREADS`], [`ErrorKind::Device`] if a thread cannot be started.
    pub fn pool(threads: usize) -> Result<Self> {
        if threads > MAX_THREADS {
            let message = format!("{threads} threads; expected at most {MAX_THREADS}");
            return Err(Error::invalid("threads", message));
        }
        let handles = Mutex::new(Vec::new());
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .spawn_handler(|thread| {
                let name = format!("etendue-{}", thread.index());
                let handle = std::thread::Builder::new().name(name).spawn(|| thread.run())?;
                lock(&handles).push(handle);
                Ok(())
            })
            .build()
            .map_err(|error| Error::new(ErrorKind::Device, "the worker threads could not be started").because(error))?;
        let threads = pool.current_num_threads();
        Ok(Self(Arc::new(WorkerKind::Pool(Pool { pool: Some(pool), threads, handles }))))
    }

    /// The thread that renders, and no other.
    pub fn calling_thread() -> Self {
        Self(Arc::new(WorkerKind::Calling))
    }

    /// Threads of somebody else: `submit` is given jobs to run once each, on whichever thread and whenever it likes.
    ///
    /// The thread that renders works too and submits `threads - 1` helpers for each pass. A job that is run late finds
    /// nothing left to do, and one that is never run is missed by nobody.
    pub fn host(threads: usize, submit: impl Fn(Box<dyn FnOnce() + Send + 'static>) + Send + Sync + 'static) -> Self {
        Self(Arc::new(WorkerKind::Host { threads: threads.clamp(1, MAX_THREADS), submit: Box::new(submit) }))
    }

    /// How many threads work at once, at most.
    pub fn threads(&self) -> usize {
        match &*self.0 {
            WorkerKind::Pool(pool) => pool.threads,
            WorkerKind::Calling => 1,
            WorkerKind::Host { threads, .. } => *threads,
        }
    }

    /// Has the work done by all threads and returns when it is. `look_up` is called on the calling thread about every
    /// [`LOOK_UP`].
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] if the work panicked.
    pub(super) fn run<W: SharedWork>(&self, work: W, look_up: &mut dyn FnMut(&W)) -> Result<Arc<W>> {
        let work = Arc::new(work);
        let job = Arc::new(RunningJob::new(&work));
        // Whatever happens in `look_up`, no helper may begin after this function is left.
        let closing = CloseOnDrop(&job);
        match &*self.0 {
            WorkerKind::Pool(pool) => {
                if let Some(pool) = &pool.pool {
                    for _ in 0..work.shares().min(pool.current_num_threads()) {
                        let job = Arc::clone(&job);
                        pool.spawn_fifo(move || take_turns(job));
                    }
                }
            }
            WorkerKind::Calling => job.do_share(&work, look_up),
            WorkerKind::Host { threads, submit } => {
                for _ in 1..work.shares().min(*threads) {
                    let job = Arc::clone(&job);
                    submit(Box::new(move || {
                        job.help(None);
                    }));
                }
                job.do_share(&work, look_up);
            }
        }
        job.wait(&work, look_up);
        drop(closing);
        let has_panicked = lock(&job.state).has_panicked;
        if has_panicked { Err(Error::new(ErrorKind::Internal, "a worker thread panicked")) } else { Ok(work) }
    }
}

/// Work that several threads share.
pub(super) trait SharedWork: Send + Sync + 'static {
    /// Takes pieces of the work until none is left, or until `pause`, asked between them, says so. Returns whether none
    /// is left to be taken.
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool;

    /// Whether every piece is done, or nobody wants it any more.
    fn is_done(&self) -> bool;

    /// Gives up: no piece is to be taken any more.
    fn abandon(&self);

    /// How many threads could be of use.
    fn shares(&self) -> usize;
}

/// A piece of work under way, and the threads that work on it.
struct RunningJob<W> {
    state: Mutex<JobState<W>>,
    changed: Condvar,
}

struct JobState<W> {
    /// The work until the job is closed. After that no helper may begin, and a helper that comes late, or never, keeps
    /// nothing alive.
    work: Option<Arc<W>>,
    /// Helpers that have begun and not ended.
    helpers: usize,
    has_panicked: bool,
}

impl<W: SharedWork> RunningJob<W> {
    fn new(work: &Arc<W>) -> Self {
        let state = JobState { work: Some(Arc::clone(work)), helpers: 0, has_panicked: false };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    /// Works as a helper, for at most `turn`, unless the job is closed. Returns whether there is more to do.
    fn help(&self, turn: Option<Duration>) -> bool {
        let work = {
            let mut state = lock(&self.state);
            let Some(work) = state.work.clone() else { return false };
            state.helpers += 1;
            work
        };
        let start = Instant::now();
        let mut pause = || turn.is_some_and(|turn| start.elapsed() >= turn);
        let outcome = catch_unwind(AssertUnwindSafe(|| work.take(&mut pause)));
        if outcome.is_err() {
            work.abandon();
        }
        // Whoever waits for the helpers may rely on them to hold nothing any more.
        drop(work);
        let mut state = lock(&self.state);
        state.helpers -= 1;
        state.has_panicked |= outcome.is_err();
        self.changed.notify_all();
        matches!(outcome, Ok(false))
    }

    /// The calling thread's share of the work.
    fn do_share(&self, work: &W, look_up: &mut dyn FnMut(&W)) {
        let mut last = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            work.take(&mut || {
                if last.elapsed() >= LOOK_UP {
                    look_up(work);
                    last = Instant::now();
                }
                false
            })
        }));
        if outcome.is_err() {
            work.abandon();
            lock(&self.state).has_panicked = true;
        }
    }

    /// Waits until all is done and no helper is at it.
    fn wait(&self, work: &W, look_up: &mut dyn FnMut(&W)) {
        let mut state = lock(&self.state);
        let mut last = Instant::now();
        while state.helpers > 0 || !work.is_done() {
            state = self.changed.wait_timeout(state, LOOK_UP).unwrap_or_else(PoisonError::into_inner).0;
            if last.elapsed() >= LOOK_UP && !work.is_done() {
                drop(state);
                look_up(work);
                last = Instant::now();
                state = lock(&self.state);
            }
        }
    }
}

/// Closes a job when it is dropped: no helper may begin any more, and those that have begun are waited for.
struct CloseOnDrop<'j, W: SharedWork>(&'j RunningJob<W>);

impl<W: SharedWork> Drop for CloseOnDrop<'_, W> {
    fn drop(&mut self) {
        let mut state = lock(&self.0.state);
        if let Some(work) = state.work.take()
            && state.helpers > 0
        {
            work.abandon();
        }
        while state.helpers > 0 {
            state = self.0.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

thread_local! {
    /// Whether this thread of a pool is in the middle of a job that has given way to another.
    static HAS_GIVEN_WAY: Cell<bool> = const { Cell::new(false) };
}

/// Helps turn by turn, giving way to what else the pool has to do in between.
///
/// A thread of a pool prefers its own queue to what comes from outside, so a job that only queued up again would keep
/// later ones waiting. Instead it lets the thread run another job on top of it, and that one, if it wants a second turn,
/// queues up.
fn take_turns<W: SharedWork>(job: Arc<RunningJob<W>>) {
    if HAS_GIVEN_WAY.get() {
        if job.help(Some(TURN)) {
            // Inside a pool this is the thread's own queue.
            rayon::spawn_fifo(move || take_turns(job));
        }
        return;
    }
    while job.help(Some(TURN)) {
        HAS_GIVEN_WAY.set(true);
        rayon::yield_now();
        HAS_GIVEN_WAY.set(false);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
