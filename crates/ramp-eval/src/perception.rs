//! Images with labels for perception research, and a judge of any detector on them.
//!
//! A view is an image of the start layout or of the built goal from a place drawn from the seed, through a camera with
//! its own error of calibration. Labels say where each part is in the camera's optical frame C, so that errors are
//! those of perception alone.

mod result;

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::tags::TagPlace;
use ramp_kit::{Kit, tags};
use ramp_render::{Looks, LooksError, Renderer, Scene, Sensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, Image, Pose};
use ramp_twin::{Disturbance, Layout, cameras};
use serde::{Deserialize, Serialize};

pub use result::{Cell, FalsePose, PerceptionVerdict, SCHEMA as VERDICT_SCHEMA};

/// Name and version of the form of the labels.
pub const SCHEMA: &str = "ramp-views/1";
/// One view in so many is from the bird's-eye camera.
const BIRDS_EYE_EVERY: u32 = 10;
/// Distances of the wrist camera from the part it looks at, m, and largest angle from straight above, rad.
const DISTANCES: [f64; 2] = [0.12, 0.60];
const LARGEST_ANGLE: f64 = 0.8;
/// A pose that is further off than this is false, m.
pub const FALSE: f64 = 5.0e-3;

/// A pose in files: position in m, quaternion w x y z.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PoseLabel {
    /// m.
    pub position: [f64; 3],
    /// Unit quaternion.
    pub quat_wxyz: [f64; 4],
}

impl From<&Pose> for PoseLabel {
    fn from(x: &Pose) -> PoseLabel {
        let q = x.rotation.quaternion();
        PoseLabel { position: x.translation.vector.into(), quat_wxyz: [q.w, q.i, q.j, q.k] }
    }
}

impl From<&PoseLabel> for Pose {
    fn from(label: &PoseLabel) -> Pose {
        let [w, i, j, k] = label.quat_wxyz;
        let rotation = UnitQuaternion::from_quaternion(nalgebra::Quaternion::new(w, i, j, k));
        Pose::from_parts(Translation3::from(Vector3::from(label.position)), rotation)
    }
}

/// A tag in a view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TagLabel {
    /// Its id.
    pub id: u32,
    /// Corners of its black square, pixels: upper left, upper right, lower right, lower left as printed.
    pub corners: [[f64; 2]; 4],
    /// Middle of the tag on its part, m.
    pub p_p: [f64; 3],
    /// Distance from the camera, m.
    pub distance: f64,
    /// Angle between its face's normal and the line of sight, degrees.
    pub angle: f64,
    /// Is all of it in view, its ring of white too? A part counts as one to be found when one of its tags is.
    pub whole: bool,
}

/// A part of which at least one tag is in view.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PartLabel {
    /// Its name in the kit.
    pub part: String,
    /// Its pose in the optical frame C.
    pub x_cp: PoseLabel,
    /// Its tags that face the camera and whose middle is in the image.
    pub tags: Vec<TagLabel>,
}

/// One image's labels.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViewLabel {
    /// The image's file.
    pub file: String,
    /// `wrist` or `birds-eye`.
    pub camera: String,
    /// Pixels in a row, and rows.
    pub size: [usize; 2],
    /// Focal lengths, pixels.
    pub focal: [f64; 2],
    /// Where the optical axis meets the image, pixels.
    pub centre: [f64; 2],
    /// k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
    /// The parts.
    pub parts: Vec<PartLabel>,
}

/// All labels of a folder of images.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Labels {
    /// [`SCHEMA`].
    pub schema: String,
    /// The views.
    pub views: Vec<ViewLabel>,
}

/// What a detector says of a part in an image.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// The image's file, as in the labels.
    pub file: String,
    /// The part.
    pub part: String,
    /// Its pose in the optical frame C.
    pub x_cp: PoseLabel,
}

/// A view: the image as an agent would get it, its labels, and which body each pixel shows.
pub struct View {
    /// The image; its tip pose is such that the camera stands where the agent is told.
    pub image: Image,
    /// The camera as an agent is told it is.
    pub told: CameraModel,
    /// The camera as it really is.
    pub real: CameraModel,
    /// The labels.
    pub label: ViewLabel,
    /// Index into the bodies of the looks for each pixel.
    pub bodies: Vec<u16>,
    /// Distance along the optical axis in each pixel, m; infinite where nothing is.
    pub depth: Vec<f32>,
    /// How each part lies, on the sheet or in the goal: its name, the height of its origin in the world (m), and whether
    /// its z axis points down.
    pub lying: Vec<(String, f64, bool)>,
}

