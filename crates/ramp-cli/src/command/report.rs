//! `ramp report`: results of one or several agents as an HTML page, as figures and tables, and as LaTeX.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use miette::{Report as Failure, miette};
use ramp_report::{Named, Report, page, paper, table};
use ramp_result::collection::collect;

use crate::output::{check_place, print, write_file};
use crate::site::Site;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// Folders of results, of one or several agents
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// Page to write; with more than ten agents, each gets a page in a folder beside it
    #[arg(short, long, value_name = "FILE", default_value = "report.html")]
    output: PathBuf,
    /// Also write a LaTeX table, for the package booktabs
    #[arg(long, value_name = "FILE")]
    paper: Option<PathBuf>,
    /// Also write every figure as SVG and all numbers as CSV to a folder; made if it is not there
    #[arg(long, value_name = "DIR")]
    figures: Option<PathBuf>,
}

pub fn run(arguments: &Arguments) -> Result<u8, Failure> {
    check_place(&arguments.output)?;
    if let Some(path) = &arguments.paper {
        check_place(path)?;
    }
    let report = Report::new(collect(&arguments.folders)?);
    let mut written = vec![arguments.output.display().to_string()];
    if report.is_large() {
        written.push(write_many(&report, &arguments.output)?);
    } else {
        write(&arguments.output, &page::html(&report))?;
    }
    if let Some(path) = &arguments.paper {
        write(path, &paper::latex(&report))?;
        written.push(path.display().to_string());
    }
    if let Some(folder) = &arguments.figures {
        std::fs::create_dir_all(folder)
            .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
        for (files, ending) in [(report.figures(), "svg"), (table::tables(&report), "csv")] {
            for Named { name, text } in files {
                write(&folder.join(format!("{name}.{ending}")), &text)?;
            }
        }
        written.push(folder.display().to_string());
    }
    print(&summary(&report, &written))?;
    Ok(DONE)
}

/// Writes the report of many agents: a front page, and a page for each agent in a folder beside it. Returns
/// the folder.
fn write_many(report: &Report, output: &Path) -> Result<String, Failure> {
    let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let folder = format!("{}-agents", name(&output.with_extension("")));
    let place = output.with_file_name(&folder);
    let mut site = Site::open(&place)?;
    let back = format!("../{}", name(output));
    for entrant in 0..report.collection.entrants.len() {
        let text = page::of_agent(&report.of_agent(entrant), (&back, "RAMP report"));
        site.write(&page::agent_page(entrant), &text)?;
    }
    site.remove_others(&["agent-"])?;
    // Write the front page last, so that all its links exist.
    write(output, &page::front(report, &folder))?;
    Ok(place.display().to_string())
}

fn write(path: &Path, text: &str) -> Result<(), Failure> {
    write_file(path, text)
}

/// One line for each agent and class.
fn summary(report: &Report, written: &[String]) -> String {
    let mut text = String::new();
    for note in &report.notes {
        let _ = writeln!(text, "note: {note}");
    }
    for part in &report.tracks {
        for class in &part.classes {
            for line in class.size_lines.iter().chain(&class.lines) {
                let sum = &line.summary;
                let time = sum.time.map_or_else(String::new, |time| format!(", {:.1} s", time.total));
                let _ = writeln!(
                    text,
                    "{}, {}, track {}: {} of {} episodes complete, completion {:.1} %{time}",
                    report.label(line.entrant),
                    class.name_of(line),
                    part.title(),
                    line.complete,
                    sum.episodes,
                    100.0 * sum.completion.mean,
                );
            }
        }
    }
    for it in &report.collection.perception {
        let [parts, found] = it.found();
        let _ = writeln!(
            text,
            "{}: {found} of {parts} parts found, {} of {} poses false",
            it.detector,
            it.false_poses.len(),
            it.poses
        );
    }
    for it in ramp_result::manipulation::sums::sums(&report.collection.trials) {
        let _ = writeln!(
            text,
            "{}, track {}, {}: {} of {} trials done",
            it.agent, it.track, it.skill, it.successes, it.trials
        );
    }
    let _ = writeln!(text, "report: {}", written.join(", "));
    text
}
