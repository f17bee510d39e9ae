//! Single abilities: plans without a robot, detectors on images, single skills.

use maud::{Markup, html};

use crate::columns::{Column, name, number, sentences, table};
use crate::format::{NONE, share, small, time};
use ramp_result::collection::Collection;
use ramp_result::manipulation::sums::{SkillSum, sums};
use ramp_result::perception::{FALSE, PerceptionVerdict};
use ramp_result::planning::PlanVerdict;

const PLANS: [Column; 6] = [
    name("planner"),
    name("goal"),
    name("verdict"),
    number("coarse actions", ""),
    number("planning", "s"),
    sentences("refused at"),
];

const DETECTIONS: [Column; 7] = [
    name("camera"),
    number("distance", "m"),
    number("angle", "°"),
    number("parts", ""),
    number("found", "%"),
    number("position", "mm, median / 95 %"),
    number("turn", "°, median / 95 %"),
];

const SKILLS: [Column; 11] = [
    name("skill"),
    name("track"),
    name("world"),
    name("agent"),
    number("trials", ""),
    number("done", "trials"),
    number("share", "%"),
    number("tried again", "trials"),
    number("time", "s, median / 95 %"),
    number("force", "N"),
    sentences("causes of failure"),
];

/// A section for each ability with at least one verdict.
pub(super) fn sections(collection: &Collection) -> Markup {
    let skills = sums(&collection.trials);
    html! {
        @if !collection.plans.is_empty() { (plans(&collection.plans)) }
        @if !collection.perception.is_empty() { (perception(&collection.perception)) }
        @if !skills.is_empty() { (manipulation(&skills)) }
    }
}

/// Plans judged without a robot.
fn plans(plans: &[PlanVerdict]) -> Markup {
    html! {
        h2 { "Planning alone" }
        p.soft {
            "Plans judged by the planner's replayer, without a robot: every action must be possible and do what it says, and \
             the end must be the goal. The time is the planner's own account."
        }
        (table(&PLANS, plans.iter().map(|it| vec![
            html! { (it.planner) },
            html! { (it.goal) },
            html! { span.bad[!it.accepted] { (if it.accepted { "accepted" } else { "refused" }) } },
            html! { (it.coarse) },
            html! { (it.seconds.map_or_else(|| NONE.to_string(), |it| format!("{it:.3}"))) },
            html! { (it.refused.as_deref().unwrap_or_default()) },
        ])))
    }
}

/// Detectors judged on images.
fn perception(verdicts: &[PerceptionVerdict]) -> Markup {
    let range = |[from, to]: [Option<f64>; 2], digits: usize| match (from, to) {
        (Some(from), Some(to)) => format!("{from:.digits$} to {to:.digits$}"),
        (Some(from), None) => format!("over {from:.digits$}"),
        _ => NONE.to_string(),
    };
    let pair = |errors: Option<[f64; 2]>, scale: f64| match errors {
        Some([median, most]) => format!("{:.2} / {:.2}", median * scale, most * scale),
        None => NONE.to_string(),
    };
    html! {
        h2 { "Perception alone" }
        p.soft {
            "Poses of parts judged against the labels of images. A part is to be found when one of its tags is wholly in view; the \
             position error is that of its nearest tag, in the camera's frame: median and 95 %. False are poses that are more than "
            (format!("{:.0} mm", FALSE * 1e3)) " off, or of parts that show no tag. Verdicts on other images (their labels' hash) \
             are not to be compared."
        }
        @for it in verdicts {
            h3 { (it.detector) }
            p {
                (it.views) " images, labels " code { (it.labels.chars().take(16).collect::<String>()) } ": " (it.poses) " poses, "
                span.bad[!it.false_poses.is_empty()] { (it.false_poses.len()) " false" } ". "
                span.soft { "ramp " (it.software.version) " (" (it.software.commit) ")" }
            }
            (table(&DETECTIONS, it.cells.iter().map(|cell| vec![
                html! { (cell.camera) },
                html! { (range(cell.distance, 2)) },
                html! { (range(cell.angle, 0)) },
                html! { (cell.parts) },
                html! { (share(cell.found as f64 / cell.parts.max(1) as f64)) },
                html! { (pair(cell.position, 1e3)) },
                html! { (pair(cell.turn, 1f64.to_degrees())) },
            ])))
        }
    }
}

/// Single skills from randomised starts.
fn manipulation(skills: &[SkillSum]) -> Markup {
    html! {
        h2 { "Manipulation alone" }
        p.soft {
            "Single skills from starts drawn at random, judged by the truth: the peg seated, or the joints where a peg can pin \
             them, and nothing that was built before undone. Below the share stands Wilson's interval of 95 %. Time is robot \
             time: median, and 95 %. Force is the largest between the hand and what it touched or held."
        }
        (table(&SKILLS, skills.iter().map(|it| vec![
            html! { (it.skill) },
            html! { (it.track) },
            html! { (it.world) },
            html! { (it.agent) small { "ramp " (it.software.version) " (" (it.software.commit) ")" } },
            html! { (it.trials) },
            html! { (it.successes) },
            html! {
                (share(it.successes as f64 / it.trials.max(1) as f64))
                (small(Some(it.interval), share))
            },
            html! { (it.retried) },
            html! { (time(it.time[0])) " / " (time(it.time[1])) },
            html! { (format!("{:.0}", it.largest_force)) },
            html! {
                @for (cause, count, seed) in &it.failures {
                    div { (count) " × " (cause) " " span.soft { "(seed " (seed) ")" } }
                }
            },
        ])))
    }
}
