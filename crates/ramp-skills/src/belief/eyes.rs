//! The eyes: whatever a track gives to find the parts by, readings of poses or camera images, as sightings.
//!
//! A track that gives no poses gives images. Both cameras are then read. A detection is only as accurate as
//! the camera's pose. The agent estimates that pose during its work, from the tags of the clamped beam and of
//! the sheet, whose poses are known.

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Point3, Vector3};
use ramp_kit::Kit;
use ramp_kit::tags::TagPlace;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Camera, CameraModel, Image, PartReading, RobotError, Track};
use ramp_vision::{Lying, Oddity, PartFinder, SeenPart};

use super::estimate::{Estimate, covariance};
use super::eye::{Eye, Sighting};
use super::own_finder::{self, OwnFinder};
use super::surroundings::{SceneReader, Surroundings};
use crate::Pose;

use crate::hand::Hand;
use crate::parameters::belief::EyesParameters;

/// Standard deviation of an exact reading, m and rad: the resolution of a double.
const EXACT: f64 = 1.0e-9;

/// The pose estimator.
pub struct Eyes {
    parameters: EyesParameters,
    kit: Kit,
    /// Name and pose of the beam that is clamped.
    base: (String, Pose),
    finder: Option<PartFinder>,
    eyes: [Eye; 2],
    /// Does the track give images instead of poses?
    images: bool,
    /// Do tags stick on the parts?
    tags_on_parts: bool,
    /// Do images have depth?
    depth: bool,
    /// The arm, which may be in an image.
    arm: ArmModel,
    scene: Option<SceneReader>,
    /// The finder that takes the place of the baseline's.
    own: Option<OwnFinder>,
    /// The reason why that one answers no more.
    failed: Option<String>,
    /// Robot time that the last look took, s.
    cost: f64,
    complaints: Vec<String>,
    /// Oddities already reported, and unknown tags that were read once.
    told: BTreeSet<String>,
    /// Parts that were seen not to lie as they were believed to.
    upset: Vec<String>,
    /// By tag: the number of images in which it was found, and of those in which it should have been visible
    /// but was not.
    tags: BTreeMap<u32, (usize, usize)>,
}

impl Eyes {
    /// Eyes for the parts of a kit, of which the beam `base` is clamped at `x_wb` in the world.
    pub fn new(kit: &Kit, arm: &ArmModel, base: &str, x_wb: Pose, parameters: &EyesParameters) -> Eyes {
        Eyes {
            parameters: parameters.clone(),
            kit: kit.clone(),
            base: (base.to_string(), x_wb),
            finder: None,
            eyes: Camera::ALL.map(|camera| Eye::new(camera, parameters)),
            images: false,
            tags_on_parts: true,
            depth: false,
            arm: arm.clone(),
            scene: None,
            own: None,
            failed: None,
            cost: 0.0,
            complaints: Vec::new(),
            told: BTreeSet::new(),
            upset: Vec::new(),
            tags: BTreeMap::new(),
        }
    }

    /// Robot time that the last look took, s.
    pub fn cost(&self) -> f64 {
        self.cost
    }

    /// Tells the track: nothing is asked for that it does not give.
    pub fn on_track(&mut self, track: Track) {
        self.images = track.gives_images();
        self.tags_on_parts = track.has_tags();
        self.depth = track.has_depth();
    }

    /// Takes this finder in place of the baseline's.
    pub fn find_with(&mut self, finder: OwnFinder) {
        self.own = Some(finder);
    }

    /// The reason why a finder that takes the place of the baseline's answers no more, if it does not.
    pub fn failed(&self) -> Option<&str> {
        self.failed.as_deref()
    }

    /// True if tags stick on the parts. Known as [`Eyes::images`] is.
    pub fn tags(&self) -> bool {
        self.tags_on_parts
    }

    /// True if the camera on the hand finds its place from the tag of the sheet, and not only from the
    /// clamped beam.
    pub fn reads_the_sheet(&self) -> bool {
        self.tags_on_parts && self.own.is_none()
    }

    /// True if the track gives images instead of poses. Known if configured, or after the first look.
    pub fn images(&self) -> bool {
        self.images
    }

