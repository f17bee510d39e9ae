//! `ramp see --count N --track colour` and `depth`: a data set of parts without tags in the form of the BOP
//! benchmark, and the poses that the baseline finds in it.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use miette::{IntoDiagnostic, Report};
use nalgebra::{Matrix6, Translation3, UnitQuaternion, Vector3, Vector6};
use ramp_abilities::perception::bop::{Instance, Objects, Pair, Record, Tally, records};
use ramp_abilities::perception::{Photographer, View};
use ramp_assembly::Assembly;
use ramp_robot::arm::ArmModel;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, Image, Pose};
use ramp_vision::Lying;
use ramp_vision::untagged::{Believed, Found, Scene, SceneFinder};
use ramp_world::World;
use serde_json::{Map, Value, json};

use crate::image_file::{write_pixels, write_png};
use crate::output::write_file;

/// Standard deviations of the poses from which the baseline begins: shift along each axis, m, and turn, rad.
const SIGMA: [f64; 6] = [1.5e-3, 1.5e-3, 0.5e-3, 0.004, 0.004, 0.01];
/// The poses are off by at most so many of them.
const MOST: f64 = 1.7;
/// Distance between the fingers of the hand in the images, m.
const WIDTH: f64 = 0.04;
/// Least share of a part that shows, from which on it is to be found: as in BOP.
const LEAST: f64 = 0.1;

/// The images of one camera.
#[derive(Default)]
struct Shots {
    count: usize,
    cameras: Map<String, Value>,
    truths: Map<String, Value>,
    infos: Map<String, Value>,
}

/// The name of a camera's folder, and its number.
fn scene(camera: Camera) -> (&'static str, usize) {
    match camera {
        Camera::Wrist => ("000001", 1),
        Camera::BirdsEye => ("000002", 2),
    }
}

/// Writes a data set of `count` images, with depth where it is asked for. Gives the table of the baseline's
/// errors.
pub fn write(
    (assembly, arm): (&Assembly, &ArmModel),
    world: &World,
    (seed, count): (u64, u32),
    depth: bool,
    folder: &Path,
) -> Result<String, Report> {
    let kit = &assembly.kit;
    let mut photographer = Photographer::without_tags(assembly, arm, world).into_diagnostic()?;
    let mut finder = SceneFinder::new(kit, arm).into_diagnostic()?;
    let beams = kit.beams.iter().map(|beam| beam.name.clone());
    let names: Vec<String> = beams.chain(kit.pegs.iter().map(|peg| peg.name.clone())).collect();
    let objects = Objects::new(photographer.looks(), &names);
    write_models(&objects, folder)?;
    write_json(&folder.join("camera.json"), &camera(arm))?;
    let mut shots = Camera::ALL.map(|_| Shots::default());
    let mut tallies = vec![Tally::default(); objects.all.len()];
    let (mut targets, mut poses) = (Vec::new(), String::from("scene_id,im_id,obj_id,score,R,t,time\n"));
    let bar = ProgressBar::new(u64::from(count));
    for index in 0..count {
        let mut view = photographer.view(seed, index, "");
        let record = record(&mut photographer, &objects, &names, &view);
        if !depth {
            view.image.depth = None;
        }
        let shots = &mut shots[usize::from(view.image.camera == Camera::BirdsEye)];
        let number = shots.take(&record);
        let (name, scene) = scene(view.image.camera);
        write_image(&folder.join("test").join(name), number, &view.image, &record)?;
        for object in 1..=objects.all.len() {
            let shown = record.instances.iter().filter(|it| it.object == object && it.share() >= LEAST);
            let instances = shown.count();
            if instances > 0 {
                targets.push(
                    json!({"scene_id": scene, "im_id": number, "obj_id": object, "inst_count": instances}),
                );
            }
        }
        let found = find(&mut finder, &view, &names, seed, index)?;
        count_up(&mut tallies, &objects, &view, &record, &found);
        for part in &found {
            let Some((object, _)) = objects.of(&part.part) else { continue };
            let (turn, shift) = records::numbers(&(view.x_wc.inverse() * part.x_wp));
            let [turn, shift] = [&turn[..], &shift[..]]
                .map(|numbers| numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" "));
            let _ = writeln!(poses, "{scene},{number},{object},{:.4},{turn},{shift},-1", part.share);
        }
        bar.inc(1);
    }
    bar.finish_and_clear();
    for (shots, camera) in shots.iter().zip(Camera::ALL) {
        shots.write(&folder.join("test").join(scene(camera).0))?;
    }
    let data_set =
        folder.file_name().map_or_else(|| "ramp".into(), |name| name.to_string_lossy().into_owned());
    write_json(&folder.join("test_targets_bop19.json"), &json!(targets))?;
    write_file(&folder.join(format!("baseline_{data_set}-test.csv")), &poses)?;
    Ok(table(&objects, &tallies))
}

