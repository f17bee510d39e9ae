//! Random search for a path around obstacles in joint space: bidirectional trees (Kuffner and LaValle:
//! RRT-Connect, 2000). The path is then shortened.

use ramp_robot::random::Stream;

use crate::space::Joints;

/// Largest distance between samples of a path in joint space, rad.
pub(crate) const JOINT_SAMPLE: f64 = 0.05;
/// Growth of a tree in one step, rad.
const TREE_STEP: f64 = 0.1;
/// Nodes of both trees together before the search gives up.
const TREE_NODES: usize = 6000;
/// Attempts to shorten a path.
const SHORTCUTS: usize = 150;

/// A node: joint positions (rad), and the number of its parent. The root is its own parent.
type Node<const N: usize> = (Joints<N>, usize);

/// The corners of a shortened path from `start` to `goal`, straight in joint space between them; `None` when
/// none was found. Joint positions are in rad, random ones within `ranges`, and every sample of the path is
/// `free`.
pub(crate) fn connect<const N: usize>(
    ranges: &[[f64; 2]; N],
    free: &impl Fn(&Joints<N>) -> bool,
    start: &Joints<N>,
    goal: &Joints<N>,
    stream: &mut Stream,
) -> Option<Vec<Joints<N>>> {
    let mut trees: [Vec<Node<N>>; 2] = [vec![(*start, 0)], vec![(*goal, 0)]];
    let mut active = 0;
    while trees[0].len() + trees[1].len() < TREE_NODES {
        let sample = Joints::from_fn(|joint, _| {
            let [low, high] = ranges[joint];
            low + (high - low) * stream.uniform()
        });
        if let Some(new) = grow(&mut trees[active], &sample, free) {
            let target = trees[active][new].0;
            let other = 1 - active;
            while let Some(near) = grow(&mut trees[other], &target, free) {
                if (trees[other][near].0 - target).amax() < 1e-9 {
                    let (mine, theirs) = (branch(&trees[active], new), branch(&trees[other], near));
                    let (head, tail) = if active == 0 { (mine, theirs) } else { (theirs, mine) };
                    let mut way: Vec<Joints<N>> = head.into_iter().rev().collect();
                    way.extend(tail.into_iter().skip(1));
                    return Some(shorten(way, free, stream));
                }
            }
        }
        active = 1 - active;
    }
    None
}

/// The nodes from one node to the root of its tree.
fn branch<const N: usize>(tree: &[Node<N>], mut node: usize) -> Vec<Joints<N>> {
    let mut way = vec![tree[node].0];
    while node != 0 {
        node = tree[node].1;
        way.push(tree[node].0);
    }
    way
}

/// Grows a tree one step towards `target`; the new node, or `None` when something blocks it.
fn grow<const N: usize>(
    tree: &mut Vec<Node<N>>,
    target: &Joints<N>,
    free: &impl Fn(&Joints<N>) -> bool,
) -> Option<usize> {
    let (nearest, _) = tree
        .iter()
        .enumerate()
        .map(|(index, (q, _))| (index, (q - target).norm_squared()))
        .min_by(|a, b| a.1.total_cmp(&b.1))?;
    let from = tree[nearest].0;
    let way = target - from;
    let next = if way.norm() <= TREE_STEP { *target } else { from + way * (TREE_STEP / way.norm()) };
    if (next - from).norm() < 1e-12 || !edge_is_free(&from, &next, free) {
        return None;
    }
    tree.push((next, nearest));
    Some(tree.len() - 1)
}

/// Replaces random parts of a path by straight lines where these are free.
fn shorten<const N: usize>(
    mut way: Vec<Joints<N>>,
    free: &impl Fn(&Joints<N>) -> bool,
    stream: &mut Stream,
) -> Vec<Joints<N>> {
    for _ in 0..SHORTCUTS {
        if way.len() < 3 {
            break;
        }
        let a = (stream.uniform() * way.len() as f64) as usize;
        let b = (stream.uniform() * way.len() as f64) as usize;
        let (a, b) = (a.min(b), a.max(b));
        if b > a + 1 && edge_is_free(&way[a], &way[b], free) {
            way.drain(a + 1..b);
        }
    }
    way
}

fn edge_is_free<const N: usize>(a: &Joints<N>, b: &Joints<N>, free: &impl Fn(&Joints<N>) -> bool) -> bool {
    interpolate(a, b).iter().all(free)
}

/// Samples of a straight line in joint space, both ends among them.
pub(crate) fn interpolate<const N: usize>(a: &Joints<N>, b: &Joints<N>) -> Vec<Joints<N>> {
    let steps = (((b - a).amax() / JOINT_SAMPLE).ceil() as usize).max(1);
    (0..=steps).map(|step| a.lerp(b, step as f64 / steps as f64)).collect()
}
