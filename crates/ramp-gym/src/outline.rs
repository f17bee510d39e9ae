//! Reads the rehearsal of a skill of one's own: the motions that it will ask for, as JSON from a program or
//! from Python.

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use ramp_kit::Pose;
use ramp_skills::rehearsal::{Motion, Outline, Stage};
use serde::Deserialize;
use serde_json::Value;

/// The most alternatives, and the most motions in one.
const MOST: usize = 64;
/// The largest distance that a motion may name, m.
const FURTHEST: f64 = 10.0;
/// The largest deviation of a quaternion's length from one.
const QUATERNION: f64 = 1e-3;

#[derive(Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
enum MotionText {
    Travel { x_wt: PoseText, open: f64 },
    Straight { x_wt: PoseText, open: f64, around: Option<String>, contact: bool },
    Contact { distance: f64 },
    Fingers { stroke: f64 },
    Retreat {},
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PoseText {
    position: [f64; 3],
    quat_wxyz: [f64; 4],
}

/// Reads alternatives, the preferred one first: a list of lists of motions. `null` stands for a skill that
/// cannot rehearse.
///
/// | motion | fields |
/// |---|---|
/// | `travel` | pose of the tip at its end, `x_wt` (world); distance of the fingers, `open` (m) |
/// | `straight` | the same; `around`: a part that arm and hand may touch as well; `contact`: an insertion |
/// | `contact` | a short motion in contact, `distance` (m) |
/// | `fingers` | opening or closing by `stroke` (m) |
/// | `retreat` | straight up to travelling height |
///
/// # Errors
/// A description of the error, for a person.
pub fn read_outline(alternatives: &Value) -> Result<Outline, String> {
    if alternatives.is_null() {
        return Ok(Outline::Unknown);
    }
    let read: Vec<Vec<MotionText>> =
        Deserialize::deserialize(alternatives).map_err(|error| error.to_string())?;
    if read.len() > MOST || read.iter().any(|motions| motions.len() > MOST) {
        return Err(format!(
            "a rehearsal has more than {MOST} alternatives, or more than {MOST} motions in one"
        ));
    }
    let alternatives = read.into_iter().map(|motions| motions.into_iter().map(motion).collect());
    Ok(Outline::Alternatives(alternatives.collect::<Result<_, String>>()?))
}

fn motion(text: MotionText) -> Result<Motion, String> {
    let would_touch = "the hand would touch";
    Ok(match text {
        MotionText::Travel { x_wt, open } => {
            Motion::Travel { x_wt: pose(&x_wt)?, open: bounded(open)?, stage: Stage::Approach }
        }
        MotionText::Straight { x_wt, open, around, contact } => {
            let stage = if contact { Stage::Insertion } else { Stage::Approach };
            Motion::Straight { x_wt: pose(&x_wt)?, open: bounded(open)?, around, stage, would_touch }
        }
        MotionText::Contact { distance } => Motion::Contact(bounded(distance)?),
        MotionText::Fingers { stroke } => Motion::Fingers(bounded(stroke)?),
        MotionText::Retreat {} => Motion::Retreat,
    })
}

fn bounded(metres: f64) -> Result<f64, String> {
    if (0.0..=FURTHEST).contains(&metres) {
        return Ok(metres);
    }
    Err(format!("found {metres} m in a rehearsal, expected 0 to {FURTHEST} m"))
}

fn pose(text: &PoseText) -> Result<Pose, String> {
    if !text.position.iter().all(|metres| metres.abs() <= FURTHEST) {
        return Err(format!("found a position beyond {FURTHEST} m in a rehearsal"));
    }
    let [w, x, y, z] = text.quat_wxyz;
    let q = Quaternion::new(w, x, y, z);
    let length = q.norm();
    let is_unit = (1.0 - QUATERNION..=1.0 + QUATERNION).contains(&length);
    if !is_unit {
        return Err(format!("found a quaternion of length {length:.4} in a rehearsal, expected 1"));
    }
    Ok(Pose::from_parts(Translation3::from(text.position), UnitQuaternion::from_quaternion(q)))
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn motions_are_read_and_wrong_ones_are_refused() {
        let pose = r#"{"position": [0.4, 0.0, 0.1], "quat_wxyz": [0.0, 1.0, 0.0, 0.0]}"#;
        let read = |motions: &str| read_outline(&serde_json::from_str(motions).unwrap());
        let all = format!(
            r#"[[{{"travel": {{"x_wt": {pose}, "open": 0.05}}}},
                {{"straight": {{"x_wt": {pose}, "open": 0.05, "around": "p1", "contact": true}}}},
                {{"contact": {{"distance": 0.03}}}}, {{"fingers": {{"stroke": 0.01}}}}, {{"retreat": {{}}}}]]"#
        );
        let Outline::Alternatives(alternatives) = read(&all).unwrap() else { panic!("unknown") };
        assert_eq!(alternatives[0].len(), 5);
        assert!(matches!(read("null"), Ok(Outline::Unknown)));
        let far = pose.replace("0.4", "1e9");
        let long = pose.replace("1.0", "2.0");
        for (wrong, why) in [
            (r#"[[{"jump": {}}]]"#.to_string(), "unknown variant `jump`"),
            (r#"[[{"fingers": {"stroke": -1}}]]"#.to_string(), "expected 0 to 10 m"),
            (format!(r#"[[{{"travel": {{"x_wt": {far}, "open": 0.05}}}}]]"#), "beyond 10 m"),
            (format!(r#"[[{{"travel": {{"x_wt": {long}, "open": 0.05}}}}]]"#), "length 2.0000"),
            (format!("[{}[]]", "[],".repeat(MOST)), "more than 64"),
        ] {
            let refused = read(&wrong).map(|_| ()).unwrap_err();
            assert!(refused.contains(why), "{wrong}: {refused}");
        }
    }
}
