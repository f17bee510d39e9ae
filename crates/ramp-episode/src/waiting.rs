//! How long a thread waits for a processor, although it could work: on a loaded machine the computing time of
//! an episode is longer than on an idle one.

/// Where Linux tells the time that this thread ran and the time that it waited, ns.
const COUNTERS: &str = "/proc/thread-self/schedstat";

/// A measurement from its creation on.
pub(crate) struct Waiting {
    begin: Option<[u64; 2]>,
}

impl Waiting {
    /// Begins for this thread.
    pub(crate) fn begin() -> Waiting {
        Waiting { begin: counters() }
    }

    /// Share of its time, ready to work, for which the thread waited, 0 to 1; `None` where the system does
    /// not tell.
    pub(crate) fn share(&self) -> Option<f64> {
        let ([ran, waited], [ran_before, waited_before]) = (counters()?, self.begin?);
        let (ran, waited) = (ran.checked_sub(ran_before)?, waited.checked_sub(waited_before)?);
        (ran > 0).then(|| waited as f64 / (ran + waited) as f64)
    }
}

fn counters() -> Option<[u64; 2]> {
    let text = std::fs::read_to_string(COUNTERS).ok()?;
    let mut numbers = text.split_whitespace().map(str::parse);
    Some([numbers.next()?.ok()?, numbers.next()?.ok()?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_is_one() {
        let waiting = Waiting::begin();
        if waiting.begin.is_none() {
            // Not this test's business: the system does not tell.
            return;
        }
        let mut sum = 0u64;
        while counters().zip(waiting.begin).is_some_and(|(now, begin)| now[0] <= begin[0]) {
            sum = std::hint::black_box(sum + 1);
            std::thread::yield_now();
        }
        assert!(waiting.share().is_some_and(|share| (0.0..1.0).contains(&share)));
    }
}
