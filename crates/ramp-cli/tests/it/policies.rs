//! Policies behind a server: over the wire, and whatever the server does, with a result.

use std::net::{SocketAddr, TcpListener};
use std::path::Path;
use std::process::Output;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;

use ramp_policy_client::wire;
use rmpv::Value as Packed;
use serde_json::Value;
use tempfile::TempDir;
use tungstenite::Message;

/// The reaction of a server to an observation.
type Policy = dyn Fn(&mut Memory, &Packed) -> Reply + Send + Sync;

/// The reactions of a server, one for each observation.
type Replier = Box<dyn Fn() -> Reply + Send + Sync>;

enum Reply {
    Say(Message),
    /// Closes the socket without a word.
    Die,
}

/// The memory of a policy within an episode.
#[derive(Default)]
struct Memory {
    /// Tip of the arm, and force on it, at the start.
    begin: Option<([f64; 3], f64)>,
    angle: f64,
    calls: usize,
}

/// A server on a port of its own; it ends with the test's process.
struct Server {
    address: SocketAddr,
    connections: Arc<AtomicUsize>,
}

impl Server {
    fn start(
        metadata: Vec<u8>,
        policy: impl Fn(&mut Memory, &Packed) -> Reply + Send + Sync + 'static,
    ) -> Server {
        let listener = TcpListener::bind("127.0.0.1:0").unwrap();
        let address = listener.local_addr().unwrap();
        let (policy, connections): (Arc<Policy>, _) = (Arc::new(policy), Arc::new(AtomicUsize::new(0)));
        let count = Arc::clone(&connections);
        thread::spawn(move || {
            for stream in listener.incoming().flatten() {
                count.fetch_add(1, Ordering::Relaxed);
                let (policy, metadata) = (Arc::clone(&policy), metadata.clone());
                thread::spawn(move || {
                    let Ok(mut socket) = tungstenite::accept(stream) else { return };
                    let _ = socket.send(Message::Binary(metadata.into()));
                    let mut memory = Memory::default();
                    while let Ok(message) = socket.read() {
                        let Message::Binary(bytes) = message else { continue };
                        let seen = wire::from_bytes(&bytes).unwrap();
                        let reply = match wire::get(&seen, "endpoint").and_then(Packed::as_str) {
                            Some("reset") => {
                                memory = Memory::default();
                                Reply::Say(Message::Text("reset successful".into()))
                            }
                            _ => {
                                memory.calls += 1;
                                policy(&mut memory, &seen)
                            }
                        };
                        let Reply::Say(message) = reply else { return };
                        if socket.send(message).is_err() {
                            return;
                        }
                    }
                });
            }
        });
        Server { address, connections }
    }

    fn url(&self) -> String {
        format!("ws://{}", self.address)
    }
}

fn metadata(entries: &[(&str, Packed)]) -> Vec<u8> {
    wire::to_bytes(&wire::map(entries.iter().cloned()))
}

/// A chunk of `count` equal actions.
fn chunk(action: &[f64], count: usize) -> Packed {
    let row = Packed::from(action.iter().map(|number| (*number).into()).collect::<Vec<Packed>>());
    wire::map([("actions", Packed::from(vec![row; count]))])
}

fn say(value: &Packed) -> Reply {
    Reply::Say(Message::Binary(wire::to_bytes(value).into()))
}

/// Holds still.
fn hold() -> Reply {
    say(&chunk(&[0.0; 8], 8))
}

fn ramp(folder: &TempDir, arguments: &[&str]) -> Output {
    super::ramp(folder.path(), arguments)
}

fn result(folder: &TempDir, name: &str) -> Value {
    serde_json::from_str(&std::fs::read_to_string(folder.path().join(name)).unwrap()).unwrap()
}

fn three(seen: &Packed, key: &str) -> [f64; 3] {
    let array = wire::to_array(wire::get(seen, key).unwrap()).unwrap();
    [array.numbers[0], array.numbers[1], array.numbers[2]]
}