/// Makes views.
pub struct Photographer<'a> {
    kit: &'a Kit,
    assembly: &'a Assembly,
    arm: &'a ArmModel,
    looks: Arc<Looks>,
    places: Vec<TagPlace>,
    renderers: [Renderer; 2],
}

impl<'a> Photographer<'a> {
    /// For a goal.
    ///
    /// # Errors
    /// A kit that cannot be drawn.
    pub fn new(
        kit: &'a Kit,
        assembly: &'a Assembly,
        arm: &'a ArmModel,
    ) -> Result<Photographer<'a>, LooksError> {
        let looks = Looks::shared(kit, arm)?;
        let renderers = Camera::ALL
            .map(|camera| Renderer::new(Arc::clone(&looks), &CameraModel::nominal(camera, arm.hand.tip)));
        Ok(Photographer { kit, assembly, arm, looks, places: tags::places(kit), renderers })
    }

    /// What everything looks like.
    pub fn looks(&self) -> &Looks {
        &self.looks
    }

    /// Where everything is in a view: as laid out for the seed, and, when the goal is built, its beams and pegs at
    /// their places.
    fn parts(&self, seed: u64, at_start: bool) -> Vec<(String, Pose)> {
        let layout = Layout::new(self.kit, self.assembly, Disturbance::default(), seed);
        let mut parts: BTreeMap<String, Pose> =
            layout.beams.into_iter().chain(layout.pegs).chain(layout.holders).collect();
        if !at_start {
            let x_wa = self.kit.x_wa();
            for placed in &self.assembly.beams {
                parts.insert(placed.beam.name.clone(), x_wa * placed.x_ab);
            }
            for (connection, peg) in self.assembly.connections.iter().zip(&self.kit.pegs) {
                let hole = x_wa * self.assembly.p_a_hole(connection.female);
                parts.insert(peg.name.clone(), Pose::translation(hole.x, hole.y, FEMALE_HEIGHT));
            }
        }
        parts.into_iter().collect()
    }

    /// View number `index` of a seed, in the file of that name.
    pub fn view(&mut self, seed: u64, index: u32, file: &str) -> View {
        let own_seed = seed.wrapping_mul(1_000_003).wrapping_add(u64::from(index));
        let mut stream = Stream::new(own_seed, "view");
        let at_start = stream.uniform() < 0.5;
        let parts = self.parts(own_seed, at_start);
        let bird = index % BIRDS_EYE_EVERY == BIRDS_EYE_EVERY - 1;
        let camera = if bird { Camera::BirdsEye } else { Camera::Wrist };
        let told = CameraModel::nominal(camera, self.arm.hand.tip);
        let real = cameras::true_camera(camera, self.arm, own_seed);
        // The wrist camera's place: somewhere on a dome over a tag, turned and not quite centred.
        let place = &self.places[(stream.uniform() * self.places.len() as f64) as usize];
        let target = parts
            .iter()
            .find(|(name, _)| *name == place.part)
            .map_or(Point3::origin(), |(_, x_wp)| x_wp * Point3::from(place.x_pg.translation.vector));
        let distance = DISTANCES[0] + (DISTANCES[1] - DISTANCES[0]) * stream.uniform();
        let (round, lean) = (stream.uniform() * std::f64::consts::TAU, LARGEST_ANGLE * stream.uniform());
        let turn = stream.uniform() * std::f64::consts::TAU;
        let aside = [stream.symmetric(0.35), stream.symmetric(0.25)];
        let x_wt = match real.mount {
            Mount::World(_) => self.home_tip(),
            Mount::Tip(x_tc) => {
                let axis = nalgebra::Unit::new_normalize(Vector3::new(round.cos(), round.sin(), 0.0));
                let rotation = UnitQuaternion::from_axis_angle(&axis, lean)
                    * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)
                    * UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn);
                let p_c = Vector3::new(aside[0], aside[1], 1.0).normalize() * distance;
                let eye = target.coords - rotation * p_c;
                Pose::from_parts(Translation3::from(eye), rotation) * x_tc.inverse()
            }
        };
        let x_wc = real.x_wc(&x_wt);
        let mut scene = Scene::default();
        for (name, x) in &parts {
            if let Some(index) = self.looks.body(name) {
                scene.bodies.push((index, *x));
            }
        }
        // The hand, half open.
        let x_wh = x_wt * Pose::translation(0.0, 0.0, -self.arm.hand.tip);
        let out = self.arm.finger.origin;
        let half_turn = Pose::rotation(Vector3::z() * std::f64::consts::PI);
        let finger = Pose::translation(0.0, 0.02, 0.0);
        for (name, x_hb) in [
            ("hand", Pose::identity()),
            ("finger1", Pose::translation(0.0, 0.0, out) * finger),
            ("finger2", Pose::translation(0.0, 0.0, out) * half_turn * finger),
        ] {
            if let Some(index) = self.looks.body(name) {
                scene.bodies.push((index, x_wh * x_hb));
            }
        }
        let lying = parts
            .iter()
            .map(|(name, x)| (name.clone(), x.translation.z, (x.rotation * Vector3::z()).z < 0.0))
            .collect();
        let mut sensor = Sensor::new(own_seed, camera.name());
        let renderer = &mut self.renderers[usize::from(bird)];
        let pixels = renderer.render(&scene, &x_wc, &mut sensor);
        let (bodies, depth) = (renderer.segmentation(), renderer.depth());
        let image = Image { camera, time: 0.0, x_wt, width: told.width, height: told.height, pixels };
        let label = self.label(file, camera, &real, &x_wc, &parts, &bodies);
        View { image, told, real, label, bodies, depth, lying }
    }

    fn home_tip(&self) -> Pose {
        // The hand is out of the bird's-eye camera's way.
        Pose::from_parts(
            Translation3::new(0.1, 0.0, 0.9),
            UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI),
        )
    }

    fn label(
        &self,
        file: &str,
        camera: Camera,
        model: &CameraModel,
        x_wc: &Pose,
        parts: &[(String, Pose)],
        bodies: &[u16],
    ) -> ViewLabel {
        let mut labels = Vec::new();
        for (name, x_wp) in parts {
            let x_cp = x_wc.inverse() * x_wp;
            let body = self.looks.body(name).unwrap_or(usize::MAX);
            let seen = |place: &TagPlace| {
                let x_cg = x_cp * place.x_pg;
                let half = place.edge / 2.0;
                let pixel = |[x, y]: [f64; 2]| {
                    let pixel = model.project(&(x_cg * Point3::new(half * x, half * y, 0.0)))?;
                    let inside =
                        |axis: usize, end: usize| pixel[axis] >= 3.0 && pixel[axis] < end as f64 - 3.0;
                    let inside = inside(0, model.width) && inside(1, model.height);
                    let shows = || {
                        let shown = bodies[pixel[1] as usize * model.width + pixel[0] as usize];
                        usize::from(shown) == body
                    };
                    Some((pixel, inside, inside && shows()))
                };
                let middle = x_cg.translation.vector;
                let cosine = -(x_cg.rotation * Vector3::z()).dot(&middle.normalize());
                let (_, inside, _) = pixel([0.0, 0.0])?;
                if !inside || cosine <= 0.0 {
                    return None;
                }
                // Its ring of white counts: without it a tag cannot be read.
                let ring = RING.map(|at| pixel(at.map(|value| value * 9.0 / 7.0)));
                let corners = [[-1.0, 1.0], [1.0, 1.0], [1.0, -1.0], [-1.0, -1.0]];
                let corner = |index: usize| pixel(corners[index]).map(|(pixel, ..)| pixel);
                Some(TagLabel {
                    id: place.id,
                    corners: [corner(0)?, corner(1)?, corner(2)?, corner(3)?],
                    p_p: place.x_pg.translation.vector.into(),
                    distance: middle.norm(),
                    angle: cosine.clamp(-1.0, 1.0).acos().to_degrees(),
                    whole: ring.iter().all(|at| at.is_some_and(|(_, _, shows)| shows)),
                })
            };
            let tags: Vec<TagLabel> =
                self.places.iter().filter(|place| place.part == *name).filter_map(seen).collect();
            if !tags.is_empty() {
                labels.push(PartLabel { part: name.clone(), x_cp: PoseLabel::from(&x_cp), tags });
            }
        }
        ViewLabel {
            file: file.to_string(),
            camera: camera.name().to_string(),
            size: [model.width, model.height],
            focal: model.focal,
            centre: model.centre,
            distortion: model.distortion,
            parts: labels,
        }
    }
}

