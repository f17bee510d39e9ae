//! Target pose and insertion path of a beam: the plan's path, aimed at the detected joints that the beam
//! meets.

use nalgebra::{Point2, Translation3, UnitQuaternion, Vector2, Vector3};
use ramp_assembly::{Assembly, JointRef};

use super::assembly_belief::{AssemblyBelief, Point};
use crate::Pose;
use crate::fault::{Fault, SkillError};
use crate::insertion_path::InsertionPath;

impl AssemblyBelief<'_> {
    /// The frame of the assembly in the world: where the clamped beam is believed to be, with the height and
    /// the tilt of the table under it.
    pub fn x_wa(&self) -> Pose {
        let base = &self.assembly.beams[self.assembly.base];
        self.parts.pose(&base.beam.name).map_or(self.assembly.kit.x_wa(), |x_wb| x_wb * base.x_ab.inverse())
    }

    /// Target pose of a beam of the assembly in the world: its nominal pose, shifted to the actual joints it
    /// meets.
    ///
    /// # Errors
    /// [`Fault::Unseen`].
    pub fn target(&self, beam: usize) -> Result<Pose, SkillError> {
        let placed = &self.assembly.beams[beam];
        let nominal = self.x_wa() * placed.x_ab;
        // Pairs of horizontal hole positions: nominal on this beam, real on the standing one.
        let mut pairs: Vec<(Point2<f64>, Point2<f64>)> = Vec::new();
        // A free sleeve moves along; only fixed ones count.
        let loose = self.loose_sleeves(beam, 0);
        let loose =
            if self.meeting(beam).iter().all(|(met, _)| loose.contains(met) || *met == placed.beam.name) {
                &[]
            } else {
                &loose[..]
            };
        for connection in &self.assembly.connections {
            if let Some((mine, theirs)) = self.assembly.sides(connection, beam)
                && self.meets(theirs, beam)
                && !loose.contains(&self.assembly.beams[theirs.beam].beam.name)
            {
                let here = nominal * placed.beam.p_b_hole(mine.joint);
                pairs.push((here.xy(), self.parts.hole(self.assembly, theirs)?.xy()));
            }
        }
        Ok(moved_onto(&nominal, &pairs))
    }

    /// The holes of this beam and of the beams that it meets where it is to stand.
    pub fn meeting(&self, beam: usize) -> Vec<Point> {
        let sides = self.assembly.connections.iter().filter_map(|connection| {
            let (mine, theirs) = self.assembly.sides(connection, beam)?;
            self.meets(theirs, beam).then_some([mine, theirs])
        });
        sides.flatten().map(|joint| self.hole(joint)).collect()
    }

    /// Was a beam laid down, rather than inserted?
    pub fn lies(&self, beam: usize) -> bool {
        self.paths.get(&beam).is_some_and(|path| path.direction.z < -0.5)
    }

    /// Is a joint of another beam where `beam` meets it? One of a deep beam is not, yet.
    pub fn meets(&self, theirs: JointRef, beam: usize) -> bool {
        theirs.beam != beam && self.standing.contains(&theirs.beam) && !self.deep.contains(&theirs.beam)
    }

    /// The insertion of this beam.
    pub fn path(&self, beam: usize) -> Result<&InsertionPath, SkillError> {
        let name = || self.assembly.beams[beam].beam.name.clone();
        self.paths.get(&beam).ok_or_else(|| Fault::NoPath { part: name() }.into())
    }

    /// The direction in which a beam is put in so that it ends at `goal`: the nominal one, turned as the goal
    /// is turned from the nominal place. Axes of the world.
    pub fn insertion_direction(&self, beam: usize, goal: &Pose) -> Result<Vector3<f64>, SkillError> {
        let x_wa = self.x_wa();
        let nominal = x_wa * self.assembly.beams[beam].x_ab;
        let turn = goal.rotation * nominal.rotation.inverse();
        Ok(turn * x_wa.rotation * self.path(beam)?.direction)
    }

    /// A beam was slid forward into others: those that no peg holds come off, and back on, along its path
    /// alone.
    pub fn slid_into(&mut self, beam: usize) {
        let Some(direction) = self.paths.get(&beam).map(|path| path.direction) else { return };
        let base = self.assembly.base;
        let sides = self.assembly.connections.iter().filter_map(|it| self.assembly.sides(it, beam));
        let loose = sides
            .map(|(_, theirs)| theirs.beam)
            .filter(|other| *other != base && self.standing.contains(other) && self.anchor(*other).is_none());
        for other in loose.collect::<Vec<_>>() {
            if let Some(path) = self.paths.get_mut(&other) {
                path.direction = direction;
            }
        }
    }

    /// The pose of a beam where its insertion begins, `height` (m) over its insertion path.
    pub fn insertion_start(&self, beam: usize, height: f64) -> Result<Pose, SkillError> {
        let path = self.path(beam)?;
        let back = self.x_wa().rotation * path.direction * -path.distance;
        let goal = self.target(beam)?;
        Ok(Translation3::new(back.x, back.y, back.z + height) * goal)
    }

    /// The beams, by name, that this beam passes through, that lie on the table, and that at most `pegs`
    /// hold: a beam that was inserted is held by its joint as well.
    pub fn loose_sleeves(&self, beam: usize, pegs: usize) -> Vec<String> {
        let pins = |beam: usize| {
            let pinned = self.pinned.iter().map(|(index, _)| &self.assembly.connections[*index]);
            pinned.filter(|connection| self.assembly.sides(connection, beam).is_some()).count()
        };
        let loose = self.sleeves(beam).map(|sleeve| sleeve.beam);
        let loose = loose.filter(|&sleeve| self.lies(sleeve) && pins(sleeve) <= pegs);
        loose.map(|sleeve| self.assembly.beams[sleeve].beam.name.clone()).collect()
    }

    /// The sleeves of other beams that this beam goes through.
    pub fn sleeves(&self, beam: usize) -> impl Iterator<Item = JointRef> {
        let through = self.assembly.connections.iter().filter(move |connection| {
            let male = &self.assembly.beams[connection.male.beam].beam.joints[connection.male.joint];
            connection.male.beam == beam && !male.kind.is_end() && self.meets(connection.female, beam)
        });
        through.map(|connection| connection.female)
    }

    /// See [`free_end`].
    pub fn free_end(&self, beam: usize) -> f64 {
        free_end(self.assembly, self.paths.get(&beam), beam)
    }

    /// Is a joint at the end of a deep beam that leaves the sleeve first?
    pub fn leads(&self, joint: JointRef) -> bool {
        let beam = &self.assembly.beams[joint.beam].beam;
        (beam.joints[joint.joint].offset - self.free_end(joint.beam)).abs() < beam.span() / 2.0
    }
}

