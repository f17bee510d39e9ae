//! Trapezoidal speed profile of straight motions.

/// Trapezoidal speed profile.
pub(super) struct SpeedProfile {
    /// Time at full speed and in one of the ramps, s.
    even: f64,
    ramp: f64,
}

impl SpeedProfile {
    /// Over a distance (m or rad), with a largest speed and acceleration (per s, per s²).
    pub(super) fn new(way: f64, speed: f64, acceleration: f64) -> SpeedProfile {
        let speed = speed.min((way * acceleration).sqrt());
        if speed <= 0.0 {
            return SpeedProfile { even: 0.0, ramp: 0.0 };
        }
        let ramp = speed / acceleration;
        SpeedProfile { even: (way / speed - ramp).max(0.0), ramp }
    }

    /// Its duration, s.
    pub(super) fn duration(&self) -> f64 {
        self.even + 2.0 * self.ramp
    }

    /// The share of the distance covered at a time (s) before the end.
    pub(super) fn share(&self, time: f64) -> f64 {
        let whole = self.ramp * (self.even + self.ramp);
        let begun = time.min(self.ramp);
        let ended = (time - self.ramp - self.even).max(0.0);
        let done = begun * begun / 2.0 + self.ramp * (time - begun) - ended * ended / 2.0;
        (done / whole).clamp(0.0, 1.0)
    }
}
