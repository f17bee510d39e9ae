//! The report's numbers as CSV, for papers and other programs. SI units, shares from 0 to 1.

use crate::report::{Named, Report};
use crate::sums::{self, Line, Scope};
use ramp_kit::source::cell;
use ramp_result::activity::Activity;
use ramp_result::manipulation::{self, sums::SkillSum};

/// All tables.
pub fn tables(report: &Report) -> Vec<Named> {
    vec![
        Named { name: "sums".into(), text: sums(report) },
        Named { name: "curves".into(), text: curves(report) },
        Named { name: "episodes".into(), text: episodes(report) },
        Named { name: "comparisons".into(), text: comparisons(report) },
        Named { name: "skills".into(), text: skills(report) },
        Named { name: "perception".into(), text: perception(report) },
    ]
}

/// Rows of fields as CSV, safe against formulas in spreadsheets.
fn write(rows: impl IntoIterator<Item = Vec<String>>) -> String {
    let mut writer = csv::WriterBuilder::new().flexible(true).from_writer(Vec::new());
    for row in rows {
        // Writing to memory cannot fail.
        let _ = writer.write_record(row.iter().map(|text| cell(text).into_owned()));
    }
    String::from_utf8(writer.into_inner().unwrap_or_default()).unwrap_or_default()
}

fn row<const N: usize>(words: [&str; N]) -> Vec<String> {
    words.map(str::to_string).to_vec()
}

fn optional(value: Option<f64>) -> String {
    value.map_or_else(String::new, |value| format!("{value:.6}"))
}

/// The track of an agent, its label, its version and the software's.
fn who(report: &Report, entrant: usize) -> Vec<String> {
    let it = &report.collection.entrants[entrant];
    vec![it.identity.track.clone(), it.label.clone()]
}

fn sums(report: &Report) -> String {
    let mut head = row([
        "track",
        "agent",
        "scope",
        "name",
        "episodes",
        "finished",
        "complete",
        "complete_low",
        "complete_high",
        "completion",
        "completion_deviation",
        "completion_low",
        "completion_high",
        "best",
        "pegs_counted",
        "pegs",
        "total",
        "total_deviation",
        "total_low",
        "total_high",
        "planning",
        "compute",
        "robot",
        "bound",
        "reference",
        "total_of_complete",
    ]);
    head.extend(Activity::ALL.map(|activity| activity.name().replace(' ', "_")));
    let line = |line: &Line| {
        let sum = &line.summary;
        let compared = sum.time.and_then(|it| it.compared);
        let mut row = who(report, line.entrant);
        let scope = match &line.scope {
            Scope::Goal(_) => "goal",
            Scope::Size(..) => "size",
            Scope::Class(_) => "class",
        };
        row.extend([scope.to_string(), line.scope.name().to_string()]);
        row.extend([sum.episodes, sum.finished, line.complete].map(|it| it.to_string()));
        let number = |value: f64| format!("{value:.6}");
        row.extend([line.complete_interval.low, line.complete_interval.high].map(number));
        row.extend([number(sum.completion.mean), optional(sum.completion.deviation)]);
        row.extend([
            optional(line.completion_interval.map(|it| it.low)),
            optional(line.completion_interval.map(|it| it.high)),
            optional(sum.best.map(|it| it.completion)),
            sum.pegs_counted.to_string(),
            sum.pegs.to_string(),
        ]);
        row.extend([
            optional(sum.time.map(|it| it.total)),
            optional(sum.time.and_then(|it| it.total_deviation)),
            optional(line.total_interval.map(|it| it.low)),
            optional(line.total_interval.map(|it| it.high)),
            optional(sum.time.map(|it| it.planning)),
            optional(sum.time.map(|it| it.compute)),
            optional(sum.time.map(|it| it.robot)),
            optional(compared.map(|it| it.bound)),
            optional(compared.map(|it| it.reference)),
            optional(line.complete_total.map(|it| it.mean)),
        ]);
        row.extend(line.activities.map(number));
        row
    };
    let classes = report.tracks.iter().flat_map(|part| &part.classes);
    let lines = classes
        .flat_map(|class| class.goal_lines.iter().chain(&class.size_lines).chain(&class.lines))
        .map(line);
    write(std::iter::once(head).chain(lines))
}

fn curves(report: &Report) -> String {
    let mut rows = vec![row(["track", "agent", "scope", "curve", "time", "completion", "deviation"])];
    for part in &report.tracks {
        for class in &part.classes {
            let goals = class.goals.iter().map(|goal| Scope::Goal(goal.clone()));
            for scope in goals.chain([Scope::Class(class.class.clone())]) {
                for &entrant in &part.entrants {
                    let agent = &report.collection.entrants[entrant];
                    let results: Vec<_> = sums::results(&report.collection, agent, &scope).collect();
                    let lost = class.goals.iter().filter(|goal| match &scope {
                        Scope::Goal(name) => *goal == name,
                        Scope::Size(..) | Scope::Class(_) => true,
                    });
                    let lost = lost.map(|goal| agent.lost.iter().filter(|it| it.goal == *goal).count()).sum();
                    let Some(curves) = crate::curves::curves(&results, lost) else { continue };
                    let mut add = |curve: &str, numbers: [String; 3]| {
                        let mut row = who(report, entrant);
                        row.extend([scope.name().to_string(), curve.to_string()]);
                        row.extend(numbers);
                        rows.push(row);
                    };
                    let number = |value: f64| format!("{value:.6}");
                    for step in &curves.mean {
                        add("mean", [step.time, step.mean, step.deviation].map(number));
                    }
                    for (time, share) in &curves.best {
                        add("best", [number(*time), number(*share), String::new()]);
                    }
                }
            }
        }
    }
    write(rows)
}

