//! The printed joint types.
//!
//! A joint type is one row of a table ([`JointForm`]): its function and its lengths. Everything
//! else follows from the [`Dimensions`]. The seven types of the benchmark are [`FORMS`]; a kit file
//! may add more.

pub use crate::dimensions::{
    AXIS_HEIGHT, AXIS_HEIGHT_LYING, BODY_WIDTH, CLEARANCE, Dimensions, EXTRUSION, EXTRUSION_MASS,
    FEMALE_HEIGHT, HEAD_HEIGHT, HEAD_ROUNDING, HEAD_WIDTH, HOLE_RADIUS, MALE_CHAMFER, MALE_TIP, PLA_DENSITY,
    SOCKET_DEPTH, STEM_CONE, STEM_LENGTH, STEM_RADIUS, STEM_TIP_RADIUS, TAG_PLATE, TAG_RECESS, WALL,
};
use crate::dimensions::{FEET, SCREW};
use std::collections::HashMap;
use std::hash::{Hash, Hasher};
use std::sync::{Mutex, PoisonError};

/// Thickness of the plate in the elbow of a bent male end, m.
const ELBOW: f64 = 12.0e-3;

/// The side of a beam, seen from above with j1 behind you and the last joint ahead.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// +y of the beam.
    Left,
    /// −y of the beam.
    Right,
}

impl Side {
    /// +1 for left, −1 for right: the sign of y in the beam's frame.
    pub fn sign(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// A joint type as a row of a table, with everything specific to it. All else follows from
/// [`Dimensions`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointForm {
    /// The name in kit files.
    pub name: &'static str,
    /// Whether it enters another joint.
    pub male: bool,
    /// Whether it sits at an end of its beam.
    pub end: bool,
    /// Whether it is a female that is open to one side only.
    pub one_sided: bool,
    /// Distance along the beam from the peg hole to the floor of the extrusion's socket, m.
    pub socket_offset: f64,
    /// Half the length of a female's cavity along the beam, m; 0 for a male.
    pub cavity: f64,
    /// Whether a male end stands on two feet.
    pub feet: bool,
    /// Angle between a male end's tip and its beam, about the hole, positive to the left of the
    /// direction out of the beam, rad.
    pub turn: f64,
}

const fn row(name: &'static str, male: bool, end: bool, socket_offset: f64) -> JointForm {
    JointForm { name, male, end, one_sided: false, socket_offset, cavity: 0.0, feet: false, turn: 0.0 }
}

const fn female(row: JointForm, cavity: f64, one_sided: bool) -> JointForm {
    JointForm { cavity, one_sided, ..row }
}

/// The seven joint types of the benchmark, in the order of the bill of parts.
pub const FORMS: [JointForm; 7] = [
    row("in-m-end", true, true, 8.6e-3),
    JointForm { feet: true, ..row("in-m-end-feet", true, true, 8.6e-3) },
    row("thru-m", true, false, 17.6e-3),
    female(row("in-f-end", false, true, 23.2e-3), 13.6e-3, true),
    female(row("in-f", false, false, 17.6e-3), 13.6e-3, true),
    female(row("thru-f", false, false, 17.6e-3), 13.6e-3, false),
    female(row("angle-f", false, false, 33.0e-3), 29.0e-3, false),
];

impl JointForm {
    /// Largest angle from straight at which a male of section `body` (m) passes this female, rad; 0
    /// for a male.
    pub fn entry_angle(&self, body: f64) -> f64 {
        if self.male {
            return 0.0;
        }
        // A strip as wide as the cavity is deep needs (1 + sin a) / cos a = tan(45° + a/2) of its
        // half width.
        2.0 * ((2.0 * self.cavity / body).atan() - std::f64::consts::FRAC_PI_4)
    }

    /// Smallest distance from the hole at which a section rotated by `angle` against the tip may
    /// begin without penetrating the female around the tip, measured back along that section, m.
    fn begin(angle: f64) -> f64 {
        let half = BODY_WIDTH / 2.0;
        (half + CLEARANCE + half * angle.sin().abs()) / angle.cos()
    }

    /// Smallest socket offset that keeps the beam's own section out of the female around a bent
    /// tip, m.
    pub fn least_socket_offset(&self) -> f64 {
        if self.turn == 0.0 { MALE_TIP - 2.0 * MALE_CHAMFER } else { JointForm::begin(self.turn) + WALL }
    }

