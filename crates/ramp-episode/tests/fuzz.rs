//! Malformed logs and messages: no panic, and memory bounded by the input's size.
//!
//! `cargo test` tries a few thousand. For an hour of it:
//! `RAMP_FUZZ_SECONDS=3600 cargo test --release -p ramp-episode --test fuzz -- --ignored --nocapture`

// A failed unwrap here is a failed test; an allocator that counts cannot be written without `unsafe`.
#![allow(clippy::unwrap_used, clippy::print_stdout, clippy::print_stderr, unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

use ramp_episode::replay;
use ramp_external_agent::protocol::{Request, parse};
use ramp_log::{Limits, Log};
use ramp_robot::random::Stream;
use ramp_testing::GoalFiles;
use ramp_testing::episode::Swing;
use ramp_testing::log::{as_log, messages, write_log};

/// The largest piece of memory that may be asked for at once, bytes.
const LARGEST: usize = 64 << 20;

/// The system's allocator, and the largest piece it was asked for.
struct Watched;

static PEAK: AtomicUsize = AtomicUsize::new(0);

unsafe impl GlobalAlloc for Watched {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        PEAK.fetch_max(layout.size(), Ordering::Relaxed);
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        unsafe { System.dealloc(pointer, layout) }
    }

    unsafe fn realloc(&self, pointer: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        PEAK.fetch_max(size, Ordering::Relaxed);
        unsafe { System.realloc(pointer, layout, size) }
    }
}

#[global_allocator]
static ALLOCATOR: Watched = Watched;

fn below(stream: &mut Stream, limit: usize) -> usize {
    (stream.uniform() * limit as f64) as usize
}

/// Bytes that readers stumble over.
const NASTY: [&[u8]; 14] = [
    b"\xff\xff\xff\xff\xff\xff\xff\x7f",
    b"\x00\x00\x00\x00",
    b"\xff\xff\xff\xff",
    b"NaN",
    b"-1",
    b"1e999",
    b"18446744073709551616",
    b"null",
    b"[[[[[[[[[[[[[[[[",
    b"\"\\ud800\"",
    b"\xc3\x28",
    b"}",
    b",",
    b"\x06\xff\xff\xff\x01",
];

/// Changes some bytes: flips, cuts, doubles, and puts nasty ones in.
fn mangle(bytes: &mut Vec<u8>, stream: &mut Stream) {
    for _ in 0..1 + below(stream, 3) * below(stream, 2) {
        let length = bytes.len();
        if length == 0 {
            return;
        }
        let at = below(stream, length);
        match below(stream, 6) {
            0 | 1 => bytes[at] ^= 1 << below(stream, 8),
            2 => bytes.truncate(at),
            3 => {
                let to = (at + 1 + below(stream, 64)).min(length);
                bytes.drain(at..to);
            }
            4 => {
                let to = (at + 1 + below(stream, 64)).min(length);
                let again = bytes[at..to].to_vec();
                bytes.splice(at..at, again);
            }
            _ => {
                let nasty = NASTY[below(stream, NASTY.len())];
                let to = (at + nasty.len() * below(stream, 2)).min(length);
                bytes.splice(at..to, nasty.iter().copied());
            }
        }
    }
}

/// Reads what may be a log, as far as its calls.
fn read(bytes: &[u8]) -> bool {
    let Ok(log) = Log::from_bytes(Path::new("x.mcap"), bytes, &Limits::default()) else { return false };
    let calls = log.calls().take_while(Result::is_ok).count();
    replay::LoggedSetup::of(&log).is_ok() && calls > 0
}

const LINES: [&str; 12] = [
    r#"{"hello": {"protocol": 1, "name": "fuzz", "version": "1.0"}}"#,
    r#"{"step": {"commands": [{"arm": {"joint_positions": [0, 0, 0, -1.5, 0, 1.5, 0]}, "gripper": {"width": 0.04, "force": 10}, "repeat": 20}]}}"#,
    r#"{"step": {"commands": [{"arm": {"pose": {"position": [0.4, 0, 0.3], "quat_wxyz": [0, 1, 0, 0]}}, "gripper": {"width": 0.04, "force": 10}}]}}"#,
    r#"{"step": {"commands": [{"arm": {"impedance": {"x_wt": {"position": [0.4, 0, 0.3], "quat_wxyz": [0, 1, 0, 0]}, "stiffness": [1, 1, 1, 1, 1, 1], "damping_ratio": 1, "feed_forward": [0, 0, 0, 0, 0, 0], "posture": [0, 0, 0, 0, 0, 0, 0]}}, "gripper": {"width": 0.04, "force": 10}}]}}"#,
    r#"{"observe": {}}"#,
    r#"{"look": {"camera": "birds-eye"}}"#,
    r#"{"expose": {}}"#,
    r#"{"plan": {"coarse": 3, "fine": 9, "planning": 0.1}}"#,
    r#"{"event": {"kind": "start", "what": "pick up b4"}}"#,
    r#"{"event": {"kind": "action_begun", "action": "pick_up", "item": {"beam": "b4"}, "grasp": {"link": "b4l1"}}}"#,
    r#"{"event": {"kind": "fault", "fault": "jammed", "part": "b4", "remaining": 0.003, "force": 25}}"#,
    r#"{"done": {}}"#,
];

