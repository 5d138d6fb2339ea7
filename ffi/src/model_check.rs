//! Tests of the thread pool and of the mark of an object under loom. It runs every interleaving
//! of a few threads that the memory model allows, up to a number of preemptions.
//!
//! `.ci/loom.sh` runs these tests. A lost wake-up shows as a deadlock, and a data race or a broken
//! claim as a failure with the interleaving that leads there.

use std::ffi::c_void;
use std::panic::resume_unwind;
use std::sync::Arc;

use loom::cell::UnsafeCell;
use loom::model::Builder;
use loom::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use loom::thread;

use crate::batch_job::Shares;
use crate::in_use::InUse;
use crate::status::{Fault, JCAS_ERROR_INTERNAL};
use crate::thread_pool::{Job, ThreadPool};

/// Runs every interleaving of a model that has at most this many preemptions.
fn explore(preemptions: usize, model: impl Fn() + Sync + Send + 'static) {
    let mut builder = Builder::new();
    builder.preemption_bound = Some(preemptions);
    builder.max_branches = 100_000;
    builder.check(model);
}

/// A job that counts how often each share was run, in memory that no atomic guards.
struct Counting<'a> {
    shares: Shares<'a>,
    counts: &'a [UnsafeCell<u32>],
    /// The share whose work panics.
    panics_at: Option<usize>,
}

impl Counting<'_> {
    fn work(&self, index: usize) -> Result<(), jcas_core::Error> {
        // SAFETY: loom reports two threads in one cell.
        self.counts[index].with_mut(|count| unsafe { *count += 1 });
        if self.panics_at == Some(index) {
            // The hook would print a message for every interleaving.
            resume_unwind(Box::new(()));
        }
        Ok(())
    }

    fn job(&self) -> Job {
        Job {
            task: run_share,
            context: (&raw const *self).cast_mut().cast(),
            count: self.shares.len() as u32,
        }
    }
}

unsafe extern "C" fn run_share(job: *mut c_void, index: u32) {
    // SAFETY: `steps` below keeps the job until the pool has run it.
    let job = unsafe { &*job.cast::<Counting<'_>>() };
    let index = index as usize;
    job.shares.take(index, || job.work(index));
}

/// Runs the life cycle of a batch: a pool with a number of threads, some jobs, then its end.
fn life(threads: usize, spins: u32, jobs: u32, shares: usize, panics_at: Option<usize>) {
    let pool = Arc::new(ThreadPool::with_spins(threads as u32, spins));
    let ended = Arc::new(AtomicUsize::new(0));
    let handles: Vec<_> = (0..threads)
        .map(|_| {
            let (pool, ended) = (Arc::clone(&pool), Arc::clone(&ended));
            thread::spawn(move || {
                pool.work();
                ended.fetch_add(1, Ordering::Release);
            })
        })
        .collect();
    let taken: Vec<_> = (0..shares).map(|_| AtomicBool::new(true)).collect();
    let counts: Vec<_> = (0..shares).map(|_| UnsafeCell::new(0)).collect();
    for done in 1..=jobs {
        let job = Counting {
            shares: Shares::new(&taken),
            counts: &counts,
            panics_at,
        };
        pool.run(job.job());
        let came_to = job.shares.finish(|index| job.work(index));
        let expected = match panics_at {
            Some(_) => Err(Fault::Status(JCAS_ERROR_INTERNAL)),
            None => Ok(()),
        };
        assert_eq!(came_to, expected);
        for count in &counts {
            // SAFETY: loom reports a thread that is still at work.
            count.with(|count| assert_eq!(unsafe { *count }, done));
        }
    }
    pool.quit();
    for handle in handles {
        handle.join().expect("a thread of the pool ends");
    }
    assert_eq!(ended.load(Ordering::Acquire), threads);
}

#[test]
fn two_threads_run_each_share_once() {
    explore(3, || life(1, 0, 2, 2, None));
}

#[test]
fn two_threads_that_spin_run_each_share_once() {
    explore(3, || life(1, 1, 2, 2, None));
}

#[test]
fn three_threads_run_each_share_once() {
    explore(2, || life(2, 0, 2, 3, None));
}

#[test]
fn three_threads_that_spin_run_each_share_once() {
    explore(2, || life(2, 1, 1, 2, None));
}

#[test]
fn a_panic_ends_the_step_with_a_status() {
    explore(3, || life(1, 0, 2, 2, Some(1)));
    explore(2, || life(2, 0, 1, 2, Some(0)));
}

#[test]
fn a_pool_that_never_worked_ends() {
    explore(3, || life(1, 1, 0, 0, None));
    explore(3, || life(2, 1, 0, 0, None));
}

/// A step whose tasks run on threads of the caller sees all their writes before it returns.
#[test]
fn a_step_waits_for_the_callers_threads() {
    explore(3, || {
        let taken: Vec<_> = (0..2).map(|_| AtomicBool::new(true)).collect();
        let counts: Vec<_> = (0..2).map(|_| UnsafeCell::new(0)).collect();
        let job = Counting {
            shares: Shares::new(&taken),
            counts: &counts,
            panics_at: None,
        };
        let tasks = job.job();
        let caller = thread::spawn(move || {
            let Job {
                task,
                context,
                count,
            } = { tasks };
            for index in 0..count {
                // SAFETY: the job lives until this thread has been joined.
                unsafe { task(context, index) };
            }
        });
        assert_eq!(job.shares.finish(|index| job.work(index)), Ok(()));
        for count in &counts {
            // SAFETY: loom reports a thread that is still at work.
            count.with(|count| assert_eq!(unsafe { *count }, 1));
        }
        caller.join().expect("a thread of the caller ends");
    });
}

/// A call that changes an object has it alone, and calls that read it see all its writes.
#[test]
fn one_call_at_a_time_changes_an_object() {
    explore(3, || {
        let object = Arc::new((InUse::new(), UnsafeCell::new(0u32)));
        let changed = Arc::new(AtomicUsize::new(0));
        let threads: Vec<_> = (0..2)
            .map(|_| {
                let (object, changed) = (Arc::clone(&object), Arc::clone(&changed));
                thread::spawn(move || {
                    if let Ok(_mark) = object.0.change() {
                        // SAFETY: loom reports two threads in the cell.
                        object.1.with_mut(|value| unsafe { *value += 1 });
                        changed.fetch_add(1, Ordering::Relaxed);
                    }
                })
            })
            .collect();
        for _ in 0..2 {
            if let Ok(_mark) = object.0.read() {
                // SAFETY: as above.
                object.1.with(|value| assert!(unsafe { *value } <= 2));
            }
        }
        for thread in threads {
            thread.join().expect("a thread ends");
        }
        assert!(object.0.change().is_ok(), "the mark is released");
        // SAFETY: as above.
        let value = object.1.with(|value| unsafe { *value });
        assert_eq!(value as usize, changed.load(Ordering::Relaxed));
    });
}
