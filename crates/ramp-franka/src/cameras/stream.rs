//! The frames of one camera, and those that were asked for.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use ramp_robot::MOST_EXPOSURES;

use super::pixels::Pixels;
use crate::error::FrankaError;

/// Time after which a camera that gives no frame counts as broken. Chosen: a camera of 5 images a second that
/// lost some.
const SILENCE: Duration = Duration::from_secs(2);

/// A frame.
#[derive(Clone, Debug)]
pub struct Frame {
    /// The middle of its exposure.
    pub exposed: Instant,
    /// Its pixels.
    pub pixels: Pixels,
}

/// A camera that takes one frame after another. The driver of another kind of camera implements this.
pub trait FrameSource: Send {
    /// The next frame; it waits for it, a second at most.
    ///
    /// # Errors
    /// When the camera gives no more.
    fn next(&mut self) -> io::Result<Frame>;
}

/// A frame that was asked for.
struct Request {
    since: Instant,
    frame: Option<Arc<Frame>>,
}

#[derive(Default)]
struct Shared {
    requests: VecDeque<Request>,
    failed: Option<String>,
    over: bool,
}

type Slot = Arc<(Mutex<Shared>, Condvar)>;

/// A panic of the other thread leaves requests that are whole.
fn lock(slot: &Slot) -> MutexGuard<'_, Shared> {
    slot.0.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A camera in a thread of its own.
pub(super) struct Stream {
    name: String,
    slot: Slot,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Stream {
    pub fn new(name: String, source: Box<dyn FrameSource>) -> Stream {
        let slot = Slot::default();
        let theirs = Arc::clone(&slot);
        let thread = std::thread::spawn(move || keep(&theirs, source));
        Stream { name, slot, thread: Some(thread) }
    }

    /// Asks for a frame that is exposed from now on. At most [`MOST_EXPOSURES`] are kept: the oldest that has
    /// its frame makes room.
    pub fn request(&mut self) {
        let mut shared = lock(&self.slot);
        if shared.requests.len() == MOST_EXPOSURES {
            let Some(done) = shared.requests.iter().position(|request| request.frame.is_some()) else {
                return;
            };
            shared.requests.remove(done);
        }
        shared.requests.push_back(Request { since: Instant::now(), frame: None });
    }

    /// The frame that was asked for first, or one that is exposed from now on.
    pub fn frame(&mut self) -> Result<Arc<Frame>, FrankaError> {
        if lock(&self.slot).requests.is_empty() {
            self.request();
        }
        let shared = lock(&self.slot);
        let waits = |shared: &mut Shared| {
            shared.failed.is_none() && shared.requests.front().is_some_and(|request| request.frame.is_none())
        };
        let (mut shared, _) =
            self.slot.1.wait_timeout_while(shared, SILENCE, waits).unwrap_or_else(PoisonError::into_inner);
        if let Some(why) = &shared.failed {
            return Err(self.wrong(why));
        }
        let request = shared.requests.pop_front();
        request
            .and_then(|request| request.frame)
            .ok_or_else(|| self.wrong(&format!("no image for {} s", SILENCE.as_secs())))
    }

    /// Something is wrong with this camera.
    pub fn wrong(&self, why: &str) -> FrankaError {
        FrankaError::Camera { name: self.name.clone(), why: why.to_string() }
    }
}

impl Drop for Stream {
    fn drop(&mut self) {
        lock(&self.slot).over = true;
        if let Some(thread) = self.thread.take() {
            // It reports its errors by the slot.
            let _ = thread.join();
        }
    }
}

/// The thread: frames go to those who asked for them.
fn keep(slot: &Slot, mut source: Box<dyn FrameSource>) {
    loop {
        let next = source.next();
        let mut shared = lock(slot);
        if shared.over {
            return;
        }
        match next {
            Ok(frame) => {
                let frame = Arc::new(frame);
                let due = |request: &&mut Request| request.frame.is_none() && request.since <= frame.exposed;
                shared.requests.iter_mut().filter(due).for_each(|request| {
                    request.frame = Some(Arc::clone(&frame));
                });
            }
            Err(error) => shared.failed = Some(error.to_string()),
        }
        let failed = shared.failed.is_some();
        drop(shared);
        slot.1.notify_all();
        if failed {
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use std::sync::mpsc::{Receiver, channel};

    use super::*;

    /// Frames from a channel; the camera breaks when it is closed.
    struct Fed(Receiver<Frame>);

    impl FrameSource for Fed {
        fn next(&mut self) -> io::Result<Frame> {
            self.0.recv().map_err(|_| io::ErrorKind::BrokenPipe.into())
        }
    }

    fn frame(exposed: Instant, number: u8) -> Frame {
        Frame { exposed, pixels: Pixels::Rgb(vec![number; 3]) }
    }

    /// An agent never gets a frame that was exposed before it asked, and gets those that it asked for in
    /// order.
    #[test]
    fn frames_are_of_the_time_that_was_asked_for() {
        let (feed, fed) = channel();
        let mut stream = Stream::new("fed".to_string(), Box::new(Fed(fed)));
        let before = Instant::now();
        std::thread::sleep(Duration::from_millis(2));
        stream.request();
        let first = Instant::now();
        std::thread::sleep(Duration::from_millis(2));
        stream.request();
        feed.send(frame(before, 1)).unwrap();
        feed.send(frame(first, 2)).unwrap();
        feed.send(frame(Instant::now(), 3)).unwrap();
        assert_eq!(stream.frame().unwrap().pixels, Pixels::Rgb(vec![2; 3]));
        assert_eq!(stream.frame().unwrap().pixels, Pixels::Rgb(vec![3; 3]));
        // Its thread ends with its frames.
        drop(feed);
    }

    /// A camera that was unplugged is told by its name, at once.
    #[test]
    fn a_broken_camera_is_told() {
        let (feed, fed) = channel();
        let mut stream = Stream::new("/dev/video7".to_string(), Box::new(Fed(fed)));
        drop(feed);
        let error = stream.frame().unwrap_err().to_string();
        assert!(error.starts_with("the camera /dev/video7: "), "{error}");
    }
}