fn episodes(report: &Report) -> String {
    let mut rows = vec![row([
        "track",
        "agent",
        "goal",
        "seed",
        "completion",
        "pegs_counted",
        "pegs",
        "planning",
        "compute",
        "robot",
        "total",
        "bound",
        "reference",
        "stops",
        "ended",
        "file",
        "sha256",
        "log_sha256",
        "technical",
    ])];
    for (entrant, agent) in report.collection.entrants.iter().enumerate() {
        for file in &agent.files {
            let result = &file.result;
            let mut row = who(report, entrant);
            row.extend([result.goal.clone(), result.seed.to_string(), format!("{:.6}", result.completion)]);
            row.extend([result.counted().to_string(), result.pegs.len().to_string()]);
            let time = &result.time;
            row.extend([time.planning, time.compute, time.robot, time.total].map(|it| format!("{it:.6}")));
            row.extend(
                [result.robot_time.map(|it| it.bound), result.robot_time.map(|it| it.reference)]
                    .map(optional),
            );
            row.push(result.physics.as_ref().map(|it| it.stops.to_string()).unwrap_or_default());
            let name = file.path.file_name().unwrap_or_default().to_string_lossy().into_owned();
            row.extend([result.ended.reason.clone(), name, file.sha256.clone()]);
            row.extend([result.log.clone().unwrap_or_default(), result.is_technical().to_string()]);
            rows.push(row);
        }
        for lost in &agent.lost {
            let mut row = who(report, entrant);
            row.extend([lost.goal.clone(), lost.seed.to_string(), "0".to_string(), "0".to_string()]);
            row.extend(vec![String::new(); 8]);
            row.extend(["lost".to_string(), String::new(), String::new(), String::new()]);
            row.push(true.to_string());
            rows.push(row);
        }
    }
    write(rows)
}

fn comparisons(report: &Report) -> String {
    let mut rows = vec![row([
        "track",
        "first",
        "second",
        "class",
        "measure",
        "pairs",
        "difference",
        "low",
        "high",
        "p",
        "p_holm",
    ])];
    for part in &report.tracks {
        for comparison in part.classes.iter().flat_map(|class| &class.comparisons) {
            let tests = [("completion", Some(&comparison.completion)), ("total", comparison.total.as_ref())];
            for (measure, test) in tests {
                let Some(test) = test else { continue };
                let [one, two] = comparison.entrants.map(|it| report.label(it).to_string());
                let mut row = vec![part.title(), one, two, comparison.scope.name().to_string()];
                row.extend([measure.to_string(), test.pairs.to_string(), format!("{:.6}", test.mean)]);
                row.extend([
                    optional(test.interval.map(|it| it.low)),
                    optional(test.interval.map(|it| it.high)),
                ]);
                row.extend([test.p, test.corrected].map(|it| format!("{it:.6}")));
                rows.push(row);
            }
        }
    }
    write(rows)
}

/// Single skills.
fn skills(report: &Report) -> String {
    let head = row([
        "track",
        "agent",
        "skill",
        "trials",
        "successes",
        "low",
        "high",
        "retried",
        "time_median",
        "time_95",
        "largest_force",
    ]);
    let line = |sum: &SkillSum| {
        let mut row = vec![sum.track.clone(), sum.agent.clone(), sum.skill.clone()];
        row.extend([sum.trials, sum.successes].map(|it| it.to_string()));
        row.extend([sum.interval.low, sum.interval.high].map(|it| format!("{it:.6}")));
        row.push(sum.retried.to_string());
        row.extend([sum.time[0], sum.time[1], sum.largest_force].map(|it| format!("{it:.6}")));
        row
    };
    write(std::iter::once(head).chain(manipulation::sums::sums(&report.collection.trials).iter().map(line)))
}

/// Detectors.
fn perception(report: &Report) -> String {
    let head = row([
        "detector",
        "labels",
        "camera",
        "distance_from",
        "distance_to",
        "angle_from",
        "angle_to",
        "parts",
        "found",
        "position_median",
        "position_95",
        "turn_median",
        "turn_95",
    ]);
    let lines = report.collection.perception.iter().flat_map(|it| {
        it.cells.iter().map(|cell| {
            let mut row = vec![it.detector.clone(), it.labels.clone(), cell.camera.clone()];
            row.extend(cell.distance.iter().chain(&cell.angle).map(|edge| optional(*edge)));
            row.extend([cell.parts, cell.found].map(|it| it.to_string()));
            for errors in [cell.position, cell.turn] {
                row.extend([0, 1].map(|index| optional(errors.map(|errors| errors[index]))));
            }
            row
        })
    });
    write(std::iter::once(head).chain(lines))
}
