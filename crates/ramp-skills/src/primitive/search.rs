//! Compliant search: what an insertion does when it stalls on an edge.
//!
//! A touch of the sleeve's floor tells the height. Then the arm pushes the beam softly along its insertion path. While the
//! beam stands still, the arm sweeps it across that path with growing amplitude, until the edge gives way.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::JointRef;
use ramp_kit::joint::{self, BODY_WIDTH, EXTRUSION, FEMALE_HEIGHT};

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;

/// Speed with which a beam backs off and goes on, m/s.
const SPEED: f64 = 0.03;
/// Distance from its place at which an insertion counts as home, m.
pub const HOME: f64 = 0.8e-3;

/// How a beam is felt in: its push along its way, and its swing.
pub struct Compliance {
    /// Push along the way, N.
    force: f64,
    /// Swing across the way, m, when it begins and when it has grown, and how often a second.
    across: ([f64; 2], f64),
    /// The same up and down.
    up: ([f64; 2], f64),
    /// Swing about the vertical and about the horizontal across the way, grown, rad, and how often a second.
    turn: [(f64, f64); 2],
    /// So near its place it is in, m.
    near: f64,
}

impl Compliance {
    /// Through sleeves: with more force, friction holds the edge against the search.
    const SLEEVE: Compliance = Compliance {
        force: 4.0,
        across: ([0.8e-3, 2.0e-3], 1.3),
        up: ([0.8e-3, 2.0e-3], 2.1),
        turn: [(0.014, 0.9), (0.007, 0.6)],
        near: 0.5 * HOME,
    };
    /// Through sleeves that little holds: a beam on the table slides at 1.4 N, and turns at 0.7 N at its end.
    const LOOSE: Compliance = Compliance { force: 0.7, ..Compliance::SLEEVE };
    /// Over an end at an angle: it meets the plate with a corner whose chamfer is too steep to slide up. Rubbed to and fro
    /// along the edge it does, since friction then acts along the edge and no longer holds it down; that takes more push
    /// than the light end weighs, and a swing wider than the frame gives way.
    pub const CAP: Compliance = Compliance {
        force: 15.0,
        across: ([1.0e-3, 5.0e-3], 0.7),
        up: ([0.0, 0.0], 0.0),
        turn: [(0.0, 0.0), (0.0, 0.0)],
        near: 2.0e-3,
    };

    /// Into a joint, through sleeves that little holds or through others.
    pub fn into(loose: bool) -> &'static Compliance {
        if loose { &Compliance::LOOSE } else { &Compliance::SLEEVE }
    }
}

/// The longest search, s.
const LONGEST: f64 = 60.0;
/// A height known this well needs no touch, m.
const TRUSTED: f64 = 0.05e-3;
/// How far a beam backs off from an edge before it touches the floor of the sleeve, m.
const TOUCH_BACK: f64 = 10.0e-3;
/// How far below the beam the floor is, about, m.
const TOUCH_DEPTH: f64 = 3.6e-3;
/// Force of the touch, N, and its speed, m/s.
const TOUCH_FORCE: f64 = 1.5;
/// See [`TOUCH_FORCE`].
const TOUCH_SPEED: f64 = 5.0e-3;
/// How long a beam may stand still before the search begins, how long the swing grows, and after what time it begins
/// anew, s.
const PATIENCE: f64 = 0.5;
/// See [`PATIENCE`].
const GROWTH: f64 = 4.0;
/// See [`PATIENCE`].
const CYCLE: f64 = 8.0;
/// A beam that in so long, s, comes on by no more than this, m, is not felt in any further.
const PACE: (f64, f64) = (15.0, 3.0e-3);
/// How often a part that does not move is looked at, s.
const LOOK_EVERY: f64 = 3.0;
/// Progress that counts as having moved, m: so much within [`PATIENCE`] a beam makes that nothing wedges.
const PROGRESS: f64 = 1.0e-3;

