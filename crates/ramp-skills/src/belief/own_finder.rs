//! A finder of one's own in place of the baseline's: it gets an image and what is believed to be in it, and
//! says where parts are.

use std::sync::{Arc, Mutex, PoisonError};

use nalgebra::{Matrix6, Point3};
use ramp_kit::Kit;
use ramp_robot::{CameraModel, Image};
use ramp_vision::untagged::Believed;

use super::estimate::Estimate;
use super::eye::{Eye, Sighting};
use super::surroundings::Surroundings;
use crate::Pose;
use crate::parameters::belief::EyesParameters;

/// The question to a finder.
pub struct Question<'q> {
    /// The image.
    pub image: &'q Image,
    /// Its camera, as it is known by now.
    pub camera: &'q CameraModel,
    /// All parts as they are believed to be at the time of the image.
    pub parts: &'q [Believed],
    /// Poses of the holders in the world, by name.
    pub holders: &'q [(String, Pose)],
    /// Distance between the fingers, m.
    pub width: f64,
}

/// A part that it found.
#[derive(Clone, Debug, PartialEq)]
pub struct OwnFound {
    /// Its name.
    pub part: String,
    /// Its pose in the optical frame.
    pub x_cp: Pose,
    /// Covariance of a shift (m) and turn (rad) about its origin, axes of the optical frame.
    pub covariance: Matrix6<f64>,
}

/// Its answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct OwnAnswer {
    /// The parts that it found.
    pub found: Vec<OwnFound>,
    /// Parts that are not where they are believed to be.
    pub absent: Vec<String>,
}

/// A finder: from a question to its answer, or the reason why there is none.
pub type OwnFinder = Arc<Mutex<dyn FnMut(&Question) -> Result<OwnAnswer, String> + Send>>;

/// Asks a finder about an image of a camera, which learns its place from the clamped beam `base` where that
/// was found. Gives the other parts, and those that are not where they are believed to be.
///
/// # Errors
/// The finder's.
pub(super) fn ask(
    finder: &OwnFinder,
    eye: &mut Eye,
    nominal: &CameraModel,
    image: &Image,
    surroundings: &Surroundings,
    (kit, base): (&Kit, &(String, Pose)),
    parameters: &EyesParameters,
) -> Result<(Vec<Sighting>, Vec<String>), String> {
    let mut model = eye.model.get_or_insert_with(|| nominal.clone()).clone();
    let parts = surroundings.at(&image.x_wt);
    let question = Question {
        image,
        camera: &model,
        parts: &parts,
        holders: &surroundings.holders,
        width: surroundings.width,
    };
    // A panic of an earlier call leaves a finder that can say so itself.
    let answer = (finder.lock().unwrap_or_else(PoisonError::into_inner))(&question)?;
    let (name, x_wb) = base;
    if let Some(seen) = answer.found.iter().find(|part| part.part == *name)
        && eye.points() < parameters.enough
    {
        let points = points(kit, name);
        model = eye.learn(nominal, parameters, |calibration| {
            for p_b in points {
                // The pixel of the nominal camera, whose lens is the same.
                if let Some(pixel) = nominal.project(&(seen.x_cp * p_b)) {
                    calibration.add(&image.x_wt, x_wb * p_b, pixel);
                }
            }
        });
    }
    let x_wc = model.x_wc(&image.x_wt);
    let turn = x_wc.rotation.to_rotation_matrix();
    let mut axes = Matrix6::zeros();
    axes.fixed_view_mut::<3, 3>(0, 0).copy_from(turn.matrix());
    axes.fixed_view_mut::<3, 3>(3, 3).copy_from(turn.matrix());
    let others = answer.found.into_iter().filter(|part| part.part != *name);
    let sighting = |part: OwnFound| {
        let covariance = axes * part.covariance * axes.transpose() * parameters.common;
        eye.sighting(part.part, Estimate { x: x_wc * part.x_cp, covariance }, &x_wc, image.x_wt)
    };
    Ok((others.map(sighting).collect(), answer.absent))
}

/// Points of a beam from which a camera learns its place: at the holes of its joints, on both sides.
fn points(kit: &Kit, beam: &str) -> Vec<Point3<f64>> {
    const ASIDE: f64 = 0.01;
    let Some(beam) = kit.beam(beam) else { return Vec::new() };
    let sides = [-ASIDE, ASIDE];
    (0..beam.joints.len())
        .flat_map(|index| sides.map(|aside| beam.p_b_hole(index) + nalgebra::Vector3::new(0.0, aside, 0.0)))
        .collect()
}
