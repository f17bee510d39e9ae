//! The processes that this one has started, with all that they have started.

use rustix::process::{Pid, Signal};

/// From now on, processes whose parents are gone become children of this one, so that they can be ended.
pub fn adopt_orphans() {
    let _ = rustix::process::set_child_subreaper(Some(rustix::process::getpid()));
}

/// Numbers of all children of this process.
pub(crate) fn children() -> Vec<i32> {
    children_of("/proc/self/task")
}

/// Numbers of the children of the process whose threads are in a folder.
fn children_of(threads: &str) -> Vec<i32> {
    let Ok(tasks) = std::fs::read_dir(threads) else { return Vec::new() };
    let lists = tasks.flatten().filter_map(|task| std::fs::read_to_string(task.path().join("children")).ok());
    lists
        .flat_map(|list| list.split_whitespace().filter_map(|it| it.parse().ok()).collect::<Vec<_>>())
        .collect()
}

/// Ends all children of this process but these.
pub fn end_orphans(but: &[i32]) {
    // Each that ends may leave children of its own.
    for _ in 0..100 {
        let orphans: Vec<Pid> =
            children().into_iter().filter(|it| !but.contains(it)).filter_map(Pid::from_raw).collect();
        if orphans.is_empty() {
            return;
        }
        for orphan in orphans {
            let _ = rustix::process::kill_process(orphan, Signal::KILL);
            let _ = rustix::process::waitpid(Some(orphan), rustix::process::WaitOptions::empty());
        }
    }
}

/// Numbers of all that this process has started, but these and what they have started.
pub(crate) fn descendants(but: &[i32]) -> Vec<i32> {
    let mut found: Vec<i32> = children().into_iter().filter(|it| !but.contains(it)).collect();
    let mut next = 0;
    while let Some(process) = found.get(next).copied() {
        let theirs = children_of(&format!("/proc/{process}/task"));
        found.extend(theirs.into_iter().filter(|it| !but.contains(it)));
        next += 1;
    }
    found
}

/// Ends processes; who started them learns how they ended.
pub(crate) fn kill(processes: &[i32]) {
    for process in processes.iter().filter_map(|it| Pid::from_raw(*it)) {
        let _ = rustix::process::kill_process(process, Signal::KILL);
    }
}

/// Processor time of the children that have ended, with all that they had waited for, s.
pub(crate) fn time_of_ended() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    // The name, in brackets, may hold spaces.
    let fields = text.rsplit_once(')').map_or("", |(_, fields)| fields);
    let ticks: u64 = fields.split_whitespace().skip(13).take(2).filter_map(|it| it.parse::<u64>().ok()).sum();
    ticks as f64 / rustix::param::clock_ticks_per_second() as f64
}
