//! One part: from its tags in the image to an accepted pose, or to an unexpected finding.

use super::lying::Lying;
use super::sighting::{Oddity, SHEET, SeenPart};
use super::tags::{corner_points, mean_size, middle_of};
use crate::detect::Detection;
use crate::edges::{self, Place, measure};
use crate::fit::{Both, CORNER_ERROR, Corners, EDGE_ERROR, Edges, Fit, Level, Terms, candidates, fit};
use crate::image::Grey;
use nalgebra::{Matrix3, Matrix3x6, Matrix6, Point3};
use ramp_kit::tags::TagPlace;
use ramp_robot::{CameraModel, Pose};

/// Largest mean residual (root of the mean square) of corners that are believed to be one part, pixels.
const CORNERS_AGREE: f64 = 1.0;
/// Likewise for places on edges.
const EDGES_AGREE: f64 = 0.35;
/// Least difference in cost at which two poses of one tag can be distinguished.
const TOLD_APART: f64 = 30.0;
/// Two poses that differ by less than this are one, rad.
const SAME: f64 = 0.02;
/// Places next to each other on an edge have errors in common: this many count as one.
const COMMON: f64 = 4.0;
/// Residuals on edges, in units of the usual one, are taken to be at least this large: there are errors that
/// all places have in common.
const LEAST_ERROR: f64 = 0.56;
/// Largest standard deviation of an accepted position, m: of a part without a prior, and of one that lies on
/// the sheet, whose height is less certain but bounded.
const VAGUE: [f64; 2] = [1.25e-3, 1.8e-3];
/// Heights in which a part's origin can be, m in the world.
const HEIGHTS: [f64; 2] = [-0.03, 1.2];
/// Largest sum of squares of the prior's residuals, in units of their σ: three numbers, five σ.
const KNOWN_AGREES: f64 = 25.0;
/// Least share of the places on the edges of a tag that must be measurable.
const MEASURED: f64 = 0.5;
/// Tags narrower than this (pixels) are used by their corners alone, because their cells blur into each
/// other, and only on parts that are known to lie.
const CORNERS_ONLY: f64 = 14.0;
/// Narrowest tag that is believed, pixels.
const SMALLEST: f64 = 8.0;

/// An image and where it was taken from.
pub(super) struct View<'a> {
    pub(super) grey: &'a Grey,
    pub(super) camera: &'a CameraModel,
    pub(super) x_wc: Pose,
}