/// Over the hole, down, and along a spiral where the peg meets no hole: as `examples/policies/server.py`.
fn insert(memory: &mut Memory, seen: &Packed) -> Reply {
    let image = wire::get(seen, "observation/wrist_image_left").unwrap();
    let shape: Vec<u64> =
        wire::get(image, "shape").unwrap().as_array().unwrap().iter().filter_map(Packed::as_u64).collect();
    assert_eq!(shape, [96, 96, 3]);
    assert!(wire::get(seen, "observation/exterior_image_0_left").is_none());
    assert!(wire::get(seen, "prompt").and_then(Packed::as_str).unwrap().starts_with("fasten"));
    let (tip, force) = (three(seen, "ramp/tip_pose"), three(seen, "ramp/wrench")[2]);
    let (begin, rest) = *memory.begin.get_or_insert((tip, force));
    let (goal, part) = (three(seen, "ramp/goal_pose"), three(seen, "ramp/part_pose"));
    let mut error: [f64; 3] = std::array::from_fn(|axis| goal[axis] - part[axis] - (tip[axis] - begin[axis]));
    if (force - rest).abs() > 4.0 && error[2] < -2.0e-3 {
        memory.angle += 0.8;
    }
    let radius = (0.5e-3 * memory.angle / std::f64::consts::TAU).min(3.0e-3);
    error[0] += radius * memory.angle.cos();
    error[1] += radius * memory.angle.sin();
    let unit = 0.075 * 15.0;
    let mut action = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0];
    for axis in 0..2 {
        action[axis] = (2.0 * error[axis]).clamp(-0.02, 0.02) / unit;
    }
    if error[0].hypot(error[1]) < 1.5e-3 || memory.angle > 0.0 {
        action[2] = -0.02 / unit;
    }
    say(&chunk(&action, 3))
}

fn inserting() -> Server {
    let sides = Packed::from(vec![Packed::from(96), 96.into()]);
    let told = metadata(&[
        ("name", "insert".into()),
        ("action_space", "cartesian_velocity".into()),
        ("needs_ramp_fields", true.into()),
        ("n_external_cameras", 0.into()),
        ("image_resolution", sides),
        ("open_loop_horizon", 3.into()),
        ("time_limit", 15.0.into()),
    ]);
    Server::start(told, insert)
}

/// A policy fastens all pegs of easy-1 on `tags` in the world `real`, and the log replays to the last bit.
#[test]
fn a_policy_over_the_wire_fastens() {
    let folder = TempDir::new().unwrap();
    let server = inserting();
    let skill = format!("fasten={}", server.url());
    let run = ramp(&folder, &["run", "easy-1", "--skill", &skill, "-o", "a.json"]);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    let result = result(&folder, "a.json");
    assert_eq!(result["completion"], 1.0);
    let name = result["agent"]["name"].as_str().unwrap();
    assert!(name.starts_with("baseline+fasten-by-insert."), "{name}");
    let replay = ramp(&folder, &["replay", "a.mcap"]);
    assert!(replay.status.success(), "{}", String::from_utf8_lossy(&replay.stdout));
}

/// One skill alone, twice with the same state at the end; a skill that no policy can carry out is refused.
#[test]
fn trials_judge_a_policy_on_one_skill() {
    let folder = TempDir::new().unwrap();
    let server = inserting();
    let url = server.url();
    let trial = |out: &str| -> Value {
        let trials = ["trials", "fasten-in-f", "--trials", "1", "--policy", &url, "-o", out];
        let run = ramp(&folder, &trials);
        assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
        let file = std::fs::read_dir(folder.path().join(out)).unwrap().next().unwrap().unwrap().path();
        serde_json::from_str(&std::fs::read_to_string(file).unwrap()).unwrap()
    };
    let (one, two) = (trial("one"), trial("two"));
    assert!(one["agent"]["name"].as_str().unwrap().starts_with("baseline+fasten-by-insert."));
    let events = one["events"].as_array().unwrap();
    assert!(events.iter().any(|event| event["kind"] == "action_begun" && event["action"] == "fasten"));
    assert_eq!(one["success"], true, "{one}");
    assert_eq!((&one["physics"], &one["time"]), (&two["physics"], &two["time"]));
    let run = ramp(&folder, &["trials", "pick-up-peg", "--trials", "1", "--policy", &url]);
    assert_eq!(run.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&run.stderr).contains("no policy can carry out the skill `pick-up-peg`"));
}

