//! The threads of a batch: started when it is built, joined when it ends. Handing out work
//! allocates nothing.
//!
//! `ffi/src/model_check.rs` runs all interleavings of a small pool.

use std::ffi::c_void;
use std::sync::PoisonError;

use crate::sync::{AtomicU32, Condvar, Mutex, MutexGuard, Ordering, spin_loop};

/// How often a thread tests whether it may go on before it sleeps: some tens of microseconds on
/// present x86 processors, less on others. Waking it takes as long, and a caller in a loop is back
/// by then.
const SPINS: u32 = 1000;

pub(crate) type Task = unsafe extern "C" fn(*mut c_void, u32);

/// Tasks with the numbers 0 to `count` - 1. Any order will do, also at once, also twice.
#[derive(Clone, Copy)]
pub(crate) struct Job {
    pub(crate) task: Task,
    pub(crate) context: *mut c_void,
    pub(crate) count: u32,
}

// SAFETY: a job is made for tasks that any thread may run.
unsafe impl Send for Job {}

/// What the threads are to do.
struct Orders {
    job: Option<Job>,
    quit: bool,
}

/// A number of threads that run the tasks of one job at a time together with the caller's.
pub(crate) struct ThreadPool {
    orders: Mutex<Orders>,
    /// Threads that have begun to work.
    started: AtomicU32,
    /// Rises by one with each job. As `working`, it is written under the lock of `orders` and read
    /// without it.
    jobs: AtomicU32,
    /// Threads that have not finished the present job.
    working: AtomicU32,
    /// Threads of the pool, beside the caller's.
    threads: u32,
    /// Tests before a thread sleeps.
    spins: u32,
    job_given: Condvar,
    job_done: Condvar,
}

impl ThreadPool {
    /// A pool for `threads` threads beside the caller's. Where the machine has no more processors
    /// than that, a thread that spins would keep another from its work, so that none does.
    pub(crate) fn new(threads: u32) -> Self {
        let spins = if (threads as usize) < processors() {
            SPINS
        } else {
            0
        };
        Self::with_spins(threads, spins)
    }

    pub(crate) fn with_spins(threads: u32, spins: u32) -> Self {
        let orders = Orders {
            job: None,
            quit: false,
        };
        Self {
            orders: Mutex::new(orders),
            started: AtomicU32::new(0),
            jobs: AtomicU32::new(0),
            working: AtomicU32::new(0),
            threads,
            spins,
            job_given: Condvar::new(),
            job_done: Condvar::new(),
        }
    }

    fn orders(&self) -> MutexGuard<'_, Orders> {
        self.orders.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Runs a job on all threads and this one, and returns when it is done.
    pub(crate) fn run(&self, job: Job) {
        let mut orders = self.orders();
        orders.job = Some(job);
        self.working.store(self.threads, Ordering::Relaxed);
        self.jobs.fetch_add(1, Ordering::Release);
        drop(orders);
        self.job_given.notify_all();
        self.run_tasks(job, 0);
        let done = || self.working.load(Ordering::Acquire) == 0;
        self.spin_until(done);
        let mut orders = self.orders();
        while !done() {
            orders = (self.job_done.wait(orders)).unwrap_or_else(PoisonError::into_inner);
        }
        orders.job = None;
    }

    /// Waits until a condition holds, but not for long.
    fn spin_until(&self, holds: impl Fn() -> bool) {
        for _ in 0..self.spins {
            if holds() {
                return;
            }
            spin_loop();
        }
    }

    /// Runs every task of a job, from a first one on that differs between threads: the data that a
    /// thread wrote in the last step is in its cache. A task that another thread has taken returns
    /// at once.
    fn run_tasks(&self, job: Job, place: u32) {
        let first = u64::from(job.count) * u64::from(place) / (u64::from(self.threads) + 1);
        let first = first as u32;
        for index in (first..job.count).chain(0..first) {
            // SAFETY: the job lives until `run` returns, which waits for every thread.
            unsafe { (job.task)(job.context, index) };
        }
    }

