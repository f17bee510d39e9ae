//! The place on the sheet to which a part is put back.

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::{Beam, Holder, Peg};

use super::footprints::is_clear;
use super::workcell::Workcell;
use crate::Pose;

impl Workcell<'_, '_> {
    /// The place on the sheet to which a part is put back, in the world. `None` for the clamped beam.
    ///
    /// A beam goes to its own outline, or to one of its shape, so that it is clear of all other parts: if
    /// need be a little beside the outline, as far as a start lays parts. A peg goes to its own hole of a
    /// holder, or to the nearest free one, where the holder is seen to stand.
    pub fn sheet_place(&self, part: &str) -> Option<Pose> {
        match self.kit.beam(part) {
            Some(beam) => self.place_of_beam(beam, |_| true),
            None => self.place_of_peg(part),
        }
    }

    /// Has the part in the hand put down at its place on the sheet ([`Workcell::sheet_place`]), and not where
    /// it was picked up. For a beam, the open fingers have room there.
    pub fn return_to_sheet(&mut self, part: &str) {
        let Some(x_pt) = self.hand.held.as_ref().map(|held| held.x_tp.inverse()) else { return };
        let open = self.parameters.grip.beam_release;
        let place = match self.kit.beam(part) {
            Some(beam) => self
                .place_of_beam(beam, |x_wb| self.has_room(&(x_wb * x_pt), open, part))
                .or_else(|| self.sheet_place(part)),
            None => self.sheet_place(part),
        };
        if let (Some(place), Some(held)) = (place, &mut self.hand.held) {
            held.x_wp_back = place;
            held.returns_to_sheet = true;
        }
    }

    /// Whether a part is believed to be in a place on the sheet where it may be put back.
    pub fn is_in_sheet_place(&self, part: &str) -> bool {
        let own = &self.parameters.sheet_place;
        let Ok(x_wp) = self.belief.parts.pose(part) else { return false };
        let (places, middle, turn) = match self.kit.beam(part) {
            Some(beam) => {
                (self.outlines(beam), beam.span() / 2.0, own.turn.iter().fold(0.0, |a, b| b.max(a)))
            }
            None => (self.holes_of_holders(part), 0.0, f64::INFINITY),
        };
        let middle = Point3::new(middle, 0.0, 0.0);
        places.iter().any(|place| {
            let off = x_wp * middle - place * middle;
            off.xy().norm() < own.near
                && off.z.abs() < own.near
                && (x_wp.rotation * Vector3::x()).angle(&(place.rotation * Vector3::x()))
                    < turn + own.turn_near
        })
    }

    /// Whether a part is believed to lie on the sheet, near a place where it may lie there.
    pub fn is_on_sheet(&self, part: &str) -> bool {
        let Ok(x_wp) = self.belief.parts.pose(part) else { return false };
        let (places, middle) = match self.kit.beam(part) {
            Some(beam) => (self.outlines(beam), beam.span() / 2.0),
            None => (self.holes_of_holders(part), 0.0),
        };
        let middle = Point3::new(middle, 0.0, 0.0);
        let near = |place: &Pose| (x_wp * middle - place * middle).norm() < self.parameters.repair.on_sheet;
        places.iter().any(near)
    }

    /// The outlines on which a beam may lie, its own first.
    fn outlines(&self, beam: &Beam) -> Vec<Pose> {
        let others = self.kit.beams.iter();
        let others = others.filter(|other| other.has_shape_of(beam) && other.name != beam.name);
        std::iter::once(beam).chain(others).filter_map(|it| self.kit.x_wb_start(it)).collect()
    }

    /// The pose on or beside an outline that is clear of all other parts by as much as can be, and nearest to
    /// the outline; its own outline where none is.
    fn place_of_beam(&self, beam: &Beam, allowed: impl Fn(&Pose) -> bool) -> Option<Pose> {
        let (outlines, around) = (self.outlines(beam), self.around(beam));
        let own = &self.parameters.sheet_place;
        let middle = Translation3::new(beam.span() / 2.0, 0.0, 0.0);
        let mut offsets: Vec<(f64, [f64; 3])> = Vec::new();
        for x in own.shift {
            for y in own.shift {
                // A turn moves the ends as much as this shift.
                offsets.extend(own.turn.map(|yaw| (x.hypot(y).hypot(yaw * beam.span() / 2.0), [x, y, yaw])));
            }
        }
        offsets.sort_by(|(a, _), (b, _)| a.total_cmp(b));
        for beside in own.beside {
            for outline in &outlines {
                let beside_it = offsets.iter().map(|(_, [x, y, yaw])| {
                    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), *yaw);
                    let about = Translation3::from((outline * middle).translation.vector);
                    Translation3::new(*x, *y, 0.0) * about * turn * about.inverse() * outline
                });
                let found =
                    beside_it.into_iter().find(|x_wb| is_clear(beam, x_wb, &around, beside) && allowed(x_wb));
                if found.is_some() {
                    return found;
                }
            }
        }
        None
    }

    fn place_of_peg(&self, peg: &str) -> Option<Pose> {
        let mut holes = self.holes_of_holders(peg);
        let own = *holes.first()?;
        let off = |x: &Pose, other: &Pose| (x.translation.vector - other.translation.vector).xy().norm();
        holes.sort_by(|a, b| off(a, &own).total_cmp(&off(b, &own)));
        let others = self.kit.pegs.iter().filter(|other| other.name != peg);
        let others: Vec<Pose> = others.filter_map(|other| self.belief.parts.pose(&other.name).ok()).collect();
        let free = |hole: &&Pose| others.iter().all(|other| off(other, hole) > Holder::PITCH / 2.0);
        Some(holes.iter().find(free).copied().unwrap_or(own))
    }

    /// The poses of a peg in the holes of all holders, in its own hole first.
    fn holes_of_holders(&self, peg: &str) -> Vec<Pose> {
        let holders = self.belief.parts.holders(self.kit);
        let others = self.kit.pegs.iter().filter(|other| other.name != peg);
        let hole = |peg: &Peg| {
            let (_, x_wh) = holders.iter().find(|(name, _)| *name == peg.holder)?;
            let along = f64::from(peg.slot) * Holder::PITCH;
            Some(x_wh * Pose::from(Translation3::new(along, 0.0, Holder::HEIGHT)))
        };
        self.kit.peg(peg).into_iter().chain(others).filter_map(hole).collect()
    }
}
