//! The printed joints of each type.

use super::body::{MM, PAST, Solid, SolidError};
use crate::dimensions::{Dimensions, FEET, MALE_CHAMFER, MALE_TIP, SCREW, TAG_PLATE, TAG_RECESS};
use crate::joint::{JointForm, JointType};
use std::sync::{Mutex, PoisonError};

/// A joint: the origin is on the axis of its peg hole at the underside of its body, y along the beam, z up.
///
/// ```
/// use ramp_kit::{Dimensions, JointType, solid};
/// let sleeve = solid::joint(JointType::ThruF, &Dimensions::BENCHMARK)?;
/// assert!((sleeve.volume() - 21720.4).abs() < 20.0);
/// # Ok::<(), solid::SolidError>(())
/// ```
///
/// # Errors
/// Dimensions that give an empty solid, or several pieces.
pub fn joint(kind: JointType, dimensions: &Dimensions) -> Result<Solid, SolidError> {
    static MADE: Mutex<Option<Made>> = Mutex::new(None);
    let mut made = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    if made.as_ref().is_none_or(|made| made.dimensions != *dimensions) {
        *made = None;
    }
    let made = made.get_or_insert_with(|| Made { dimensions: *dimensions, joints: Vec::new() });
    if let Some((_, solid)) = made.joints.iter().find(|(other, _)| *other == kind) {
        return Ok(solid.clone());
    }
    let form = kind.form();
    let sizes = Sizes::new(dimensions);
    let solid = if form.male { male(kind, form, &sizes) } else { female(kind, form, &sizes) };
    let solid = solid.checked(kind.name())?;
    made.joints.push((kind, solid.clone()));
    Ok(solid)
}

/// The joints of the last dimensions: one takes tens of milliseconds, and a kit has many of a few types.
struct Made {
    dimensions: Dimensions,
    joints: Vec<(JointType, Solid)>,
}

/// Derived dimensions, mm.
struct Sizes {
    wall: f64,
    clearance: f64,
    /// Half of the body, of the socket and of a female's cavity; the height of a female.
    body: f64,
    socket: f64,
    cavity: f64,
    height: f64,
    hole: f64,
}

impl Sizes {
    fn new(d: &Dimensions) -> Sizes {
        Sizes {
            wall: d.wall * MM,
            clearance: d.clearance * MM,
            body: d.body() * MM / 2.0,
            socket: d.socket() * MM / 2.0,
            cavity: d.cavity() * MM / 2.0,
            height: d.female_height() * MM,
            hole: d.peg_hole * MM / 2.0,
        }
    }

    fn hole(&self, z: [f64; 2]) -> Solid {
        Solid::round([0.0; 2], [self.hole; 2], [z[0] - PAST, z[1] + PAST])
    }

    /// The countersunk hole in the wall of a socket at y, its axis at height z; `side` (±1) is the
    /// face it is in.
    fn screw(&self, side: f64, y: f64, z: f64) -> Solid {
        let (cone, outer, inner) = (SCREW.cone * MM, SCREW.outer * MM, SCREW.inner * MM);
        // Along +z first: the countersink from below, a little longer than its depth on the outside.
        let steeper = (outer - inner) / cone * PAST;
        let sink = Solid::round([0.0; 2], [outer + steeper, inner], [-PAST, cone]);
        let shank = Solid::round([0.0; 2], [inner; 2], [0.0, self.wall + PAST]);
        let turn = if side > 0.0 { -90.0 } else { 90.0 };
        Solid::union(&[sink, shank]).rotated([0.0, turn, 0.0]).translated([side * self.body, y, z])
    }

    /// The socket between its floor `from` and its mouth `to`, with its screw hole.
    fn socket(&self, [from, to]: [f64; 2], side: f64, z: f64) -> [Solid; 2] {
        let out = (to - from).signum();
        let ends = [from.min(to + out * PAST), from.max(to + out * PAST)];
        let half = self.socket;
        [Solid::cuboid([-half, half], ends, [z - half, z + half]), self.screw(side, (from + to) / 2.0, z)]
    }
}