/// Joint velocities in DROID's unit, joint positions, and images as a plain openpi server gets them.
#[test]
fn the_arm_moves_as_the_action_space_says() {
    let folder = TempDir::new().unwrap();
    let moved = Arc::new(std::sync::Mutex::new(Vec::new()));
    let joints = |seen: &Packed| {
        wire::to_array(wire::get(seen, "observation/joint_position").unwrap()).unwrap().numbers
    };
    let keep = Arc::clone(&moved);
    let server = Server::start(metadata(&[]), move |memory, seen| {
        let shape =
            wire::get(wire::get(seen, "observation/exterior_image_1_left").unwrap(), "shape").unwrap();
        assert_eq!(shape.to_string(), "[224, 224, 3]");
        assert!(wire::get(seen, "endpoint").is_none());
        keep.lock().unwrap().push(joints(seen)[0]);
        if memory.calls == 3 {
            let actions = wire::get(&chunk(&[0.0; 8], 1), "actions").cloned().unwrap();
            return say(&wire::map([("actions", actions), ("done", true.into())]));
        }
        // Four actions more than are carried out.
        say(&chunk(&[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 12))
    });
    let run =
        ramp(&folder, &["run", "easy-1", "--world", "ideal", "--policy", &server.url(), "-o", "v.json"]);
    assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stderr));
    let v = result(&folder, "v.json");
    assert_eq!(v["ended"]["reason"], "done");
    assert!(v["agent"]["name"].as_str().unwrap().starts_with("policy."));
    assert!(v["time"]["compute"].as_f64().unwrap() > 0.0);
    // 0.1 of 3 rad/s over eight actions at 15 Hz.
    let positions = moved.lock().unwrap().clone();
    let turned = positions[1] - positions[0];
    assert!((turned - 0.16).abs() < 0.03, "{positions:?}");

    let told = metadata(&[
        ("action_space", "joint_position".into()),
        ("needs_session_id", true.into()),
        ("n_external_cameras", 0.into()),
        ("needs_wrist_camera", false.into()),
        ("time_limit", 2.0.into()),
    ]);
    let last = Arc::new(std::sync::Mutex::new(0.0));
    let keep = Arc::clone(&last);
    let server = Server::start(told, move |memory, seen| {
        assert!(wire::get(seen, "session_id").is_some());
        let mut target = joints(seen);
        let begin = *memory.begin.get_or_insert(([target[0], 0.0, 0.0], 0.0));
        *keep.lock().unwrap() = target[0] - begin.0[0];
        target[0] = begin.0[0] + 0.2;
        target.push(0.0);
        say(&chunk(&target, 8))
    });
    let run =
        ramp(&folder, &["run", "easy-1", "--world", "ideal", "--policy", &server.url(), "-o", "p.json"]);
    assert_eq!(run.status.code(), Some(1), "{}", String::from_utf8_lossy(&run.stderr));
    let reason = result(&folder, "p.json")["ended"]["reason"].clone();
    assert_eq!(reason, "the policy was not done after 2 s, its `time_limit`");
    assert!((*last.lock().unwrap() - 0.2).abs() < 0.01, "{last:?}");
}

