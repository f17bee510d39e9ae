//! The messages between the baseline and a finder of one's own: a question about an image as plain data, and
//! the answer.

use nalgebra::Matrix6;
use ramp_kit::Kit;
use ramp_kit::source::shorten;
use ramp_skills::belief::own_finder::{OwnAnswer, OwnFound, Question};
use ramp_vision::untagged::Believed;
use serde::Deserialize;
use serde_json::{Map, Value, json};

use crate::observation::pose;
use crate::protocol::PoseText;

/// The version of the messages.
pub const VERSION: u32 = 1;
/// The largest place, m, and the least and largest standard deviation, m or rad, in an answer.
const FARTHEST: f64 = 10.0;
const SIGMAS: [f64; 2] = [1.0e-6, 10.0];

/// The names of all parts of a kit.
pub fn names_of(kit: &Kit) -> Vec<String> {
    let beams = kit.beams.iter().map(|beam| beam.name.clone());
    beams.chain(kit.pegs.iter().map(|peg| peg.name.clone())).collect()
}

/// The question as plain data; the pixels come beside it.
pub fn question_text(question: &Question) -> Value {
    let Question { image, camera, parts, holders, width } = *question;
    let mut head = json!({
        "camera": image.camera.name(),
        "time": image.time,
        "x_wt": pose(&image.x_wt),
        "x_wc": pose(&camera.x_wc(&image.x_wt)),
        "focal": camera.focal,
        "centre": camera.centre,
        "distortion": camera.distortion,
        "width": image.width,
        "height": image.height,
        "bytes": image.pixels.len(),
    });
    if let Some(depth) = &image.depth {
        head["depth_bytes"] = (2 * depth.len()).into();
    }
    let holders: Map<String, Value> = holders.iter().map(|(name, x)| (name.clone(), pose(x))).collect();
    let parts: Vec<Value> = parts.iter().map(part).collect();
    json!({"image": head, "parts": parts, "holders": holders, "fingers": width})
}

/// A part as it is believed to be.
fn part(part: &Believed) -> Value {
    let rows: Vec<Vec<f64>> = part.covariance.row_iter().map(|row| row.iter().copied().collect()).collect();
    let lying = part.lying.as_ref();
    json!({
        "part": part.part,
        "x_wp": pose(&part.x_wp),
        "covariance": rows,
        "held": part.held,
        "lying": lying.map(|it| json!({"height": it.height, "flipped": it.flipped, "sigma": it.sigma})),
    })
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AnswerText {
    parts: Vec<PartText>,
    #[serde(default)]
    absent: Vec<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct PartText {
    part: String,
    x_cp: PoseText,
    /// Standard deviations of a shift along each axis, m, and of a turn about it, rad.
    sigma: Option<[f64; 2]>,
    covariance: Option<[[f64; 6]; 6]>,
}

/// Reads an answer; `names` are the parts of the kit.
///
/// # Errors
/// The mistake, for a person, after `the finder`.
pub fn read_answer(line: &[u8], names: &[String]) -> Result<OwnAnswer, String> {
    let text: AnswerText = serde_json::from_slice(line)
        .map_err(|error| format!("did not answer with parts: {}", shorten(&error.to_string())))?;
    let mut answer = OwnAnswer::default();
    let known = |part: &str| match names.iter().any(|name| name == part) {
        true => Ok(()),
        false => Err(format!("speaks of `{}`, which is no part of the kit", shorten(part))),
    };
    for part in text.parts {
        known(&part.part)?;
        if answer.found.iter().any(|other| other.part == part.part) {
            return Err(format!("gives {} twice", part.part));
        }
        let of = |why: &str| format!("gives {} {why}", part.part);
        let x_cp = part.x_cp.pose().map_err(|why| of(&format!("a pose that {why}")))?;
        if !x_cp.translation.vector.iter().all(|value| value.abs() <= FARTHEST) {
            return Err(of("a place beyond 10 m"));
        }
        let covariance = match (part.sigma, part.covariance) {
            (Some([shift, turn]), None) => {
                let [shift, turn] = [shift, turn].map(|sigma| sigma * sigma);
                Matrix6::from_diagonal(&[shift, shift, shift, turn, turn, turn].into())
            }
            (None, Some(rows)) => Matrix6::from_fn(|row, column| rows[row][column]),
            _ => return Err(of("neither `sigma` nor `covariance` alone")),
        };
        let covariance = sound(&covariance).ok_or_else(|| {
            of("a covariance that is none: symmetric and positive, with standard deviations of 1e-6 to 10")
        })?;
        answer.found.push(OwnFound { part: part.part, x_cp, covariance });
    }
    for part in &text.absent {
        known(part)?;
    }
    answer.absent = text.absent;
    Ok(answer)
}

/// A covariance that can be worked with.
fn sound(covariance: &Matrix6<f64>) -> Option<Matrix6<f64>> {
    let even = (covariance + covariance.transpose()) / 2.0;
    let [low, high] = SIGMAS.map(|sigma| sigma * sigma);
    let symmetric = (even - covariance).amax() <= 1.0e-6 * even.amax();
    let within = even.diagonal().iter().all(|value| (low..=high).contains(value));
    (symmetric && within && even.cholesky().is_some()).then_some(even)
}