    /// Tells the threads to end.
    pub(crate) fn quit(&self) {
        self.orders().quit = true;
        self.job_given.notify_all();
    }

    /// What each thread of the pool does: job after job, until it is told to quit.
    pub(crate) fn work(&self) {
        let place = 1 + self.started.fetch_add(1, Ordering::Relaxed);
        let mut done = 0;
        loop {
            let given = || self.jobs.load(Ordering::Acquire) != done;
            self.spin_until(given);
            let mut orders = self.orders();
            while !given() && !orders.quit {
                orders = (self.job_given.wait(orders)).unwrap_or_else(PoisonError::into_inner);
            }
            if orders.quit {
                return;
            }
            done = self.jobs.load(Ordering::Relaxed);
            let job = orders.job;
            drop(orders);
            if let Some(job) = job {
                self.run_tasks(job, place);
            }
            let orders = self.orders();
            let last = self.working.fetch_sub(1, Ordering::Release) == 1;
            drop(orders);
            if last {
                self.job_done.notify_one();
            }
        }
    }
}

extern "C" fn work(pool: *mut c_void) -> *mut c_void {
    // SAFETY: a pool outlives its threads: its owner joins them first.
    unsafe { &*pool.cast::<ThreadPool>() }.work();
    std::ptr::null_mut()
}

pub(crate) use system::{Thread, join, processors, start};

/// POSIX threads themselves: the standard library's allocate on the way, and abort where they
/// cannot.
#[cfg(unix)]
mod system {
    use std::mem::MaybeUninit;
    use std::ptr;

    use super::ThreadPool;

    pub(crate) type Thread = libc::pthread_t;

    /// Starts a thread of a pool; `None` if the system has none.
    ///
    /// # Safety
    /// The pool stays where it is until the thread has been joined.
    pub(crate) unsafe fn start(pool: *const ThreadPool) -> Option<Thread> {
        let mut thread = MaybeUninit::uninit();
        // SAFETY: `thread` is a place for a thread; the pool lives by the caller's promise.
        let failed = unsafe {
            libc::pthread_create(
                thread.as_mut_ptr(),
                ptr::null(),
                super::work,
                pool.cast_mut().cast(),
            )
        };
        // SAFETY: written where the thread was created.
        (failed == 0).then(|| unsafe { thread.assume_init() })
    }

    /// Waits for a thread to end.
    ///
    /// # Safety
    /// The thread came from [`start`] in this process and was not joined before.
    pub(crate) unsafe fn join(thread: Thread) {
        // SAFETY: a thread that can be joined, by the caller's promise.
        unsafe { libc::pthread_join(thread, ptr::null_mut()) };
    }

    /// Processors of the machine, at least 1.
    pub(crate) fn processors() -> usize {
        // SAFETY: a question without side effects.
        let count = unsafe { libc::sysconf(libc::_SC_NPROCESSORS_ONLN) };
        usize::try_from(count).unwrap_or(1).max(1)
    }
}

#[cfg(not(unix))]
mod system {
    use std::thread::{Builder, JoinHandle, available_parallelism};

    use super::ThreadPool;

    pub(crate) type Thread = JoinHandle<()>;

    /// Starts a thread of a pool; `None` if the system has none.
    ///
    /// # Safety
    /// The pool stays where it is until the thread has been joined.
    pub(crate) unsafe fn start(pool: *const ThreadPool) -> Option<Thread> {
        let address = pool.expose_provenance();
        let work = move || {
            super::work(std::ptr::with_exposed_provenance_mut(address));
        };
        Builder::new().spawn(work).ok()
    }

    /// Waits for a thread to end.
    ///
    /// # Safety
    /// None is needed: the handle joins its own thread.
    pub(crate) unsafe fn join(thread: Thread) {
        let _ended = thread.join();
    }

    /// Processors of the machine, at least 1.
    pub(crate) fn processors() -> usize {
        available_parallelism().map_or(1, usize::from)
    }
}
