//! Images without tags: what is believed of all parts goes to the finder, and the camera learns from the
//! clamped beam where it is.

use std::collections::BTreeMap;

use nalgebra::{Matrix6, Point3};
use ramp_kit::Kit;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Camera, CameraModel, Image};
use ramp_vision::Lying;
use ramp_vision::untagged::{Believed, Found, Scene, SceneFinder, Trace};

use super::estimate::Estimate;
use super::eye::{Eye, Sighting};
use super::in_frame::{self, Unseen};
use super::repeats::Repeats;
use super::strewn::{StrewnParts, View};
use crate::Pose;
use crate::parameters::belief::EyesParameters;

/// Standard deviations of the camera's place within which a part is looked for.
const SIGMAS: f64 = 2.5;
/// The belief about a part before an image is read.
#[derive(Clone, Debug)]
pub struct Expected {
    /// Its name.
    pub part: String,
    /// Its pose: in the tip's frame if it is held, and in the world otherwise.
    pub estimate: Estimate,
    /// True if it is between the fingers.
    pub held: bool,
    /// The knowledge of its height and tilt, if there is any.
    pub lying: Option<Lying>,
    /// True if it was never seen and may lie anywhere.
    pub anywhere: bool,
    /// Its places in the frame, in the world, if it was never seen: it may stand there already.
    pub places: Vec<Pose>,
    /// Its pose in the world by a single look that has yet to be confirmed, if it was never seen.
    pub glimpsed: Option<Pose>,
}

/// Everything that may be in an image.
#[derive(Clone, Debug, Default)]
pub struct Surroundings {
    /// The parts.
    pub parts: Vec<Expected>,
    /// Poses of the holders in the world, by name.
    pub holders: Vec<(String, Pose)>,
    /// Distance between the fingers, m.
    pub width: f64,
}

impl Surroundings {
    /// The same parts, with those that may stand in the frame already, and are `meant`, in their places.
    fn framed(&self, parts: &[Believed], meant: impl Fn(&Believed) -> bool) -> Vec<Believed> {
        let mut taken: Vec<Pose> = Vec::new();
        let mut place = |part: &Believed| {
            let expected = self.parts.iter().find(|it| it.part == part.part).filter(|_| meant(part))?;
            let place = expected.places.iter().find(|place| !taken.contains(place)).copied()?;
            taken.push(place);
            Some(place)
        };
        let moved = |part: &Believed| Believed { x_wp: place(part).unwrap_or(part.x_wp), ..part.clone() };
        parts.iter().map(moved).collect()
    }

    /// Factor on the covariance of a look at a part at `x_cp` in a camera, m. Looks at a part in the hand
    /// never count in full: the fingers hide much of it, and it may be turned in them.
    fn factor(&self, repeats: &mut Repeats, part: &str, x_cp: &Pose, parameters: &EyesParameters) -> f64 {
        let held = self.parts.iter().any(|it| it.held && it.part == part);
        if held { parameters.common } else { repeats.factor(part, x_cp, parameters) }
    }

    /// Names of the parts that were seen before, and their poses in the world.
    fn seen(&self) -> impl Iterator<Item = (&str, Pose)> {
        let seen = self.parts.iter().filter(|it| it.places.is_empty() && !it.held);
        seen.map(|it| (it.part.as_str(), it.estimate.x))
    }

    /// The parts in the world, at the tip's pose of an image.
    pub(super) fn at(&self, x_wt: &Pose) -> Vec<Believed> {
        let believed = |it: &Expected| {
            let Estimate { x, covariance } =
                if it.held { it.estimate.seen_from(x_wt) } else { it.estimate.clone() };
            Believed { part: it.part.clone(), x_wp: x, covariance, lying: it.lying.clone(), held: it.held }
        };
        self.parts.iter().map(believed).collect()
    }
}

/// Reads images without tags.
pub struct SceneReader {
    finder: SceneFinder,
    /// Name and pose of the beam that is clamped.
    base: (String, Pose),
    kit: Kit,
    /// Names of the pegs.
    pegs: Vec<String>,
    /// Parts that were never seen, where they may lie anywhere.
    strewn: StrewnParts,
    /// Number of images of the camera over the table before a part was seen.
    missed: BTreeMap<String, usize>,
}

impl SceneReader {
    /// For the parts of a kit, of which the beam `base` is clamped.
    ///
    /// # Errors
    /// The reason, as text.
    pub fn new(kit: &Kit, arm: &ArmModel, base: &(String, Pose)) -> Result<SceneReader, String> {
        let finder = SceneFinder::new(kit, arm).map_err(|error| error.to_string())?;
        let pegs = kit.pegs.iter().map(|peg| peg.name.clone()).collect();
        Ok(SceneReader {
            finder,
            base: base.clone(),
            kit: kit.clone(),
            pegs,
            strewn: StrewnParts::new(kit),
            missed: BTreeMap::new(),
        })
    }