/// A line of the judge's table.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// `wrist` or `birds-eye`.
    pub camera: String,
    /// Distances of tags, m.
    pub distance: [f64; 2],
    /// Angles of tags, degrees.
    pub angle: [f64; 2],
    /// Parts with a tag wholly in view.
    pub parts: usize,
    /// How many of them were found.
    pub found: usize,
    /// Position error at the middle of the part's nearest tag, median and 95 %, m.
    pub position: [f64; 2],
    /// Turn between found and true, median and 95 %, rad.
    pub turn: [f64; 2],
}

/// The judge's verdict.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// By camera, distance and angle.
    pub lines: Vec<Line>,
    /// By camera and distance, all angles of the table together.
    pub distances: Vec<Line>,
    /// Poses given.
    pub poses: usize,
    /// Poses more than [`FALSE`] off, or of parts that show no tag: file, part and error (m) where there is one.
    pub false_poses: Vec<(String, String, Option<f64>)>,
}

/// Bins of the table.
const WRIST_DISTANCES: [f64; 6] = [0.10, 0.15, 0.25, 0.35, 0.50, 0.80];
const ANGLES: [f64; 5] = [0.0, 15.0, 30.0, 45.0, 75.0];

/// Places around a tag at which it is asked whether it is hidden, in halves of its edge.
const RING: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]];

