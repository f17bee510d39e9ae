//! The loop of the gripper.

/// Stiffness of a finger's position loop, N/m, and of the gear that couples the two fingers.
const FINGER_STIFFNESS: f64 = 20_000.0;
/// Damping of a finger's position loop, N·s/m.
const FINGER_DAMPING: f64 = 200.0;
/// Largest speed of a finger, m/s. The Panda's hand allows 0.1 m/s for both together.
pub const FINGER_SPEED: f64 = 0.05;

/// The gripper's loop: two fingers that move together at limited speed and press with limited force.
#[derive(Clone, Copy, Debug)]
pub struct GripperLoop {
    /// Commanded position of both fingers, m from closed.
    target: f64,
}

impl GripperLoop {
    /// Starts with the fingers at `q`, m from closed.
    pub fn new(q: f64) -> GripperLoop {
        GripperLoop { target: q }
    }

    /// Forces on the two fingers, N, for a wanted distance between them (m) and a largest force each (N). `q`
    /// (m) and `v` (m/s) are the fingers' positions and speeds, `period` is in s.
    pub fn forces(&mut self, width: f64, force: f64, q: [f64; 2], v: [f64; 2], period: f64) -> [f64; 2] {
        let wanted = width / 2.0;
        let step = FINGER_SPEED * period;
        self.target += (wanted - self.target).clamp(-step, step);
        // The target never runs away from blocked fingers, so that opening starts at once.
        let lead = 1.05 * force / FINGER_STIFFNESS;
        let mean = (q[0] + q[1]) / 2.0;
        self.target = self.target.clamp(mean - lead, mean + lead);
        // The real hand drives both fingers from one motor; its gear is a stiff spring between them here.
        let gear = FINGER_STIFFNESS * (q[0] - q[1]) / 2.0;
        std::array::from_fn(|finger| {
            let loop_force = FINGER_STIFFNESS * (self.target - q[finger]) - FINGER_DAMPING * v[finger];
            loop_force.clamp(-force, force) + if finger == 0 { -gear } else { gear }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocked_fingers_press_with_no_more_than_the_force_they_are_given() {
        let mut gripper = GripperLoop::new(0.02);
        let mut forces = [0.0; 2];
        for _ in 0..1000 {
            forces = gripper.forces(0.0, 30.0, [0.02; 2], [0.0; 2], 1e-3);
        }
        assert_eq!(forces, [-30.0; 2]);
    }

    #[test]
    fn blocked_fingers_open_as_soon_as_they_are_told() {
        let mut gripper = GripperLoop::new(0.02);
        for _ in 0..1000 {
            gripper.forces(0.0, 30.0, [0.02; 2], [0.0; 2], 1e-3);
        }
        // The target leads by little more than the force needs: 35 ms later the fingers are pushed apart.
        let forces = (0..70).map(|_| gripper.forces(0.08, 30.0, [0.02; 2], [0.0; 2], 1e-3)).last();
        assert!(forces.is_some_and(|forces| forces.iter().all(|force| *force > 0.0)), "{forces:?}");
    }
}