    /// Of each beam whose shape only looks from near can tell, the points to look at, m, in the world.
    pub fn untold(&self) -> Vec<Vec<Point3<f64>>> {
        self.strewn.untold()
    }

    /// The parts in an image, and those that are not where they are believed to be. The camera learns from
    /// it.
    ///
    /// # Errors
    /// The reason for which the image is of no use, as text.
    pub fn read(
        &mut self,
        eye: &mut Eye,
        nominal: &CameraModel,
        image: &Image,
        surroundings: &Surroundings,
        parameters: &EyesParameters,
    ) -> Result<(Vec<Sighting>, Vec<String>), String> {
        let all = surroundings.at(&image.x_wt).into_iter().zip(&surroundings.parts);
        let (unseen, known): (Vec<_>, Vec<_>) = all.partition(|(_, part)| part.anywhere);
        let mut parts: Vec<Believed> = known.into_iter().map(|(part, _)| part).collect();
        if eye.camera == Camera::BirdsEye {
            for part in surroundings.parts.iter().filter(|it| !it.places.is_empty()) {
                *self.missed.entry(part.part.clone()).or_default() += 1;
            }
        }
        let model = self.calibrate(eye, nominal, image, surroundings, &mut parts, parameters)?;
        let x_wc = model.x_wc(&image.x_wt);
        if eye.points() == 0 {
            // Where the camera is is not known well enough to tell neighbours apart.
            return Ok((Vec::new(), Vec::new()));
        }
        let mut holders = surroundings.holders.clone();
        if !unseen.is_empty() {
            let unseen: Vec<Believed> = unseen.into_iter().map(|(part, _)| part).collect();
            let scene = Scene { parts: &parts, holders: &surroundings.holders, width: surroundings.width };
            let mut view = View { finder: &mut self.finder, image, camera: &model };
            let (named, found) = self.strewn.look(&mut view, &scene, &unseen)?;
            parts.extend(named);
            holders = found;
        }
        let scene = Scene { parts: &parts, holders: &holders, width: surroundings.width };
        let base = self.base.0.clone();
        let wanted = |part: &Believed| part.part != base;
        let slack = slack(&eye.covariance, &x_wc);
        let seen =
            self.finder.find(image, &model, &scene, &wanted, slack).map_err(|error| error.to_string())?;
        let mut repeats = std::mem::take(&mut eye.repeats);
        let sighting = |part: Found| {
            let x_cp = x_wc.inverse() * part.x_wp;
            let factor = surroundings.factor(&mut repeats, &part.part, &x_cp, parameters);
            let seen = Estimate { x: part.x_wp, covariance: part.covariance * factor };
            eye.sighting(part.part, seen, &x_wc, image.x_wt)
        };
        let mut sightings: Vec<Sighting> = seen.found.into_iter().map(sighting).collect();
        eye.repeats = repeats;
        let is_unseen = |part: &&Expected| {
            !part.places.is_empty() && self.missed.get(&part.part).is_some_and(|it| *it >= parameters.mislaid)
        };
        let mislaid: Vec<&Expected> = surroundings.parts.iter().filter(is_unseen).collect();
        let is_lost = |part: &&Believed| {
            let unknown = || part.covariance[(0, 0)].max(part.covariance[(1, 1)]).sqrt() > parameters.lost;
            let never_seen =
                surroundings.parts.iter().any(|it| it.part == part.part && !it.places.is_empty());
            let lost = if never_seen { mislaid.iter().any(|it| it.part == part.part) } else { unknown() };
            lost && part.part != base && !part.held && sightings.iter().all(|seen| seen.part != part.part)
        };
        // One of each kind: two cannot be told apart.
        let (pegs, beams): (Vec<_>, Vec<_>) =
            parts.iter().filter(is_lost).partition(|part| self.pegs.contains(&part.part));
        let mut found: Vec<(String, Estimate)> = Vec::new();
        // A beam may be hidden by another one that stands on it, and is hypothetical as well.
        let framed = surroundings.framed(&parts, |part| is_lost(&part) && !self.pegs.contains(&part.part));
        let frame = Scene { parts: &framed, ..scene };
        let mut view = View { finder: &mut self.finder, image, camera: &model };
        let unseen = parts.iter().filter(is_lost).filter_map(|part| {
            let expected = mislaid.iter().find(|it| it.part == part.part)?;
            Some(Unseen { part, places: &expected.places, glimpsed: expected.glimpsed })
        });
        let there: Vec<(&str, Pose)> = surroundings.seen().collect();
        found.extend(in_frame::find(&mut view, &frame, &self.kit, &unseen.collect::<Vec<_>>(), &there)?);
        // One that was never seen stands in a hole, if anywhere.
        let was_seen = |part: &&&Believed| mislaid.iter().all(|it| it.part != part.part);
        if let Some(peg) = pegs.iter().find(was_seen) {
            found.extend(lost_peg(&mut view, &scene, peg, parameters)?);
        }
        if let Some(beam) = beams.first() {
            let was_seen = was_seen(&beam);
            found.extend(self.strewn.find_lost(&mut view, &scene, beam, was_seen, parameters)?);
        }
        let sighting = |(part, seen)| eye.sighting(part, seen, &x_wc, image.x_wt);
        sightings.extend(found.into_iter().map(sighting));
        Ok((sightings, seen.absent))
    }