impl Workcell<'_, '_> {
    /// How much higher than believed a beam is to go through a sleeve, m: backs off from the edge that it stands on,
    /// lowers the beam on the sleeve's floor, and compares. 0 when that tells nothing.
    pub fn touch_floor(
        &mut self,
        part: &str,
        sleeve: JointRef,
        direction: &Vector3<f64>,
    ) -> Result<f64, SkillError> {
        let hole = self.belief.hole(self.assembly, sleeve)?;
        let inside = |x_wp: &Pose| Point3::new(x_wp.inverse_transform_point(&hole).x, 0.0, 0.0);
        if self.belief.deviation(part, &inside(&self.belief.pose(part)?))[1] < TRUSTED {
            return Ok(0.0);
        }
        let mut back = self.hand.setpoint;
        back.translation.vector = self.hand.seen.x_wt.translation.vector - direction * TOUCH_BACK;
        self.hand.go(&back, SPEED)?;
        self.hand.wait(0.1)?;
        self.hand.zero()?;
        let mut down = self.hand.setpoint;
        down.translation.z -= 2.0 * TOUCH_DEPTH;
        let touched = self.hand.drive(&down, TOUCH_SPEED, |hand| -hand.force().z > TOUCH_FORCE)?;
        self.glance()?;
        let x_wp = self.belief.pose(part)?;
        let believed = (x_wp * inside(&x_wp)).z;
        self.hand.go(&back, SPEED)?;
        self.hand.wait(0.1)?;
        // On the floor lies the extrusion, or a joint's body.
        let floor = (FEMALE_HEIGHT - BODY_WIDTH) / 2.0 - joint::CLEARANCE;
        let off = [EXTRUSION, BODY_WIDTH].map(|width| believed - (floor + width / 2.0));
        let off = off.into_iter().min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or_default();
        if !touched || off.abs() > TOUCH_DEPTH / 2.0 {
            return Ok(0.0);
        }
        self.note("search", format!("{part} touched the floor {:.2} mm off", off * 1e3));
        Ok(off)
    }

    /// Feels a stalled beam in: a light push along its way, and a slow swing of growing size across it, up and down,
    /// and about both, until the edge that it stands on gives way. An unchamfered edge (thru-m) stops dead unless it
    /// meets its female within 0.3 mm. Returns for how long at a time it stood still, s.
    pub fn compliant_search(
        &mut self,
        part: &str,
        goal: &Pose,
        direction: &Vector3<f64>,
        feel: &Compliance,
    ) -> Result<f64, SkillError> {
        let begin = self.hand.time();
        let across = Vector3::z().cross(direction);
        let (mut stalled_since, mut stood) = (begin, 0.0_f64);
        let mut looked = begin;
        let mut best = self.remaining(part, goal, direction)?;
        let mut paced = (begin, best);
        // The line of the way in, as a correction of the setpoint taken anew at every look.
        let mut line = self.hand.setpoint;
        let mut ticks = 0u32;
        while self.hand.time() - begin < LONGEST {
            if ticks.is_multiple_of(20) {
                // A part that does not move may have moved in the hand.
                if stalled_since.max(looked) + LOOK_EVERY < self.hand.time() {
                    self.belief.update(&mut self.hand)?;
                    looked = self.hand.time();
                } else {
                    self.glance()?;
                }
                let x_wp = self.belief.pose(part)?;
                let remaining = self.remaining(part, goal, direction)?;
                if remaining < feel.near {
                    break;
                }
                if self.hand.time() - paced.0 > PACE.0 {
                    if paced.1 - remaining < PACE.1 {
                        break;
                    }
                    paced = (self.hand.time(), remaining);
                }
                stood = stood.max(self.hand.time() - stalled_since);
                if remaining < best - PROGRESS {
                    best = remaining;
                    stalled_since = self.hand.time();
                }
                // Where the tip would be with the part on the line, as far along as it is now.
                let on_line = Translation3::from(direction * -remaining) * goal;
                line = on_line * x_wp.inverse() * self.hand.seen.x_wt;
            }
            ticks += 1;
            let time = self.hand.time() - begin;
            let stalled = self.hand.time() - stalled_since;
            // Straight on while it moves; then a swing that grows, and begins small again.
            let grown = ((stalled - PATIENCE).max(0.0) % CYCLE / GROWTH).min(1.0);
            let swings = if stalled < PATIENCE { 0.0 } else { 1.0 };
            let wave = |hertz: f64| (std::f64::consts::TAU * hertz * time).sin();
            let swing = |([begin, end], hertz): ([f64; 2], f64)| {
                swings * (begin + (end - begin) * grown) * wave(hertz)
            };
            let lead = feel.force / self.hand.stiffness.x;
            let shift = direction * lead + across * swing(feel.across) + Vector3::z() * swing(feel.up);
            let [yaw, roll] = feel.turn.map(|(turn, hertz)| turn * grown * wave(hertz));
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw)
                * UnitQuaternion::from_scaled_axis(across * roll);
            self.hand.setpoint =
                Pose::from_parts(Translation3::from(line.translation.vector + shift), turn * line.rotation);
            self.hand.tick()?;
        }
        let seconds = self.hand.time() - begin;
        self.note("search", format!("{part} felt its way in for {seconds:.1} s"));
        Ok(stood)
    }
}
