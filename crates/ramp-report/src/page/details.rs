//! Details of each agent: failures, every episode over time, and the origin of its results.

use maud::{Markup, PreEscaped, html};

use super::capital;
use super::view::View;
use crate::columns::{Column, name, number, sentences, table};
use crate::format::{NONE, percent, seconds};
use crate::sums;

const FAILURES: [Column; 3] =
    [number("episodes", ""), sentences("cause"), sentences("which, and what was said")];

const FILES: [Column; 9] = [
    name("file"),
    name("goal"),
    number("seed", ""),
    number("completion", ""),
    number("total time", ""),
    number("stops of the arm", ""),
    sentences("ended"),
    name("SHA-256"),
    name("SHA-256 of its log"),
];

/// Causes of the incomplete episodes.
pub fn failures(view: View) -> Markup {
    let report = view.report;
    html! {
        h2 { "Failures by cause" }
        @for (index, entrant) in report.collection.entrants.iter().enumerate() {
            @let failures = sums::failures(entrant);
            h3 { (view.swatch(index)) (entrant.label) ", track " (entrant.identity.track) }
            @if failures.is_empty() {
                p { "Every episode is complete." }
            } @else {
                (table(&FAILURES, failures.iter().map(|failure| vec![
                    html! { (failure.episodes.len()) },
                    html! { (failure.cause) @if failure.technical { small { "technical: no failure of the agent" } } },
                    html! {
                        @for (goal, seed, reason) in &failure.episodes {
                            div { (goal) ", seed " (seed) ": " span.soft { (reason) } }
                        }
                    },
                ])))
            }
        }
    }
}

/// Each episode as a line.
pub fn episodes_over_time(view: View) -> Markup {
    let report = view.report;
    html! {
        h2 { "Every episode over time" }
        p.soft { "A line is an episode: its goal and seed. Hover over a mark or an interval for details." }
        @for part in &report.tracks {
            @for class in &part.classes {
                @for &entrant in &part.entrants {
                    @if let Some(svg) = report.timeline(entrant, class) {
                        h3 {
                            (view.swatch(entrant)) (report.label(entrant)) ": " (class.name()) ", track " (part.setting.track)
                        }
                        figure.wide { (PreEscaped(svg)) }
                    }
                }
            }
        }
    }
}

/// The first digits of a hash from a file.
fn short(hash: Option<&str>) -> String {
    hash.map_or_else(|| NONE.to_string(), |hash| hash.chars().take(16).collect())
}

/// Versions, computers, and the hash of every file.
pub fn origin(view: View) -> Markup {
    let report = view.report;
    html! {
        h2 { "Where this comes from" }
        @for (index, entrant) in report.collection.entrants.iter().enumerate() {
            @let it = &entrant.identity;
            h3 { (view.swatch(index)) (it.agent) " " (it.agent_version) ", track " (it.track) }
            p {
                @if let Some(real) = &it.real {
                    (capital(real.kind.words())) ": " (real.robot) ". Scored by " (real.scorer) ". " (real.source) ". "
                } @else {
                    "In the twin. "
                }
                "ramp " (it.version) " (" code { (it.commit) } "), rules " (ramp_result::episode::RULES) ", schema "
                code { (ramp_result::episode::SCHEMA) } "."
                @if let Some(file) = entrant.files.first() {
                    " Computer: " (file.result.host.cpu) ", " (file.result.host.cores) " threads."
                }
            }
            (table(&FILES, entrant.files.iter().map(|file| vec![
                html! { (file.path.file_name().unwrap_or_default().to_string_lossy()) },
                html! { (file.result.goal) },
                html! { (file.result.seed) },
                html! { (percent(file.result.completion)) },
                html! { (seconds(file.result.time.total)) },
                html! { @if let Some(physics) = &file.result.physics { (physics.stops) } },
                html! { (file.result.ended.reason) },
                html! { code { (&file.sha256[..16]) } },
                html! { code { (short(file.result.log.as_deref())) } },
            ])))
        }
    }
}