fn write_json(path: &Path, value: &Value) -> Result<(), Report> {
    write_file(path, serde_json::to_string_pretty(value).into_diagnostic()? + "\n")
}

/// The file `camera.json`: the lens of the camera on the hand, for those who draw images of their own.
fn camera(arm: &ArmModel) -> Value {
    let lens = CameraModel::nominal(Camera::Wrist, arm.hand.tip);
    let ([fx, fy], [cx, cy]) = (lens.focal, lens.centre.map(|centre| centre - 0.5));
    json!({
        "width": lens.width, "height": lens.height, "fx": fx, "fy": fy, "cx": cx, "cy": cy,
        "depth_scale": ramp_robot::DEPTH_UNIT * 1e3,
    })
}

fn write_models(objects: &Objects, folder: &Path) -> Result<(), Report> {
    for (name, fine) in [("models", false), ("models_eval", true)] {
        let folder = folder.join(name);
        std::fs::create_dir_all(&folder).into_diagnostic()?;
        for (object, number) in objects.all.iter().zip(1..) {
            write_file(&folder.join(format!("obj_{number:06}.ply")), object.ply(fine))?;
        }
        write_json(&folder.join("models_info.json"), &objects.info())?;
    }
    Ok(())
}

/// The parts in an image, hidden or not.
fn record(photographer: &mut Photographer, objects: &Objects, names: &[String], view: &View) -> Record {
    let depth = view.image.depth.clone().unwrap_or_default();
    let x_cw = view.x_wc.inverse();
    let mut instances = Vec::new();
    for (part, x_wp) in view.parts.iter().filter(|(part, _)| names.contains(part)) {
        let whole = photographer.silhouette(view, part);
        let body = photographer.looks().body(part);
        let visible = view.bodies.iter().map(|shown| Some(usize::from(*shown)) == body).collect();
        let place = (part.as_str(), x_cw * x_wp);
        instances.extend(Instance::new(objects, place, &view.real, (whole, visible), &depth));
    }
    Record { camera: view.real.clone(), x_wc: view.x_wc, instances }
}

impl Shots {
    /// Takes an image, and gives its number.
    fn take(&mut self, record: &Record) -> usize {
        let key = self.count.to_string();
        self.cameras.insert(key.clone(), record.camera_entry());
        self.truths.insert(key.clone(), record.truth_entry());
        self.infos.insert(key, record.info_entry());
        self.count += 1;
        self.count - 1
    }

    fn write(&self, folder: &Path) -> Result<(), Report> {
        if self.count == 0 {
            return Ok(());
        }
        let files = [("camera", &self.cameras), ("gt", &self.truths), ("gt_info", &self.infos)];
        for (name, content) in files {
            let text = serde_json::to_string(content).into_diagnostic()?;
            write_file(&folder.join(format!("scene_{name}.json")), text + "\n")?;
        }
        Ok(())
    }
}

