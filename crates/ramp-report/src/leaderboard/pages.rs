//! The boards as static pages: a front page with the best of each board, pages of each board, and
//! the refused entries.

use maud::{Markup, html};
use ramp_result::episode::RobotKind;

use super::boards::{Board, Boards, Control, Key, Standing};
use crate::columns::{self, Column, name, number, sentences};
use crate::format::{NONE, counted, share, small};
use crate::shell::page;

/// Entries on one page.
pub const PAGE: usize = 50;
/// Entries of each board on the front page.
const BEST: usize = 3;
/// The front page.
pub const INDEX: &str = "index.html";
/// The site's title.
pub const TITLE: &str = "RAMP leaderboard";

/// Note on the source of each figure.
const SOURCES: &str = "Computed here from the logs: completion, pegs, robot time; from the goals: bound and reference. Told by \
     the entrant: planning and compute time, and with them total time, unless “timed here” is beside them; computer; \
     software; the name of the agent.";

/// An entry without a board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refusal {
    /// Its name.
    pub entry: String,
    /// The reason.
    pub reason: String,
}

/// All pages but those of the agents: their file names and texts, the front page last. `compared` gives the
/// names and hashes of what all entries of a board share.
pub fn pages(
    boards: &Boards,
    refused: &[Refusal],
    compared: &dyn Fn(&Key) -> Vec<(String, String)>,
) -> Vec<(String, String)> {
    let mut pages = Vec::new();
    for board in boards.boards() {
        let stem = format!("board-{}", board.key.slug());
        let chunks: Vec<&[Standing]> = board.standings.chunks(PAGE).collect();
        for (number, chunk) in chunks.iter().enumerate() {
            let body = html! {
                (way_back())
                h1 { (board.key.title()) }
                (board_words(board))
                (turn(&stem, number, chunks.len()))
                (table(chunk, number * PAGE, &board.controls))
                (turn(&stem, number, chunks.len()))
                (hashes(board, compared(&board.key)))
            };
            pages.push((file(&stem, number), page(&format!("{TITLE}: {}", board.key.title()), &body)));
        }
    }
    let chunks: Vec<&[Refusal]> = refused.chunks(PAGE).collect();
    for (number, chunk) in chunks.iter().enumerate() {
        let body = html! {
            (way_back())
            h1 { "Refused" }
            p.soft { (counted(refused.len(), "entry is", "entries are")) " on no board, each with the first reason found." }
            (turn(REFUSED, number, chunks.len()))
            (columns::table(
                &[name("entry"), sentences("reason")],
                chunk.iter().map(|it| vec![html! { (it.entry) }, html! { (it.reason) }]),
            ))
            (turn(REFUSED, number, chunks.len()))
        };
        pages.push((file(REFUSED, number), page(&format!("{TITLE}: refused"), &body)));
    }
    pages.push((INDEX.to_string(), front(boards, refused.len())));
    pages
}

/// The name of the pages of refused entries.
const REFUSED: &str = "refused";

/// The file of a page, from 0.
fn file(stem: &str, number: usize) -> String {
    if number == 0 { format!("{stem}.html") } else { format!("{stem}-{}.html", number + 1) }
}

fn way_back() -> Markup {
    html! { p { a href=(INDEX) { "← " (TITLE) } } }
}

/// Links to the other pages.
fn turn(stem: &str, number: usize, pages: usize) -> Markup {
    html! {
        @if pages > 1 {
            p {
                "Page "
                @for other in 0..pages {
                    @if other == number { strong { (other + 1) } } @else { a href=(file(stem, other)) { (other + 1) } }
                    " "
                }
            }
        }
    }
}

fn front(boards: &Boards, refused: usize) -> String {
    let body = html! {
        header {
            div {
                h1 { (TITLE) }
                p.soft {
                    "Whole classes, every goal five times. Every result of the twin was run again from its log and is equal \
                     to the last bit. " (SOURCES) " Intervals are of 95 %."
                }
            }
            button type="button" { "light / dark" }
        }
        @for board in boards.boards() {
            h2 { a href=(file(&format!("board-{}", board.key.slug()), 0)) { (board.key.title()) } }
            p.soft { (counted(board.standings.len(), "entry", "entries")) ", rules " (board.key.rules) "." }
            (table(&board.standings[..board.standings.len().min(BEST)], 0, &board.controls))
        }
        @if boards.boards().is_empty() { p { "No entry is on a board." } }
        @if refused > 0 {
            h2 { a href=(file(REFUSED, 0)) { "Refused" } }
            p { (counted(refused, "entry was", "entries were")) " refused; the page gives the reasons." }
        }
    };
    page(TITLE, &body)
}

