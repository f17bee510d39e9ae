//! `ramp score`: converts the log of a real robot's run to results, and writes the form for such a log.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Report, miette};
use ramp_assembly::Assembly;
use ramp_data::Data;
use ramp_kit::drawing::pdf;
use ramp_log::ENDING;
use ramp_real_run::form::form;
use ramp_real_run::poses::{self, QuaternionOrder};
use ramp_real_run::stopwatch::{Log, read_log};
use ramp_result::write_whole;

use crate::output::{check_place, print, tell, write_file};
use crate::software::software;
use crate::status::DONE;

#[derive(clap::Args)]
pub struct Arguments {
    /// Log of the run: stopwatch times (CSV), or poses from cameras (MCAP)
    #[arg(required_unless_present = "form")]
    log: Option<PathBuf>,
    /// Write the form for the timekeeper, to be printed on A4
    #[arg(long, value_name = "GOAL", conflicts_with = "log", requires = "output")]
    form: Option<String>,
    /// Folder for the results [default: results/score]; with --form, the PDF to write
    #[arg(short, long, value_name = "DIR|FILE")]
    output: Option<PathBuf>,
    /// Numbers that the fields w, x, y, z of the rotations in a log of poses hold
    #[arg(long, value_name = "ORDER", default_value = "wxyz", value_parser = order, conflicts_with = "form")]
    quaternion: QuaternionOrder,
}

fn order(name: &str) -> Result<QuaternionOrder, String> {
    let all = QuaternionOrder::ALL;
    all.into_iter()
        .find(|order| order.name() == name)
        .ok_or_else(|| format!("expected {}", all.map(QuaternionOrder::name).join(", ")))
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    if let (Some(goal), Some(path)) = (&arguments.form, &arguments.output) {
        return write_form(data, goal, path);
    }
    let Some(path) = &arguments.log else { return Err(miette!("name a log")) };
    let folder = arguments.output.clone().unwrap_or_else(|| PathBuf::from("results/score"));
    if folder.exists() && !folder.is_dir() {
        return Err(miette!(help = "name a folder with -o", "{} is not a folder", folder.display()));
    }
    let names = data.goal_names()?;
    let goals: Vec<Assembly> = names.iter().map(|name| data.goal(name)).collect::<Result<_, _>>()?;
    let kit = data.kit()?;
    let software = software();
    let log = if path.extension().is_some_and(|ending| ending == ENDING) {
        let order = arguments.quaternion;
        let reader = poses::Reader { kit, goals: &goals, software: &software, order, unmeasured: false };
        let judged = reader.read(path).into_diagnostic()?;
        if !judged.clamped_seen {
            tell(
                "the clamped beam was never measured, so nothing shows that frame, units and axes are right",
            );
        }
        Log::Episodes(vec![judged.result])
    } else {
        if arguments.quaternion != QuaternionOrder::default() {
            let help = "leave out --quaternion";
            return Err(miette!(help = help, "{} is no log of poses, and has no rotations", path.display()));
        }
        read_log(path, kit, &goals, &software)?
    };
    let mut text = String::new();
    let mut files = Vec::new();
    match log {
        Log::Episodes(results) => {
            for result in &results {
                let _ = writeln!(
                    text,
                    "{}, track {}, repeat {}: {} of {} {}, {:.1} s (planning {:.1} s), {}",
                    result.goal,
                    result.track,
                    result.repeat,
                    result.counted(),
                    result.wanted(),
                    result.unit(),
                    result.time.total,
                    result.time.planning,
                    result.ended.reason
                );
                let name = format!("{}-{}-{}.json", result.goal, result.track, result.seed);
                files.push((name, result.to_json()));
            }
        }
        Log::Means(means) => {
            for (index, it) in means.iter().enumerate() {
                let _ = writeln!(
                    text,
                    "{}, {}, track {}: {:.0} % in {:.0} s, as published",
                    it.name,
                    it.class,
                    it.track,
                    100.0 * it.completion,
                    it.total
                );
                let stem = path.file_stem().unwrap_or_default().to_string_lossy();
                let json = serde_json::to_string_pretty(it).into_diagnostic()?;
                files.push((format!("{stem}-{}-{}.json", it.class, index + 1), json + "\n"));
            }
        }
    }
    std::fs::create_dir_all(&folder)
        .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
    for (name, json) in files {
        write_whole(&folder.join(name), &json).map_err(|error| miette!("{error}"))?;
    }
    let _ = writeln!(text, "results: {}", folder.display());
    print(&text)?;
    Ok(DONE)
}

fn write_form(data: &Data, goal: &str, path: &Path) -> Result<u8, Report> {
    check_place(path)?;
    if path.extension().is_none_or(|ending| ending != "pdf") {
        return Err(miette!(help = "end the file's name in .pdf", "{} is no PDF file", path.display()));
    }
    let goal = data.goal(goal)?;
    let page = form(&goal).into_diagnostic()?;
    write_file(path, pdf(&page.title, std::slice::from_ref(&page)))?;
    print(&format!("form: {}\n", path.display()))?;
    Ok(DONE)
}
