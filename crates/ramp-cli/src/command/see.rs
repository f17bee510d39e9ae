//! `ramp see`: camera images of a goal, the detected poses, and their errors.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use indicatif::ProgressBar;
use miette::{IntoDiagnostic, Report, miette};
use ramp_abilities::perception::{
    Estimate, Labels, Photographer, PoseLabel, SCHEMA, Verdict, areas, coco, judge,
};
use ramp_assembly::Task;
use ramp_data::Data;
use ramp_kit::source::{A_NAME, MAX_SENTENCE, decode, is_name, plain, read_bytes, shorten, to_name};
use ramp_kit::strokes::{self, Align};
use ramp_result::perception::FALSE;
use ramp_result::sha256;
use ramp_robot::{Camera, CameraModel, Image, Pose, Robot, Track};
use ramp_twin::{Setup, Twin};
use ramp_vision::{Lying, PartFinder, Sighting};
use ramp_world::Start;
use resvg::{tiny_skia, usvg};

use super::{see_bop, see_scene};
use crate::image_file::{write_pixels, write_png};
use crate::output::{check_place, print, write_file};
use crate::software::software;
use crate::status::{DONE, INCOMPLETE};

#[derive(clap::Args)]
pub struct Arguments {
    /// Name of a goal, or a goal file
    #[arg(required_unless_present = "judge")]
    goal: Option<String>,
    /// Track of the images: `tags`; `colour` for parts without tags; `depth` for the same with depth
    #[arg(long, default_value = "tags", value_parser = ["tags", "colour", "depth"], conflicts_with = "judge")]
    track: String,
    /// Seed of the layout, the cameras' errors and the noise
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Folder to write to, made if it is not there; with --judge, the file for the verdict, for `ramp report`
    #[arg(short, long, value_name = "DIR|FILE", required_unless_present = "judge")]
    output: Option<PathBuf>,
    /// Write a data set of N images with labels and the baseline's detections; without tags in the form of
    /// BOP
    #[arg(long, value_name = "N")]
    count: Option<u32>,
    /// Judge a detector's poses (a file like estimates.json) on the labels of a data set (its folder)
    #[arg(long, num_args = 2, value_names = ["FILE", "DIR"], conflicts_with_all = ["goal", "count"])]
    judge: Option<Vec<PathBuf>>,
    /// Also write the depth of each image of a data set: 16 bits, tenths of a millimetre along the optical
    /// axis, 0 beyond 6.5 m
    #[arg(long, requires = "count")]
    depth: bool,
    /// Keep the labels and poses of a data set only, not its images
    #[arg(long, requires = "count")]
    no_images: bool,
}

pub fn run(data: &Data, arguments: &Arguments) -> Result<u8, Report> {
    if let Some([file, folder]) = arguments.judge.as_deref() {
        if let Some(path) = &arguments.output {
            check_place(path)?;
        }
        let (estimates, _): (Vec<Estimate>, _) = read(file)?;
        let path = folder.join(LABELS);
        let (labels, hash): (Labels, String) = read(&path)?;
        check_names(file, estimates.iter().flat_map(|it| [&it.file, &it.part]))?;
        for view in &labels.views {
            check_names(
                &path,
                [&view.file, &view.camera].into_iter().chain(view.parts.iter().map(|it| &it.part)),
            )?;
        }
        let verdict = judge(&labels, &estimates);
        if let Some(output) = &arguments.output {
            let detector = to_name(&file.file_stem().unwrap_or_default().to_string_lossy());
            let result = verdict.to_result(&detector, &hash, labels.views.len(), &software());
            let text = serde_json::to_string_pretty(&result).into_diagnostic()? + "\n";
            write_file(output, &text)?;
        }
        print(&table(&verdict))?;
        return Ok(if verdict.false_poses.is_empty() { DONE } else { INCOMPLETE });
    }
    let (Some(goal), Some(folder)) = (&arguments.goal, &arguments.output) else {
        return Err(miette!("name a goal, and a folder with -o"));
    };
    let assembly = data.goal(goal)?;
    let arm = data.arm()?;
    std::fs::create_dir_all(folder).into_diagnostic()?;
    // The parser has no other names.
    let track = Track::ALL.into_iter().find(|it| it.name() == arguments.track).unwrap_or(Track::Tags);
    if let Some(count) = arguments.count.filter(|_| !track.has_tags()) {
        if arguments.depth || arguments.no_images {
            let help = "without tags, `--track depth` writes depth and `--track colour` does not";
            return Err(miette!(help = help, "`--depth` and `--no-images` are for images with tags"));
        }
        let world = data.world("real")?;
        let seed = (arguments.seed, count);
        print(&see_bop::write((&assembly, &arm), &world, seed, track.has_depth(), folder)?)?;
        return Ok(DONE);
    }
    if let Some(count) = arguments.count {
        let photographer = Photographer::new(&assembly, &arm).into_diagnostic()?;
        return data_set(photographer, &assembly.kit, arguments, folder, count);
    }
    let setup = Setup {
        assembly: &assembly,
        arm: &arm,
        track,
        seed: arguments.seed,
        start: Start::sheet(),
        world: &data.world("real")?,
        state: None,
        task: Task::Build,
        fault: None,
    };
    let mut twin = Twin::new(&setup).into_diagnostic()?;
    if !track.has_tags() {
        print(&see_scene::write(&assembly.kit, &arm, &mut twin, folder)?)?;
        return Ok(DONE);
    }
    let mut finder = PartFinder::new(&assembly.kit).into_diagnostic()?;
    let lying = Lying::at_start(&assembly.kit);
    let mut text = String::new();
    for camera in Camera::ALL {
        let image = twin.look(camera).into_diagnostic()?;
        let told = twin.camera(camera);
        let sighting = finder.find(&image, &told, &lying).into_diagnostic()?;
        write_png(&folder.join(format!("{}.png", camera.name())), &image, &image.pixels)?;
        let drawn = draw(&image, &told, &sighting, &finder)?;
        write_png(&folder.join(format!("{}-found.png", camera.name())), &image, &drawn)?;
        compare(&mut text, camera, &twin, &image, &sighting);
    }
    print(&text)?;
    Ok(DONE)
}

