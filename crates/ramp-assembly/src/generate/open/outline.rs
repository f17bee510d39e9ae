//! Copies of goals, up to symmetry.

use crate::assembly::Assembly;
use nalgebra::Point2;

/// Holes nearer than this are at the same place, m. Different goals of a kit differ by much more.
const NEAR: f64 = 1.0e-3;

/// A joint of a beam: its type, and its hole, m in the assembly frame.
type PlacedJoint = (&'static str, Point2<f64>);

/// The shape of a goal: which joint types lie where. Names of beams, and the order in the file, do not
/// count; neither does the side to which a joint is open.
#[derive(Clone, Debug)]
pub(super) struct Outline {
    pegs: usize,
    /// Length of the clamped beam, m: it lies along X from the origin.
    base: f64,
    /// The joints of each beam.
    beams: Vec<Vec<PlacedJoint>>,
}

impl Outline {
    /// The outline of a goal.
    pub fn of(assembly: &Assembly) -> Outline {
        let beam = |placed: &crate::PlacedBeam| {
            let joints = placed.beam.joints.iter().enumerate();
            let hole = |index| (placed.x_ab * placed.beam.p_b_hole(index)).xy();
            joints.map(|(index, joint)| (joint.kind.name(), hole(index))).collect()
        };
        Outline {
            pegs: assembly.connections.len(),
            base: assembly.beams[assembly.base].beam.span(),
            beams: assembly.beams.iter().map(beam).collect(),
        }
    }

    /// Whether two goals are the same one: as they are, or one as the mirror image of the other, at the
    /// middle of the clamped beam. Beams of one shape count as one another, from either end.
    pub fn is_copy(&self, other: &Outline) -> bool {
        self.pegs == other.pegs
            && self.beams.len() == other.beams.len()
            && [false, true].into_iter().any(|mirrored| {
                self.beams.iter().all(|own| other.beams.iter().any(|it| self.lies_as(own, it, mirrored)))
            })
    }

    /// Whether a beam, or its mirror image, lies where another one does.
    fn lies_as(&self, own: &[PlacedJoint], other: &[PlacedJoint], mirrored: bool) -> bool {
        let image = |p: &Point2<f64>| if mirrored { Point2::new(self.base - p.x, p.y) } else { *p };
        let near = |(a, b): (&PlacedJoint, &PlacedJoint)| a.0 == b.0 && (image(&a.1) - b.1).norm() < NEAR;
        own.len() == other.len()
            && (own.iter().zip(other).all(near) || own.iter().zip(other.iter().rev()).all(near))
    }
}
