//! The state of a frame in which an episode begins, as a file: beams in their goal poses, pegs in their
//! connections, and parts in any pose. The agent is not told of it.

use std::collections::BTreeMap;
use std::path::Path;

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::source::{Fault, FormProblem, MAX_SENTENCE, Problem, SourceFile, nearest, plain};
use ramp_kit::{Kit, Pose};
use serde::Deserialize;
use serde::de::IgnoredAny;

use crate::layout::Layout;
use crate::mjcf::TABLE_SIDE;

/// Largest deviation of a quaternion's length from one.
const UNIT: f64 = 1e-3;
/// Largest height of a part above the table, m.
const HIGHEST: f64 = 1.0;

/// An error in a state file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StateProblem {
    /// Not a text file.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// Not JSON, or not of the form of a state.
    #[error("this is no state: {0}")]
    Json(String),
    /// An unknown name.
    #[error("there is no {kind} `{name}` in {place}")]
    Unknown {
        /// Kind of the object.
        kind: &'static str,
        /// The name found.
        name: String,
        /// Expected owner of the name.
        place: String,
        /// The most similar name.
        nearest: Option<String>,
    },
    /// An episode cannot begin like this.
    #[error("{0}")]
    Impossible(String),
}

impl Problem for StateProblem {
    fn label(&self) -> String {
        match self {
            StateProblem::Form(problem) => problem.label(),
            StateProblem::Json(_) => "here".to_string(),
            StateProblem::Unknown { kind, .. } => format!("expected a {kind}"),
            StateProblem::Impossible(_) => "impossible".to_string(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            StateProblem::Form(problem) => problem.help(),
            StateProblem::Unknown { nearest: Some(nearest), .. } => {
                Some(format!("did you mean `{nearest}`?"))
            }
            _ => None,
        }
    }
}

/// An error in a state file, with its place.
pub type StateFault = Fault<StateProblem>;

/// The file: that of `ramp plan --state`, and poses.
#[derive(Deserialize)]
#[serde(default, deny_unknown_fields)]
#[derive(Default)]
struct Form {
    in_assembly: Vec<String>,
    fastened: Vec<(String, String)>,
    misaligned: Vec<String>,
    deep: Vec<String>,
    lost_pegs: Vec<String>,
    poses: BTreeMap<String, PoseForm>,
    in_hand: Option<IgnoredAny>,
    slipped: Option<IgnoredAny>,
    hand_over: Option<IgnoredAny>,
    motion: Option<IgnoredAny>,
}

/// A pose in the world.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseForm {
    position: [f64; 3],
    quat_wxyz: Option<[f64; 4]>,
    yaw: Option<f64>,
}

/// The state of a frame in which an episode begins. All parts that it does not name lie as the start draws
/// them.
#[derive(Clone, Debug)]
pub struct GivenState {
    /// Its file.
    pub text: String,
    /// The pose of each named beam and peg in W, as if the table were level.
    poses: BTreeMap<String, Pose>,
}

impl GivenState {
    /// Reads a state file for a goal.
    ///
    /// # Errors
    /// The first error in the file.
    pub fn read(path: &Path, assembly: &Assembly) -> Result<GivenState, StateFault> {
        GivenState::from_source(&SourceFile::read(path)?, assembly)
    }

    /// As [`GivenState::read`], for a file that is already in memory.
    ///
    /// # Errors
    /// As [`GivenState::read`].
    pub fn from_source(file: &SourceFile, assembly: &Assembly) -> Result<GivenState, StateFault> {
        let form: Form = serde_json::from_str(file.text()).map_err(|error| {
            let before = file.text().split_inclusive('\n').take(error.line().saturating_sub(1));
            let at = before.map(str::len).sum::<usize>() + error.column().saturating_sub(1);
            Fault::new(StateProblem::Json(plain(&error.to_string(), MAX_SENTENCE)), file.place(at..at + 1))
        })?;
        let reading = Reading { file, assembly };
        reading.check_hand(&form)?;
        let mut poses = BTreeMap::new();
        for name in &form.in_assembly {
            let beam = reading.beam(name)?;
            poses.insert(name.clone(), assembly.kit.x_wa() * assembly.beams[beam].x_ab);
        }
        reading.fasten(&form, &mut poses)?;
        for (name, pose) in &form.poses {
            reading.part(name)?;
            poses.insert(name.clone(), reading.pose(name, pose)?);
        }
        for (names, what) in
            [(&form.misaligned, "misaligned"), (&form.deep, "pushed back"), (&form.lost_pegs, "lost")]
        {
            if let Some(name) = names.iter().find(|name| !form.poses.contains_key(*name)) {
                return reading.impossible(name, format!("`{name}` is {what}: give its pose under `poses`"));
            }
        }
        Ok(GivenState { text: file.text().to_string(), poses })
    }