    /// Of each beam whose shape only looks from near can tell, the points to look at, m, in the world.
    pub fn untold(&self) -> Vec<Vec<Point3<f64>>> {
        self.scene.as_ref().map(SceneReader::untold).unwrap_or_default()
    }

    /// True if images have depth. Known as [`Eyes::images`] is.
    pub fn depth(&self) -> bool {
        self.depth
    }

    /// Problems with images since the last call, as text.
    pub fn complaints(&mut self) -> Vec<String> {
        std::mem::take(&mut self.complaints)
    }

    /// The parts that images of the last look show not to lie as they were believed to.
    pub fn upset(&mut self) -> Vec<String> {
        std::mem::take(&mut self.upset)
    }

    /// Reports each problem with a tag once. A tag that is only hidden or far away is not reported.
    fn tell(&mut self, oddity: Oddity) {
        let told = match oddity {
            Oddity::NotLying { part } => return self.upset.push(part),
            // A single reading may be a misreading; a real tag is read again.
            Oddity::UnknownTag { id } if self.told.insert(format!("once unknown {id}")) => return,
            Oddity::UnknownTag { id } => format!("unknown {id}"),
            Oddity::SameTagTwice { id, .. } if self.told.insert(format!("once twice {id}")) => return,
            Oddity::SameTagTwice { id, .. } => format!("twice {id}"),
            Oddity::TagsDisagree { ref part, .. } => format!("disagree {part}"),
            _ => return,
        };
        if self.told.insert(told) {
            self.complaints.push(oddity.to_string());
        }
    }

    /// The middle of the tag of a part that is nearest to a point of it, both in the part's frame, m.
    pub fn nearest_tag(&self, part: &str, p: &Point3<f64>) -> Option<Point3<f64>> {
        let places = self.finder.as_ref()?.places().values().filter(|place| place.part == part);
        let middles = places.map(|place| Point3::from(place.x_pg.translation.vector));
        middles.min_by(|a, b| (a - p).norm().total_cmp(&(b - p).norm()))
    }

    /// Looks once; an agent whose cameras all show nothing looks again after a pause, and does nothing else
    /// until one shows something or all count as broken. `surroundings` is what is believed.
    ///
    /// # Errors
    /// The robot's; [`RobotError::CameraStopped`] when no camera gives an image in which something could be
    /// seen.
    pub fn look(
        &mut self,
        hand: &mut Hand,
        surroundings: &Surroundings,
    ) -> Result<Vec<Sighting>, RobotError> {
        let begin = hand.time();
        let sightings = match self.read_poses(hand)? {
            Some(sightings) => sightings,
            None => loop {
                if let Some(sightings) = self.look_through_cameras(hand, surroundings)? {
                    break sightings;
                }
                hand.hold(self.parameters.pause)?;
            },
        };
        self.cost = hand.time() - begin;
        Ok(sightings)
    }

    /// The poses that the robot reports; `None` on a track that gives images.
    fn read_poses(&mut self, hand: &mut Hand) -> Result<Option<Vec<Sighting>>, RobotError> {
        if self.images {
            return Ok(None);
        }
        let readings = match hand.read_parts() {
            Err(RobotError::NotOnTrack { track, .. }) => {
                self.on_track(track);
                self.images = true;
                return Ok(None);
            }
            readings => readings?,
        };
        let sighting = |reading: PartReading| {
            let [position, angle] = reading.sigma.map(|sigma| sigma.max(EXACT));
            let covariance = covariance([position; 3], [angle; 3]);
            let estimate = Estimate { x: reading.x_wp, covariance };
            Sighting { part: reading.part, estimate, nominal: None, x_wt: hand.seen.x_wt }
        };
        Ok(Some(readings.into_iter().map(sighting).collect()))
    }