/// With `--async` the last actions play on while the server computes: the joint goes further between two
/// observations than the actions before each question say. The result says so, and is kept apart; its log
/// replays to the last bit.
#[test]
fn a_robot_may_go_on_while_its_policy_computes() {
    let folder = TempDir::new().unwrap();
    let told = metadata(&[
        ("n_external_cameras", 0.into()),
        ("needs_wrist_camera", false.into()),
        ("open_loop_horizon", 2.into()),
    ]);
    let seen_at = Arc::new(std::sync::Mutex::new(Vec::new()));
    let keep = Arc::clone(&seen_at);
    let server = Server::start(told, move |memory, seen| {
        let joints = wire::to_array(wire::get(seen, "observation/joint_position").unwrap()).unwrap();
        keep.lock().unwrap().push(joints.numbers[0]);
        thread::sleep(std::time::Duration::from_millis(150));
        let mut answer = chunk(&[0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0], 12);
        if memory.calls == 4 {
            let actions = wire::get(&answer, "actions").cloned().unwrap();
            answer = wire::map([("actions", actions), ("done", true.into())]);
        }
        say(&answer)
    });
    let run = |arguments: &[&str]| {
        let all =
            [&["run", "easy-1", "--world", "ideal", "--policy", &server.url(), "-o", "v.json"], arguments];
        ramp(&folder, &all.concat())
    };
    let ran = run(&["--async"]);
    assert_eq!(ran.status.code(), Some(1), "{}", String::from_utf8_lossy(&ran.stderr));
    let v = result(&folder, "v.json");
    assert_eq!(v["ended"]["reason"], "done");
    assert_eq!(v["agent"]["async"], true);
    // An action is 0.02 rad: a robot that waits goes on by two, and 0.15 s of the server are three.
    let positions = seen_at.lock().unwrap().clone();
    assert!(positions.len() == 4 && positions[3] - positions[2] > 0.05, "{positions:?}");
    let replay = ramp(&folder, &["replay", "v.mcap"]);
    assert!(replay.status.success(), "{}", String::from_utf8_lossy(&replay.stdout));
    let refused = run(&[]);
    assert_eq!(refused.status.code(), Some(2));
    let said = String::from_utf8_lossy(&refused.stderr);
    let said = said.split_whitespace().filter(|word| *word != "│").collect::<Vec<_>>().join(" ");
    assert!(said.contains("unknown, async"), "{said}");
    let alone = ramp(&folder, &["run", "easy-1", "--async"]);
    assert_eq!(alone.status.code(), Some(2));
}

/// Whatever a server does, the episode has a result, and the reason names the field.
#[test]
fn a_server_that_fails_ends_its_episode_with_a_reason() {
    let folder = TempDir::new().unwrap();
    let told = || metadata(&[("n_external_cameras", 0.into()), ("needs_wrist_camera", false.into())]);
    let mut nan = [0.0; 8];
    nan[3] = f64::NAN;
    let cases: [(&str, Replier, &str); 7] = [
        ("dies", Box::new(|| Reply::Die), "the policy server closed the connection"),
        ("nan", Box::new(move || say(&chunk(&nan, 2))), "not understood: `actions`[0, 3] is NaN"),
        (
            "shape",
            Box::new(|| say(&chunk(&[0.0; 7], 2))),
            "`actions` is of shape (2, 7), and (T, 8) was expected",
        ),
        (
            "huge",
            Box::new(|| Reply::Say(vec![0_u8; 2 << 20].into())),
            "sent a message of more than 1048576 bytes",
        ),
        (
            "words",
            Box::new(|| Reply::Say("Traceback: out of memory".into())),
            "failed: Traceback: out of memory",
        ),
        ("bytes", Box::new(|| Reply::Say(vec![0x92_u8, 1].into())), "its answer is no MessagePack value"),
        (
            "slow",
            Box::new(|| {
                thread::sleep(std::time::Duration::from_secs(3));
                hold()
            }),
            "did not answer in time",
        ),
    ];
    for (name, reply, why) in cases {
        let server = Server::start(told(), move |memory, _| if memory.calls < 2 { hold() } else { reply() });
        let out = format!("{name}.json");
        let limit = if name == "slow" { "1" } else { "20" };
        let policy = ["--policy", &server.url(), "--agent-limit", limit, "-o", &out];
        let run = ramp(&folder, &[&["run", "easy-1", "--world", "ideal"][..], &policy].concat());
        assert_eq!(run.status.code(), Some(1), "{name}: {}", String::from_utf8_lossy(&run.stderr));
        let result = result(&folder, &out);
        let reason = result["ended"]["reason"].as_str().unwrap();
        assert!(reason.contains(why), "{name}: {reason}");
        assert_eq!(result["ended"]["kind"], "agent");
        // The first chunk was carried out.
        assert!(result["time"]["robot"].as_f64().unwrap() > 0.5, "{name}");
    }
}