/// Writes an image, its depth, and the masks of the parts in it.
fn write_image(folder: &Path, number: usize, image: &Image, record: &Record) -> Result<(), Report> {
    let place = |kind: &str, name: String| -> Result<PathBuf, Report> {
        let folder = folder.join(kind);
        std::fs::create_dir_all(&folder).into_diagnostic()?;
        Ok(folder.join(name))
    };
    write_png(&place("rgb", format!("{number:06}.png"))?, image, &image.pixels)?;
    if let Some(depth) = &image.depth {
        let bytes: Vec<u8> = depth.iter().flat_map(|depth| depth.to_be_bytes()).collect();
        let path = place("depth", format!("{number:06}.png"))?;
        write_pixels(&path, image, &bytes, png::ColorType::Grayscale, png::BitDepth::Sixteen)?;
    }
    for (index, part) in record.instances.iter().enumerate() {
        for (kind, mask) in [("mask", &part.whole), ("mask_visib", &part.visible)] {
            let bytes: Vec<u8> = mask.iter().map(|set| if *set { 255 } else { 0 }).collect();
            let path = place(kind, format!("{number:06}_{index:06}.png"))?;
            write_pixels(&path, image, &bytes, png::ColorType::Grayscale, png::BitDepth::Eight)?;
        }
    }
    Ok(())
}

/// The parts that the baseline finds, from poses that are off as they are before a look in an episode.
fn find(
    finder: &mut SceneFinder,
    view: &View,
    names: &[String],
    seed: u64,
    index: u32,
) -> Result<Vec<Found>, Report> {
    let mut stream = Stream::new(seed, &format!("belief-{index}"));
    let covariance = Matrix6::from_diagonal(&Vector6::from(SIGMA).map(|sigma| sigma * sigma));
    let believed = |(part, x_wp): &(String, Pose)| {
        let off = SIGMA.map(|sigma| stream.symmetric(MOST * sigma));
        let turn = UnitQuaternion::from_scaled_axis(Vector3::new(off[3], off[4], off[5]));
        let at = x_wp.translation.vector + Vector3::new(off[0], off[1], off[2]);
        let lying = view.lying.iter().find(|(name, ..)| name == part).map(|(_, height, flipped)| Lying {
            part: part.clone(),
            height: *height,
            flipped: *flipped,
            sigma: Lying::SIGMA,
        });
        let x_wp = Pose::from_parts(Translation3::from(at), turn * x_wp.rotation);
        Believed { part: part.clone(), x_wp, covariance, lying, held: false }
    };
    let (parts, holders): (Vec<_>, Vec<_>) =
        view.parts.iter().cloned().partition(|(name, _)| names.contains(name));
    let parts: Vec<Believed> = parts.iter().map(believed).collect();
    let scene = Scene { parts: &parts, holders: &holders, width: WIDTH };
    Ok(finder.find(&view.image, &view.told, &scene, &|_| true, 0.0).into_diagnostic()?.found)
}

/// Counts the parts that are to be found in an image, and the errors of those that were.
fn count_up(tallies: &mut [Tally], objects: &Objects, view: &View, record: &Record, found: &[Found]) {
    for part in record.instances.iter().filter(|part| part.share() >= LEAST) {
        let Some((number, object)) = objects.of(&part.part) else { continue };
        let tally = &mut tallies[number - 1];
        tally.parts += 1;
        if let Some(found) = found.iter().find(|it| it.part == part.part) {
            let found = view.x_wc.inverse() * found.x_wp;
            tally.add(&Pair { object, camera: &view.real, found, truth: part.x_cp });
        }
    }
}

fn table(objects: &Objects, tallies: &[Tally]) -> String {
    let mut text = String::from(
        "object  parts to find  found   mm 50 %   95 %    ° 50 %   95 %   ADD-S < 10 %   AR by MSPD  parts\n",
    );
    let mut line = |name: &str, tally: &Tally, parts: &str| {
        let ([mm, worst], [turn, most]) = (tally.shift(), tally.turn());
        let _ = writeln!(
            text,
            "{name:<6} {:>14} {:>6} {:>9.2} {:>6.2} {:>9.2} {:>6.2} {:>14.3} {:>12.3}  {parts}",
            tally.parts,
            tally.found(),
            mm * 1e3,
            worst * 1e3,
            turn.to_degrees(),
            most.to_degrees(),
            tally.recall_by_mean_distance(),
            tally.recall_by_image_distance(),
        );
    };
    let mut all = Tally::default();
    for ((object, tally), number) in objects.all.iter().zip(tallies).zip(1..) {
        line(&format!("{number}"), tally, &object.parts.join(" "));
        all.extend(tally);
    }
    line("all", &all, "");
    text
}