    /// The detections of both cameras; `None` without a usable image.
    fn look_through_cameras(
        &mut self,
        hand: &mut Hand,
        surroundings: &Surroundings,
    ) -> Result<Option<Vec<Sighting>>, RobotError> {
        let mut sightings = None;
        for index in 0..self.eyes.len() {
            if self.eyes[index].broken(&self.parameters) {
                continue;
            }
            let why = match self.fresh(index, hand) {
                Ok(image) => match self.read(index, hand, &image, surroundings) {
                    Ok(found) => {
                        self.eyes[index].bad = 0;
                        self.eyes[index].last = image.pixels;
                        sightings.get_or_insert_with(Vec::new).extend(found);
                        continue;
                    }
                    Err(why) => why,
                },
                Err(error @ RobotError::CameraStopped { .. }) => error.to_string(),
                Err(error) => return Err(error),
            };
            if self.failed.is_some() {
                // No other image will be read, either.
                self.complaints.push(why);
                return Err(RobotError::CameraStopped { camera: self.eyes[index].camera });
            }
            let eye = &mut self.eyes[index];
            eye.bad += 1;
            // Reported at the first and the last of them.
            if eye.bad == 1 {
                self.complaints.push(why);
            } else if eye.broken(&self.parameters) {
                self.complaints.push(format!(
                    "{why}, {} times in a row: this camera is no longer used",
                    self.parameters.broken
                ));
            }
        }
        match self.eyes.iter().find(|eye| !eye.broken(&self.parameters)) {
            Some(_) => Ok(sightings),
            None => Err(RobotError::CameraStopped { camera: Camera::Wrist }),
        }
    }

    /// Looks once with the camera on the hand: how far off its image is from the drawings with each of two
    /// beams where the first is believed to be (grey levels, summed over pixels). `None` where the image does
    /// not tell, and on tracks and with finders that do not draw.
    ///
    /// # Errors
    /// The robot's.
    pub fn compare(
        &mut self,
        hand: &mut Hand,
        surroundings: &Surroundings,
        names: [&str; 2],
    ) -> Result<Option<[f64; 2]>, RobotError> {
        if self.scene.is_none() {
            return Ok(None);
        }
        let Some(index) = self.eyes.iter().position(|eye| eye.camera == Camera::Wrist) else {
            return Ok(None);
        };
        if self.eyes[index].broken(&self.parameters) {
            return Ok(None);
        }
        let image = match self.fresh(index, hand) {
            Err(RobotError::CameraStopped { .. }) => return Ok(None),
            image => image?,
        };
        let Some(reader) = &mut self.scene else { return Ok(None) };
        Ok(reader.compare(&self.eyes[index], &image, surroundings, names).ok().flatten())
    }

    /// A new image. Noise makes any two of them differ: a camera that repeats its last one, of a hand that
    /// may have gone on, is waited for.
    fn fresh(&mut self, index: usize, hand: &mut Hand) -> Result<Image, RobotError> {
        let camera = self.eyes[index].camera;
        let begin = hand.time();
        loop {
            let image = hand.look(camera)?;
            if begin - image.time > self.parameters.stale {
                continue;
            }
            if image.pixels != self.eyes[index].last {
                return Ok(image);
            }
            let told = format!("the {} camera repeats its image", camera.name());
            if self.told.insert(told.clone()) {
                self.complaints.push(told);
            }
            if hand.time() - begin > self.parameters.patience {
                return Err(RobotError::CameraStopped { camera });
            }
            hand.hold(self.parameters.pause)?;
        }
    }

