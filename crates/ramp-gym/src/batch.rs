//! Many environments at a time, on threads that live as long as they do.
//!
//! Each environment is worked on by one thread at a time and depends on nothing but its own seed and actions,
//! so the number of threads changes no bit.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use crate::env::{Env, EnvError, Step};

/// The job of all environments.
#[derive(Clone)]
enum Job {
    /// To reset those that have an entry: with this seed, if there is one.
    Reset(Arc<[Option<Option<u64>>]>),
    /// To step, each with its row of these actions. With `reset_ended`, one whose episode is over is reset
    /// instead.
    Step { actions: Arc<[f64]>, reset_ended: bool },
}

/// An environment with what came of its last job.
struct Slot {
    env: Env,
    over: bool,
    outcome: Result<Outcome, EnvError>,
}

/// Outcome of a job in one environment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Outcome of the action; none after a reset.
    pub step: Step,
    /// Whether it was reset.
    pub reset: bool,
}

/// State shared by the threads.
struct Shared {
    slots: Vec<Mutex<Slot>>,
    /// The next environment that nobody works on yet.
    next: AtomicUsize,
    state: Mutex<State>,
    begun: Condvar,
    ended: Condvar,
}

struct State {
    /// Counts jobs.
    number: u64,
    job: Option<Job>,
    /// Threads that still work on it.
    working: usize,
    closed: bool,
}

/// A mutex that a panic has left behind is used all the same.
fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

impl Shared {
    /// Works on environments until none is left.
    fn work(&self, job: &Job) {
        loop {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            let Some(slot) = self.slots.get(index) else { return };
            lock(slot).work(index, job);
        }
    }

    /// A thread that works on every job until the batch is gone.
    fn serve(&self) {
        let mut done = 0;
        loop {
            let mut state = lock(&self.state);
            while state.number == done && !state.closed {
                state = self.begun.wait(state).unwrap_or_else(PoisonError::into_inner);
            }
            if state.closed {
                return;
            }
            done = state.number;
            let job = state.job.clone();
            drop(state);
            if let Some(job) = job {
                self.work(&job);
            }
            let mut state = lock(&self.state);
            state.working -= 1;
            if state.working == 0 {
                self.ended.notify_all();
            }
        }
    }
}

impl Slot {
    fn work(&mut self, index: usize, job: &Job) {
        match job {
            Job::Reset(seeds) => {
                if let Some(Some(seed)) = seeds.get(index) {
                    self.reset(*seed);
                }
            }
            Job::Step { reset_ended: true, .. } if self.over => self.reset(None),
            Job::Step { actions, .. } => {
                let width = self.env.actions();
                let action = actions.get(index * width..(index + 1) * width).unwrap_or_default();
                self.outcome = self.env.step(action).map(|step| {
                    self.over = step.terminated || step.truncated;
                    Outcome { step, reset: false }
                });
            }
        }
    }

    fn reset(&mut self, seed: Option<u64>) {
        self.over = false;
        self.outcome = self.env.reset(seed).map(|()| Outcome { step: Step::default(), reset: true });
    }
}

/// Many environments.
pub struct Batch {
    shared: Arc<Shared>,
    threads: Vec<JoinHandle<()>>,
    width: usize,
    actions: usize,
}

impl Batch {
    /// `count` environments like `env`, worked on by `threads` threads, the caller's among them.
    ///
    /// # Errors
    /// When an environment cannot be made.
    pub fn new(env: &Env, count: usize, threads: usize) -> Result<Batch, EnvError> {
        let slot =
            || Ok(Mutex::new(Slot { env: env.sibling()?, over: false, outcome: Err(EnvError::NotReset) }));
        let slots = (0..count).map(|_| slot()).collect::<Result<Vec<_>, EnvError>>()?;
        let shared = Arc::new(Shared {
            slots,
            next: AtomicUsize::new(0),
            state: Mutex::new(State { number: 0, job: None, working: 0, closed: false }),
            begun: Condvar::new(),
            ended: Condvar::new(),
        });
        let others = threads.min(count).saturating_sub(1);
        let thread = |_| {
            let shared = Arc::clone(&shared);
            std::thread::spawn(move || shared.serve())
        };
        let threads = (0..others).map(thread).collect();
        Ok(Batch { shared, threads, width: env.width(), actions: env.actions() })
    }

