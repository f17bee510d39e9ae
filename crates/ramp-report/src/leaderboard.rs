//! A leaderboard: whole classes, each result run again from its log, as a static site.

use maud::{Markup, html};

use crate::page;
use crate::report::{REPEATS, Report};
use crate::sums::Line;
use ramp_log::Log;
use ramp_result::collection::{Collection, ResultFile};
use ramp_result::episode::RULES;

/// A goal of the organiser.
#[derive(Clone, Debug)]
pub struct Goal {
    /// Its name.
    pub name: String,
    /// Its class.
    pub class: Option<String>,
    /// Its file.
    pub xml: String,
}

/// What results must have been made with.
#[derive(Clone, Debug)]
pub struct Terms {
    /// The goals.
    pub goals: Vec<Goal>,
    /// The kit file.
    pub kit: String,
    /// The arm file.
    pub arm: String,
    /// Largest shift (m) and turn (rad) of the start.
    pub disturbance: [f64; 2],
}

/// Why a result does not go on the board.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refused {
    /// Part of a class.
    #[error(
        "{who}: {goal} was run with seeds {found}; a class is every goal of it with seeds 1 to {REPEATS}"
    )]
    Part {
        /// The agent and track.
        who: String,
        /// The goal.
        goal: String,
        /// The seeds that are there.
        found: String,
    },
    /// A goal of somebody else.
    #[error("{file}: the goal is not the one of this name here")]
    Goal {
        /// The result.
        file: String,
    },
    /// Other parts or start than everybody's.
    #[error("{file}: the {what} is not the one here")]
    Other {
        /// The result.
        file: String,
        /// Kit, arm or disturbance.
        what: &'static str,
    },
    /// The result is not that of its log.
    #[error("{file}: the result is not the one that its log ends with")]
    NotOfLog {
        /// The result.
        file: String,
    },
}

/// Is every class that an agent has begun whole? A lost episode is part of it.
///
/// # Errors
/// The first goal that lacks a seed, or has one too many.
pub fn check_whole(collection: &Collection, terms: &Terms) -> Result<(), Refused> {
    for entrant in &collection.entrants {
        let of = |goal: &str| {
            let files = entrant.files.iter().filter(|file| file.result.goal == goal);
            let lost = entrant.lost.iter().filter(|lost| lost.goal == goal);
            let mut seeds: Vec<u64> =
                files.map(|file| file.result.seed).chain(lost.map(|lost| lost.seed)).collect();
            seeds.sort_unstable();
            seeds
        };
        let who = format!("{}, track {}", entrant.label, entrant.identity.track);
        if let Some(file) =
            entrant.files.iter().find(|file| terms.goals.iter().all(|goal| goal.name != file.result.goal))
        {
            return Err(Refused::Goal { file: file.path.display().to_string() });
        }
        for goal in &terms.goals {
            let begun = terms.goals.iter().any(|other| {
                other.class == goal.class && goal.class.is_some() && !of(&other.name).is_empty()
            });
            let seeds = of(&goal.name);
            let whole = seeds == (1..=REPEATS).collect::<Vec<u64>>();
            if (begun || !seeds.is_empty()) && !whole {
                let list: Vec<String> = seeds.iter().map(u64::to_string).collect();
                let found = if list.is_empty() { "none".to_string() } else { list.join(", ") };
                return Err(Refused::Part { who, goal: goal.name.clone(), found });
            }
        }
    }
    Ok(())
}

/// Was a result made with everybody's goal, parts and start, and is it that of its log?
///
/// # Errors
/// What differs.
pub fn check_log(file: &ResultFile, log: &Log, terms: &Terms) -> Result<(), Refused> {
    let name = || file.path.display().to_string();
    let header = &log.header;
    let goal = terms.goals.iter().find(|goal| goal.name == file.result.goal);
    if goal.is_none_or(|goal| goal.xml != header.goal.xml || goal.name != header.goal.name) {
        return Err(Refused::Goal { file: name() });
    }
    let other = |what| Err(Refused::Other { file: name(), what });
    if header.kit.xml != terms.kit {
        return other("kit");
    }
    if header.arm.json != terms.arm {
        return other("arm");
    }
    if [header.disturbance.position, header.disturbance.angle] != terms.disturbance {
        return other("disturbance of the start");
    }
    let mut logged = log.result.clone();
    logged.log = Some(log.sha256.clone());
    if logged != file.result {
        return Err(Refused::NotOfLog { file: name() });
    }
    Ok(())
}

