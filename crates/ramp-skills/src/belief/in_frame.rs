//! Parts without tags that were never seen, and so may stand in the frame already when the work begins.
//!
//! Each place of the frame is tried with the parts that may stand there: the beam that belongs there and
//! those with the same joints, or any peg. Where the image supports several beams, they are compared.

use nalgebra::{Point3, Vector3};
use ramp_kit::Kit;
use ramp_vision::Lying;
use ramp_vision::untagged::{Believed, Scene, Strewn};

use super::estimate::{Estimate, covariance};
use super::strewn::View;
use crate::Pose;

/// How far from its place in the frame a peg may stand there, m, and how far a beam may, which may be short
/// of it; and how much both may be turned, rad. Chosen: as far as the baseline takes a part for standing.
const PEG: f64 = 8.0e-3;
const BEAM: f64 = 15.0e-3;
const TURN: f64 = 0.01;
/// Parts of one kind that are nearer to one another are one, m.
const ONE: f64 = 8.0e-3;

/// A part that was never seen.
pub struct Unseen<'u> {
    /// The belief.
    pub part: &'u Believed,
    /// Its places in the frame, in the world.
    pub places: &'u [Pose],
    /// Its pose in the world by a single look that has yet to be confirmed.
    pub glimpsed: Option<Pose>,
}

/// Finds those of the `unseen` parts that stand in one of their places in the frame. Where another part was
/// seen (`there`), none is looked for.
///
/// # Errors
/// The reason for which the image is of no use, as text.
pub fn find(
    view: &mut View,
    scene: &Scene,
    kit: &Kit,
    unseen: &[Unseen],
    there: &[(&str, Pose)],
) -> Result<Vec<(String, Estimate)>, String> {
    let mut places: Vec<Pose> = Vec::new();
    for place in unseen.iter().flat_map(|it| it.places) {
        if !places.contains(place) {
            places.push(*place);
        }
    }
    let mut found: Vec<(String, Estimate)> = Vec::new();
    for place in &places {
        let is_new = |part: &str| found.iter().all(|(other, _)| other != part);
        let is_meant = |it: &&Unseen| it.places.contains(place) && is_new(&it.part.part);
        let mut meant: Vec<&Unseen> = unseen.iter().filter(is_meant).collect();
        let Some(Unseen { part: first, .. }) = meant.first() else { continue };
        let here = middle(kit, &first.part, place);
        let is_peg = kit.peg(&first.part).is_some();
        let is_here = |part: &str, x: &Pose| {
            kit.peg(part).is_some() == is_peg && (middle(kit, part, x) - here).norm() < ONE
        };
        if there.iter().any(|(part, x)| is_here(part, x)) {
            continue;
        }
        if is_peg {
            // All pegs look the same: one is enough, which is the one that was glimpsed here, or nowhere yet.
            let glimpsed =
                |it: &Unseen| it.glimpsed.filter(|x| it.places.iter().any(|place| far(x, place) < ONE));
            meant.retain(|it| glimpsed(it).is_none_or(|x| far(&x, place) < ONE));
            meant.sort_by_key(|it| glimpsed(it).is_none());
            meant.truncate(1);
        }
        let mut fits: Vec<(String, Estimate)> = Vec::new();
        for it in meant {
            fits.extend(standing(view, scene, it.part, place, if is_peg { PEG } else { BEAM })?);
        }
        found.extend(best(view, scene, fits)?);
    }
    Ok(found)
}

/// The distance between two places, m.
fn far(a: &Pose, b: &Pose) -> f64 {
    (a.translation.vector - b.translation.vector).norm()
}

/// The middle of a part at a pose, m.
fn middle(kit: &Kit, part: &str, x_wp: &Pose) -> Point3<f64> {
    x_wp * Point3::new(kit.beam(part).map_or(0.0, |beam| beam.span() / 2.0), 0.0, 0.0)
}

/// A part at its place in the frame, or up to `off` (m) beside it.
fn standing(
    view: &mut View,
    scene: &Scene,
    part: &Believed,
    place: &Pose,
    off: f64,
) -> Result<Option<(String, Estimate)>, String> {
    let there = Believed {
        x_wp: *place,
        // Three standard deviations are looked through.
        covariance: covariance([off / 3.0; 3], [TURN; 3]),
        lying: Some(lying(&part.part, place)),
        part: part.part.clone(),
        held: false,
    };
    let wanted = |it: &Believed| it.part == there.part;
    let others = scene.parts.iter().filter(|it| !wanted(it)).cloned();
    let parts: Vec<Believed> = others.chain([there.clone()]).collect();
    let seen = view.finder.find(view.image, view.camera, &Scene { parts: &parts, ..*scene }, &wanted, 0.0);
    let seen = seen.map_err(|error| error.to_string())?.found.into_iter().next();
    Ok(seen.map(|part| (part.part, Estimate { x: part.x_wp, covariance: part.covariance })))
}

/// The knowledge of the height and tilt of a part in a place.
fn lying(part: &str, place: &Pose) -> Lying {
    let flipped = (place.rotation * Vector3::z()).z < 0.0;
    Lying { part: part.to_string(), height: place.translation.z, flipped, sigma: Lying::SIGMA }
}

/// Of beams that the image supports in one place, the one that explains it best.
fn best(
    view: &mut View,
    scene: &Scene,
    mut fits: Vec<(String, Estimate)>,
) -> Result<Option<(String, Estimate)>, String> {
    if fits.len() < 2 {
        return Ok(fits.pop());
    }
    let names: Vec<&str> = fits.iter().map(|(part, _)| part.as_str()).collect();
    let Some(off) = compare(view, scene, &names, &fits[0].1.x)? else { return Ok(None) };
    let least = (0..off.len()).min_by(|a, b| off[*a].total_cmp(&off[*b]));
    Ok(least.map(|least| fits.swap_remove(least)))
}

/// How far off an image is from its drawings with one of the beams of these names at a pose, and not the
/// others (grey levels, summed over the pixels in which the drawings differ); `None` where it supports none
/// of them.
///
/// # Errors
/// The reason for which the image is of no use, as text.
pub fn compare(
    view: &mut View,
    scene: &Scene,
    names: &[&str],
    x_wb: &Pose,
) -> Result<Option<Vec<f64>>, String> {
    let is_other = |it: &&Believed| !names.contains(&it.part.as_str());
    let parts: Vec<Believed> = scene.parts.iter().filter(is_other).cloned().collect();
    let shape = |name: &&str| Strewn { part: name.to_string(), flat: *x_wb, lying: Some(lying(name, x_wb)) };
    let shapes: Vec<Strewn> = names.iter().map(shape).collect();
    let shapes: Vec<(&Strewn, Pose)> = shapes.iter().map(|shape| (shape, *x_wb)).collect();
    let compared = view.finder.compare(view.image, view.camera, &Scene { parts: &parts, ..*scene }, &shapes);
    let compared = compared.map_err(|error| error.to_string())?;
    Ok(compared.map(|compared| compared.off.iter().map(|off| off.iter().sum()).collect()))
}