    /// The whole frame, pinned by [`Assembly::built_with`].
    ///
    /// # Errors
    /// When the kit has fewer pegs than the goal has connections.
    pub fn built(assembly: &Assembly) -> Result<GivenState, StateFault> {
        let beams = assembly.beams.iter().enumerate().filter(|(index, _)| *index != assembly.base);
        let beams: Vec<&str> = beams.map(|(_, placed)| placed.beam.name.as_str()).collect();
        let connections = assembly.connections.iter().map(|connection| connection.name.as_str());
        let pegs: Vec<(&str, &str)> = connections.zip(assembly.built_with()).collect();
        let text = serde_json::json!({"in_assembly": beams, "fastened": pegs}).to_string();
        let file = SourceFile::new("built.json", &text);
        let state = GivenState::from_source(&file, assembly)?;
        if pegs.len() < assembly.connections.len() {
            let why = format!(
                "the kit has {} pegs, and the frame needs {}",
                pegs.len(),
                assembly.connections.len()
            );
            return Err(Fault::new(StateProblem::Impossible(why), file.place(0..1)));
        }
        Ok(state)
    }

    /// The names of the parts that it places.
    pub fn parts(&self) -> impl Iterator<Item = &str> {
        self.poses.keys().map(String::as_str)
    }

    /// Puts the named parts of a layout into their poses.
    pub(crate) fn place(&self, layout: &mut Layout) {
        for (name, x_wp) in layout.beams.iter_mut().chain(&mut layout.pegs) {
            if let Some(given) = self.poses.get(name) {
                *x_wp = *given;
            }
        }
    }
}

/// A file that is being read for a goal.
struct Reading<'a> {
    file: &'a SourceFile,
    assembly: &'a Assembly,
}