/// Distance from j1, m, of the end of a deep beam that is to go into the other joint: the one that leads on
/// the way out.
pub fn free_end(assembly: &Assembly, path: Option<&InsertionPath>, beam: usize) -> f64 {
    let placed = &assembly.beams[beam];
    let along = placed.x_ab.rotation * Vector3::x();
    let into = path.map_or(0.0, |path| along.dot(&path.direction));
    if into > 0.0 { 0.0 } else { placed.beam.span() }
}

/// The pose moved in the plane so that points of it fall on given points as well as they can: by their mean
/// shift, and by the best rotation if they are far enough apart to determine it.
fn moved_onto(nominal: &Pose, pairs: &[(Point2<f64>, Point2<f64>)]) -> Pose {
    if pairs.is_empty() {
        return *nominal;
    }
    let n = pairs.len() as f64;
    let from: Vector2<f64> = pairs.iter().map(|(a, _)| a.coords).sum::<Vector2<f64>>() / n;
    let to: Vector2<f64> = pairs.iter().map(|(_, b)| b.coords).sum::<Vector2<f64>>() / n;
    let (mut sine, mut cosine) = (0.0, 0.0);
    for (a, b) in pairs {
        let (a, b) = (a.coords - from, b.coords - to);
        sine += a.perp(&b);
        cosine += a.dot(&b);
    }
    // Nearer together than 50 mm the points say more about noise than about the turn.
    let angle = if cosine > 0.05_f64.powi(2) { sine.atan2(cosine) } else { 0.0 };
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
    let pivot = Translation3::new(from.x, from.y, 0.0);
    let moved = Translation3::new(to.x, to.y, 0.0);
    moved * turn * pivot.inverse() * nominal
}
