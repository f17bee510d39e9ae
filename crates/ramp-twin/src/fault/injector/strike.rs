//! How each kind of fault strikes, and what follows when a pushed part does not move.

use nalgebra::{Point3, Vector3};
use ramp_kit::Pose;

use super::state::{Action, Data, Injector};
use crate::fault::act::{Motion, Obstacle, Progress, Push, Strength};
use crate::fault::kind::FaultKind;
use crate::fault::occasion::Occasion;

/// Time from a lift until the lifted part is dropped or moved in the grip, s.
const DELAY: [f64; 2] = [0.3, 2.5];
/// Time without finger force, s.
const LIMP: [f64; 2] = [0.3, 0.6];
/// A part that moves by less than this share of the intended distance counts as stuck.
const LEAST_OF_WAY: f64 = 0.3;
/// Rotation of a peg in the grip, rad.
const TILT: [f64; 2] = [6.0 / 180.0 * std::f64::consts::PI, 15.0 / 180.0 * std::f64::consts::PI];
/// Displacement of a beam along its axis in the grip, m.
const SLIP: [f64; 2] = [4.0e-3, 12.0e-3];
/// Rotation of a beam in the grip, rad.
const TURN: [f64; 2] = [4.0 / 180.0 * std::f64::consts::PI, 10.0 / 180.0 * std::f64::consts::PI];
/// Displacement of a standing beam, m.
const BUMP: [f64; 2] = [3.0e-3, 15.0e-3];
/// Least displacement of a bump, m. After a smaller one the beam is pushed from another side, or on another
/// occasion.
const LEAST_BUMP: f64 = 2.5e-3;
/// Displacement of a holder, m.
const SHIFT: [f64; 2] = [3.0e-3, 8.0e-3];
/// Force at which the obstacle of an insertion gives way, N, and its duration, s.
const JAM: ([f64; 2], [f64; 2]) = ([25.0, 35.0], [4.0, 8.0]);
/// Time for which the cameras repeat their images, s.
const FROZEN: f64 = 5.0;
/// Distance by which the fingers spring back, m.
const SHORT: [f64; 2] = [2.0e-3, 4.0e-3];
/// Growth of the sensor's bias, N/s, and its final value, N.
const DRIFT: ([f64; 2], [f64; 2]) = ([0.05, 0.2], [5.0, 8.0]);

/// Between two ends.
fn between([from, to]: [f64; 2], share: f64) -> f64 {
    from + (to - from) * share
}

impl Injector {
    /// Begins the fault at its occasion.
    pub(super) fn strike(&mut self, occasion: &Occasion, data: &Data, time: f64, width: f64) {
        let draws = self.draws;
        let part = match occasion {
            Occasion::Part(part) | Occasion::Inserted { part, .. } => Some(*part),
            Occasion::Left => None,
        };
        let name = part.map(|part| self.bodies.parts[part].name.clone()).unwrap_or_default();
        let action = match (self.report.kind, occasion) {
            (FaultKind::HolderShifted, Occasion::Part(peg)) => self.shift(*peg, data, time),
            (FaultKind::BeamBumped, Occasion::Left) => self.begin_bump(data, time),
            (FaultKind::Jam, Occasion::Inserted { part, p_w, direction }) => {
                let (force, seconds) = (between(JAM.0, draws.size), between(JAM.1, draws.second));
                self.struck(
                    time,
                    &name,
                    Some(force),
                    format!("{name} meets {force:.0} N for {seconds:.1} s"),
                );
                let body = self.bodies.parts[*part].body;
                Some(Action::Jam(Obstacle::new(data, body, *p_w, *direction, force, seconds)))
            }
            (FaultKind::CameraFrozen, Occasion::Part(_)) => {
                let text = format!("both cameras repeat their images for {FROZEN:.0} s");
                self.struck(time, "", Some(FROZEN), text);
                Some(Action::Frozen { left: FROZEN })
            }
            (FaultKind::GripperWeak, Occasion::Part(_)) => {
                let short = between(SHORT, draws.size);
                let text = format!("the fingers spring back by {:.1} mm on {name}", short * 1e3);
                self.struck(time, &name, Some(short), text);
                Some(Action::Short { width: width + short })
            }
            (FaultKind::ForceDrift, Occasion::Part(_)) => {
                let (growth, most) = (between(DRIFT.0, draws.size), between(DRIFT.1, draws.second));
                let text = format!("the wrist's force drifts by {growth:.2} N/s up to {most:.1} N");
                self.struck(time, "", Some(growth), text);
                // Uniform on the sphere.
                let z = 2.0 * draws.side - 1.0;
                let (sine, cosine) = (std::f64::consts::TAU * draws.angle).sin_cos();
                let flat = (1.0 - z * z).sqrt();
                let direction = Vector3::new(flat * cosine, flat * sine, z);
                Some(Action::Drift { force: 0.0, growth, most, direction })
            }
            (_, Occasion::Part(part)) => {
                Some(Action::Lifted { part: *part, left: between(DELAY, draws.delay) })
            }
            _ => None,
        };
        if let Some(action) = action {
            self.action = action;
        }
    }

