//! The view that a person has of a run: its progress, a window, and the result as text.

use std::cell::RefCell;
use std::fmt::Write;
use std::io::IsTerminal;
use std::path::Path;
use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};
use miette::{Report, miette};
use ramp_episode::Progress;
use ramp_result::episode::{EpisodeResult, RobotTime};
use ramp_robot::{Event, EventKind};
use ramp_twin::{Setup, Twin};

use crate::output::tell;

/// The result as text.
pub fn summary(result: &EpisodeResult, [output, curve, log]: [&Path; 3]) -> String {
    let name = |named: Option<&String>| named.map_or("none", String::as_str).to_string();
    let place = match &result.real {
        Some(real) => format!("{}, track {}, repeat {}", real.kind.words(), result.track, result.repeat),
        None => format!(
            "arm {}, world {}, start {}, track {}, seed {}",
            name(result.arm.as_ref()),
            name(result.world.as_ref().map(|world| &world.name)),
            name(result.start.as_ref().map(|start| &start.name)),
            result.track,
            result.seed
        ),
    };
    let (counted, wanted, unit) = (result.counted(), result.wanted(), result.unit());
    let mut text = format!("{}, {place}: {counted} of {wanted} {unit}\n", result.goal);
    for part in &result.parts {
        let _ = match part.t_total {
            Some(time) => writeln!(text, "  {:<4} back at {time:6.1} s", part.part),
            None => writeln!(text, "  {:<4} is not back in its place", part.part),
        };
    }
    for (index, peg) in result.pegs.iter().enumerate() {
        let _ = match peg {
            Some(peg) => writeln!(
                text,
                "  {:<4} {} in {}  {:<4} seated at {:6.1} s",
                peg.connection, peg.joints[1], peg.joints[0], peg.peg, peg.t_total
            ),
            None => writeln!(text, "  connection {} has no peg that counts", index + 1),
        };
    }
    for rejected in &result.rejected {
        let _ = writeln!(text, "  does not count: {rejected}");
    }
    let time = &result.time;
    let _ = writeln!(
        text,
        "time {:.1} s = planning {:.2} + computing {:.2} + robot {:.1}",
        time.total, time.planning, time.compute, time.robot
    );
    if let Some(share) = time.waiting.filter(|_| time.is_loaded()) {
        let _ = writeln!(
            text,
            "the machine was loaded: the program waited {:.0} % of its time for a processor, and planning and \
             computing took longer than on an idle machine",
            100.0 * share
        );
    }
    if let Some(RobotTime { bound, reference }) = result.robot_time {
        let _ = writeln!(
            text,
            "robot time of the baseline's plan: bound {bound:.1} s, reference {reference:.1} s"
        );
    }
    if result.ended.reason != "done" {
        let _ = writeln!(text, "ended early: {}", result.ended.reason);
    }
    if let Some(fault) = &result.fault {
        let struck = fault.at.map_or_else(|| "never".to_string(), |at| format!("{at:.1} s"));
        let _ = writeln!(text, "fault {}@{}, struck {struck}: {}", fault.kind, fault.occasion, fault.text);
    }
    if let Some(physics) = &result.physics {
        let _ = writeln!(
            text,
            "deepest penetration {:.2} mm, largest force {:.0} N",
            physics.deepest_penetration * 1e3,
            physics.largest_force
        );
        if physics.stops > 0 {
            let times = if physics.stops == 1 { "time" } else { "times" };
            let _ = writeln!(text, "the arm stopped and was ready again {} {times}", physics.stops);
        }
    }
    let _ = writeln!(text, "result: {}", output.display());
    let _ = writeln!(text, "curve:  {}\nlog:    {}", curve.display(), log.display());
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty());
    let folder = folder.unwrap_or(Path::new("."));
    if result.real.is_none() {
        let film = log.with_extension("gif");
        let _ = writeln!(text, "film:   ramp replay {} --video {}", log.display(), film.display());
    }
    let _ = writeln!(text, "report: ramp report {} -o report.html", folder.display());
    text
}

/// Progress on standard error: one moving line on a terminal, a line for each action elsewhere.
pub struct Display {
    bar: Option<ProgressBar>,
    action: RefCell<String>,
}

impl Display {
    /// `wanted` is the number of pegs in the goal, or of parts to be put back: `unit` says which.
    pub fn new(wanted: usize, unit: &str) -> Display {
        let bar = std::io::stderr().is_terminal().then(|| {
            let bar = ProgressBar::new(wanted as u64);
            let template = format!("{{bar:24}} {{pos}}/{{len}} {unit}  {{msg}}");
            if let Ok(style) = ProgressStyle::with_template(&template) {
                bar.set_style(style);
            }
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        Display { bar, action: RefCell::new("planning".to_string()) }
    }

    /// The agent's current action.
    pub fn action(&self) -> String {
        self.action.borrow().clone()
    }

    pub fn event(&self, event: &Event) {
        let line = || format!("{:7.1} s  {}: {}", event.time, event.kind.name(), event.kind);
        match (&self.bar, &event.kind) {
            (bar, EventKind::ActionBegun(action)) => {
                *self.action.borrow_mut() = action.to_string();
                if let Some(bar) = bar {
                    bar.set_message(format!("{:.1} s  {action}", event.time));
                }
            }
            (None, EventKind::ActionEnded(action)) => tell(&format!("{:7.1} s  {action}", event.time)),
            (Some(_), EventKind::ActionEnded(_)) => {}
            (Some(bar), _) => bar.println(line()),
            (None, _) => tell(&line()),
        }
    }

    pub fn progress(&self, progress: &Progress) {
        if let Some(bar) = &self.bar {
            bar.set_position(progress.seated as u64);
            bar.set_message(format!("{:.1} s  {}", progress.time, self.action.borrow()));
        }
    }

    /// Asks something on the terminal, without the bar.
    #[cfg(feature = "franka")]
    pub fn pause<T>(&self, ask: impl FnOnce() -> T) -> T {
        match &self.bar {
            Some(bar) => bar.suspend(ask),
            None => ask(),
        }
    }

    pub fn finish(&self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(feature = "view")]
use ramp_twin::view::Window as TwinWindow;

/// The live window, if the program was built with it.
pub struct Window {
    #[cfg(feature = "view")]
    inner: TwinWindow,
}

impl Window {
    #[cfg(feature = "view")]
    pub fn open(setup: &Setup) -> Result<Window, Report> {
        let inner = TwinWindow::open(setup).map_err(|error| {
            miette!(help = "is there a display? without one, leave --view out", "{error}")
        })?;
        Ok(Window { inner })
    }

    #[cfg(not(feature = "view"))]
    pub fn open(_: &Setup) -> Result<Window, Report> {
        Err(miette!(
            help = "build it with `cargo build --release --features view` (needs OpenGL and a display), or leave --view out",
            "this program was built without a window"
        ))
    }

    #[cfg_attr(not(feature = "view"), allow(clippy::unused_self, unused_variables))]
    pub fn show(&mut self, twin: &Twin) {
        #[cfg(feature = "view")]
        self.inner.show(twin);
    }
}