fn male(kind: JointType, form: &JointForm, s: &Sizes) -> Solid {
    let (sleeve, floor) = (kind.sleeve() * MM, form.socket_offset * MM);
    let (w, z) = (s.body, [0.0, 2.0 * s.body]);
    if !form.end {
        let body = Solid::cuboid([-w, w], [-sleeve, sleeve], z);
        let mut cuts = vec![s.hole(z)];
        for way in [1.0, -1.0] {
            cuts.extend(s.socket([way * floor, way * sleeve], 1.0, w));
        }
        return body.minus(&cuts);
    }
    let mut solids = Vec::new();
    for section in form.sections() {
        let [from, to] = section.along.map(|v| v * MM);
        let solid = if section.along[1] < MALE_TIP {
            let [right, left] = section.across.map(|v| v * MM);
            Solid::cuboid([-left, -right], [from, to], z)
        } else {
            let c = MALE_CHAMFER * MM;
            let ring = |y: f64, inset: f64| {
                [(-1.0, 0), (1.0, 0), (1.0, 1), (-1.0, 1)]
                    .map(|(x, top)| [x * (w - inset), y, if top == 0 { inset } else { z[1] - inset }])
            };
            Solid::hull(&[ring(from, 0.0), ring(to - c, 0.0), ring(to, c)].concat())
        };
        // Anticlockwise from above is also to the left of +y.
        solids.push(solid.rotated([0.0, 0.0, section.turn.to_degrees()]));
    }
    let plate = sleeve + TAG_PLATE * MM;
    solids.push(Solid::cuboid([-w, w], [-plate, -sleeve + 0.5], [z[1] - s.wall, z[1]]));
    if form.feet {
        let [across, along] = FEET.map(|range| range.map(|v| v * MM));
        for side in [-1.0, 1.0] {
            let mut x = across.map(|v| side * v);
            x.sort_by(f64::total_cmp);
            solids.push(Solid::cuboid(x, along, [-(s.height / 2.0 - w), 0.5]));
        }
    }
    let mut cuts = vec![s.hole(z)];
    cuts.extend(s.socket([-floor, -sleeve], -1.0, w));
    cuts.push(recess(kind, z[1], 0.5));
    Solid::union(&solids).minus(&cuts)
}

/// The recess for the tag in the face at height z, `depth` deep; upwards when it is negative.
fn recess(kind: JointType, z: f64, depth: f64) -> Solid {
    let at = -kind.tag_offset().unwrap_or_default() * MM;
    let half = TAG_RECESS * MM / 2.0;
    let ends = if depth > 0.0 { [z - depth, z + PAST] } else { [z - PAST, z - depth] };
    Solid::cuboid([-half, half], [at - half, at + half], ends)
}

fn female(kind: JointType, form: &JointForm, s: &Sizes) -> Solid {
    let (sleeve, floor) = (kind.sleeve() * MM, form.socket_offset * MM);
    let (w, middle) = (s.body, s.height / 2.0);
    let cavity = form.cavity * MM;
    let head = cavity + s.wall;
    // An end is open where the beam stops, and to −x; a middle to +x.
    let (open, ends) = if form.end { (-1.0, [-head, cavity]) } else { (1.0, [-head, head]) };
    let neck = if form.end { [-sleeve, 0.0] } else { [-sleeve, sleeve] };
    let solids = [
        Solid::cuboid([-w, w], ends, [0.0, s.height]),
        Solid::cuboid([-w, w], neck, [middle - w, middle + w]),
    ];
    let closed = if form.one_sided { w - s.wall } else { w + PAST };
    let x = if open > 0.0 { [-closed, w + PAST] } else { [-w - PAST, closed] };
    let y = if form.end { [-cavity, cavity + PAST] } else { [-cavity, cavity] };
    let mut cuts = vec![Solid::cuboid(x, y, [middle - s.cavity, middle + s.cavity]), s.hole([0.0, s.height])];
    if form.end {
        cuts.extend(s.socket([-floor, -sleeve], -1.0, middle));
        cuts.push(recess(kind, middle + w, s.clearance));
        cuts.push(recess(kind, middle - w, -s.clearance));
    } else {
        for way in [1.0, -1.0] {
            cuts.extend(s.socket([way * floor, way * sleeve], 1.0, middle));
        }
    }
    Solid::union(&solids).minus(&cuts)
}
