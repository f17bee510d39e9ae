//! Height measurement by contact: a held beam touches the surface that it must not rub against later.

use nalgebra::{Point3, UnitQuaternion, Vector3};
use ramp_assembly::JointRef;
use ramp_kit::joint::{self, BODY_WIDTH, EXTRUSION, FEMALE_HEIGHT};
use ramp_robot::{EventKind, Surface};

use crate::Pose;
use crate::cell::Workcell;
use crate::fault::SkillError;
use crate::hand::Rise;

impl Workcell<'_, '_> {
    /// Presses a held beam, a little over the table, flat on it: then its height and its tilt in the hand are
    /// known, however the cameras and the arm are off. A beam whose height is known well enough is left as it
    /// is.
    ///
    /// # Errors
    /// [`Fault::Unseen`](crate::Fault::Unseen), [`Fault::Overload`](crate::Fault::Overload), and the robot's.
    pub fn touch_table(&mut self, beam: usize) -> Result<(), SkillError> {
        let placed = &self.assembly.beams[beam].beam;
        let ends = [0.0, placed.span()].map(|x| Point3::new(x, 0.0, 0.0));
        let known =
            |p: &Point3<f64>| self.belief.parts.deviation(&placed.name, p)[1] < self.parameters.touch.trusted;
        if ends.iter().all(known) {
            return Ok(());
        }
        self.hand.relax();
        let before = self.hand.setpoint;
        let x_wb = self.belief.parts.pose(&placed.name)?;
        // The table's plane, as high as the axis of a beam that lies on it.
        let x_wa = self.belief.x_wa();
        let lying = |p: &Point3<f64>| {
            let p_a = x_wa.inverse_transform_point(p);
            (x_wa * Point3::new(p_a.x, p_a.y, placed.axis_height_on_table())).z
        };
        let over = ends.map(|end| (x_wb * end).z - lying(&(x_wb * end)));
        let mut down = before;
        down.translation.z -= over[0].max(over[1]) + self.parameters.touch.further;
        let mut rise = Rise::over_beginning(-Vector3::z(), &self.parameters.rise);
        let limit = self.parameters.touch.press;
        let touched =
            self.hand.drive(&down, self.parameters.touch.press_speed, |hand| rise.sense(hand) > limit)?;
        if touched {
            // The impact has stopped the hand: now it presses.
            self.hand.relax();
            let mut press = self.hand.setpoint;
            press.translation.z -= limit / self.hand.stiffness.z;
            self.hand.go(&press, self.parameters.touch.load_speed)?;
            let along = x_wb.rotation * Vector3::x();
            self.rock(&Vector3::z().cross(&along))?;
        }
        self.hand.wait(self.parameters.touch.flat)?;
        self.belief.parts.follow(&self.hand);
        if touched {
            let x_wb = self.belief.parts.pose(&placed.name)?;
            let off = ends.map(|end| (x_wb * end).z - lying(&(x_wb * end)));
            for end in &ends {
                let height = lying(&(x_wb * end));
                self.belief.parts.stands_at(&placed.name, end, height, self.parameters.touch.known);
            }
            let (part, off) = (placed.name.clone(), off.to_vec());
            self.record(EventKind::Touched { part, surface: Surface::Table, off });
            self.hand.relax();
            let mut off_table = self.hand.setpoint;
            off_table.translation.z += self.parameters.touch.raise;
            return self.hand.go(&off_table, self.parameters.touch.back_speed);
        }
        self.hand.go(&before, self.parameters.touch.back_speed)
    }

    /// Whether the arm feels so much in free space that its joints must have much friction.
    pub fn is_rough(&self) -> bool {
        self.hand.usual_force >= self.parameters.touch.rough
    }

    /// Rocks the hand about an axis (a unit vector, axes of the world) with a swing that dies away: the beam
    /// that it presses comes to lie as the contact says, and not as the friction of the joints holds the
    /// hand. An arm whose force in free space is nearly right has little friction, and does without.
    fn rock(&mut self, axis: &Vector3<f64>) -> Result<(), SkillError> {
        let touch = self.parameters.touch.clone();
        if !self.is_rough() {
            return Ok(());
        }
        let (begin, middle) = (self.hand.time(), self.hand.setpoint);
        loop {
            let time = self.hand.time() - begin;
            let left = 1.0 - time / touch.rock_time;
            if left <= 0.0 {
                break;
            }
            let angle = touch.rock * left * (std::f64::consts::TAU * touch.rock_rate * time).sin();
            let turn = UnitQuaternion::from_scaled_axis(axis * angle);
            self.hand.setpoint = Pose::from_parts(middle.translation, turn * middle.rotation);
            self.hand.tick()?;
        }
        self.hand.setpoint = middle;
        Ok(())
    }

    /// Height correction for a beam that goes through a sleeve, m: backs off from the edge that blocks it,
    /// lowers the beam onto the sleeve's floor, and compares. 0 when the measurement is inconclusive.
    pub fn touch_floor(
        &mut self,
        part: &str,
        sleeve: JointRef,
        direction: &Vector3<f64>,
    ) -> Result<f64, SkillError> {
        let hole = self.belief.parts.hole(self.assembly, sleeve)?;
        let inside = |x_wp: &Pose| Point3::new(x_wp.inverse_transform_point(&hole).x, 0.0, 0.0);
        if self.belief.parts.deviation(part, &inside(&self.belief.parts.pose(part)?))[1]
            < self.parameters.touch.trusted
        {
            return Ok(0.0);
        }
        let mut back = self.hand.setpoint;
        back.translation.vector =
            self.hand.seen.x_wt.translation.vector - direction * self.parameters.touch.back;
        self.hand.go(&back, self.parameters.touch.back_speed)?;
        self.hand.wait(self.parameters.hand.rest)?;
        let mut down = self.hand.setpoint;
        down.translation.z -= 2.0 * self.parameters.touch.depth;
        let mut rise = Rise::over_beginning(-Vector3::z(), &self.parameters.rise);
        let limit = self.parameters.touch.force;
        let touched = self.hand.drive(&down, self.parameters.touch.speed, |hand| rise.sense(hand) > limit)?;
        self.glance()?;
        let x_wp = self.belief.parts.pose(part)?;
        let believed = (x_wp * inside(&x_wp)).z;
        self.hand.go(&back, self.parameters.touch.back_speed)?;
        self.hand.wait(self.parameters.hand.rest)?;
        // On the floor lies the extrusion, or a joint's body.
        let floor = (FEMALE_HEIGHT - BODY_WIDTH) / 2.0 - joint::CLEARANCE;
        let off = [EXTRUSION, BODY_WIDTH].map(|width| believed - (floor + width / 2.0));
        let off = off.into_iter().min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or_default();
        if !touched || off.abs() > self.parameters.touch.depth / 2.0 {
            return Ok(0.0);
        }
        let part = part.to_string();
        self.record(EventKind::Touched { part, surface: Surface::Floor, off: vec![off] });
        Ok(off)
    }
}
