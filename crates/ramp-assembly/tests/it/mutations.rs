//! Any mutation of a goal's file gives an assembly or an error that points into the file.

use proptest::prelude::*;
use ramp_assembly::{draw_svg, read_goal_str, report};
use ramp_kit::{Kit, read_kit_str};
use std::sync::LazyLock;

const DATA: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data");

static KIT: LazyLock<Kit> = LazyLock::new(|| {
    read_kit_str("kit.xml", &std::fs::read_to_string(format!("{DATA}/kit.xml")).unwrap()).unwrap()
});

static GOALS: LazyLock<Vec<String>> = LazyLock::new(|| {
    let names = ramp_assembly::goal_names(format!("{DATA}/goals").as_ref()).unwrap();
    names.iter().map(|name| std::fs::read_to_string(format!("{DATA}/goals/{name}.xml")).unwrap()).collect()
});

fn check(text: &str) {
    match read_goal_str("goal.xml", text, &KIT) {
        Ok(goal) => {
            assert_eq!(goal.insertions.len() + 1, goal.beams.len());
            assert!(report(&goal).overlaps.is_empty());
            assert!(!draw_svg(&goal).contains("NaN"));
        }
        Err(error) => {
            let (line, column) = error.place().line_column();
            assert!(line >= 1 && column >= 1 && line <= text.lines().count() + 1);
            let mut out = String::new();
            miette::NarratableReportHandler::new().render_report(&mut out, &error).unwrap();
        }
    }
}

fn quoted(text: &str) -> Vec<(usize, usize)> {
    let quotes: Vec<usize> = text.match_indices('"').map(|(at, _)| at).collect();
    quotes.chunks_exact(2).map(|pair| (pair[0] + 1, pair[1])).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn text_is_put_in(goal in 0usize..9, at in 0.0..1.0f64, what in "\\PC{0,12}") {
        let goal = &GOALS[goal];
        let mut at = (goal.len() as f64 * at) as usize;
        while !goal.is_char_boundary(at) { at -= 1; }
        check(&format!("{}{what}{}", &goal[..at], &goal[at..]));
    }

    #[test]
    fn text_is_cut_out(goal in 0usize..9, at in 0.0..1.0f64, length in 1usize..200) {
        let goal = &GOALS[goal];
        let at = (goal.len() as f64 * at) as usize;
        let bytes: Vec<u8> = goal.bytes().enumerate().filter(|(i, _)| !(at..at + length).contains(i)).map(|(_, b)| b).collect();
        check(&String::from_utf8_lossy(&bytes));
    }

    #[test]
    fn a_joint_is_another_one(goal in 0usize..9, changes in prop::collection::vec((any::<prop::sample::Index>(), 1usize..6), 1..4)) {
        // Keeps the syntax valid, so that the geometry is tested too.
        let mut text = GOALS[goal].clone();
        for (which, joint) in changes {
            let places: Vec<usize> = text.match_indices("joint=\"").map(|(at, _)| at + 9).collect();
            let at = *which.get(&places);
            text.replace_range(at..at + 2, &format!("j{joint}"));
        }
        check(&text);
    }

    #[test]
    fn a_component_is_turned(goal in 0usize..9, which in any::<prop::sample::Index>(), how in 0usize..4, yaw in -360.0..360.0f64) {
        let text = &GOALS[goal];
        let places: Vec<usize> = text.match_indices("<component beam=\"bX").map(|(at, m)| at + m.len()).collect();
        let places = if places.is_empty() { text.match_indices("<component ").map(|(at, m)| at + m.len()).collect() } else { places };
        let at = *which.get(&places);
        let what = match how { 0 => "flipped=\"True\" ".into(), 1 => "yaw=\"180\" ".into(), 2 => "yaw=\"90\" ".into(), _ => format!("yaw=\"{yaw}\" ") };
        check(&format!("{}{what}{}", &text[..at], &text[at..]));
    }

    #[test]
    fn values_are_exchanged(goal in 0usize..9, one in any::<prop::sample::Index>(), other in any::<prop::sample::Index>()) {
        let goal = &GOALS[goal];
        let values = quoted(goal);
        let (a, b) = (*one.get(&values), *other.get(&values));
        let (a, b) = if a.0 <= b.0 { (a, b) } else { (b, a) };
        prop_assume!(a != b);
        check(&[&goal[..a.0], &goal[b.0..b.1], &goal[a.1..b.0], &goal[a.0..a.1], &goal[b.1..]].concat());
    }

    #[test]
    fn lines_are_dropped_or_repeated(goal in 0usize..9, at in any::<prop::sample::Index>(), count in 0usize..4) {
        let lines: Vec<&str> = GOALS[goal].lines().collect();
        let at = at.index(lines.len());
        let mut changed = lines[..at].to_vec();
        changed.extend(std::iter::repeat_n(lines[at], count));
        changed.extend(&lines[at + 1..]);
        check(&changed.join("\n"));
    }
}