    fn struck(&mut self, time: f64, part: &str, size: Option<f64>, text: String) {
        self.report.occasion = self.count;
        self.report.at = Some(time);
        self.report.part = (!part.is_empty()).then(|| part.to_string());
        self.report.size = size;
        self.report.text = text;
    }

    /// Direction drawn for the fault, 1 or −1.
    fn side(&self) -> f64 {
        if self.draws.side < 0.5 { -1.0 } else { 1.0 }
    }

    /// Drops the lifted part, or moves it in the grip. If it is not held any more, waits for the next
    /// occasion.
    pub(super) fn strike_in_grip(&mut self, part: usize, data: &Data, x_wt: &Pose, time: f64) -> Action {
        if self.watch.held() != Some(part) {
            return Action::Waiting;
        }
        let kind = self.report.kind;
        let (name, body) = (self.bodies.parts[part].name.clone(), self.bodies.parts[part].body);
        if kind == FaultKind::PegDropped {
            let left = between(LIMP, self.draws.size);
            self.struck(
                time,
                &name,
                Some(left),
                format!("the fingers lose {name}: no force for {left:.2} s"),
            );
            return Action::Limp { left };
        }
        let x_tp = x_wt.inverse() * self.bodies.pose(data, part);
        // The fingers close along y of the tip: about that axis a part turns most easily.
        let (motion, way, what) = match kind {
            FaultKind::BeamSlipped => {
                let axis = x_tp.rotation * Vector3::x() * self.side();
                (Motion::Line(axis), between(SLIP, self.draws.size), "slips along its axis")
            }
            FaultKind::BeamTurned => {
                (Motion::Turn(Vector3::y() * self.side()), between(TURN, self.draws.size), "turns")
            }
            _ => (Motion::Turn(Vector3::y() * self.side()), between(TILT, self.draws.size), "tilts"),
        };
        let strength = match motion {
            Motion::Line(_) => {
                Strength { way, speed: 0.03, most: 40.0, growth: 150.0, back_off: 0.9, longest: 2.0 }
            }
            // A peg is so light that it starts with a jerk.
            Motion::Turn(_) if self.bodies.parts[part].is_peg => {
                Strength { way, speed: 0.5, most: 3.0, growth: 3.0, back_off: 0.8, longest: 4.0 }
            }
            Motion::Turn(_) => {
                Strength { way, speed: 0.5, most: 3.0, growth: 3.0, back_off: 0.9, longest: 2.0 }
            }
        };
        let wanted = match motion {
            Motion::Line(_) => format!("{:.1} mm", way * 1e3),
            Motion::Turn(_) => format!("{:.1}°", way.to_degrees()),
        };
        self.struck(time, &name, Some(0.0), format!("{name} {what} in the grip, pushed for {wanted}"));
        let push = |motion| Push::new(data, body, Point3::origin(), motion, strength, Some(x_wt));
        let back = match motion {
            Motion::Line(axis) => Motion::Line(-axis),
            Motion::Turn(axis) => Motion::Turn(-axis),
        };
        Action::InGrip { push: push(motion), other: Some(push(back)) }
    }

    /// Continues a push in the grip. If the part does not move because a joint is at the fingers, pushes it
    /// the other way.
    pub(super) fn push_in_grip(
        &mut self,
        mut push: Push,
        other: Option<Push>,
        data: &mut Data,
        x_wt: &Pose,
    ) -> Action {
        let progress = push.step(data, x_wt);
        self.report.size = Some(push.gone());
        match progress {
            Progress::Over(gone) if gone < LEAST_OF_WAY * push.way() => match other {
                Some(other) => Action::InGrip { push: other, other: None },
                None => Action::Over,
            },
            Progress::Over(_) => Action::Over,
            _ if self.watch.held().is_none() => {
                push.end(data);
                self.report.text.push_str(", and is lost from it");
                Action::Over
            }
            _ => Action::InGrip { push, other },
        }
    }