/// Largest size of a file of labels or poses, bytes. This is enough for 100,000 images.
const LARGEST: usize = 512 << 20;
/// Number of images of a data set that are also written with the detections drawn in.
const DRAWN: u32 = 10;
/// Files of a data set.
const LABELS: &str = "labels.json";
const ESTIMATES: [&str; 2] = ["estimates.json", "estimates-lying.json"];
const COCO: &str = "coco.json";
/// Conditions of each of the two estimates.
const TITLES: [&str; 2] = [
    "each image alone. Nothing is known of the parts, and the cameras' poses are nominal.\n\
     A pose that is too uncertain is not given: from above, the tags are too small for one without prior knowledge.",
    "like the baseline in an episode. The heights of the parts are known, and the cameras are calibrated.",
];

fn data_set(
    mut photographer: Photographer<'_>,
    kit: &ramp_kit::Kit,
    arguments: &Arguments,
    folder: &Path,
    count: u32,
) -> Result<u8, Report> {
    let mut finder = PartFinder::new(kit).into_diagnostic()?;
    let names: Vec<String> = kit
        .beams
        .iter()
        .map(|beam| beam.name.clone())
        .chain(kit.pegs.iter().map(|peg| peg.name.clone()))
        .collect();
    let bodies: Vec<Option<usize>> = photographer
        .looks()
        .bodies()
        .iter()
        .map(|body| names.iter().position(|name| *name == body.name))
        .collect();
    let mut labels = Labels { schema: SCHEMA.to_string(), views: Vec::new() };
    let mut all_areas = Vec::new();
    let mut estimates = [Vec::new(), Vec::new()];
    let bar = ProgressBar::new(u64::from(count));
    for index in 0..count {
        let file = format!("{index:05}.png");
        let view = photographer.view(arguments.seed, index, &file);
        if !arguments.no_images {
            write_png(&folder.join(&file), &view.image, &view.image.pixels)?;
            all_areas.push(areas(&view, &bodies));
        }
        // Detect twice: without prior knowledge, and with calibrated cameras and known heights.
        let lying: Vec<Lying> = view
            .lying
            .iter()
            .map(|(part, height, flipped)| Lying {
                part: part.clone(),
                height: *height,
                flipped: *flipped,
                sigma: Lying::SIGMA,
            })
            .collect();
        let ways = [(&view.told, &[][..]), (&view.real, &lying[..])];
        for ((camera, known), estimates) in ways.into_iter().zip(&mut estimates) {
            let sighting = finder.find(&view.image, camera, known).into_diagnostic()?;
            let x_cw = camera.x_wc(&view.image.x_wt).inverse();
            estimates.extend(sighting.parts.iter().map(|part| Estimate {
                file: file.clone(),
                part: part.part.clone(),
                x_cp: PoseLabel::from(&(x_cw * part.x_wp)),
            }));
        }
        if arguments.depth {
            write_depth(&folder.join(format!("{index:05}-depth.png")), &view.image, &view.depth)?;
        }
        if !arguments.no_images && index < DRAWN {
            let sighting = finder.find(&view.image, &view.told, &[]).into_diagnostic()?;
            let drawn = draw(&view.image, &view.told, &sighting, &finder)?;
            write_png(&folder.join(format!("{index:05}-found.png")), &view.image, &drawn)?;
        }
        labels.views.push(view.label);
        bar.inc(1);
    }
    bar.finish_and_clear();
    write_json(&folder.join(LABELS), &labels)?;
    if !arguments.no_images {
        write_json(&folder.join(COCO), &coco(&labels.views, &all_areas, &names))?;
    }
    let mut text = String::new();
    // The baseline's conditions first.
    for ((file, estimates), title) in ESTIMATES.iter().zip(&estimates).zip(TITLES).rev() {
        write_json(&folder.join(file), estimates)?;
        let _ = write!(text, "{file}, {title}\n{}\n", table(&judge(&labels, estimates)));
    }
    print(&text)?;
    Ok(DONE)
}