fn quantile(values: &mut [f64], share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let index = ((values.len() as f64 * share) as usize).min(values.len().saturating_sub(1));
    values.get(index).copied().unwrap_or(f64::NAN)
}

/// Judges what a detector said of the images.
pub fn judge(labels: &Labels, estimates: &[Estimate]) -> Verdict {
    let mut said: BTreeMap<(&str, &str), &Estimate> = BTreeMap::new();
    for estimate in estimates {
        said.insert((&estimate.file, &estimate.part), estimate);
    }
    /// Parts, position errors and turns.
    type Errors = (usize, Vec<f64>, Vec<f64>);
    // By camera, distance and angle; the one behind the last angle has them all.
    let all = ANGLES.len();
    let mut cells: BTreeMap<(String, usize, usize), Errors> = BTreeMap::new();
    let mut false_poses = Vec::new();
    for view in &labels.views {
        for part in &view.parts {
            let nearest = |whole: bool| {
                let tags = part.tags.iter().filter(move |tag| tag.whole == whole);
                tags.min_by(|a, b| a.distance.total_cmp(&b.distance))
            };
            let Some(tag) = nearest(true).or(nearest(false)) else { continue };
            let found = said.remove(&(view.file.as_str(), part.part.as_str())).map(|estimate| {
                let (truth, found) = (Pose::from(&part.x_cp), Pose::from(&estimate.x_cp));
                let p_p = Point3::from(tag.p_p);
                ((found * p_p - truth * p_p).norm(), found.rotation.angle_to(&truth.rotation))
            });
            if let Some((error, _)) = found.filter(|(error, _)| *error > FALSE) {
                false_poses.push((view.file.clone(), part.part.clone(), Some(error)));
            }
            if !tag.whole {
                continue;
            }
            let bin = |edges: &[f64], value: f64| edges.iter().skip(1).filter(|edge| value >= **edge).count();
            let wrist = view.camera == Camera::Wrist.name();
            let distance = if wrist { bin(&WRIST_DISTANCES, tag.distance) } else { 0 };
            let angle = bin(&ANGLES, tag.angle);
            let both = [Some(angle), (angle + 1 < ANGLES.len()).then_some(all)];
            for angle in both.into_iter().flatten() {
                let cell = cells.entry((view.camera.clone(), distance, angle)).or_default();
                cell.0 += 1;
                if let Some((error, turn)) = found {
                    cell.1.push(error);
                    cell.2.push(turn);
                }
            }
        }
    }
    // What is left was said of parts that show no tag at all.
    let ghost = |(file, part): (&str, &str)| (file.to_string(), part.to_string(), None);
    false_poses.extend(said.into_keys().map(ghost));
    let (mut lines, mut distances) = (Vec::new(), Vec::new());
    for ((camera, distance, angle), (parts, mut errors, mut turns)) in cells {
        let edges =
            |edges: &[f64], bin: usize| [edges[bin], edges.get(bin + 1).copied().unwrap_or(f64::INFINITY)];
        let wrist = camera == Camera::Wrist.name();
        let line = Line {
            camera,
            distance: if wrist { edges(&WRIST_DISTANCES, distance) } else { [2.3, 2.6] },
            angle: if angle == all { [ANGLES[0], ANGLES[all - 1]] } else { edges(&ANGLES, angle) },
            parts,
            found: errors.len(),
            position: [quantile(&mut errors, 0.5), quantile(&mut errors, 0.95)],
            turn: [quantile(&mut turns, 0.5), quantile(&mut turns, 0.95)],
        };
        let table = if angle == all { &mut distances } else { &mut lines };
        table.push(line);
    }
    Verdict { lines, distances, poses: estimates.len(), false_poses }
}