/// Notes for the reader of a board.
fn board_words(board: &Board) -> Markup {
    html! {
        p.soft {
            (counted(board.standings.len(), "entry", "entries")) ", rules " (board.key.rules)
            ". Higher completion first, then less total time. Intervals are of 95 %. The bound is a lower one for the robot's \
             time; the reference is the time of the same plan without looks and retries. "
            @if board.key.robot == Some(RobotKind::Arm) {
                "By stopwatch: these cannot be reproduced."
            } @else if board.key.robot.is_some() {
                "Over the wire: these are not run again."
            } @else {
                "Every result was run again from its log and is equal to the last bit. " (SOURCES)
            }
            @if board.key.asynchronous {
                " The robot went on while the policies computed: a result depends on their server's speed, and no run is the \
                 same again, though its log is."
            }
            @if !board.controls.is_empty() {
                " Rows without a place are the organiser's own."
            }
        }
    }
}

/// The hashes of everything that the episodes of a board share.
fn hashes(board: &Board, compared: Vec<(String, String)>) -> Markup {
    let named = [("world", &board.key.world), ("start", &board.key.start)].into_iter();
    let named = named.filter_map(|(kind, file)| {
        let file = file.as_ref()?;
        Some((format!("{kind} {}", file.name), file.sha256.clone()))
    });
    let rows = named.chain(compared).collect::<Vec<_>>();
    html! {
        h2 { "Compared" }
        p.soft { "All episodes of this board have these in common; each is given by its SHA-256, the secret by its commitment." }
        div.wide {
            table {
                tbody { @for (name, hash) in &rows { tr { td.name { (name) } td.name { code { (hash) } } } } }
            }
        }
    }
}

const COLUMNS: [Column; 13] = [
    number("place", ""),
    name("agent").with("entry"),
    number("completion", "%"),
    number("complete", "episodes"),
    number("pegs", ""),
    number("technical", "failures"),
    number("total time", "s"),
    number("planning", "s, told"),
    number("compute", "s, told"),
    number("robot", "s"),
    number("bound", "s"),
    number("reference", "s"),
    sentences("robot or computer").with("and software, told"),
];

fn table(standings: &[Standing], above: usize, controls: &[Control]) -> Markup {
    let places = standings.iter().enumerate().map(|(index, it)| row(it, &(above + index + 1).to_string()));
    let others = controls.iter().map(|it| row(&it.standing, &it.label));
    columns::table(&COLUMNS, places.chain(others))
}

fn row(it: &Standing, place: &str) -> Vec<Markup> {
    let sum = &it.line.summary;
    let compared = sum.time.and_then(|time| time.compared);
    let mean = |digits: usize, time: Option<f64>| {
        let text = time.map_or_else(|| NONE.to_string(), |time| format!("{time:.digits$}"));
        html! { (text) }
    };
    let told = |time: Option<f64>| html! { (mean(2, time)) @if it.timed_here { small { "timed here" } } };
    vec![
        html! { (place) },
        html! {
            a href=(it.page) { (it.agent) }
            small { (it.entry) }
            @for warning in &it.warnings { div.warning { (warning) } }
        },
        html! { (share(sum.completion.mean)) (small(it.line.completion_interval, share)) },
        html! { (it.line.complete) "/" (sum.episodes) },
        html! { (sum.pegs_counted) "/" (sum.pegs) },
        html! { (sum.technical) },
        mean(1, sum.time.map(|time| time.total)),
        told(sum.time.map(|time| time.planning)),
        told(sum.time.map(|time| time.compute)),
        mean(1, sum.time.map(|time| time.robot)),
        mean(1, compared.map(|it| it.bound)),
        mean(1, compared.map(|it| it.reference)),
        html! {
            @if let Some(real) = &it.real { (real.robot) } @else { (it.host) }
            small { "ramp " (it.software[0]) " (" (it.software[1]) ")" }
        },
    ]
}
