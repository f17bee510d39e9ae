//! The pool of threads that works through the episodes of a bench, the trials of skills and the logs of a
//! leaderboard.

use std::ops::ControlFlow;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

/// Works through the items 0 to `count` on at most `jobs` threads, and returns the outcomes by item.
///
/// After an item returns [`ControlFlow::Break`], no further item starts. The outcome of an item that did not
/// start is `None`.
pub fn work<T: Send>(
    count: usize,
    jobs: usize,
    item: impl Fn(usize) -> ControlFlow<T, T> + Sync,
) -> Vec<Option<T>> {
    let next = AtomicUsize::new(0);
    let outcomes = Mutex::new((0..count).map(|_| None).collect::<Vec<Option<T>>>());
    std::thread::scope(|scope| {
        for _ in 0..jobs.min(count) {
            scope.spawn(|| {
                loop {
                    let index = next.fetch_add(1, Ordering::Relaxed);
                    if index >= count {
                        return;
                    }
                    let outcome = match item(index) {
                        ControlFlow::Continue(outcome) => outcome,
                        ControlFlow::Break(outcome) => {
                            next.store(count, Ordering::Relaxed);
                            outcome
                        }
                    };
                    outcomes.lock().unwrap_or_else(PoisonError::into_inner)[index] = Some(outcome);
                }
            });
        }
    });
    outcomes.into_inner().unwrap_or_else(PoisonError::into_inner)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_item_is_worked_on_once_whatever_the_number_of_threads() {
        for jobs in [1, 3, 100] {
            let outcomes = work(20, jobs, ControlFlow::Continue);
            assert_eq!(outcomes, (0..20).map(Some).collect::<Vec<_>>());
        }
        assert_eq!(work(0, 4, ControlFlow::Continue), []);
    }

    #[test]
    fn no_item_is_begun_after_one_that_breaks() {
        let outcomes = work(10, 1, |item| match item {
            3 => ControlFlow::Break(item),
            _ => ControlFlow::Continue(item),
        });
        assert_eq!(outcomes.iter().flatten().copied().collect::<Vec<_>>(), [0, 1, 2, 3]);
    }
}