impl View<'_> {
    /// A part from the tags of it that were seen.
    pub(super) fn part(
        &self,
        name: &str,
        seen: &[(&TagPlace, &Detection)],
        lying: Option<&Lying>,
        oddities: &mut Vec<Oddity>,
    ) -> Option<SeenPart> {
        // An id that is there twice says nothing: which of the two is it?
        let count = |id: u32| seen.iter().filter(|(place, _)| place.id == id).count();
        let mut once: Vec<(&TagPlace, &Detection)> = Vec::new();
        for (place, detection) in seen {
            match count(place.id) {
                1 => once.push((place, detection)),
                count => {
                    let twice = Oddity::SameTagTwice { id: place.id, part: name.to_string(), count };
                    if !oddities.contains(&twice) {
                        oddities.push(twice);
                    }
                }
            }
        }
        let tags: Vec<u32> = once.iter().map(|(place, _)| place.id).collect();
        if once.is_empty() {
            return None;
        }
        let width = once.iter().map(|(_, d)| d.width()).fold(f64::INFINITY, f64::min);
        if width < SMALLEST || (width < CORNERS_ONLY && lying.is_none()) {
            oddities.push(Oddity::Small { part: name.to_string(), pixels: width });
            return None;
        }
        // The prior holds at the tags: the part's origin may be far away.
        let middle = middle_of(&once);
        let level = lying.map(|lying| Level {
            r_wc: self.x_wc.rotation.to_rotation_matrix(),
            eye: self.x_wc.translation.z,
            p_p: Point3::from(middle),
            height: [lying.height + if lying.flipped { -middle.z } else { middle.z }, lying.sigma[0]],
            tilt: lying.sigma[1],
            flipped: lying.flipped,
        });
        let corners: Vec<(Point3<f64>, [f64; 2])> = once
            .iter()
            .flat_map(|(place, detection)| corner_points(place).into_iter().zip(detection.corners))
            .collect();
        let terms = Corners { camera: self.camera, points: &corners };
        let mut fits: Vec<Fit> = Vec::new();
        for (place, detection) in &once {
            for start in candidates(self.camera, place, &detection.corners).into_iter().flatten() {
                // First without the prior: a part that does not lie flat must not be forced flat.
                let Some(found) = fit(&terms, &start, 30) else { continue };
                let same = |other: &Fit| other.x_cp.rotation.angle_to(&found.x_cp.rotation) < SAME;
                match fits.iter_mut().find(|other| same(other)) {
                    Some(other) if found.cost < other.cost => *other = found,
                    Some(_) => {}
                    None => fits.push(found),
                }
            }
        }
        fits.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let pixels = root_mean(fits.first()?.cost, fits.first()?.count, CORNER_ERROR);
        if pixels > CORNERS_AGREE {
            oddities.push(disagree(name, tags, pixels));
            return None;
        }
        let (best, scale, pixels) = if width < CORNERS_ONLY {
            self.settle_corners(name, &terms, &fits, level.as_ref(), oddities)?
        } else {
            let (best, places) = self.settle_edges(name, &once, &fits, level.as_ref(), oddities)?;
            let edges = Edges { camera: self.camera, places: &places };
            let pixels = root_mean(edges.cost(&best.x_cp), places.len(), EDGE_ERROR);
            if pixels > EDGES_AGREE {
                oddities.push(disagree(name, tags, pixels));
                return None;
            }
            (best, COMMON * (pixels / EDGE_ERROR).max(LEAST_ERROR).powi(2), pixels)
        };
        self.believed(name, &best, scale, pixels, tags, &once, level.is_some(), oddities)
    }

    /// Measures edges from the poses that corners allow, and decides between them.
    fn settle_edges(
        &self,
        name: &str,
        once: &[(&TagPlace, &Detection)],
        fits: &[Fit],
        level: Option<&Level>,
        oddities: &mut Vec<Oddity>,
    ) -> Option<(Fit, Vec<Place>)> {
        let best = fits.first()?;
        let close = fits.iter().filter(|fit| fit.cost < best.cost + TOLD_APART);
        let mut refined: Vec<(Fit, Vec<Place>)> = Vec::new();
        for start in close {
            match self.refine(once, &start.x_cp, level) {
                Ok(found) => refined.push(found),
                Err(id) if refined.is_empty() && fits.len() == 1 => {
                    oddities.push(Oddity::Hidden { part: name.to_string(), id });
                    return None;
                }
                Err(_) => {}
            }
        }
        // Cost for each independent piece of edge.
        let cost = |fit: &Fit| fit.cost / COMMON;
        refined.sort_by(|(a, _), (b, _)| cost(a).total_cmp(&cost(b)));
        let mut refined = refined.into_iter();
        let (first, places) = refined.next()?;
        for (other, _) in refined {
            let angle = other.x_cp.rotation.angle_to(&first.x_cp.rotation);
            if angle > SAME && cost(&other) < cost(&first) + TOLD_APART {
                oddities.push(Oddity::Ambiguous { part: name.to_string(), degrees: angle.to_degrees() });
                return None;
            }
        }
        lies(level, &first.x_cp, name, oddities)?;
        Some((first, places))
    }

    /// Decides between the poses that corners allow, for tags too small to measure edges on. Returns the
    /// pose, by how much its covariance is larger than usual, and the corners' mean residual in pixels.
    fn settle_corners(
        &self,
        name: &str,
        corners: &Corners<'_>,
        fits: &[Fit],
        level: Option<&Level>,
        oddities: &mut Vec<Oddity>,
    ) -> Option<(Fit, f64, f64)> {
        let mut settled: Vec<Fit> =
            fits.iter().filter_map(|start| fit(&Both(corners, level), &start.x_cp, 20)).collect();
        settled.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        let best = settled.first()?.clone();
        for other in &settled[1..] {
            let angle = other.x_cp.rotation.angle_to(&best.x_cp.rotation);
            if angle > SAME && other.cost < best.cost + TOLD_APART {
                oddities.push(Oddity::Ambiguous { part: name.to_string(), degrees: angle.to_degrees() });
                return None;
            }
        }
        lies(level, &best.x_cp, name, oddities)?;
        let pixels = root_mean(best.cost, best.count, CORNER_ERROR);
        if pixels > CORNERS_AGREE {
            oddities.push(Oddity::NotLying { part: name.to_string() });
            return None;
        }
        let scale = (pixels / CORNER_ERROR).max(1.0).powi(2);
        Some((best, scale, pixels))
    }

    /// Measures the edges and fits to them, twice; the id of a tag whose edges are hidden otherwise.
    fn refine(
        &self,
        once: &[(&TagPlace, &Detection)],
        start: &Pose,
        level: Option<&Level>,
    ) -> Result<(Fit, Vec<Place>), u32> {
        let mut x_cp = *start;
        let mut last = None;
        let first = once.first().map_or(0, |(place, _)| place.id);
        for _ in 0..2 {
            let mut places = Vec::new();
            for (index, (tag, _)) in once.iter().enumerate() {
                let before = places.len();
                measure(self.grey, self.camera, tag, &x_cp, 4 * index, &mut places);
                if ((places.len() - before) as f64) < MEASURED * edges::COUNT as f64 {
                    return Err(tag.id);
                }
            }
            let edges = Edges { camera: self.camera, places: &places };
            let found = fit(&Both(&edges, level), &x_cp, 12).ok_or(first)?;
            x_cp = found.x_cp;
            last = Some((found, places));
        }
        last.ok_or(first)
    }

    #[allow(clippy::too_many_arguments)]
    fn believed(
        &self,
        name: &str,
        fit: &Fit,
        scale: f64,
        pixels: f64,
        tags: Vec<u32>,
        once: &[(&TagPlace, &Detection)],
        known: bool,
        oddities: &mut Vec<Oddity>,
    ) -> Option<SeenPart> {
        let x_wp = self.x_wc * fit.x_cp;
        let height = x_wp.translation.z;
        if name != SHEET && !(HEIGHTS[0]..HEIGHTS[1]).contains(&height) {
            oddities.push(Oddity::Height { part: name.to_string(), height });
            return None;
        }
        // From usual residuals to the ones found, and from the optical frame's axes to the world's.
        let covariance = fit.information.try_inverse()? * scale;
        // Uncertainty of the tags' position, from translation of the origin and rotation about it.
        let middle = middle_of(once);
        let arm = fit.x_cp.rotation * middle;
        let mut motion = Matrix3x6::zeros();
        motion.fixed_view_mut::<3, 3>(0, 0).copy_from(&Matrix3::identity());
        motion.fixed_view_mut::<3, 3>(0, 3).copy_from(&(-arm.cross_matrix()));
        let place: Matrix3<f64> = motion * covariance * motion.transpose();
        let sigma = place.symmetric_eigenvalues().max().max(0.0).sqrt();
        if sigma > VAGUE[usize::from(known)] {
            oddities.push(Oddity::Vague { part: name.to_string(), sigma });
            return None;
        }
        let mut turn = Matrix6::zeros();
        let r_wc = self.x_wc.rotation.to_rotation_matrix();
        turn.fixed_view_mut::<3, 3>(0, 0).copy_from(r_wc.matrix());
        turn.fixed_view_mut::<3, 3>(3, 3).copy_from(r_wc.matrix());
        Some(SeenPart {
            part: name.to_string(),
            x_wp,
            covariance: turn * covariance * turn.transpose(),
            tags,
            pixel_error: pixels,
            distance: (fit.x_cp * Point3::from(middle)).coords.norm(),
            tag_size: mean_size(once),
        })
    }
}

fn root_mean(cost: f64, count: usize, unit: f64) -> f64 {
    (cost / count.max(1) as f64).sqrt() * unit
}

/// Tags that are not where a part has them: one alone must be partly hidden.
fn disagree(name: &str, tags: Vec<u32>, pixels: f64) -> Oddity {
    match tags[..] {
        [id] => Oddity::Hidden { part: name.to_string(), id },
        _ => Oddity::TagsDisagree { part: name.to_string(), tags, pixels },
    }
}

/// Checks that the prior of a part and its measurement agree.
fn lies(level: Option<&Level>, x_cp: &Pose, name: &str, oddities: &mut Vec<Oddity>) -> Option<()> {
    let mut known = 0.0;
    if let Some(level) = level {
        level.each(x_cp, &mut |residual, _| known += residual * residual);
    }
    if known > KNOWN_AGREES {
        oddities.push(Oddity::NotLying { part: name.to_string() });
        return None;
    }
    Some(())
}
