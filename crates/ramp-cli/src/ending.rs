//! Describes how a process ended, and ends this one on request.
//!
//! A terminal, a shell or a cluster asks a program to end with one of three signals. A signal that this
//! program was started to ignore, as `nohup` does, stays ignored, also in the programs that it starts.

use std::os::unix::process::CommandExt;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::Once;
use std::sync::atomic::{AtomicBool, AtomicU8, Ordering};

use miette::Report;
use ramp_kit::source::remove_unfinished;
use ramp_planner::Exceeded;
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

use crate::output::tell;
use crate::status::{MachineFault, STOPPED_BY};

/// Only argument of a process that ends at once with the status of bad input.
pub const ENDED: &str = "ended";

/// Exit status of the request to end that has arrived, or zero.
static REQUESTED: AtomicU8 = AtomicU8::new(0);
/// True if the command looks for requests itself, and ends its work in its own way.
static DEFERRED: AtomicBool = AtomicBool::new(false);

/// Ends the program on the signals INT, TERM and HUP, except those that it was started to ignore. Removes
/// unfinished files first. A command that must do more calls [`defer_requests`].
///
/// # Errors
/// If the handlers cannot be installed.
pub fn end_on_request() -> Result<(), Report> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP].into_iter().filter(|&it| !is_ignored(it)))
        .map_err(MachineFault::of)?;
    std::thread::spawn(move || {
        for status in
            signals.forever().filter_map(|signal| u8::try_from(signal).ok()).map(|it| STOPPED_BY + it)
        {
            REQUESTED.store(status, Ordering::Relaxed);
            if !DEFERRED.load(Ordering::Relaxed) {
                remove_unfinished();
                // Without exit handlers: another thread may be solving rules.
                signal_hook::low_level::exit(status.into());
            }
        }
    });
    Ok(())
}

/// From now on the command itself looks for requests to end, with [`requested`].
pub fn defer_requests() {
    DEFERRED.store(true, Ordering::Relaxed);
}

/// Exit status of the request to end that has arrived, if any.
pub fn requested() -> Option<u8> {
    Some(REQUESTED.load(Ordering::Relaxed)).filter(|&status| status != 0)
}

/// True if this process ignores the signal.
#[allow(unsafe_code)]
fn is_ignored(signal: i32) -> bool {
    let mut action = std::mem::MaybeUninit::<libc::sigaction>::zeroed();
    // SAFETY: without a new action, the call only writes the current one, for which all zeros are a value.
    let (done, action) = unsafe {
        let done = libc::sigaction(signal, std::ptr::null(), action.as_mut_ptr());
        (done, action.assume_init())
    };
    done == 0 && action.sa_sigaction == libc::SIG_IGN
}

/// Describes in words how a process ended.
pub fn end_of(status: ExitStatus) -> String {
    if let Some(signal) = std::os::unix::process::ExitStatusExt::signal(&status) {
        return format!("killed by signal {signal}");
    }
    match status.code() {
        Some(code) => format!("ended with status {code} and no result"),
        None => "ended without a result".to_string(),
    }
}

/// Ends this program while another thread still solves rules. That thread cannot be stopped, and must not run
/// during the exit handlers of the process. Therefore `exec` replaces the process by a new one that ends at
/// once.
pub fn end_planning(exceeded: &Exceeded) {
    static ENDING: Once = Once::new();
    ENDING.call_once(|| {
        tell(&format!("{:?}", Report::new(exceeded.clone())));
        remove_unfinished();
        if let Ok(program) = std::env::current_exe() {
            // `exec` returns only if it fails.
            let _ = Command::new(program).arg(ENDED).stdin(Stdio::null()).exec();
        }
        std::process::abort();
    });
}
