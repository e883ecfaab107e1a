//! The threads that do the work of a render: a pool, the calling thread, or threads of the host.

use std::cell::Cell;
use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use crate::control::PROGRESS_INTERVAL;
use crate::error::{Error, ErrorKind, Result};

/// Greatest number of worker threads of a render.
pub const MAX_THREADS: usize = 1024;

/// Time for which a thread of a pool works on one render before it works on other renders that share the pool.
const TURN: Duration = Duration::from_millis(10);

/// A job for a host's executor.
type HostJob = Box<dyn FnOnce() + Send + 'static>;

/// Threads that render. Clones are cheap, and any number of renders may share the threads. No image depends on the threads.
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

/// A rayon pool whose threads have ended once it is dropped.
struct Pool {
    pool: Option<rayon::ThreadPool>,
    threads: usize,
    handles: Mutex<Vec<JoinHandle<()>>>,
    /// The process that has the threads. A child of it has only the thread that made the child.
    process: u32,
}

impl Drop for Pool {
    fn drop(&mut self) {
        let handles = std::mem::take(&mut *lock(&self.handles));
        if self.process != std::process::id() {
            // No thread is there to be ended, and what the threads held is held for ever.
            std::mem::forget((self.pool.take(), handles));
            return;
        }
        drop(self.pool.take());
        let own = std::thread::current().id();
        for handle in handles {
            // The last clone may be dropped by a job of the pool itself, which cannot wait for itself to end.
            if handle.thread().id() != own {
                let _ = handle.join();
            }
        }
    }
}

impl Workers {
    /// Starts a pool of `threads` threads; 0 means one for each core. Renders that share a pool take turns.
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
        Ok(Self(Arc::new(WorkerKind::Pool(Pool { pool: Some(pool), threads, handles, process: std::process::id() }))))
    }

    /// The calling thread of a render, and no other thread.
    pub fn calling_thread() -> Self {
        Self(Arc::new(WorkerKind::Calling))
    }

    /// Threads of the host: `submit` receives jobs, each to be run once, on any thread and at any time.
    ///
    /// The thread that renders works too and submits up to `threads - 1` helper jobs for each pass, and for other work that
    /// threads share, such as the estimate of errors at the end. A job that is run late returns at once, and the render does
    /// not wait for jobs that never run.
    pub fn host(threads: usize, submit: impl Fn(Box<dyn FnOnce() + Send + 'static>) + Send + Sync + 'static) -> Self {
        Self(Arc::new(WorkerKind::Host { threads: threads.clamp(1, MAX_THREADS), submit: Box::new(submit) }))
    }

    /// Greatest number of threads that work at the same time.
    pub fn threads(&self) -> usize {
        match &*self.0 {
            WorkerKind::Pool(pool) => pool.threads,
            WorkerKind::Calling => 1,
            WorkerKind::Host { threads, .. } => *threads,
        }
    }

    /// Whether the threads are there: those of a pool are only in the process that made it, not in one that was forked from it.
    pub fn are_there(&self) -> bool {
        match &*self.0 {
            WorkerKind::Pool(pool) => pool.process == std::process::id(),
            WorkerKind::Calling | WorkerKind::Host { .. } => true,
        }
    }

    /// Does the work on all threads and returns once it is done. `poll` is called on the calling thread about every
    /// [`SharedWork::poll_interval`].
    ///
    /// # Errors
    /// [`ErrorKind::Internal`] if the work panicked, [`ErrorKind::Unsupported`] for a pool of the process that this one was
    /// forked from.
    pub(super) fn run<W: SharedWork>(&self, work: W, poll: &mut dyn FnMut(&W)) -> Result<Arc<W>> {
        if !self.are_there() {
            let message = "the threads are those of the process that this one was forked from, expected threads that were \
                 started after the fork";
            return Err(Error::new(ErrorKind::Unsupported, message));
        }
        let work = Arc::new(work);
        let job = Arc::new(RunningJob::new(&work));
        // No helper may begin after this function has returned, even if `poll` panics.
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
            WorkerKind::Calling => job.do_share(&work, poll),
            WorkerKind::Host { threads, submit } => {
                for _ in 1..work.shares().min(*threads) {
                    let job = Arc::clone(&job);
                    submit(Box::new(move || {
                        job.help(None);
                    }));
                }
                job.do_share(&work, poll);
            }
        }
        job.wait(&work, poll);
        drop(closing);
        let has_panicked = lock(&job.state).has_panicked;
        if has_panicked { Err(Error::new(ErrorKind::Internal, "a worker thread panicked")) } else { Ok(work) }
    }
}

