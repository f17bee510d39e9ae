//! Photographs of the start layout or of the built goal, from places drawn from the seed, with their labels.

use std::collections::BTreeMap;
use std::sync::Arc;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::joint::FEMALE_HEIGHT;
use ramp_kit::tags;
use ramp_kit::tags::TagPlace;
use ramp_render::{Looks, LooksError, Renderer, Scene, Sensor, StereoSensor};
use ramp_robot::arm::ArmModel;
use ramp_robot::camera::Mount;
use ramp_robot::random::Stream;
use ramp_robot::{Camera, CameraModel, Image, Pose};
use ramp_twin::{Layout, Start, cameras};
use ramp_world::World;

use super::labels::{PartLabel, PoseLabel, TagLabel, ViewLabel};

/// One view in so many is from the bird's-eye camera.
const BIRDS_EYE_EVERY: u32 = 10;
/// Distances of the wrist camera from the part it looks at, m, and largest angle from straight above, rad.
const DISTANCES: [f64; 2] = [0.12, 0.60];
const LARGEST_ANGLE: f64 = 0.8;

/// Places around a tag at which it is asked whether it is hidden, in halves of its edge.
const RING: [[f64; 2]; 8] =
    [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0], [0.0, 1.0], [1.0, 0.0], [0.0, -1.0], [-1.0, 0.0]];

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
    /// The pose of the optical frame in the world.
    pub x_wc: Pose,
    /// Each part and holder, with its pose in the world.
    pub parts: Vec<(String, Pose)>,
    /// How each part lies, on the sheet or in the goal: its name, the height of its origin in the world (m),
    /// and whether its z axis points down.
    pub lying: Vec<(String, f64, bool)>,
}

/// Makes views.
pub struct Photographer<'a> {
    assembly: &'a Assembly,
    arm: &'a ArmModel,
    looks: Arc<Looks>,
    places: Vec<TagPlace>,
    renderers: [Renderer; 2],
    /// The world in which parts and cameras are drawn from a view's seed.
    world: World,
    /// Whether tags stick on the parts. Without them, images have depth, and lenses neither distortion nor
    /// errors.
    tags: bool,
}

impl<'a> Photographer<'a> {
    /// For a goal.
    ///
    /// # Errors
    /// A kit that cannot be drawn.
    pub fn new(assembly: &'a Assembly, arm: &'a ArmModel) -> Result<Photographer<'a>, LooksError> {
        let looks = Looks::shared(&assembly.kit, arm)?;
        Ok(Photographer::with(assembly, arm, looks, World::ideal().clone(), true))
    }

    /// For a goal of which no part has a tag, with the parts and the depth of a world. Lenses have no
    /// distortion, and are known.
    ///
    /// # Errors
    /// As [`Photographer::new`].
    pub fn without_tags(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        world: &World,
    ) -> Result<Photographer<'a>, LooksError> {
        let looks = Looks::shared_without_tags(&assembly.kit, arm)?;
        Ok(Photographer::with(assembly, arm, looks, world.clone(), false))
    }

    fn with(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        looks: Arc<Looks>,
        world: World,
        tags: bool,
    ) -> Photographer<'a> {
        let renderers = Camera::ALL
            .map(|camera| Renderer::new(Arc::clone(&looks), &CameraModel::nominal(camera, arm.hand.tip)));
        Photographer { assembly, arm, looks, places: tags::places(&assembly.kit), renderers, world, tags }
    }

    /// Looks of all bodies.
    pub fn looks(&self) -> &Looks {
        &self.looks
    }

    /// Poses of everything in a view: as laid out for the seed, and, when the goal is built, its beams and
    /// pegs at their places.
    fn parts(&self, seed: u64, at_start: bool) -> Vec<(String, Pose)> {
        let layout = Layout::new(self.assembly, Start::sheet(), seed);
        let mut parts: BTreeMap<String, Pose> =
            layout.beams.into_iter().chain(layout.pegs).chain(layout.holders).collect();
        if !at_start {
            let x_wa = self.assembly.kit.x_wa();
            for placed in &self.assembly.beams {
                parts.insert(placed.beam.name.clone(), x_wa * placed.x_ab);
            }
            for (connection, peg) in self.assembly.connections.iter().zip(&self.assembly.kit.pegs) {
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
        let nominal = CameraModel::nominal(camera, self.arm.hand.tip);
        let physics = self.world.draw(own_seed);
        let (told, real) = if self.tags {
            let real = cameras::true_camera(camera, self.arm, own_seed, &physics.cameras);
            (nominal, real)
        } else {
            let straight = CameraModel { distortion: [0.0; 5], ..nominal };
            (straight.clone(), straight)
        };
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
        if !self.tags {
            let kit = &self.assembly.kit;
            let names = kit.beams.iter().map(|it| &it.name).chain(kit.pegs.iter().map(|it| &it.name));
            let names = names.map(String::as_str);
            let looks = cameras::looks_in_world(&self.looks, kit, names, (&physics, own_seed));
            *renderer = Renderer::new(looks, &real);
        }
        let pixels = renderer.render(&scene, &x_wc, &mut sensor);
        let errors = cameras::stereo_errors(&physics.cameras);
        let measured = (!self.tags).then(|| StereoSensor::new(own_seed, camera, errors).measure(renderer));
        let (bodies, depth) = (renderer.segmentation(), renderer.depth());
        let (width, height) = (told.width, told.height);
        let image = Image { camera, time: 0.0, x_wt, width, height, pixels, depth: measured };
        let label = self.label(file, camera, &real, &x_wc, &parts, &bodies);
        View { image, told, real, label, bodies, depth, x_wc, parts, lying }
    }

    /// Pixels that a part would show in the last view of that camera with nothing before it, row by row.
    pub fn silhouette(&mut self, view: &View, part: &str) -> Vec<bool> {
        let body = self.looks.body(part);
        let pose = view.parts.iter().find(|(name, _)| name == part);
        let Some((body, (_, x))) = body.zip(pose) else { return vec![false; view.bodies.len()] };
        let renderer = &mut self.renderers[usize::from(view.image.camera == Camera::BirdsEye)];
        let shown = renderer.bodies(&Scene { bodies: vec![(body, *x)] }, &view.x_wc);
        shown.into_iter().map(|shown| usize::from(shown) == body).collect()
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