impl Reading<'_> {
    /// A fault at the first place where the file names this.
    fn fault(&self, name: &str, problem: StateProblem) -> StateFault {
        let quoted = format!("\"{name}\"");
        let at = self.file.text().find(&quoted).unwrap_or(0);
        Fault::new(problem, self.file.place(at..at + quoted.len()))
    }

    fn impossible<T>(&self, name: &str, why: String) -> Result<T, StateFault> {
        Err(self.fault(name, StateProblem::Impossible(why)))
    }

    fn unknown<'n>(
        &self,
        (kind, name, place): (&'static str, &str, &str),
        names: impl IntoIterator<Item = &'n str>,
    ) -> StateFault {
        let problem = StateProblem::Unknown {
            kind,
            name: plain(name, MAX_SENTENCE),
            place: place.to_string(),
            nearest: nearest(name, names).map(str::to_string),
        };
        self.fault(name, problem)
    }

    /// The hand starts empty at home, and the file tells where parts are.
    fn check_hand(&self, form: &Form) -> Result<(), StateFault> {
        for (key, is_there, why) in [
            ("in_hand", form.in_hand.is_some(), "the hand is empty when an episode begins"),
            ("slipped", form.slipped.is_some(), "the hand is empty when an episode begins"),
            ("hand_over", form.hand_over.is_some(), "the arm is at home when an episode begins"),
            ("motion", form.motion.is_some(), "limits of the arm move no part"),
        ] {
            if is_there {
                return self.impossible(key, format!("`{key}` cannot be given: {why}"));
            }
        }
        Ok(())
    }

    /// The index of a beam of the goal that is not clamped.
    fn beam(&self, name: &str) -> Result<usize, StateFault> {
        let Assembly { beams, .. } = self.assembly;
        let names = beams.iter().map(|placed| placed.beam.name.as_str());
        let unknown = || self.unknown(("beam", name, &self.assembly.name), names);
        let index = self.assembly.beam_index(name).ok_or_else(unknown)?;
        self.check_loose(name)?;
        Ok(index)
    }

    fn check_loose(&self, name: &str) -> Result<(), StateFault> {
        match self.assembly.beams[self.assembly.base].beam.name == name {
            true => self.impossible(name, format!("`{name}` is clamped to the table: leave it out")),
            false => Ok(()),
        }
    }

    fn peg(&self, name: &str) -> Result<(), StateFault> {
        let names = || self.assembly.kit.pegs.iter().map(|peg| peg.name.as_str());
        match names().any(|peg| peg == name) {
            true => Ok(()),
            false => Err(self.unknown(("peg", name, "the kit"), names())),
        }
    }

    /// Checks the name of a beam or a peg of the kit.
    fn part(&self, name: &str) -> Result<(), StateFault> {
        let Kit { beams, pegs, .. } = &*self.assembly.kit;
        let names = || beams.iter().map(|it| it.name.as_str()).chain(pegs.iter().map(|it| it.name.as_str()));
        if !names().any(|part| part == name) {
            return Err(self.unknown(("part", name, "the kit"), names()));
        }
        self.check_loose(name)
    }

    /// Puts the pegs of `fastened` into their holes.
    fn fasten(&self, form: &Form, poses: &mut BTreeMap<String, Pose>) -> Result<(), StateFault> {
        let assembly = self.assembly;
        let mut pinned = Vec::new();
        for (name, peg) in &form.fastened {
            let names = assembly.connections.iter().map(|connection| connection.name.as_str());
            let unknown = || self.unknown(("connection", name, &assembly.name), names);
            let index = assembly.connection_index(name).ok_or_else(unknown)?;
            self.peg(peg)?;
            if pinned.contains(&index) {
                return self.impossible(name, format!("`{name}` is fastened twice"));
            }
            pinned.push(index);
            let connection = &assembly.connections[index];
            for side in [connection.female, connection.male] {
                let beam = &assembly.beams[side.beam].beam.name;
                let moved = form.poses.contains_key(beam);
                if side.beam != assembly.base && (moved || !form.in_assembly.contains(beam)) {
                    return self
                        .impossible(name, format!("`{name}` is fastened, but `{beam}` is not in its place"));
                }
            }
            let hole = assembly.kit.x_wa() * assembly.p_a_hole(connection.female);
            let p = Translation3::new(hole.x, hole.y, hole.z + FEMALE_HEIGHT / 2.0);
            if poses.insert(peg.clone(), Pose::from_parts(p, UnitQuaternion::identity())).is_some() {
                return self.impossible(peg, format!("the peg `{peg}` is used twice"));
            }
            if form.poses.contains_key(peg) {
                return self.impossible(peg, format!("`{peg}` fastens `{name}`, but also has a pose"));
            }
        }
        Ok(())
    }

    fn pose(&self, name: &str, form: &PoseForm) -> Result<Pose, StateFault> {
        let [x, y, z] = form.position;
        if x.abs().max(y.abs()) > TABLE_SIDE || !(0.0..=HIGHEST).contains(&z) {
            let why = format!(
                "`{name}` is off the table: expected x and y from -{TABLE_SIDE} to {TABLE_SIDE} m, \
                 z from 0 to {HIGHEST} m"
            );
            return self.impossible(name, why);
        }
        let rotation = match (form.quat_wxyz, form.yaw) {
            (Some([w, i, j, k]), None) => {
                let q = Quaternion::new(w, i, j, k);
                if (q.norm() - 1.0).abs() > UNIT {
                    let why =
                        format!("the quaternion of `{name}` has the length {:.4}, expected 1", q.norm());
                    return self.impossible(name, why);
                }
                UnitQuaternion::from_quaternion(q)
            }
            (None, Some(yaw)) => UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw),
            _ => {
                let why = format!("the pose of `{name}` needs either `quat_wxyz` or `yaw`");
                return self.impossible(name, why);
            }
        };
        Ok(Pose::from_parts(Translation3::new(x, y, z), rotation))
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn assembly() -> Assembly {
        let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
        let kit = ramp_kit::read_kit(&data.join("kit.xml")).unwrap();
        ramp_assembly::read_goal(&data.join("goals/easy-1.xml"), &kit).unwrap()
    }

    #[test]
    fn wrong_files_are_reported_with_their_place() {
        for (text, expected) in [
            ("{\"in_assembly\":\n [\"b44\"]}", "s.json:2:3: there is no beam `b44` in easy-1"),
            ("{\n\"in_assembly\": 3}", "s.json:2:16: this is no state: invalid type"),
            ("{\"posse\": {}}", "s.json:1:8: this is no state: unknown field `posse`"),
            ("{\"slipped\": true}", "s.json:1:2: `slipped` cannot be given"),
            ("{\"lost_pegs\": [\"p1\"]}", "s.json:1:16: `p1` is lost: give its pose under `poses`"),
            ("{\"fastened\": [[\"C1\", \"p1\"]]}", "s.json:1:16: `C1` is fastened, but `"),
            (
                "{\"poses\": {\"p1\": {\"position\": [0, 3, 0], \"yaw\": 0}}}",
                "s.json:1:12: `p1` is off the table",
            ),
            (
                "{\"poses\": {\"p1\": {\"position\": [0, 0, -1], \"yaw\": 0}}}",
                "s.json:1:12: `p1` is off the table",
            ),
            (
                "{\"poses\": {\"p1\": {\"position\": [0, 0, 0]}}}",
                "s.json:1:12: the pose of `p1` needs either",
            ),
            (
                "{\"poses\": {\"p1\": {\"position\": [0, 0, 0], \"quat_wxyz\": [1, 1, 0, 0]}}}",
                "s.json:1:12: the quaternion of `p1` has the length 1.4142",
            ),
        ] {
            let fault = GivenState::from_source(&SourceFile::new("s.json", text), &assembly()).unwrap_err();
            let found = format!("{fault:#}");
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
    }
}
