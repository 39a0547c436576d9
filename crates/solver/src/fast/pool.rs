//! Tasks on threads.

use std::marker::PhantomData;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};

use rayon::prelude::*;

/// The threads that share a step, or none but the caller's.
#[derive(Clone, Debug, Default)]
pub(crate) struct Pool(Option<Arc<rayon::ThreadPool>>);

impl Pool {
    /// A pool of so many threads; of one where more cannot be had.
    pub fn new(threads: usize) -> Self {
        if threads < 2 {
            return Pool(None);
        }
        Pool(rayon::ThreadPoolBuilder::new().num_threads(threads).build().ok().map(Arc::new))
    }

    /// `job` on one of the threads, whose parallel parts then need not wake the pool up each time.
    pub fn enter<R: Send>(&self, job: impl FnOnce() -> R + Send) -> R {
        match &self.0 {
            Some(pool) => pool.install(job),
            None => job(),
        }
    }

    /// What `task(scratch, 0..count)` give, in this order; `least` tasks and more go to a thread at a time. Tasks that share a thread may
    /// share scratch memory, which must not show in what they do.
    pub fn run<S, R: Send>(
        &self,
        count: usize,
        least: usize,
        scratch: impl Fn() -> S + Sync + Send,
        task: impl Fn(&mut S, usize) -> R + Sync + Send,
    ) -> Vec<R> {
        match &self.0 {
            Some(pool) if count > least => pool.install(|| {
                (0..count).into_par_iter().with_min_len(least).map_init(&scratch, &task).collect()
            }),
            _ => {
                let mut scratch = scratch();
                (0..count).map(|number| task(&mut scratch, number)).collect()
            }
        }
    }

    /// Runs `work(scratch, k)` and then `commit(scratch, k)` for all k below `count`. Work is done side by side; the commit of k begins when
    /// `turn(k)` commits have ended, which must be those of the numbers below `turn(k)`: turn(k) <= k, and it never falls as k grows.
    pub fn run_in_turns<S>(
        &self,
        count: usize,
        turn: impl Fn(usize) -> usize + Sync,
        scratch: impl Fn() -> S + Sync,
        work: impl Fn(&mut S, usize) + Sync,
        commit: impl Fn(&mut S, usize) + Sync,
    ) {
        let Some(pool) = self.0.as_ref().filter(|_| count > 1) else {
            let mut scratch = scratch();
            for k in 0..count {
                work(&mut scratch, k);
                commit(&mut scratch, k);
            }
            return;
        };
        // Numbers are handed out in order, so that whoever waits waits for a thread that is at work. No commit of a turn begins before all
        // of the turns before have ended: their count says which have.
        let next = AtomicUsize::new(0);
        let turns = Turns { committed: AtomicUsize::new(0), broken: AtomicBool::new(false) };
        pool.broadcast(|_| {
            let mut scratch = scratch();
            loop {
                let k = next.fetch_add(1, Ordering::Relaxed);
                if k >= count {
                    return;
                }
                let broken = BreaksOff(&turns);
                work(&mut scratch, k);
                if !turns.wait_for(turn(k)) {
                    return;
                }
                commit(&mut scratch, k);
                std::mem::forget(broken);
                turns.committed.fetch_add(1, Ordering::Release);
            }
        });
    }
}

/// Commits that have ended, and whether one never will.
struct Turns {
    committed: AtomicUsize,
    broken: AtomicBool,
}

impl Turns {
    /// Waits, at first without giving the core away, until `least` commits have ended; `false` if they never will.
    fn wait_for(&self, least: usize) -> bool {
        // chosen: some tens of microseconds, about as long as it takes to be scheduled again.
        const SPINS: usize = 1000;
        let mut spins = 0;
        while self.committed.load(Ordering::Acquire) < least {
            if self.broken.load(Ordering::Acquire) {
                return false;
            }
            if spins < SPINS {
                spins += 1;
                std::hint::spin_loop();
            } else {
                std::thread::yield_now();
            }
        }
        true
    }
}

/// Dropped by a task that panics, or gives up: nobody need wait for it.
struct BreaksOff<'a>(&'a Turns);

impl Drop for BreaksOff<'_> {
    fn drop(&mut self) {
        self.0.broken.store(true, Ordering::Release);
    }
}

/// A slice that tasks write to, each to a part of its own.
pub(crate) struct Shared<'a, V> {
    first: *mut V,
    len: usize,
    owner: PhantomData<&'a mut [V]>,
}

#[expect(unsafe_code, reason = "a slice shared by tasks")]
// SAFETY: all access goes through `range`, whose callers answer for the parts being apart.
unsafe impl<V: Send> Sync for Shared<'_, V> {}

impl<'a, V> Shared<'a, V> {
    pub fn new(slice: &'a mut [V]) -> Self {
        Shared { first: slice.as_mut_ptr(), len: slice.len(), owner: PhantomData }
    }

    /// Elements `first .. first + count`.
    ///
    /// # Safety
    /// Nobody else may hold any of them at the same time.
    #[expect(unsafe_code, reason = "a slice shared by tasks")]
    #[expect(clippy::mut_from_ref, reason = "the caller answers for the parts being apart")]
    #[inline(always)]
    pub unsafe fn range(&self, first: usize, count: usize) -> &mut [V] {
        assert!(first + count <= self.len, "a part of the slice");
        // SAFETY: in bounds, and not held by anybody else.
        unsafe { std::slice::from_raw_parts_mut(self.first.add(first), count) }
    }
}