/// One line of an agent, mangled, and as far as the robot.
fn say(stream: &mut Stream) -> bool {
    let mut line = LINES[below(stream, LINES.len())].as_bytes().to_vec();
    mangle(&mut line, stream);
    match parse(&line) {
        Ok(Request::Hello(hello)) => hello.check().is_ok(),
        Ok(Request::Step(step)) => step
            .commands()
            .is_ok_and(|commands| commands.iter().all(|(command, _)| command.check_limits().is_ok())),
        Ok(Request::Event(event)) => event.at(0.0).is_ok(),
        Ok(Request::Plan(plan)) => plan.check().is_ok(),
        Ok(_) => true,
        Err(_) => false,
    }
}

/// Damages logs and messages for this many rounds, or fewer if they end before; returns a line of what came
/// of it.
fn fuzz(seed: u64, rounds: impl Iterator) -> String {
    let folder = tempfile::TempDir::new().unwrap();
    let path = folder.path().join("a.mcap");
    GoalFiles::new("easy-1").record_noisy(&mut Swing(400), &path);
    let whole = std::fs::read(&path).unwrap();
    let parts = messages(&whole);
    // A file without checksums, so that what is mangled gets as far as the readers.
    let bare = |compression| {
        let options = mcap::WriteOptions::new()
            .compression(compression)
            .calculate_chunk_crcs(false)
            .calculate_data_section_crc(false)
            .calculate_summary_section_crc(false);
        write_log(&parts, options)
    };
    let files = [whole.clone(), bare(None), bare(Some(mcap::Compression::Zstd))];
    assert!(files.iter().all(|file| read(file)));
    assert!(read(&whole));
    let mut stream = Stream::new(seed, "fuzz");
    let begin = Instant::now();
    let mut counts = [[0_u64; 2]; 3];
    PEAK.store(0, Ordering::Relaxed);
    for _ in rounds {
        // The file as it lies there.
        let mut bytes = files[below(&mut stream, files.len())].clone();
        mangle(&mut bytes, &mut stream);
        counts[0][usize::from(read(&bytes))] += 1;
        // A whole file with one message mangled.
        let mut messages = parts.clone();
        let wanted: Vec<usize> = (0..messages.len())
            .filter(|index| ["/episode", "/calls", "/result"].contains(&messages[*index].0.as_str()))
            .collect();
        let index = wanted[below(&mut stream, wanted.len())];
        mangle(&mut messages[index].1, &mut stream);
        counts[1][usize::from(read(&as_log(&messages)))] += 1;
        for _ in 0..20 {
            counts[2][usize::from(say(&mut stream))] += 1;
        }
        let peak = PEAK.load(Ordering::Relaxed);
        assert!(peak < LARGEST, "{peak} bytes at once");
    }
    format!(
        "{:.0} s, seed {seed}: files {} refused and {} read, messages in files {} and {}, lines {} and {}; at most {} bytes at once",
        begin.elapsed().as_secs_f64(),
        counts[0][0],
        counts[0][1],
        counts[1][0],
        counts[1][1],
        counts[2][0],
        counts[2][1],
        PEAK.load(Ordering::Relaxed)
    )
}

#[test]
fn mangled_logs_and_messages_do_no_harm() {
    println!("{}", fuzz(1, 0..2000));
}

#[test]
#[ignore = "runs for RAMP_FUZZ_SECONDS"]
fn mangled_logs_and_messages_do_no_harm_for_long() {
    let seconds = std::env::var("RAMP_FUZZ_SECONDS").ok().and_then(|it| it.parse().ok()).unwrap_or(60);
    let seed = std::env::var("RAMP_FUZZ_SEED").ok().and_then(|it| it.parse().ok()).unwrap_or(2);
    let end = Instant::now() + Duration::from_secs(seconds);
    println!("{}", fuzz(seed, std::iter::from_fn(|| (Instant::now() < end).then_some(()))));
}