    /// How many environments.
    pub fn len(&self) -> usize {
        self.shared.slots.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.shared.slots.is_empty()
    }

    fn run(&mut self, job: Job) {
        self.shared.next.store(0, Ordering::Relaxed);
        {
            let mut state = lock(&self.shared.state);
            state.number += 1;
            state.job = Some(job.clone());
            state.working = self.threads.len();
        }
        self.shared.begun.notify_all();
        self.shared.work(&job);
        let mut state = lock(&self.shared.state);
        while state.working > 0 {
            state = self.shared.ended.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
        state.job = None;
    }

    /// Resets those environments that have an entry: with its seed, or to their next episode.
    ///
    /// # Errors
    /// The first that has no start.
    pub fn reset(&mut self, seeds: &[Option<Option<u64>>]) -> Result<(), EnvError> {
        self.run(Job::Reset(seeds.into()));
        for slot in &self.shared.slots {
            if let Err(error) = &lock(slot).outcome
                && !matches!(error, EnvError::NotReset)
            {
                return Err(error.clone());
            }
        }
        Ok(())
    }

    /// Steps all environments, each with its row of `actions`. With `reset_ended`, one whose episode is over
    /// is reset instead, and its action does not count; otherwise it stays over.
    ///
    /// # Errors
    /// When `actions` has not as many numbers as it should, or an environment cannot go on.
    pub fn step(&mut self, actions: &[f64], reset_ended: bool) -> Result<Vec<Outcome>, EnvError> {
        let expected = self.len() * self.actions;
        if actions.len() != expected {
            return Err(EnvError::Length { found: actions.len(), expected });
        }
        self.run(Job::Step { actions: actions.into(), reset_ended });
        self.shared.slots.iter().map(|slot| lock(slot).outcome.clone()).collect()
    }

    /// Looks at one of the environments.
    ///
    /// # Panics
    /// When there is none with this index.
    pub fn with<T>(&self, index: usize, look: impl FnOnce(&Env) -> T) -> T {
        look(&lock(&self.shared.slots[index]).env)
    }

    /// Ends the episodes of some environments from outside, as a limit of steps does.
    pub fn end(&mut self, which: &[bool]) {
        for (slot, end) in self.shared.slots.iter().zip(which) {
            lock(slot).over |= *end;
        }
    }

    /// Writes the observations of all environments, row by row.
    pub fn observe(&self, out: &mut [f32]) {
        for (slot, row) in self.shared.slots.iter().zip(out.chunks_mut(self.width.max(1))) {
            lock(slot).env.observe(row);
        }
    }

    /// Writes the images of a view of all environments, one after the other.
    pub fn images(&self, view: usize, out: &mut [u8]) {
        let size = out.len() / self.len().max(1);
        for (slot, out) in self.shared.slots.iter().zip(out.chunks_mut(size.max(1))) {
            if let Some(image) = lock(slot).env.image(view).filter(|image| image.len() == out.len()) {
                out.copy_from_slice(image);
            }
        }
    }

    /// Writes the depth images of a view of all environments, one after the other.
    pub fn depths(&self, view: usize, out: &mut [f32]) {
        let size = out.len() / self.len().max(1);
        for (slot, out) in self.shared.slots.iter().zip(out.chunks_mut(size.max(1))) {
            if let Some(depth) = lock(slot).env.depth(view).filter(|depth| depth.len() == out.len()) {
                out.copy_from_slice(depth);
            }
        }
    }

    /// A number for each environment that two runs share only if they share every bit of their physics state.
    pub fn state_hashes(&self) -> Vec<u64> {
        let hash = |slot: &Mutex<Slot>| lock(slot).env.twin().map_or(0, ramp_twin::Twin::state_hash);
        self.shared.slots.iter().map(hash).collect()
    }
}

impl Drop for Batch {
    fn drop(&mut self) {
        lock(&self.shared.state).closed = true;
        self.shared.begun.notify_all();
        for thread in self.threads.drain(..) {
            // A thread that panicked has nothing left to give back.
            let _ = thread.join();
        }
    }
}
