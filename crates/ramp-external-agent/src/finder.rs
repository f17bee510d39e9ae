//! A finder of parts that is a program of its own, in any language. It is told the goal once; then it gets
//! each image as a line of JSON with the pixels after it, and answers with a line.

use std::ffi::OsString;
use std::sync::{Arc, Mutex};

use ramp_skills::OwnFinder;
use ramp_skills::belief::own_finder::{OwnAnswer, Question};
use serde_json::{Value, json};

use crate::file::AgentFile;
use crate::finder_message::{VERSION, question_text, read_answer};
use crate::limits::Patience;
use crate::process::{Process, Silence};
use crate::sandbox::Sandbox;

/// The reason why there is no answer.
#[derive(Debug, thiserror::Error)]
pub enum FinderError {
    /// The system does not start the program.
    #[error("the finder cannot be started: {0}")]
    Start(std::io::Error),
    /// The program does not answer.
    #[error("{}", of_finder(.0))]
    Silence(Silence),
    /// Its answer is none.
    #[error("the finder {why}")]
    Answer {
        /// The mistake, for a person.
        why: String,
    },
}

/// The words about an agent that is silent, about a finder.
fn of_finder(silence: &Silence) -> String {
    let words = silence.to_string().replacen("the agent", "the finder", 1);
    words.replace("ended without saying that it is done", "ended before the episode did")
}

/// A finder that runs.
struct Running {
    process: Process,
    names: Vec<String>,
    /// The reason why it answers no more.
    failed: Option<String>,
}

/// Starts a finder and tells it the goal. `command` is what starts it, usually [`AgentFile::command`];
/// `names` are the parts of the kit. It runs as long as the finder that is given back is there. Once it has
/// failed, each question gets the reason.
///
/// # Errors
/// When it does not start, or does not listen.
pub fn start_finder(
    command: &[OsString],
    patience: Patience,
    sandbox: Option<Sandbox>,
    goal: &Value,
    names: Vec<String>,
) -> Result<OwnFinder, FinderError> {
    let mut process = Process::start(command, patience, sandbox.as_ref()).map_err(FinderError::Start)?;
    let first = json!({"finder": VERSION, "goal": goal});
    process.tell(format!("{first}\n").into_bytes()).map_err(FinderError::Silence)?;
    let mut running = Running { process, names, failed: None };
    Ok(Arc::new(Mutex::new(move |question: &Question| {
        // The sandbox stands as long as its program runs.
        let _ = &sandbox;
        running.ask(question)
    })))
}

impl Running {
    fn ask(&mut self, question: &Question) -> Result<OwnAnswer, String> {
        if let Some(why) = &self.failed {
            return Err(why.clone());
        }
        let mut bytes = format!("{}\n", question_text(question)).into_bytes();
        bytes.extend_from_slice(&question.image.pixels);
        bytes.extend(question.image.depth_bytes());
        let heard = self.process.tell(bytes).and_then(|()| self.process.hear());
        let answer = heard
            .map_err(FinderError::Silence)
            .and_then(|heard| read_answer(&heard, &self.names).map_err(|why| FinderError::Answer { why }));
        answer.map_err(|error| self.failed.insert(error.to_string()).clone())
    }
}

/// The name of a finder in results: `finder`, its file's name, and the first digits of its hash.
pub fn finder_name(file: &AgentFile) -> String {
    let stem = file.path().file_stem().map(|stem| stem.to_string_lossy()).unwrap_or_default();
    let short: String = ramp_kit::source::to_name(&stem).chars().take(24).collect();
    format!("finder-{short}.{}", &file.sha256()[..8])
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use ramp_robot::{Camera, CameraModel, Image, Pose};

    use super::*;

    /// The answer of a program that says this.
    fn said(answer: &str) -> Result<OwnAnswer, String> {
        let script = format!("read goal; read image; echo '{answer}'");
        let command = ["sh".into(), "-c".into(), script.into()];
        let patience = Patience { answer: Duration::from_secs(5), end: None };
        let names = vec!["b1".to_string()];
        let finder = start_finder(&command, patience, None, &json!({}), names).unwrap();
        let model = CameraModel::nominal(Camera::Wrist, 0.1);
        let image = Image {
            camera: Camera::Wrist,
            time: 0.0,
            x_wt: Pose::identity(),
            width: 1,
            height: 1,
            pixels: vec![0; 3],
            depth: None,
        };
        let question = Question { image: &image, camera: &model, parts: &[], holders: &[], width: 0.0 };
        let ask = || (finder.lock().unwrap())(&question);
        let first = ask();
        if let Err(why) = &first {
            // It does not come back to life.
            assert_eq!(ask().unwrap_err(), *why);
        }
        first
    }

    #[test]
    fn answers_are_read_and_strange_ones_are_refused() {
        let pose = r#""x_cp": {"position": [0, 0, 0.3], "quat_wxyz": [1, 0, 0, 0]}"#;
        let good = said(&format!(
            r#"{{"parts": [{{"part": "b1", {pose}, "sigma": [0.001, 0.01]}}], "absent": ["b1"]}}"#
        ));
        let good = good.unwrap();
        assert!((good.found[0].covariance[(4, 4)] - 1e-4).abs() < 1e-12 && good.absent == ["b1"]);
        for (answer, why) in [
            (r#"{"parts": 7}"#.to_string(), "did not answer with parts"),
            (
                format!(r#"{{"parts": [{{"part": "b2", {pose}, "sigma": [0.001, 0.01]}}]}}"#),
                "no part of the kit",
            ),
            (format!(r#"{{"parts": [{{"part": "b1", {pose}}}]}}"#), "neither `sigma`"),
            (
                format!(r#"{{"parts": [{{"part": "b1", {pose}, "sigma": [0, 0.01]}}]}}"#),
                "a covariance that is none",
            ),
            (r#"{"parts": [], "absent": ["hand"]}"#.to_string(), "no part of the kit"),
        ] {
            let refused = said(&answer).unwrap_err();
            assert!(refused.starts_with("the finder ") && refused.contains(why), "{refused}");
        }
        assert!(said("").unwrap_err().contains("did not answer with parts"));
    }
}
