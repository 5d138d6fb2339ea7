//! The threads of a batch, which start when it is built and are joined when it is freed. Running a
//! job allocates nothing.
//!
//! `ffi/src/model_check.rs` runs all interleavings of a small pool.

use std::ffi::c_void;
use std::sync::PoisonError;

use crate::sync::{AtomicU32, Condvar, Mutex, MutexGuard, Ordering, spin_loop};

/// Tests of a waiting thread before it sleeps. They take some tens of microseconds on present x86
/// processors, and less on others. Waking a thread takes as long, and a caller in a loop returns
/// within that time.
const SPINS: u32 = 1000;

pub(crate) type Task = unsafe extern "C" fn(*mut c_void, u32);

/// Tasks with the indices 0 to `count` - 1. They may run in any order, concurrently and more than
/// once.
#[derive(Clone, Copy)]
pub(crate) struct Job {
    pub(crate) task: Task,
    pub(crate) context: *mut c_void,
    pub(crate) count: u32,
}

// SAFETY: a job is made for tasks that any thread may run.
unsafe impl Send for Job {}

/// The orders for the threads.
struct Orders {
    job: Option<Job>,
    quit: bool,
}

/// A thread pool that runs one job at a time together with the caller's thread.
pub(crate) struct ThreadPool {
    orders: Mutex<Orders>,
    /// Number of threads that have started.
    started: AtomicU32,
    /// Number of the present job. Like `working`, it is written under the lock of `orders` and read
    /// without it.
    jobs: AtomicU32,
    /// Number of threads that have not finished the present job.
    working: AtomicU32,
    /// Number of threads of the pool, without the caller's.
    threads: u32,
    /// Number of tests before a thread sleeps.
    spins: u32,
    job_given: Condvar,
    job_done: Condvar,
}

impl ThreadPool {
    /// Builds a pool for `threads` threads and the caller's. Spinning is disabled when there are no
    /// more processors than `threads`.
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

    /// Spins until a condition holds, for a limited number of tests.
    fn spin_until(&self, holds: impl Fn() -> bool) {
        for _ in 0..self.spins {
            if holds() {
                return;
            }
            spin_loop();
        }
    }

    /// Runs every task of a job. Each thread begins at another task, whose data is in its cache
    /// from the last step. A task that another thread has taken returns at once.
    fn run_tasks(&self, job: Job, place: u32) {
        let first = u64::from(job.count) * u64::from(place) / (u64::from(self.threads) + 1);
        let first = first as u32;
        for index in (first..job.count).chain(0..first) {
            // SAFETY: the job lives until `run` returns, which waits for every thread.
            unsafe { (job.task)(job.context, index) };
        }
    }

    /// Orders the threads to end.
    pub(crate) fn quit(&self) {
        self.orders().quit = true;
        self.job_given.notify_all();
    }

    /// The main function of each thread: it runs job after job until the order to quit.
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

/// POSIX threads, used directly because starting a thread of the standard library allocates and
/// aborts if that fails.
#[cfg(unix)]
mod system {
    use std::mem::MaybeUninit;
    use std::ptr;

    use super::ThreadPool;

    pub(crate) type Thread = libc::pthread_t;

    /// Starts a thread of a pool. The result is `None` if the system refuses.
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

    /// Returns the number of processors of the machine, at least 1.
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

    /// Starts a thread of a pool. The result is `None` if the system refuses.
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

    /// Returns the number of processors of the machine, at least 1.
    pub(crate) fn processors() -> usize {
        available_parallelism().map_or(1, usize::from)
    }
}
