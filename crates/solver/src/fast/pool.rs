//! Tasks on threads.

use std::marker::PhantomData;
use std::sync::Arc;

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