/// Work that several threads share.
pub(super) trait SharedWork: Send + Sync + 'static {
    /// Does pieces of the work until none is left, or until `pause`, which is called between pieces, returns `true`. Returns
    /// whether no piece is left.
    fn take(&self, pause: &mut dyn FnMut() -> bool) -> bool;

    /// Whether every piece is done, or the work was stopped.
    fn is_done(&self) -> bool;

    /// Stops the work: no further piece is begun.
    fn abandon(&self);

    /// Greatest number of threads that the work can occupy.
    fn shares(&self) -> usize;

    /// Time between two calls of `poll`.
    fn poll_interval(&self) -> Duration {
        PROGRESS_INTERVAL
    }
}

/// A piece of work under way, and the threads that work on it.
struct RunningJob<W> {
    state: Mutex<JobState<W>>,
    changed: Condvar,
}

struct JobState<W> {
    /// The work; `None` once the job is closed. No helper begins on a closed job, and a job that a host runs late or never
    /// keeps no scene or film in memory.
    work: Option<Arc<W>>,
    /// Number of helpers that have begun and not ended.
    helpers: usize,
    has_panicked: bool,
}

impl<W: SharedWork> RunningJob<W> {
    fn new(work: &Arc<W>) -> Self {
        let state = JobState { work: Some(Arc::clone(work)), helpers: 0, has_panicked: false };
        Self { state: Mutex::new(state), changed: Condvar::new() }
    }

    /// Works as a helper for at most `turn`, unless the job is closed. Returns whether pieces are left.
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
        // Threads that wait for helpers rely on ended helpers to hold no reference to the work.
        drop(work);
        let mut state = lock(&self.state);
        state.helpers -= 1;
        state.has_panicked |= outcome.is_err();
        self.changed.notify_all();
        matches!(outcome, Ok(false))
    }

    /// The calling thread's share of the work.
    fn do_share(&self, work: &W, poll: &mut dyn FnMut(&W)) {
        let mut last = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            work.take(&mut || {
                if last.elapsed() >= work.poll_interval() {
                    poll(work);
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

    /// Waits until the work is done and every helper has ended.
    fn wait(&self, work: &W, poll: &mut dyn FnMut(&W)) {
        let mut state = lock(&self.state);
        let mut last = Instant::now();
        while state.helpers > 0 || !work.is_done() {
            let interval = work.poll_interval();
            state = self.changed.wait_timeout(state, interval).unwrap_or_else(PoisonError::into_inner).0;
            if last.elapsed() >= interval && !work.is_done() {
                drop(state);
                poll(work);
                last = Instant::now();
                state = lock(&self.state);
            }
        }
    }
}

/// Closes a job when it is dropped: no further helper may begin, and the drop waits for the helpers that have begun.
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
    /// Whether this thread of a pool runs a job inside [`rayon::yield_now`] of another job.
    static IS_NESTED: Cell<bool> = const { Cell::new(false) };
}

/// Helps in turns of [`TURN`], between which the thread runs other jobs of the pool.
///
/// A thread of a rayon pool prefers its own queue to jobs from outside. A job that only queued itself again would therefore
/// keep jobs from outside waiting. Instead, a job that has used its turn calls [`rayon::yield_now`], which runs another job
/// on the same stack. A nested job that has used its turn queues itself again.
fn take_turns<W: SharedWork>(job: Arc<RunningJob<W>>) {
    if IS_NESTED.get() {
        if job.help(Some(TURN)) {
            // On a thread of a pool, this function uses the thread's own queue.
            rayon::spawn_fifo(move || take_turns(job));
        }
        return;
    }
    while job.help(Some(TURN)) {
        IS_NESTED.set(true);
        rayon::yield_now();
        IS_NESTED.set(false);
    }
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
