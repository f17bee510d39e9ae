//! Images of environments and samples show the parts of the episode.

use std::path::Path;
use std::sync::Arc;

use ramp_gym::pictures::Painter;
use ramp_gym::{Benchmark, Env, Options, Pictures, Sampler, Scenario, View};
use ramp_robot::{Camera, Track};
use ramp_twin::{Start, World};

const SIZE: usize = 128;

fn data() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

/// An environment of easy-1 in a world, and a painter of the parts as they were drawn by their designer.
fn scene(world: World) -> (Env, Painter) {
    let benchmark = Arc::new(Benchmark::read(&data()).unwrap());
    let assembly = benchmark.goal("easy-1").unwrap();
    let view = View { camera: Camera::BirdsEye, size: SIZE, depth: true };
    let drawn = Painter::of(view, &benchmark).unwrap();
    let scenario = Scenario::goal(benchmark, assembly, Track::State, world, Start::moved().clone());
    let options = Options { views: vec![view], ..Options::default() };
    let mut env = Env::new(Arc::new(scenario), options).unwrap();
    env.reset(Some(3)).unwrap();
    (env, drawn)
}

#[test]
fn images_show_the_parts_of_the_episode() {
    for (world, differ) in [("ideal", false), ("real", true)] {
        let world = World::read(&data().join(format!("worlds/{world}.toml"))).unwrap();
        let (env, mut drawn) = scene(world);
        let twin = env.twin().unwrap();
        drawn.paint(twin);
        assert_eq!(env.image(0).unwrap() != drawn.colour, differ);
        drawn.dress(twin).unwrap();
        drawn.paint(twin);
        assert!(env.image(0).unwrap() == drawn.colour);
    }
}

/// The camera from above is 2.5 m over the table, and the floor beside the table is 0.75 m deeper.
#[test]
fn samples_have_the_depth_of_their_images() {
    let (env, _) = scene(World::ideal().clone());
    let (twin, benchmark) = (env.twin().unwrap(), &env.scenario().benchmark);
    let assembly = benchmark.goal("easy-1").unwrap();
    let take = |depth| {
        let pictures = Some(Pictures { size: SIZE, depth });
        let mut sampler = Sampler::new(&assembly, &benchmark.arm, 50, pictures).unwrap();
        sampler.due(twin).unwrap().remove(0)
    };
    let (with, without) = (take(true), take(false));
    assert!(without.depths.is_empty() && with.images == without.images);
    let above = &with.depths[1];
    assert_eq!(above.len(), SIZE * SIZE);
    assert!(above.iter().all(|it| (10_000..34_000).contains(it)));
    let near = |value: i32| above.iter().filter(|it| (i32::from(**it) - value).abs() < 300).count();
    assert!(near(25_000) > SIZE * SIZE / 3 && near(32_500) > SIZE);
}