/// COCO's form of the same labels: boxes around what is seen of each part, and which pixels that is.
pub fn coco(views: &[ViewLabel], areas: &[Vec<Area>], names: &[String]) -> serde_json::Value {
    let categories: Vec<_> =
        names.iter().enumerate().map(|(id, name)| serde_json::json!({"id": id + 1, "name": name})).collect();
    let images: Vec<_> = views
        .iter()
        .enumerate()
        .map(|(id, view)| {
            serde_json::json!({"id": id + 1, "file_name": view.file, "width": view.size[0], "height": view.size[1]})
        })
        .collect();
    let mut annotations = Vec::new();
    for (image, areas) in areas.iter().enumerate() {
        for area in areas {
            annotations.push(serde_json::json!({
                "id": annotations.len() + 1,
                "image_id": image + 1,
                "category_id": area.name + 1,
                "bbox": area.around,
                "area": area.pixels,
                "iscrowd": 0,
                "segmentation": {"size": views.get(image).map(|view| [view.size[1], view.size[0]]), "counts": area.runs},
            }));
        }
    }
    serde_json::json!({"images": images, "annotations": annotations, "categories": categories})
}

/// Which pixels show a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Area {
    /// Index of its name.
    pub name: usize,
    /// Left, top, width and height, pixels.
    pub around: [usize; 4],
    /// How many pixels.
    pub pixels: usize,
    /// Lengths of runs of pixels that do not and do show it, down the columns, as COCO counts them.
    pub runs: Vec<usize>,
}

/// What each pixel shows, by part; `names` are bodies by index, and what is not a part is `None`.
pub fn areas(view: &View, names: &[Option<usize>]) -> Vec<Area> {
    let [width, height] = view.label.size;
    let mut areas: BTreeMap<usize, (Area, usize)> = BTreeMap::new();
    for x in 0..width {
        for y in 0..height {
            let body = usize::from(view.bodies[y * width + x]);
            let Some(name) = names.get(body).copied().flatten() else { continue };
            let at = x * height + y;
            let start = || (Area { name, around: [x, y, x, y], pixels: 0, runs: Vec::new() }, 0);
            let (area, end) = areas.entry(name).or_insert_with(start);
            let [left, top, right, low] = area.around;
            area.around = [left.min(x), top.min(y), right.max(x), low.max(y)];
            area.pixels += 1;
            match area.runs.last_mut() {
                Some(run) if *end == at => *run += 1,
                _ => area.runs.extend([at - *end, 1]),
            }
            *end = at + 1;
        }
    }
    areas
        .into_values()
        .map(|(mut area, end)| {
            if end < width * height {
                area.runs.push(width * height - end);
            }
            let [left, top, right, low] = area.around;
            area.around = [left, top, right + 1 - left, low + 1 - top];
            area
        })
        .collect()
}