/// The front page: each class on each track, the best agent first.
pub fn front(report: &Report) -> String {
    let body = html! {
        header {
            div {
                h1 { "RAMP leaderboard" }
                p.soft {
                    "Rules " (RULES) ". Whole classes, every goal five times. Every result of the twin was run again from \
                     its log and is equal to the last bit. Intervals are of 95 %."
                }
            }
            button type="button" { "light / dark" }
        }
        @for part in &report.tracks {
            @for class in &part.classes {
                @for real in [false, true] {
                    @let lines = ranked(report, &class.lines, real);
                    @if !lines.is_empty() {
                        h2 { "Class " (class.name()) ", track " (part.track) @if real { ", real robots" } }
                        @if real { p.soft { "By stopwatch: nobody can run these again." } }
                        (table(report, &lines))
                    }
                }
            }
        }
    };
    page::page("RAMP leaderboard", &body)
}

/// The file of an agent's own page.
pub fn agent_page(entrant: usize) -> String {
    format!("agent-{}.html", entrant + 1)
}

/// Higher completion first, then less time.
fn ranked<'r>(report: &Report, lines: &'r [Line], real: bool) -> Vec<&'r Line> {
    let is_real = |line: &&Line| report.collection.entrants[line.entrant].identity.real.is_some() == real;
    let mut lines: Vec<&Line> = lines.iter().filter(is_real).collect();
    let total = |line: &Line| line.summary.time.map_or(f64::INFINITY, |time| time.total);
    lines.sort_by(|a, b| {
        let completion = b.summary.completion.mean.total_cmp(&a.summary.completion.mean);
        completion.then(total(a).total_cmp(&total(b))).then(a.entrant.cmp(&b.entrant))
    });
    lines
}

fn table(report: &Report, lines: &[&Line]) -> Markup {
    html! {
        div.wide {
            table {
                thead { tr {
                    th { "" } th.name { "agent" } th { "completion" small { "%" } } th { "complete" } th { "pegs" }
                    th { "total time" small { "s" } } th { "planning" small { "s" } } th.name { "robot or computer" }
                    th.name { "software" }
                } }
                tbody {
                    @for (index, line) in lines.iter().enumerate() {
                        @let entrant = &report.collection.entrants[line.entrant];
                        @let it = &entrant.identity;
                        @let host = entrant.files.first().map(|file| &file.result.host);
                        tr {
                            td { (index + 1) }
                            td.name {
                                a href=(agent_page(line.entrant)) { (it.agent) " " (it.agent_version) }
                            }
                            td {
                                (format!("{:.1}", 100.0 * line.summary.completion.mean))
                                @if let Some(interval) = line.completion_interval {
                                    small { (format!("{:.1} to {:.1}", 100.0 * interval.low, 100.0 * interval.high)) }
                                }
                            }
                            td { (line.complete) "/" (line.summary.episodes) }
                            td { (line.summary.pegs_counted) "/" (line.summary.pegs) }
                            td {
                                (line.summary.time.map_or_else(|| "–".to_string(), |time| format!("{:.1}", time.total)))
                            }
                            td {
                                (line.summary.time.map_or_else(|| "–".to_string(), |time| format!("{:.2}", time.planning)))
                            }
                            td.long {
                                @if let Some(real) = &it.real { (real.robot) }
                                @else if let Some(host) = host { (host.cpu) ", " (host.cores) " threads" }
                            }
                            td.name { "ramp " (it.version) small { (it.commit) } }
                        }
                    }
                }
            }
        }
    }
}
