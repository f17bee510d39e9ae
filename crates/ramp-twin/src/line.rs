//! The line between the program and the motors: some commands are lost, and the others act late.

use std::collections::VecDeque;

use ramp_control::JointVector;
use ramp_robot::random::Stream;
use ramp_world::groups;

/// Number of commands lost in a row that stops the arm. From libfranka's documentation.
pub(crate) const MOST_LOST: u32 = 20;

/// Commands on their way to the motors.
#[derive(Clone)]
pub(crate) struct Line {
    /// Commands that do not act yet, the oldest first.
    coming: VecDeque<JointVector>,
    /// In periods.
    delay: usize,
    lost: f64,
    lost_row: f64,
    stream: Stream,
    /// Commands that are still to be lost in this row, and how many already were.
    losing: u32,
    in_row: u32,
    /// The torques that the arm received last, N·m.
    received: JointVector,
    /// The torques that act, N·m.
    acting: JointVector,
}

impl Line {
    pub fn new(line: &groups::Line, seed: u64) -> Line {
        Line {
            coming: VecDeque::new(),
            delay: line.delay.round() as usize,
            lost: line.lost,
            lost_row: line.lost_row,
            stream: Stream::new(seed, "line"),
            losing: 0,
            in_row: 0,
            received: JointVector::zeros(),
            acting: JointVector::zeros(),
        }
    }

    /// Sends torques (N·m). Returns those of the motors in this period. While commands are lost, the last
    /// ones hold.
    pub fn send(&mut self, torques: JointVector) -> JointVector {
        if self.lost > 0.0 && self.losing == 0 && self.stream.uniform() < self.lost {
            // A row continues with the same probability after each command: its mean length is `lost_row`.
            self.losing = 1;
            while self.stream.uniform() < 1.0 - 1.0 / self.lost_row && self.losing < 10 * MOST_LOST {
                self.losing += 1;
            }
        }
        if self.losing > 0 {
            self.losing -= 1;
            self.in_row += 1;
        } else {
            self.in_row = 0;
            self.received = torques;
        }
        self.coming.push_back(self.received);
        if self.coming.len() > self.delay {
            self.acting = self.coming.pop_front().unwrap_or(self.received);
        }
        self.acting
    }

    /// Torques (N·m) act that did not come over the line.
    pub fn hold(&mut self, torques: JointVector) {
        self.coming.clear();
        (self.received, self.acting) = (torques, torques);
    }

    /// The torques that the arm received last, N·m.
    pub fn received(&self) -> JointVector {
        self.received
    }

    /// Whether [`MOST_LOST`] commands or more were lost in a row, so that the arm stops.
    pub fn has_stopped(&self) -> bool {
        self.in_row >= MOST_LOST
    }

    /// Makes the arm ready again: nothing is on its way any more, and no torque is received.
    pub fn restart(&mut self) {
        self.coming.clear();
        self.received = JointVector::zeros();
        self.losing = 0;
        self.in_row = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(delay: f64, lost: f64, lost_row: f64) -> Line {
        Line::new(&groups::Line { delay, lost, lost_row, recovery: 1.0 }, 1)
    }

    #[test]
    fn commands_come_late() {
        let mut line = line(2.0, 0.0, 1.0);
        let came: Vec<f64> =
            (1..6).map(|number| line.send(JointVector::repeat(f64::from(number)))[0]).collect();
        assert_eq!(came, [0.0, 0.0, 1.0, 2.0, 3.0]);
    }

    /// While commands are lost the last torque is held; 20 in a row stop the arm, and rows have the specified
    /// mean length.
    #[test]
    fn lost_commands_hold_the_last_torque() {
        let mut line = line(0.0, 0.01, 4.0);
        let (mut rows, mut lost, mut stops, mut before) = (0, 0, 0, 0.0);
        for number in 1..200_000 {
            let came = line.send(JointVector::repeat(f64::from(number)))[0];
            if came < f64::from(number) {
                rows += usize::from(before == f64::from(number - 1));
                lost += 1;
                assert_eq!(came, before);
            }
            before = came;
            if line.has_stopped() {
                stops += 1;
                line.restart();
            }
        }
        let mean = f64::from(lost) / rows as f64;
        assert!((mean - 4.0).abs() < 0.4, "{mean}");
        assert!((2..30).contains(&stops), "{stops}");
    }
}