/// The content of a JSON file, and its hash.
fn read<T: serde::de::DeserializeOwned>(path: &Path) -> Result<(T, String), Report> {
    let bytes = read_bytes(path, LARGEST)?;
    let text = decode(&bytes).map_err(|error| miette!("{}: {error}", path.display()))?;
    let value = serde_json::from_str(&text)
        .map_err(|error| miette!("{}: {}", path.display(), plain(&error.to_string(), MAX_SENTENCE)))?;
    Ok((value, sha256(&bytes)))
}

/// Checks that all names are valid.
fn check_names<'a>(path: &Path, mut names: impl Iterator<Item = &'a String>) -> Result<(), Report> {
    match names.find(|name| !is_name(name)) {
        None => Ok(()),
        Some(name) => {
            let expected = format!("images, cameras and parts have names: {A_NAME}");
            Err(miette!(help = expected, "{}: `{}` is no name", path.display(), shorten(name)))
        }
    }
}

fn write_json<T: serde::Serialize>(path: &Path, value: &T) -> Result<(), Report> {
    let text = serde_json::to_string(value).into_diagnostic()?;
    write_file(path, text)
}

fn write_depth(path: &Path, image: &Image, depth: &[f32]) -> Result<(), Report> {
    let tenths = |depth: &f32| {
        let tenths = (depth * 1e4).round();
        if tenths <= f32::from(u16::MAX) { tenths as u16 } else { 0 }
    };
    let bytes: Vec<u8> = depth.iter().flat_map(|depth| tenths(depth).to_be_bytes()).collect();
    write_pixels(path, image, &bytes, png::ColorType::Grayscale, png::BitDepth::Sixteen)
}

/// The statistics of an error, or a dash if nothing was detected.
fn error(value: f64) -> String {
    if value.is_finite() { format!("{value:>6.3}") } else { format!("{:>6}", "–") }
}

/// The table of a verdict.
fn table(verdict: &Verdict) -> String {
    let mut text = String::from(
        "camera     distance m   angle °  parts  found   position mm      turn °\n                                               median   95 %   median   95 %\n",
    );
    for line in verdict.lines.iter().chain(&verdict.distances) {
        let _ = writeln!(
            text,
            "{:<9}  {:.2} – {:.2}  {:>2.0} – {:<2.0}  {:>5}  {:>4.0} %  {} {}   {} {}",
            line.camera,
            line.distance[0],
            line.distance[1],
            line.angle[0],
            line.angle[1],
            line.parts,
            100.0 * line.found as f64 / line.parts.max(1) as f64,
            error(line.position[0] * 1e3),
            error(line.position[1] * 1e3),
            error(line.turn[0].to_degrees()),
            error(line.turn[1].to_degrees()),
        );
    }
    let _ = writeln!(
        text,
        "false poses (more than {:.0} mm off, or of a part that shows no tag): {} of {}",
        FALSE * 1e3,
        verdict.false_poses.len(),
        verdict.poses
    );
    for (file, part, error) in verdict.false_poses.iter().take(20) {
        let _ = match error {
            Some(error) => writeln!(text, "  {file}: {part}, {:.1} mm", error * 1e3),
            None => writeln!(text, "  {file}: {part} shows no tag"),
        };
    }
    text
}

