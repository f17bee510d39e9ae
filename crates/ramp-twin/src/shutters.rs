//! Exposures of the cameras: when the shutters open, and the poses of all bodies while they are open.

use std::collections::VecDeque;

use ramp_render::Scene;
use ramp_robot::{Camera, MOST_EXPOSURES, Pose};

/// Time for which the shutter is open, in control periods of a millisecond.
pub const EXPOSURE_STEPS: u32 = 8;
/// Periods after the opening at which the poses of all bodies are recorded. The image carries the pose of the
/// middle one. If the hand moved, it shows the others together.
const MOMENTS: [u64; 5] = [1, 3, 4, 5, 7];
/// See [`MOMENTS`].
const MIDDLE: usize = 2;
/// Motion of the hand while the shutter is open (m, and rad) below which an image of a camera is not
/// blurred: a fifth of a pixel or less. The wrist camera moves with the hand. The bird's-eye camera sees the
/// hand move, from 1.7 m or more, where a pixel is 1.2 mm wide; the hand and what it holds reach 0.2 m from
/// the tip.
fn at_rest(camera: Camera) -> (f64, f64) {
    match camera {
        Camera::Wrist => (1.0e-4, 3.0e-4),
        Camera::BirdsEye => (2.3e-4, 1.2e-3),
    }
}

/// The poses of all bodies at one moment.
#[derive(Clone)]
pub(crate) struct Moment {
    pub scene: Scene,
    /// The tip in the world.
    pub x_wt: Pose,
    /// Robot time, s.
    pub time: f64,
}

/// One exposure of both cameras together. An image of it is drawn when it is requested.
#[derive(Clone)]
pub(crate) struct Exposure {
    /// The period in which the shutters open.
    begin: u64,
    /// The period in which the images are available.
    pub available: u64,
    /// Requested ahead of its images: they are kept until they are read.
    pub kept: bool,
    /// One for each of [`MOMENTS`] so far; empty when nothing can be drawn.
    moments: Vec<Moment>,
    /// Whether the cameras repeat their last images.
    pub frozen: bool,
    /// Cameras whose image has been read.
    taken: Vec<Camera>,
}

impl Exposure {
    /// Whether the poses after this number of periods are part of the exposure.
    fn is_due(&self, period: u64) -> bool {
        period.checked_sub(self.begin).is_some_and(|since| MOMENTS.contains(&since))
    }

    /// The moment whose time and tip pose the images carry.
    pub fn middle(&self) -> Option<&Moment> {
        self.moments.get(MIDDLE)
    }

    /// The moments that the image of a camera shows: the middle one, or those before and after it if the hand
    /// moved.
    pub fn shown(&self, camera: Camera) -> Vec<&Moment> {
        let ([first, .., last], Some(middle)) = (&self.moments[..], self.middle()) else { return Vec::new() };
        let moved = (last.x_wt.translation.vector - first.x_wt.translation.vector).norm();
        let (shift, turn) = at_rest(camera);
        if moved < shift && last.x_wt.rotation.angle_to(&first.x_wt.rotation) < turn {
            return vec![middle];
        }
        let aside = self.moments.iter().enumerate().filter(|(index, _)| *index != MIDDLE);
        aside.map(|(_, moment)| moment).collect()
    }
}

/// The shutters of both cameras, which open together.
#[derive(Clone, Default)]
pub(crate) struct Shutters {
    /// Exposures whose images have not all been read, the oldest first.
    exposures: VecDeque<Exposure>,
    /// The period in which the next exposure can begin.
    free: u64,
}

impl Shutters {
    /// Makes room for another exposure: if there are as many as are kept, drops the oldest whose images are
    /// available. False if all of them still wait for their images.
    pub fn make_room(&mut self, now: u64) -> bool {
        if self.exposures.len() < MOST_EXPOSURES {
            return true;
        }
        let oldest = self.exposures.iter().position(|exposure| exposure.available <= now);
        oldest.and_then(|oldest| self.exposures.remove(oldest)).is_some()
    }

    /// Opens the shutters as soon as they are free. `interval` is the time from one exposure to the next and
    /// `latency` that from its end until the images are available, in periods. `kept` images stay until they
    /// are read.
    pub fn open(&mut self, now: u64, interval: u64, latency: u32, kept: bool) {
        let begin = now.max(self.free);
        self.free = begin + interval;
        let available = begin + u64::from(EXPOSURE_STEPS + latency);
        let exposure =
            Exposure { begin, available, kept, moments: Vec::new(), frozen: false, taken: Vec::new() };
        self.exposures.push_back(exposure);
    }

    /// Whether the poses after this number of periods are part of an exposure.
    pub fn are_due(&self, period: u64) -> bool {
        self.exposures.iter().any(|exposure| exposure.is_due(period))
    }

    /// Adds the poses after this number of periods to the exposures that include it, and whether the cameras
    /// are frozen.
    pub fn record(&mut self, period: u64, moment: &Moment, frozen: bool) {
        for exposure in self.exposures.iter_mut().filter(|exposure| exposure.is_due(period)) {
            exposure.moments.push(moment.clone());
            exposure.frozen = frozen;
        }
    }

    /// Drops exposures that are not kept once time has passed since their images were available.
    pub fn forget(&mut self, now: u64) {
        self.exposures.retain(|exposure| exposure.kept || exposure.available == now);
    }

    /// Number of the oldest exposure whose image of `camera` has not been read.
    pub fn waiting(&self, camera: Camera) -> Option<usize> {
        self.exposures.iter().position(|exposure| !exposure.taken.contains(&camera))
    }

    /// Number of the newest exposure.
    pub fn newest(&self) -> usize {
        self.exposures.len() - 1
    }

    /// The period in which the images of an exposure are available.
    pub fn available(&self, number: usize) -> u64 {
        self.exposures[number].available
    }

    /// Marks the image of `camera` from the exposure with this number as read. Returns the exposure.
    pub fn take(&mut self, camera: Camera, number: usize) -> Exposure {
        let exposure = &mut self.exposures[number];
        exposure.taken.push(camera);
        let exposure = exposure.clone();
        if Camera::ALL.iter().all(|camera| exposure.taken.contains(camera)) {
            self.exposures.remove(number);
        }
        exposure
    }
}
