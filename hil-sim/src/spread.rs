//! Many runs on all processors, with results in the order of the runs however many processors
//! there are.

use std::num::NonZero;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use crate::interrupt;

/// How many runs go at the same time where nothing else is said: one per processor.
#[must_use]
pub fn processors() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// What `work` makes of each of `items`, in their order, by as many threads as `workers`, one at
/// least. `progress` is told how many of how many are done. None where a signal ended it
/// ([`interrupt`]).
///
/// # Errors
/// The first in the order of the items. What was not begun by then is not made.
pub fn in_order<I: Sync, T: Send, E: Send>(
    items: &[I],
    workers: usize,
    progress: impl Fn(usize, usize) + Sync,
    work: impl Fn(&I) -> Result<T, E> + Sync,
) -> Result<Option<Vec<T>>, E> {
    let (next, done) = (AtomicUsize::new(0), AtomicUsize::new(0));
    let worker = || {
        let mut made = Vec::new();
        while interrupt::stop().is_none() {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(item) = items.get(index) else { break };
            let result = work(item);
            if result.is_err() {
                // Whatever comes before it has been begun.
                next.store(items.len(), Ordering::Relaxed);
            }
            made.push((index, result));
            progress(done.fetch_add(1, Ordering::Relaxed) + 1, items.len());
        }
        made
    };
    let mut made = thread::scope(|scope| {
        let threads = 0..workers.min(items.len()).max(1);
        let threads: Vec<_> = threads.map(|_| scope.spawn(worker)).collect();
        let mut made = Vec::with_capacity(items.len());
        for thread in threads {
            match thread.join() {
                Ok(part) => made.extend(part),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        made
    });
    made.sort_by_key(|(index, _)| *index);
    let results: Vec<T> = made
        .into_iter()
        .map(|(_, result)| result)
        .collect::<Result<_, _>>()?;
    Ok(interrupt::stop().is_none().then_some(results))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_are_in_order_by_any_number_of_threads() {
        let items: Vec<u32> = (0..100).collect();
        let expected: Vec<_> = items.iter().map(|n| n * n).collect();
        for workers in [0, 1, 2, 7, 1000] {
            let seen = AtomicUsize::new(0);
            let made = in_order(
                &items,
                workers,
                |_, all| {
                    assert_eq!(all, 100);
                    seen.fetch_add(1, Ordering::Relaxed);
                },
                |n| Ok::<_, ()>(n * n),
            );
            assert_eq!(made, Ok(Some(expected.clone())));
            assert_eq!(seen.into_inner(), 100);
        }
        let nothing = in_order(&[], 2, |_, _| (), |n: &u32| Ok::<_, ()>(*n));
        assert_eq!(nothing, Ok(Some(Vec::new())));
    }

    #[test]
    fn the_first_error_is_that_of_the_first_item() {
        let items: Vec<u32> = (0..100).collect();
        for workers in [1, 4] {
            let work = |n: &u32| if *n % 30 == 29 { Err(*n) } else { Ok(*n) };
            assert_eq!(in_order(&items, workers, |_, _| (), work), Err(29));
        }
    }
}