    /// Volume of the printed part, m³.
    pub fn volume(&self) -> f64 {
        let d = Dimensions::BENCHMARK;
        let (body, socket, height) = (d.body(), d.socket(), d.female_height());
        let hole = std::f64::consts::PI * (d.peg_hole / 2.0).powi(2);
        let sockets = if self.end { 1.0 } else { 2.0 };
        let r = &SCREW;
        let cone = r.cone / 3.0 * (r.outer.powi(2) + r.outer * r.inner + r.inner.powi(2));
        let screw = std::f64::consts::PI * (cone + r.inner.powi(2) * (d.wall - r.cone));
        let cut = sockets * (socket * socket * SOCKET_DEPTH + screw);
        let sleeve = self.socket_offset + SOCKET_DEPTH;
        if self.male {
            let section = body * body;
            if !self.end {
                return section * 2.0 * sleeve - body * hole - cut;
            }
            // The four chamfers of the tip, with the corners counted once.
            let c = MALE_CHAMFER;
            let chamfer = section * c - (body.powi(3) - (body - 2.0 * c).powi(3)) / 6.0;
            let plate = TAG_PLATE * body * d.wall - TAG_RECESS * TAG_RECESS * 0.5e-3;
            let feet = if self.feet {
                let [across, along] = FEET.map(|range| range[1] - range[0]);
                2.0 * across * along * (height - body) / 2.0
            } else {
                0.0
            };
            return self.plan_area() * body - chamfer + plate + feet - body * hole - cut;
        }
        let head = self.cavity + d.wall;
        let (head_length, neck) =
            if self.end { (head + self.cavity, sleeve - head) } else { (2.0 * head, 2.0 * (sleeve - head)) };
        let open = if self.one_sided { body - d.wall } else { body };
        let recess = if self.end { 2.0 * TAG_RECESS * TAG_RECESS * d.clearance } else { 0.0 };
        head_length * body * height - 2.0 * self.cavity * open * d.cavity() - 2.0 * d.wall * hole
            + neck * body * body
            - cut
            - recess
    }

    /// Area of a male end seen from above without its tag plate, m².
    fn plan_area(&self) -> f64 {
        let sleeve = self.socket_offset + SOCKET_DEPTH;
        if self.turn == 0.0 {
            return BODY_WIDTH * (sleeve + MALE_TIP);
        }
        // Overlapping sections are integrated on a grid, accurate to a part in a thousand.
        let sections = self.sections();
        let step = 0.1e-3;
        let cells = (2.0 * sleeve / step) as i32;
        let mut count = 0u32;
        for row in -cells..cells {
            for column in -cells..cells {
                let (x, y) = ((f64::from(column) + 0.5) * step, (f64::from(row) + 0.5) * step);
                let inside = |section: &Section| {
                    let (sin, cos) = section.turn.sin_cos();
                    let (along, across) = (x * cos + y * sin, y * cos - x * sin);
                    let within = |value: f64, range: [f64; 2]| value > range[0] && value < range[1];
                    within(along, section.along) && within(across, section.across)
                };
                count += u32::from(sections.iter().any(inside));
            }
        }
        f64::from(count) * step * step
    }

    /// The sections of a male end from its socket to its tip, seen from above.
    pub(crate) fn sections(&self) -> Vec<Section> {
        let sleeve = self.socket_offset + SOCKET_DEPTH;
        let half = BODY_WIDTH / 2.0;
        let whole = [-half, half];
        if self.turn == 0.0 {
            return vec![Section { turn: 0.0, along: [-sleeve, MALE_TIP], across: whole }];
        }
        let begin = JointForm::begin(self.turn);
        // A plate behind the female, as wide as both together, joins the tip and the beam's own
        // section.
        let (back, front) = (JointForm::begin(0.0) + ELBOW, JointForm::begin(0.0));
        let (sin, cos) = self.turn.sin_cos();
        let far = half * cos + begin * sin.abs();
        let across = if self.turn > 0.0 { [-half, far] } else { [-far, half] };
        vec![
            Section { turn: 0.0, along: [-sleeve, -begin], across: whole },
            Section { turn: self.turn, along: [-back, -front], across },
            Section { turn: self.turn, along: [-back, MALE_TIP], across: whole },
        ]
    }
}

/// A straight piece of a male end, see [`JointForm::sections`]: its rotation about the hole, and
/// its ranges along its own direction and across it, to the left.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section {
    pub turn: f64,
    pub along: [f64; 2],
    pub across: [f64; 2],
}

/// A joint type added by a kit file; two are equal when all fields of their rows are equal.
#[derive(Clone, Copy, Debug)]
pub struct Added(&'static JointForm);

impl PartialEq for Added {
    fn eq(&self, other: &Added) -> bool {
        std::ptr::eq(self.0, other.0)
    }
}

impl Eq for Added {}

impl Hash for Added {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.0.name.hash(state);
    }
}