    /// How far off an image is from its drawings with each of two beams where the first is believed to be
    /// (grey levels, summed over pixels); `None` where it supports neither.
    ///
    /// # Errors
    /// The reason for which the image is of no use, as text.
    pub fn compare(
        &mut self,
        eye: &Eye,
        image: &Image,
        surroundings: &Surroundings,
        names: [&str; 2],
    ) -> Result<Option<[f64; 2]>, String> {
        let parts = surroundings.at(&image.x_wt);
        let part = parts.iter().find(|it| it.part == names[0]);
        let (Some(camera), Some(part)) = (&eye.model, part) else { return Ok(None) };
        let scene = Scene { parts: &parts, holders: &surroundings.holders, width: surroundings.width };
        let mut view = View { finder: &mut self.finder, image, camera };
        let off = in_frame::compare(&mut view, &scene, &names, &part.x_wp)?;
        Ok(off.map(|off| [off[0], off[1]]))
    }

    /// Finds the clamped beam, whose pose is known, and corrects the camera's pose by it until it was seen
    /// often enough. Gives the camera's model.
    fn calibrate(
        &mut self,
        eye: &mut Eye,
        nominal: &CameraModel,
        image: &Image,
        surroundings: &Surroundings,
        parts: &mut [Believed],
        parameters: &EyesParameters,
    ) -> Result<CameraModel, String> {
        let model = eye.model.get_or_insert_with(|| nominal.clone()).clone();
        if eye.points() >= parameters.enough {
            return Ok(model);
        }
        let (base, x_wb) = &self.base;
        let x_wc = model.x_wc(&image.x_wt);
        // It seems tilted or raised as the camera is off.
        if let Some(part) = parts.iter_mut().find(|part| part.part == *base) {
            part.lying = None;
        }
        let wanted = |part: &Believed| part.part == *base;
        let slack = slack(&eye.covariance, &x_wc);
        // Beams and pegs that may stand on it hide it, wherever they are.
        let framed = surroundings.framed(parts, |part| !self.pegs.contains(&part.part));
        let pinned = surroundings.framed(parts, |_| true);
        let mut found = None;
        for parts in [&*parts, &framed, &pinned] {
            let scene = Scene { parts, holders: &surroundings.holders, width: surroundings.width };
            let seen = self.finder.find(image, &model, &scene, &wanted, slack);
            found = seen.map_err(|error| error.to_string())?.found.into_iter().next();
            if found.is_some() {
                break;
            }
        }
        let Some(found) = found else { return Ok(model) };
        let x_cp = x_wc.inverse() * found.x_wp;
        Ok(eye.learn(nominal, parameters, |calibration| {
            for p_p in &found.points {
                if let Some(pixel) = nominal.project(&(x_cp * p_p)) {
                    calibration.add(&image.x_wt, x_wb * p_p, pixel);
                }
            }
        }))
    }
}

/// A lost peg, or where something of its colour is.
fn lost_peg(
    view: &mut View,
    scene: &Scene,
    peg: &Believed,
    parameters: &EyesParameters,
) -> Result<Option<(String, Estimate)>, String> {
    let trace = view.finder.find_lost(view.image, view.camera, scene, peg);
    let estimate = trace.map_err(|error| error.to_string())?.map(|trace| match trace {
        Trace::Pose(found) => Estimate { x: found.x_wp, covariance: found.covariance * parameters.common },
        Trace::Area { x_wp, covariance } => Estimate { x: x_wp, covariance },
    });
    Ok(estimate.map(|it| (peg.part.clone(), it)))
}

/// Largest apparent shift of something on the table because of the error of the camera's place, m.
fn slack(covariance: &Matrix6<f64>, x_wc: &Pose) -> f64 {
    let distance = x_wc.translation.z.max(0.1);
    let largest = |from: usize| (from..from + 3).map(|axis| covariance[(axis, axis)]).fold(0.0, f64::max);
    SIGMAS * (largest(0).sqrt() + largest(3).sqrt() * distance)
}