/// Compares estimated and true poses of every detected part.
fn compare(text: &mut String, camera: Camera, twin: &Twin, image: &Image, sighting: &Sighting) {
    let truth = twin.truth();
    let places: Vec<(&str, Pose)> = twin.part_names().zip(truth.x_wp).collect();
    // Pose error that the camera calibration adds to every part.
    let told = twin.camera(camera).x_wc(&image.x_wt);
    let real = twin.true_camera(camera).x_wc(&image.x_wt);
    let calibration = told * real.inverse();
    let _ = writeln!(
        text,
        "{}: {} tags, {} parts; error in the world, and what is left of it beyond the camera's calibration",
        camera.name(),
        sighting.detections.len(),
        sighting.parts.len()
    );
    let _ = writeln!(
        text,
        "part  tags      distance   pixels      x mm    y mm    z mm   turn °   beyond: mm    °"
    );
    for part in &sighting.parts {
        let Some((_, x_wp)) = places.iter().find(|(name, _)| *name == part.part) else { continue };
        let off = (part.x_wp.translation.vector - x_wp.translation.vector) * 1e3;
        let turn = part.x_wp.rotation.angle_to(&x_wp.rotation).to_degrees();
        let seen = calibration * x_wp;
        let beyond = (part.x_wp.translation.vector - seen.translation.vector).norm() * 1e3;
        let beyond_turn = part.x_wp.rotation.angle_to(&seen.rotation).to_degrees();
        let tags: Vec<String> = part.tags.iter().map(u32::to_string).collect();
        let _ = writeln!(
            text,
            "{:<5} {:<8} {:>7.3} m {:>8.1}   {:>7.2} {:>7.2} {:>7.2} {:>8.2} {:>10.3} {:>6.3}",
            part.part,
            tags.join(", "),
            part.distance,
            part.tag_size,
            off.x,
            off.y,
            off.z,
            turn,
            beyond,
            beyond_turn
        );
    }
    for oddity in &sighting.oddities {
        let _ = writeln!(text, "odd: {oddity}");
    }
    text.push('\n');
}

/// The image with framed tags, and with the names and axes of the detected parts.
fn draw(
    image: &Image,
    told: &CameraModel,
    sighting: &Sighting,
    finder: &PartFinder,
) -> Result<Vec<u8>, Report> {
    let (width, height) = (image.width, image.height);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">"
    );
    for detection in &sighting.detections {
        let points: Vec<String> = detection.corners.iter().map(|[x, y]| format!("{x:.2},{y:.2}")).collect();
        let _ = write!(
            svg,
            "<polygon points=\"{}\" fill=\"none\" stroke=\"#00c853\" stroke-width=\"2\"/>",
            points.join(" ")
        );
    }
    let x_cw = told.x_wc(&image.x_wt).inverse();
    for part in sighting.parts.iter().chain(&sighting.sheet) {
        let Some(place) = part.tags.first().and_then(|id| finder.places().get(id)) else { continue };
        let x_cg = x_cw * part.x_wp * place.x_pg;
        let project = |x: f64, y: f64, z: f64| told.project(&(x_cg * nalgebra::Point3::new(x, y, z)));
        let Some(origin) = project(0.0, 0.0, 0.0) else { continue };
        let length = place.edge;
        for (end, colour) in [
            (project(length, 0.0, 0.0), "#e53935"),
            (project(0.0, length, 0.0), "#43a047"),
            (project(0.0, 0.0, length), "#1e88e5"),
        ] {
            let Some(end) = end else { continue };
            let _ = write!(
                svg,
                "<line x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\" stroke=\"{colour}\" stroke-width=\"2\"/>",
                origin[0], origin[1], end[0], end[1]
            );
        }
        let size = (part.tag_size / 3.0).clamp(9.0, 18.0);
        let at = [origin[0] + 0.62 * part.tag_size, origin[1] - 0.2 * part.tag_size];
        strokes::text(&mut svg, at, Align::Left, size, "#d500f9", &part.part);
    }
    svg.push_str("</svg>");
    let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).into_diagnostic()?;
    let mut pixmap = tiny_skia::Pixmap::new(width as u32, height as u32)
        .ok_or_else(|| miette!("an image of {width} × {height} pixels"))?;
    for (out, pixel) in pixmap.data_mut().chunks_exact_mut(4).zip(image.pixels.chunks_exact(3)) {
        out.copy_from_slice(&[pixel[0], pixel[1], pixel[2], 255]);
    }
    resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixmap.as_mut());
    Ok(pixmap.data().chunks_exact(4).flat_map(|pixel| [pixel[0], pixel[1], pixel[2]]).collect())
}