    /// The holder of a lifted peg, or the first with pegs in it when that is empty, is pushed.
    fn shift(&mut self, peg: usize, data: &Data, time: f64) -> Option<Action> {
        let own = self.bodies.parts[peg].holder.clone();
        let filled = |(name, body): &&(String, usize)| {
            let p_h = Vector3::from(data.xpos()[*body]);
            self.bodies.parts.iter().enumerate().any(|(index, part)| {
                let p_w = self.bodies.pose(data, index).translation.vector;
                index != peg && part.holder.as_ref() == Some(name) && (p_w - p_h).xy().norm() < 0.05
            })
        };
        let holders = self.bodies.holders.iter();
        let first = holders.clone().filter(|(name, _)| Some(name) == own.as_ref()).find(filled);
        let (name, body) = first.or_else(|| holders.clone().find(filled))?.clone();
        let way = between(SHIFT, self.draws.size);
        let (sine, cosine) = (std::f64::consts::TAU * self.draws.angle).sin_cos();
        let motion = Motion::Line(Vector3::new(cosine, sine, 0.0));
        let strength = Strength { way, speed: 0.03, most: 60.0, growth: 200.0, back_off: 0.9, longest: 2.0 };
        self.struck(time, &name, Some(0.0), format!("{name} is pushed by {:.1} mm", way * 1e3));
        Some(Action::Shift(Push::new(data, body, Point3::origin(), motion, strength, None)))
    }

    /// The beams that stand, those with the fewest pegs first, each from its four sides.
    fn begin_bump(&mut self, data: &Data, time: f64) -> Option<Action> {
        let mut standing = self.bodies.standing(data, self.watch.held());
        if standing.is_empty() {
            return None;
        }
        // Among equals the drawn one comes first.
        let turn = ((self.draws.angle * standing.len() as f64) as usize).min(standing.len() - 1);
        standing.rotate_left(turn);
        standing.sort_by_key(|&index| self.bodies.pins(data, &self.bodies.placed[index]).len());
        let mut sides = Vec::new();
        for index in standing {
            let x_wb = self.bodies.pose(data, self.bodies.placed[index].part);
            let along =
                (x_wb.rotation * Vector3::x()).component_mul(&Vector3::new(1.0, 1.0, 0.0)).normalize();
            let across = Vector3::z().cross(&along) * self.side();
            sides.extend([across, -across, along, -along].map(|axis| (index, Motion::Line(axis))));
        }
        sides.reverse();
        let (index, motion) = sides.pop()?;
        Some(self.bump_from(index, motion, time, sides, data))
    }

    fn bump_from(
        &self,
        index: usize,
        motion: Motion,
        at: f64,
        left: Vec<(usize, Motion)>,
        data: &Data,
    ) -> Action {
        let placed = &self.bodies.placed[index];
        // At the link that is furthest from the pegs, where it gives way most.
        let pins = self.bodies.pins(data, placed);
        let far = |p: &Point3<f64>| pins.iter().map(|pin| (p - pin).norm()).fold(f64::INFINITY, f64::min);
        let p_b = placed.links.iter().copied().max_by(|a, b| far(a).total_cmp(&far(b)));
        let way = between(BUMP, self.draws.size);
        let strength = Strength { way, speed: 0.05, most: 40.0, growth: 100.0, back_off: 0.9, longest: 1.5 };
        let body = self.bodies.parts[placed.part].body;
        let push = Push::new(data, body, p_b.unwrap_or_else(Point3::origin), motion, strength, None);
        Action::Bump { push, part: placed.part, at, left }
    }

    /// Continues a bump. If the beam does not move, pushes it from the next side. Ends when the hand comes
    /// back.
    pub(super) fn bump(
        &mut self,
        mut push: Push,
        part: usize,
        at: f64,
        mut left: Vec<(usize, Motion)>,
        data: &mut Data,
        x_wt: &Pose,
    ) -> Action {
        let back = self.watch.is_back(&self.bodies, data, part, x_wt);
        if back {
            push.end(data);
            left.clear();
        }
        let gone = match push.step(data, x_wt) {
            Progress::Over(gone) => gone,
            _ if back => push.gone(),
            _ => return Action::Bump { push, part, at, left },
        };
        if gone >= LEAST_BUMP {
            let name = self.bodies.parts[part].name.clone();
            self.struck(at, &name, Some(gone), format!("{name} is pushed by {:.1} mm", gone * 1e3));
            return Action::Over;
        }
        match left.pop() {
            Some((index, motion)) => self.bump_from(index, motion, at, left, data),
            None => Action::Waiting,
        }
    }
}
