//! The judge of a detector: its poses against the labels, by camera, distance and angle.

use std::collections::BTreeMap;

use nalgebra::Point3;
use ramp_result::episode::Software;
use ramp_result::perception::{FALSE, FalsePose, PerceptionVerdict, SCHEMA, ViewRange};
use ramp_robot::{Camera, Pose};

use super::labels::{Estimate, Labels};

/// A line of the judge's table.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// `wrist` or `birds-eye`.
    pub camera: String,
    /// Distances of tags, m.
    pub distance: [f64; 2],
    /// Angles of tags, degrees.
    pub angle: [f64; 2],
    /// Parts with a tag wholly in view.
    pub parts: usize,
    /// How many of them were found.
    pub found: usize,
    /// Position error at the middle of the part's nearest tag, median and 95 %, m.
    pub position: [f64; 2],
    /// Turn between found and true, median and 95 %, rad.
    pub turn: [f64; 2],
}

/// The judge's verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// By camera, distance and angle.
    pub lines: Vec<Line>,
    /// By camera and distance, all angles of the table together.
    pub distances: Vec<Line>,
    /// Poses given.
    pub poses: usize,
    /// Poses more than [`FALSE`] off, or of parts that show no tag: file, part and error (m) where there is
    /// one.
    pub false_poses: Vec<(String, String, Option<f64>)>,
}

impl Verdict {
    /// As a result file: the poses are those of `detector`, on the images with the labels of that hash.
    pub fn to_result(
        &self,
        detector: &str,
        labels: &str,
        views: usize,
        software: &Software,
    ) -> PerceptionVerdict {
        let end = |edge: f64| edge.is_finite().then_some(edge);
        let cell = |line: &Line| ViewRange {
            camera: line.camera.clone(),
            distance: line.distance.map(end),
            angle: line.angle.map(end),
            parts: line.parts,
            found: line.found,
            position: (line.found > 0).then_some(line.position),
            turn: (line.found > 0).then_some(line.turn),
        };
        let wrong = |(file, part, error): &(String, String, Option<f64>)| FalsePose {
            file: file.clone(),
            part: part.clone(),
            error: *error,
        };
        PerceptionVerdict {
            schema: SCHEMA.to_string(),
            detector: detector.to_string(),
            labels: labels.to_string(),
            views,
            software: software.clone(),
            cells: self.lines.iter().map(cell).collect(),
            poses: self.poses,
            false_poses: self.false_poses.iter().map(wrong).collect(),
        }
    }
}

/// Bins of the table.
const WRIST_DISTANCES: [f64; 6] = [0.10, 0.15, 0.25, 0.35, 0.50, 0.80];
const ANGLES: [f64; 5] = [0.0, 15.0, 30.0, 45.0, 75.0];

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = ((values.len() as f64 * share) as usize).min(values.len().saturating_sub(1));
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// Judges what a detector said of the images.
pub fn judge(labels: &Labels, estimates: &[Estimate]) -> Verdict {
    let mut said: BTreeMap<(&str, &str), &Estimate> = BTreeMap::new();
    for estimate in estimates {
        said.insert((&estimate.file, &estimate.part), estimate);
    }
    /// Parts, position errors and turns.
    type Errors = (usize, Vec<f64>, Vec<f64>);
    // By camera, distance and angle; the one behind the last angle has them all.
    let all = ANGLES.len();
    let mut cells: BTreeMap<(String, usize, usize), Errors> = BTreeMap::new();
    let mut false_poses = Vec::new();
    for view in &labels.views {
        for part in &view.parts {
            let nearest = |whole: bool| {
                let tags = part.tags.iter().filter(move |tag| tag.whole == whole);
                tags.min_by(|a, b| a.distance.total_cmp(&b.distance))
            };
            let Some(tag) = nearest(true).or(nearest(false)) else { continue };
            let found = said.remove(&(view.file.as_str(), part.part.as_str())).map(|estimate| {
                let (truth, found) = (Pose::from(&part.x_cp), Pose::from(&estimate.x_cp));
                let p_p = Point3::from(tag.p_p);
                ((found * p_p - truth * p_p).norm(), found.rotation.angle_to(&truth.rotation))
            });
            if let Some((error, _)) = found.filter(|(error, _)| *error > FALSE) {
                false_poses.push((view.file.clone(), part.part.clone(), Some(error)));
            }
            if !tag.whole {
                continue;
            }
            let bin = |edges: &[f64], value: f64| edges.iter().skip(1).filter(|edge| value >= **edge).count();
            let wrist = view.camera == Camera::Wrist.name();
            let distance = if wrist { bin(&WRIST_DISTANCES, tag.distance) } else { 0 };
            let angle = bin(&ANGLES, tag.angle);
            let both = [Some(angle), (angle + 1 < ANGLES.len()).then_some(all)];
            for angle in both.into_iter().flatten() {
                let cell = cells.entry((view.camera.clone(), distance, angle)).or_default();
                cell.0 += 1;
                if let Some((error, turn)) = found {
                    cell.1.push(error);
                    cell.2.push(turn);
                }
            }
        }
    }
    // The rest was reported of parts that show no tag at all.
    let ghost = |(file, part): (&str, &str)| (file.to_string(), part.to_string(), None);
    false_poses.extend(said.into_keys().map(ghost));
    let (mut lines, mut distances) = (Vec::new(), Vec::new());
    for ((camera, distance, angle), (parts, mut errors, mut turns)) in cells {
        let edges =
            |edges: &[f64], bin: usize| [edges[bin], edges.get(bin + 1).copied().unwrap_or(f64::INFINITY)];
        let wrist = camera == Camera::Wrist.name();
        let line = Line {
            camera,
            distance: if wrist { edges(&WRIST_DISTANCES, distance) } else { [2.3, 2.6] },
            angle: if angle == all { [ANGLES[0], ANGLES[all - 1]] } else { edges(&ANGLES, angle) },
            parts,
            found: errors.len(),
            position: [quantile(&mut errors, 0.5), quantile(&mut errors, 0.95)],
            turn: [quantile(&mut turns, 0.5), quantile(&mut turns, 0.95)],
        };
        let table = if angle == all { &mut distances } else { &mut lines };
        table.push(line);
    }
    Verdict { lines, distances, poses: estimates.len(), false_poses }
}
