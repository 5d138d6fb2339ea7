//! Threads of a batch: started when it is built, joined when it ends. Handing out work allocates nothing.

use std::ffi::c_void;
use std::sync::atomic::{AtomicU32, Ordering};
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// How often a thread looks whether it may go on before it sleeps: some tens of microseconds on present x86 processors,
/// less on others, which is what waking it takes, and in which a caller in a loop is back.
const LOOKS: u32 = 1000;

pub(crate) type Task = unsafe extern "C" fn(*mut c_void, u32);

/// Tasks with the numbers 0 to `count` - 1. Any order will do, also at once, also twice.
#[derive(Clone, Copy)]
pub(crate) struct Job {
    pub(crate) task: Task,
    pub(crate) context: *mut c_void,
    pub(crate) count: u32,
}

// SAFETY: whoever makes a job lets any thread run its tasks.
unsafe impl Send for Job {}

/// What the threads are to do.
struct Orders {
    job: Option<Job>,
    quit: bool,
}

pub(crate) struct Team {
    orders: Mutex<Orders>,
    /// Threads that have begun to serve.
    serving: AtomicU32,
    /// Rises by one with each job. As `working`, written by who holds the orders, for all to see.
    round: AtomicU32,
    /// Threads that have not finished the present job.
    working: AtomicU32,
    /// All of them, beside the caller's.
    threads: u32,
    looks: u32,
    begin: Condvar,
    end: Condvar,
}

impl Team {
    /// Of so many threads beside the caller's. Where there are not as many processors, who looks would only keep
    /// another from its work.
    pub(crate) fn new(threads: u32) -> Self {
        Self {
            orders: Mutex::new(Orders {
                job: None,
                quit: false,
            }),
            serving: AtomicU32::new(0),
            round: AtomicU32::new(0),
            working: AtomicU32::new(0),
            threads,
            looks: if (threads as usize) < processors() {
                LOOKS
            } else {
                0
            },
            begin: Condvar::new(),
            end: Condvar::new(),
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
        self.round.fetch_add(1, Ordering::Release);
        drop(orders);
        self.begin.notify_all();
        self.take_tasks(job, 0);
        let done = || self.working.load(Ordering::Acquire) == 0;
        self.look_for(done);
        let mut orders = self.orders();
        while !done() {
            orders = self
                .end
                .wait(orders)
                .unwrap_or_else(PoisonError::into_inner);
        }
        orders.job = None;
    }

    /// Waits for something to become true, but not for long.
    fn look_for(&self, happened: impl Fn() -> bool) {
        for _ in 0..self.looks {
            if happened() {
                return;
            }
            std::hint::spin_loop();
        }
    }

    /// Runs what no other thread has taken of a job, each from a place of its own on: what it wrote in the last
    /// step is in its cache.
    fn take_tasks(&self, job: Job, place: u32) {
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
        self.begin.notify_all();
    }

    /// What each thread does: job after job, until it is told to quit.
    fn serve(&self) {
        let place = 1 + self.serving.fetch_add(1, Ordering::Relaxed);
        let mut done = 0;
        loop {
            let called = || self.round.load(Ordering::Acquire) != done;
            self.look_for(called);
            let mut orders = self.orders();
            while !called() && !orders.quit {
                orders = self
                    .begin
                    .wait(orders)
                    .unwrap_or_else(PoisonError::into_inner);
            }
            if orders.quit {
                return;
            }
            done = self.round.load(Ordering::Relaxed);
            let job = orders.job;
            drop(orders);
            if let Some(job) = job {
                self.take_tasks(job, place);
            }
            let orders = self.orders();
            let last = self.working.fetch_sub(1, Ordering::Release) == 1;
            drop(orders);
            if last {
                self.end.notify_one();
            }
        }
    }
}

extern "C" fn serve(team: *mut c_void) -> *mut c_void {
    // SAFETY: a team outlives its threads: its owner joins them first.
    unsafe { &*team.cast::<Team>() }.serve();
    std::ptr::null_mut()
}

pub(crate) use system::{Thread, join, processors, start};

/// POSIX threads themselves: the standard library's allocate on the way, and abort where they cannot.
#[cfg(unix)]
mod system {
    use std::mem::MaybeUninit;
    use std::ptr;

    use super::Team;

    pub(crate) type Thread = libc::pthread_t;

    /// Starts a thread of a team; `None` if the system has none.
    ///
    /// # Safety
    /// The team stays where it is until the thread has been joined.
    pub(crate) unsafe fn start(team: *const Team) -> Option<Thread> {
        let mut thread = MaybeUninit::uninit();
        // SAFETY: `thread` is a place for a thread; the team lives by the caller's promise.
        let failed = unsafe {
            libc::pthread_create(
                thread.as_mut_ptr(),
                ptr::null(),
                super::serve,
                team.cast_mut().cast(),
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

    use super::Team;

    pub(crate) type Thread = JoinHandle<()>;

    /// Starts a thread of a team; `None` if the system has none.
    ///
    /// # Safety
    /// The team stays where it is until the thread has been joined.
    pub(crate) unsafe fn start(team: *const Team) -> Option<Thread> {
        let address = team.expose_provenance();
        let serve = move || {
            super::serve(std::ptr::with_exposed_provenance_mut(address));
        };
        Builder::new().spawn(serve).ok()
    }

    /// Waits for a thread to end.
    ///
    /// # Safety
    /// None: the handle says it all.
    pub(crate) unsafe fn join(thread: Thread) {
        let _ended = thread.join();
    }

    /// Processors of the machine, at least 1.
    pub(crate) fn processors() -> usize {
        available_parallelism().map_or(1, usize::from)
    }
}