/// Every row added by a kit file in this process, so that equal rows are stored once.
static ADDED: Mutex<Option<HashMap<String, Vec<&'static JointForm>>>> = Mutex::new(None);

/// A type of joint, by its name in the published files.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum JointType {
    /// `in-m-end`: a male end; its beam lies flat on the table.
    InMEnd,
    /// `in-m-end-feet`: a male end on two feet, which hold it at the height of a female's floor.
    InMEndFeet,
    /// `thru-m`: a male in the middle of a beam; the beam passes through a female.
    ThruM,
    /// `in-f-end`: a female at the beam's end, open to one side.
    InFEnd,
    /// `in-f`: a female in the middle of a beam, open to one side, with a stop wall.
    InF,
    /// `thru-f`: a female in the middle of a beam, open to both sides.
    ThruF,
    /// `angle-f`: a long female in the middle of a beam, open to both sides, entered at up to 40.7°.
    AngleF,
    /// A type described in the kit file itself.
    Added(Added),
}

impl JointType {
    /// The seven of the benchmark, in the order of the bill of parts.
    pub const ALL: [JointType; 7] = [
        JointType::InMEnd,
        JointType::InMEndFeet,
        JointType::ThruM,
        JointType::InFEnd,
        JointType::InF,
        JointType::ThruF,
        JointType::AngleF,
    ];

    /// A type of the kit file's own. Rows are kept for the lifetime of the process, one per
    /// description, however often it is read.
    pub fn added(name: &str, form: JointForm) -> JointType {
        let mut added = ADDED.lock().unwrap_or_else(PoisonError::into_inner);
        let known = added.get_or_insert_default().entry(name.to_string()).or_default();
        let same = known.iter().find(|row| JointForm { name: form.name, ..***row } == form);
        JointType::Added(Added(same.copied().unwrap_or_else(|| {
            let name: &'static str = known.first().map_or_else(|| &*name.to_string().leak(), |row| row.name);
            let row: &'static JointForm = Box::leak(Box::new(JointForm { name, ..form }));
            known.push(row);
            row
        })))
    }

    /// Its row of the table.
    pub fn form(self) -> &'static JointForm {
        match self {
            JointType::InMEnd => &FORMS[0],
            JointType::InMEndFeet => &FORMS[1],
            JointType::ThruM => &FORMS[2],
            JointType::InFEnd => &FORMS[3],
            JointType::InF => &FORMS[4],
            JointType::ThruF => &FORMS[5],
            JointType::AngleF => &FORMS[6],
            JointType::Added(row) => row.0,
        }
    }

    /// The name in kit files.
    pub fn name(self) -> &'static str {
        self.form().name
    }

    /// The benchmark's type of this name.
    pub fn from_name(name: &str) -> Option<JointType> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Whether it enters another joint.
    pub fn is_male(self) -> bool {
        self.form().male
    }

    /// Whether it sits at an end of its beam.
    pub fn is_end(self) -> bool {
        self.form().end
    }

    /// Whether it is open to one side only, so that the kit must say which.
    pub fn has_opening(self) -> bool {
        self.form().one_sided
    }

    /// Distance along the beam from the peg hole to the floor of the extrusion's socket, m.
    pub fn socket_offset(self) -> f64 {
        self.form().socket_offset
    }

    /// Distance along the beam from the peg hole to the end of the joint's outside, where the bare
    /// extrusion begins, m.
    pub fn sleeve(self) -> f64 {
        self.socket_offset() + SOCKET_DEPTH
    }

    /// Distance along the beam from the peg hole to the first place with room for the gripper from
    /// above, m: past the tag plate of a male end, otherwise the sleeve.
    pub fn top_cover(self) -> f64 {
        if self.is_male() && self.is_end() { self.sleeve() + TAG_PLATE } else { self.sleeve() }
    }

    /// Distance along the beam from the peg hole inwards to the centre of the tag, m; `None` for a
    /// joint in the middle of a beam, which has none.
    pub fn tag_offset(self) -> Option<f64> {
        let form = self.form();
        let from = if form.male { self.sleeve() + 1.0e-3 } else { form.cavity + WALL + 0.55e-3 };
        form.end.then_some(from + TAG_RECESS / 2.0)
    }

    /// Height of the tag's recess over the beam's axis, m; `None` for a joint without one.
    pub fn tag_height(self) -> Option<f64> {
        let form = self.form();
        form.end.then_some(BODY_WIDTH / 2.0 - if form.male { 0.5e-3 } else { 0.3e-3 })
    }

    /// Mass of the printed part, kg: its volume in solid PLA.
    pub fn mass(self) -> f64 {
        self.form().volume() * PLA_DENSITY
    }
}