/// Nothing is written where there is no server, or none that fits.
#[test]
fn a_handshake_that_fails_is_bad_input() {
    let folder = TempDir::new().unwrap();
    let nobody = TcpListener::bind("127.0.0.1:0").unwrap().local_addr().unwrap();
    let foreign = Server::start(metadata(&[("action_space", "dance".into())]), |_, _| Reply::Die);
    let cases = [
        (format!("ws://{nobody}"), "cannot be reached"),
        (foreign.url(), "`action_space` is `dance`; there are joint_position"),
        ("wss://127.0.0.1:1".to_string(), "wss is not built in"),
        ("127.0.0.1:8000".to_string(), "expected ws://HOST:PORT"),
    ];
    for (url, why) in &cases {
        for command in [&["run", "easy-1"][..], &["bench", "easy-1"], &["trials", "fasten-in-f"]] {
            let run = ramp(&folder, &[command, &["--policy", url]].concat());
            assert_eq!(run.status.code(), Some(2), "{command:?} {url}");
            let said = String::from_utf8_lossy(&run.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
            assert!(said.contains(why), "{command:?}: {said}");
        }
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Another policy than at first behind the address ends the episode.
#[test]
fn a_policy_that_is_exchanged_is_noticed() {
    let folder = TempDir::new().unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let url = format!("ws://{}", listener.local_addr().unwrap());
    thread::spawn(move || {
        for (number, stream) in listener.incoming().flatten().enumerate() {
            let Ok(mut socket) = tungstenite::accept(stream) else { continue };
            let told = metadata(&[
                ("version", number.to_string().into()),
                ("n_external_cameras", 0.into()),
                ("needs_wrist_camera", false.into()),
                ("time_limit", 0.5.into()),
            ]);
            let _ = socket.send(Message::Binary(told.into()));
            while socket.read().is_ok() {
                let Reply::Say(message) = hold() else { return };
                let _ = socket.send(message);
            }
        }
    });
    ramp(&folder, &["run", "easy-1", "--world", "ideal", "--policy", &url, "-o", "out.json"]);
    let result = result(&folder, "out.json");
    let reason = result["ended"]["reason"].as_str().unwrap();
    assert!(reason.contains("other metadata than when the command began"), "{reason}");
}

/// Each episode of a bench has a connection of its own, and the folder is of one policy.
#[test]
fn a_bench_connects_for_each_episode() {
    let folder = TempDir::new().unwrap();
    let told = |name: &str| {
        metadata(&[
            ("name", name.into()),
            ("n_external_cameras", 0.into()),
            ("needs_wrist_camera", false.into()),
            ("time_limit", 0.5.into()),
        ])
    };
    let server = Server::start(told("one"), |_, _| hold());
    let bench = |server: &Server| {
        let url = server.url();
        let bench =
            ["bench", "easy-1", "--world", "ideal", "--repeats", "2", "--jobs", "2", "--policy", &url];
        ramp(&folder, &[&bench[..], &["-o", "out"]].concat())
    };
    let run = bench(&server);
    assert!(run.status.success(), "{}", String::from_utf8_lossy(&run.stderr));
    // The command's, and for each episode that of its process and its own.
    assert_eq!(server.connections.load(Ordering::Relaxed), 5);
    let result = result(&folder, "out/easy-1-tags-2.json");
    assert!(result["agent"]["name"].as_str().unwrap().starts_with("one."));
    let other = bench(&Server::start(told("two"), |_, _| hold()));
    assert_eq!(other.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&other.stderr).contains("of the agent one."));
    assert!(Path::new(&folder.path().join("out/easy-1-tags-1.mcap")).exists());
}