    /// Finds the parts in an image.
    fn read(
        &mut self,
        index: usize,
        hand: &Hand,
        image: &Image,
        surroundings: &Surroundings,
    ) -> Result<Vec<Sighting>, String> {
        if let Some(own) = &self.own {
            let eye = &mut self.eyes[index];
            let nominal = hand.camera(eye.camera);
            let base = (&self.kit, &self.base);
            let answer = own_finder::ask(own, eye, &nominal, image, surroundings, base, &self.parameters);
            self.failed = answer.as_ref().err().cloned();
            let (sightings, absent) = answer?;
            self.upset.extend(absent);
            return Ok(sightings);
        }
        if !self.tags_on_parts {
            let reader = match &mut self.scene {
                Some(reader) => reader,
                None => self.scene.insert(SceneReader::new(&self.kit, &self.arm, &self.base)?),
            };
            let eye = &mut self.eyes[index];
            let nominal = hand.camera(eye.camera);
            let read = reader.read(eye, &nominal, image, surroundings, &self.parameters);
            return read.map(|(sightings, absent)| {
                self.upset.extend(absent);
                sightings
            });
        }
        let lying: Vec<Lying> = surroundings.parts.iter().filter_map(|part| part.lying.clone()).collect();
        let finder = match &mut self.finder {
            Some(finder) => finder,
            None => self.finder.insert(PartFinder::new(&self.kit).map_err(|error| error.to_string())?),
        };
        let eye = &mut self.eyes[index];
        let nominal = hand.camera(eye.camera);
        let model = eye.model.get_or_insert_with(|| nominal.clone());
        let seen = finder.find(image, model, &lying).map_err(|error| error.to_string())?;
        for part in &seen.parts {
            for place in finder.places().values().filter(|place| place.part == part.part) {
                let (found, missed) = self.tags.entry(place.id).or_default();
                if part.tags.contains(&place.id) {
                    *found += 1;
                } else if in_sight(model, &model.x_wc(&image.x_wt), part, place, &self.parameters) {
                    *missed += 1;
                    if *found == 0 && *missed == self.parameters.missed {
                        let part = &part.part;
                        self.complaints.push(format!("tag {} of {part} is not visible", place.id));
                    }
                }
            }
        }
        let x_wc_before = model.x_wc(&image.x_wt);
        // Tags with known poses determine the camera's pose.
        let mut model = model.clone();
        if eye.points() < self.parameters.enough {
            let (name, x_wb) = &self.base;
            let base = seen.parts.iter().filter(|part| part.part == *name).map(|part| (part, *x_wb));
            let known: Vec<(&SeenPart, Pose)> =
                base.chain(seen.sheet.as_ref().map(|sheet| (sheet, Pose::identity()))).collect();
            if !known.is_empty() {
                let places = finder.places();
                // The pixels are those of the image, independent of the believed camera, so they are kept as
                // seen through the nominal one.
                let change = nominal.x_wc(&image.x_wt) * x_wc_before.inverse();
                model = eye.learn(&nominal, &self.parameters, |calibration| {
                    for (part, x_wp) in &known {
                        let part = SeenPart { x_wp: change * part.x_wp, ..(*part).clone() };
                        calibration.add_part(&image.x_wt, &part, x_wp, places);
                    }
                });
            }
        }
        let x_wc = model.x_wc(&image.x_wt);
        let moved = x_wc * x_wc_before.inverse();
        let base = &self.base.0;
        let parts = seen.parts.into_iter().filter(|part| part.part != *base);
        let sightings = parts
            .map(|part| {
                let covariance = part.covariance * self.parameters.common;
                let seen = Estimate { x: moved * part.x_wp, covariance };
                eye.sighting(part.part, seen, &x_wc, image.x_wt)
            })
            .collect();
        for oddity in seen.oddities {
            self.tell(oddity);
        }
        Ok(sightings)
    }
}

/// Should a tag of a part that was seen in an image have been seen, too, with nothing in between?
fn in_sight(
    model: &CameraModel,
    x_wc: &Pose,
    part: &SeenPart,
    place: &TagPlace,
    parameters: &EyesParameters,
) -> bool {
    let border = parameters.border;
    let x_cg = x_wc.inverse() * part.x_wp * place.x_pg;
    let towards = -x_cg.translation.vector.normalize();
    let half = place.edge / 2.0;
    let corners = [[-half, -half], [half, -half], [half, half], [-half, half]]
        .map(|[x, y]| model.project(&(x_cg * Point3::new(x, y, 0.0))));
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return false };
    let inside = |[x, y]: [f64; 2]| {
        let [width, height] = [model.width, model.height].map(|size| size as f64);
        (border..width - border).contains(&x) && (border..height - border).contains(&y)
    };
    let edge = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).hypot(p[1] - q[1]);
    (x_cg.rotation * Vector3::z()).dot(&towards) > parameters.facing
        && [a, b, c, d].into_iter().all(inside)
        && [edge(a, b), edge(b, c), edge(c, d), edge(d, a)].into_iter().all(|edge| edge > parameters.legible)
}
