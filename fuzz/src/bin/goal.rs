//! Goal files.
#![no_main]

use ramp_assembly::{draw_svg, read_goal_str, report};
use ramp_fuzz::{KIT, data_of, points, target};

fn check(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    match read_goal_str("goal.xml", &text, &KIT) {
        Ok(goal) => {
            assert_eq!(goal.insertions.len() + 1, goal.beams.len());
            assert!(report(&goal).overlaps.is_empty());
            assert!(!draw_svg(&goal).contains("NaN"));
        }
        Err(error) => points(&error, &text),
    }
}

target!(data_of("goals", "xml"), check);
