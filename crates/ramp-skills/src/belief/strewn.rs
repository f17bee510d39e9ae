//! Parts without tags that were never seen and may lie anywhere: found in images, and named by their places.
//!
//! Pegs come first: heads in a row are a holder, which then is known when beams are looked for. Pegs are all
//! alike, so any name is right. The camera over the table shows where beams are and how long they are; which
//! of the shapes of that length one has, and which end is which, the camera on the hand tells from near. Once
//! that is known of all beams of a length, they are named as the [rules of the start](ramp_kit::lookalike)
//! say. A part that has a name is then found like any other.

use std::collections::BTreeMap;
use std::f64::consts::PI;

use nalgebra::{Point3, Translation3, UnitQuaternion, Vector2, Vector3};
use ramp_kit::{Beam, Holder, Kit, lookalike};
use ramp_robot::{Camera, CameraModel, Image};
use ramp_vision::Lying;
use ramp_vision::untagged::{Believed, Found, Scene, SceneFinder, Strewn, strewn_covariance};

use super::estimate::Estimate;
use crate::Pose;
use crate::grasp::yaw_of;
use crate::parameters::belief::EyesParameters;

/// Middles of two findings that are nearer than this are one part, m.
const SAME: f64 = 15.0e-3;
/// Beams whose spans differ by less may be taken for one another from far, m.
const SPANS: f64 = 30.0e-3;
/// How far a head may be from where the row of a holder has it, m.
const ROW: f64 = 4.0e-3;
/// Least excess of the share of agreeing steps of a beam that leans over that of one that lies flat.
const LEANS: f64 = 0.05;
/// How far beside a beam the camera looks at it from, m.
const BESIDE: f64 = 0.08;
/// A shape is clearly better than another one if images are off from it by less than this share of what they
/// are off from both, where those differ; and by how much they must be off from both (grey levels, summed
/// over pixels).
const CLEARLY: f64 = 0.4;
const LEAST_OFF: f64 = 2.0e4;

/// Whether images that are off from two shapes by these amounts show that the first is clearly better.
pub fn is_clearly_better(off: f64, other: f64) -> bool {
    off + other > LEAST_OFF && off < CLEARLY * (off + other)
}

/// Parts as they are believed to be, and poses of holders in the world, by name.
pub type Named = (Vec<Believed>, Vec<(String, Pose)>);

/// A beam as it may be: its name or that of a lookalike, and a pose in the world.
#[derive(Clone, Debug)]
struct Shape {
    name: String,
    x_wb: Pose,
}

/// A place where a beam lies that has no name yet.
#[derive(Clone, Debug)]
struct Place {
    middle: Point3<f64>,
    span: f64,
    /// The shapes that it may have.
    shapes: Vec<Shape>,
    /// Of each shape and each other one: how far off images from near are from the first where the two
    /// differ.
    off: Vec<Vec<f64>>,
}

impl Place {
    /// The direction of its axis along the table.
    fn direction(&self) -> Vector3<f64> {
        self.shapes.first().map_or(Vector3::x(), |shape| shape.x_wb.rotation * Vector3::x())
    }

    /// Its middle and its ends, m, in the world.
    fn points(&self) -> [Point3<f64>; 3] {
        [0.0, 0.5, -0.5].map(|end| self.middle + self.direction() * (end * self.span))
    }

    /// The shape that explains what was seen clearly better than each other one.
    fn told(&self) -> Option<&Shape> {
        let beats = |a: usize, b: usize| a == b || is_clearly_better(self.off[a][b], self.off[b][a]);
        let all = 0..self.shapes.len();
        let best = all.clone().find(|a| all.clone().all(|b| beats(*a, b)))?;
        self.shapes.get(best)
    }
}

/// The parts that were found, and those that are named.
pub struct StrewnParts {
    kit: Kit,
    /// The heads of pegs that are in no row yet.
    heads: Vec<Point3<f64>>,
    /// The holders that were found by their pegs.
    holders: Vec<(String, Pose)>,
    places: Vec<Place>,
    /// Poses of named parts from which they can be found.
    named: BTreeMap<String, Pose>,
}

/// An image, and what reads it.
pub struct View<'v> {
    /// Finds parts.
    pub finder: &'v mut SceneFinder,
    /// The image.
    pub image: &'v Image,
    /// Its camera.
    pub camera: &'v CameraModel,
}

impl StrewnParts {
    /// Before any image.
    pub fn new(kit: &Kit) -> StrewnParts {
        StrewnParts {
            kit: kit.clone(),
            heads: Vec::new(),
            holders: Vec::new(),
            places: Vec::new(),
            named: BTreeMap::new(),
        }
    }

    /// Of each beam whose shape only looks from near can tell, the points to look at, m, in the world: beside
    /// its middle and beside its ends, so that a side of it shows, and then those on its other side.
    pub fn untold(&self) -> Vec<Vec<Point3<f64>>> {
        let beside = |place: &Place| beside(place.direction(), place.points());
        self.places.iter().filter(|place| place.told().is_none()).map(beside).collect()
    }

    /// Looks for the parts in `unseen`, which the scene does not have. Gives those whose names are known, as
    /// they are believed to be, and all holders that are known by now.
    ///
    /// # Errors
    /// The reason for which the image is of no use, as text.
    pub fn look(&mut self, view: &mut View, scene: &Scene, unseen: &[Believed]) -> Result<Named, String> {
        let unnamed = |named: &BTreeMap<String, Pose>| -> Vec<&Believed> {
            unseen.iter().filter(|part| !named.contains_key(&part.part)).collect()
        };
        if unnamed(&self.named).iter().any(|part| self.kit.peg(&part.part).is_some()) {
            let heads = view.finder.find_heads_anywhere(view.image, view.camera, scene);
            self.take_heads(&heads.map_err(|error| error.to_string())?);
        }
        let seen = |name: &String| scene.holders.iter().any(|(other, _)| other == name);
        let found = self.holders.iter().filter(|(name, _)| !seen(name));
        let holders: Vec<(String, Pose)> = scene.holders.iter().chain(found).cloned().collect();
        let scene = Scene { holders: &holders, ..*scene };
        let beams: Vec<&Believed> = unnamed(&self.named);
        let beams: Vec<&Believed> =
            beams.into_iter().filter(|part| self.kit.beam(&part.part).is_some()).collect();
        if !beams.is_empty() {
            let shapes = self.shapes(&beams);
            if self.places.len() < beams.len() {
                let found = view.finder.find_beams_anywhere(view.image, view.camera, &scene, &shapes);
                self.take_beams(found.map_err(|error| error.to_string())?, &shapes);
            }
            if view.image.camera == Camera::Wrist {
                self.compare(view, &scene, &shapes)?;
            }
            let names: Vec<String> = beams.iter().map(|part| part.part.clone()).collect();
            self.name(&names);
        }
        let believed = |part: &Believed| {
            let x_wp = *self.named.get(&part.part)?;
            Some(Believed { x_wp, covariance: strewn_covariance(part.lying.is_some()), ..part.clone() })
        };
        Ok((unseen.iter().filter_map(believed).collect(), holders))
    }

    /// A beam that was lost, found where it lies flat on the table, of those that look like it the nearest,
    /// with its ends as they were; or where it leans on something. One that never `was_seen` may stand in a
    /// frame that begins an episode, where much looks as if it leaned.
    ///
    /// # Errors
    /// The reason for which the image is of no use, as text.
    pub fn find_lost(
        &self,
        view: &mut View,
        scene: &Scene,
        lost: &Believed,
        was_seen: bool,
        parameters: &EyesParameters,
    ) -> Result<Option<(String, Estimate)>, String> {
        let Some(beam) = self.kit.beam(&lost.part) else { return Ok(None) };
        let Some(flat) = self.kit.x_wb_start(beam) else { return Ok(None) };
        let lying = Lying {
            part: lost.part.clone(),
            height: flat.translation.z,
            flipped: beam.start.is_some_and(|start| start.flipped),
            sigma: Lying::SIGMA,
        };
        let shape = Strewn { part: lost.part.clone(), flat, lying: Some(lying.clone()) };
        let estimate = |part: Found| {
            let covariance = part.covariance * parameters.common;
            (part.part, Estimate { x: part.x_wp, covariance })
        };
        let leaning = if was_seen {
            let leaning = view.finder.find_leaning(view.image, view.camera, scene, &shape, &lost.x_wp);
            leaning.map_err(|error| error.to_string())?
        } else {
            None
        };
        let found = view.finder.find_beams_anywhere(view.image, view.camera, scene, &[shape]);
        let found = found.map_err(|error| error.to_string())?;
        let was = middle_of(beam, &lost.x_wp);
        let off = |x_wb: &Pose| (middle_of(beam, x_wb) - was).norm();
        let nearest = found.into_iter().map(|(_, x_wb)| x_wb).min_by(|a, b| off(a).total_cmp(&off(b)));
        let Some(x_wb) = nearest else { return Ok(leaning.map(estimate)) };
        let back = (x_wb.rotation * Vector3::x()).dot(&(lost.x_wp.rotation * Vector3::x())) < 0.0;
        let yaw = yaw_of(&x_wb) + if back { PI } else { 0.0 };
        let there = Believed {
            x_wp: laid(beam, &flat, &middle_of(beam, &x_wb), yaw),
            covariance: strewn_covariance(true),
            lying: Some(lying),
            ..lost.clone()
        };
        let others = scene.parts.iter().filter(|part| part.part != lost.part).cloned();
        let parts: Vec<Believed> = others.chain([there]).collect();
        let wanted = |part: &Believed| part.part == lost.part;
        let scene = Scene { parts: &parts, ..*scene };
        let seen = view.finder.find(view.image, view.camera, &scene, &wanted, 0.0);
        let seen = seen.map_err(|error| error.to_string())?.found.into_iter().next();
        // A flat beam is seen about as well as one that leans a little.
        let flat = seen.as_ref().map_or(0.0, |flat| flat.share + LEANS);
        Ok(leaning.filter(|leaning| leaning.share > flat).or(seen).map(estimate))
    }

    /// One beam of each look.
    fn shapes(&self, beams: &[&Believed]) -> Vec<Strewn> {
        let mut shapes: Vec<Strewn> = Vec::new();
        for part in beams {
            let flat = self.kit.beam(&part.part).and_then(|beam| self.kit.x_wb_start(beam));
            let alike = lookalike::of(&self.kit, &part.part);
            if let Some(flat) = flat
                && shapes.iter().all(|other| !alike.contains(&other.part.as_str()))
            {
                shapes.push(Strewn { part: part.part.clone(), flat, lying: part.lying.clone() });
            }
        }
        shapes
    }

    /// Beams were found: each that lies at a new place may have any shape of its length, either end first.
    fn take_beams(&mut self, found: Vec<(String, Pose)>, shapes: &[Strewn]) {
        for (name, x_wb) in found {
            let Some(beam) = self.kit.beam(&name) else { continue };
            let (middle, span) = (middle_of(beam, &x_wb), beam.span());
            if self.places.iter().any(|place| (place.middle - middle).xy().norm() < SAME) {
                continue;
            }
            let mut place = Place { middle, span, shapes: Vec::new(), off: Vec::new() };
            for shape in shapes {
                let Some(beam) = self.kit.beam(&shape.part) else { continue };
                if (beam.span() - span).abs() > SPANS {
                    continue;
                }
                let ends = if lookalike::has_like_ends(beam) { &[0.0][..] } else { &[0.0, PI] };
                for end in ends {
                    let x_wb = laid(beam, &shape.flat, &middle, yaw_of(&x_wb) + end);
                    place.shapes.push(Shape { name: shape.part.clone(), x_wb });
                }
            }
            place.off = vec![vec![0.0; place.shapes.len()]; place.shapes.len()];
            self.places.push(place);
        }
    }

    /// Compares the shapes that each beam may have by an image from near.
    fn compare(&mut self, view: &mut View, scene: &Scene, shapes: &[Strewn]) -> Result<(), String> {
        let x_cw = view.camera.x_wc(&view.image.x_wt).inverse();
        let size = [view.camera.width as f64, view.camera.height as f64];
        let shows = |p: &Point3<f64>| {
            let pixel = view.camera.project(&(x_cw * p));
            pixel.is_some_and(|pixel| (0..2).all(|axis| (0.0..size[axis]).contains(&pixel[axis])))
        };
        let some_shows = |place: &Place| place.points().iter().any(shows);
        for place in self.places.iter_mut().filter(|place| place.shapes.len() > 1 && some_shows(place)) {
            let shape = |own: &Shape| {
                let shape = shapes.iter().find(|shape| shape.part == own.name)?;
                Some((shape, own.x_wb))
            };
            let Some(beams) = place.shapes.iter().map(shape).collect::<Option<Vec<_>>>() else { continue };
            let compared = view.finder.compare(view.image, view.camera, scene, &beams);
            let Some(compared) = compared.map_err(|error| error.to_string())? else { continue };
            let sums = place.off.iter_mut().flatten();
            sums.zip(compared.off.iter().flatten()).for_each(|(sum, off)| *sum += off);
            for (own, x_wb) in place.shapes.iter_mut().zip(compared.poses) {
                own.x_wb = x_wb;
            }
        }
        Ok(())
    }

    /// Names the beams of each length of which all were found and told apart.
    fn name(&mut self, unnamed: &[String]) {
        for name in unnamed {
            let Some(span) = self.kit.beam(name).map(Beam::span) else { continue };
            let has_span = |other: f64| (other - span).abs() < SPANS;
            let names: Vec<&str> = unnamed
                .iter()
                .map(String::as_str)
                .filter(|name| self.kit.beam(name).is_some_and(|beam| has_span(beam.span())))
                .filter(|name| !self.named.contains_key(*name))
                .collect();
            let (places, others): (Vec<Place>, Vec<Place>) =
                std::mem::take(&mut self.places).into_iter().partition(|place| has_span(place.span));
            self.places = others;
            if places.len() > names.len() {
                // One of them was none.
                continue;
            }
            let told: Vec<&Shape> = places.iter().filter_map(Place::told).collect();
            if told.len() < names.len() {
                self.places.extend(places);
                continue;
            }
            let beams: Vec<(String, Pose)> =
                told.into_iter().map(|shape| (shape.name.clone(), shape.x_wb)).collect();
            self.named.extend(lookalike::named(&self.kit, &names, &beams));
        }
    }

    /// Heads of pegs were found: those in a row like that of a holder are its pegs.
    fn take_heads(&mut self, found: &[Point3<f64>]) {
        let near = |p: Vector2<f64>, head: &Point3<f64>| (p - head.coords.xy()).norm() < SAME;
        for head in found {
            let known = self.heads.iter().any(|other| near(other.coords.xy(), head));
            let named = self.named.iter().filter(|(part, _)| self.kit.peg(part).is_some());
            let is_named = named.into_iter().any(|(_, x_wp)| near(x_wp.translation.vector.xy(), head));
            if !known && !is_named {
                self.heads.push(*head);
            }
        }
        let kit = &self.kit;
        for holder in &kit.holders {
            if self.holders.iter().any(|(name, _)| *name == holder.name) {
                continue;
            }
            let mut slots: Vec<(f64, &str)> = kit
                .pegs
                .iter()
                .filter(|peg| peg.holder == holder.name)
                .map(|peg| (f64::from(peg.slot) * Holder::PITCH, peg.name.as_str()))
                .collect();
            slots.sort_by(|(a, _), (b, _)| a.total_cmp(b));
            let along: Vec<f64> = slots.iter().map(|(along, _)| *along).collect();
            let Some((x_wh, used)) = row(&self.heads, &along) else { continue };
            for (along, peg) in &slots {
                let x_hp = Pose::translation(*along, 0.0, Holder::HEIGHT);
                self.named.insert(peg.to_string(), x_wh * x_hp);
            }
            self.holders.push((holder.name.clone(), x_wh));
            let mut index = 0..;
            self.heads.retain(|_| !index.next().is_some_and(|index| used.contains(&index)));
        }
    }
}

/// The points from which the camera on the hand sees a beam from its sides, given the direction of its axis,
/// its middle and its ends, m, in the world: first those on the side of the arm.
pub fn beside(direction: Vector3<f64>, points: [Point3<f64>; 3]) -> Vec<Point3<f64>> {
    let across = Vector3::new(-direction.y, direction.x, 0.0) * BESIDE;
    let [middle, ..] = points;
    let near = (middle + across).xy().coords.norm() < (middle - across).xy().coords.norm();
    let across = if near { across } else { -across };
    points.map(|p| p + across).into_iter().chain(points.map(|p| p - across)).collect()
}

/// The middle of a beam, m, in the world.
fn middle_of(beam: &Beam, x_wb: &Pose) -> Point3<f64> {
    x_wb * Point3::new(beam.span() / 2.0, 0.0, 0.0)
}

/// The pose of a beam that lies as `flat`, with its middle at a place and turned by `yaw`.
fn laid(beam: &Beam, flat: &Pose, middle: &Point3<f64>, yaw: f64) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), yaw - yaw_of(flat));
    let rotation = turn * flat.rotation;
    let origin = middle.coords - rotation * Vector3::new(beam.span() / 2.0, 0.0, 0.0);
    Pose::from_parts(Translation3::new(origin.x, origin.y, flat.translation.z), rotation)
}

/// The pose of a holder whose pegs stand at these distances along it, by heads that stand in such a row, and
/// the indices of those; the best of several.
fn row(heads: &[Point3<f64>], along: &[f64]) -> Option<(Pose, Vec<usize>)> {
    let (from, to) = (*along.first()?, *along.last()?);
    let mut best: Option<(f64, Pose, Vec<usize>)> = None;
    for (first, p) in heads.iter().enumerate() {
        for (last, q) in heads.iter().enumerate() {
            let apart = (q - p).xy();
            // One peg tells no direction.
            if (last == first) != (from == to) || (apart.norm() - (to - from)).abs() > ROW {
                continue;
            }
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), apart.y.atan2(apart.x));
            let centre = (p.coords + q.coords) / 2.0 - turn * Vector3::new((from + to) / 2.0, 0.0, 0.0);
            let x_wh = Pose::from_parts(Translation3::new(centre.x, centre.y, 0.0), turn);
            let nearest = |along: &f64| {
                let slot = (x_wh * Point3::new(*along, 0.0, 0.0)).xy();
                let off = |index: &usize| (heads[*index].xy() - slot).norm();
                let nearest = (0..heads.len()).min_by(|a, b| off(a).total_cmp(&off(b)))?;
                (off(&nearest) < ROW).then(|| (nearest, off(&nearest)))
            };
            let Some(row) = along.iter().map(nearest).collect::<Option<Vec<_>>>() else { continue };
            let worst = row.iter().map(|(_, off)| *off).fold(0.0, f64::max);
            if best.as_ref().is_none_or(|(other, ..)| worst < *other) {
                best = Some((worst, x_wh, row.into_iter().map(|(index, _)| index).collect()));
            }
        }
    }
    best.map(|(_, x_wh, used)| (x_wh, used))
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Two holders in line, one behind the other: each row is that of one holder, and not of two.
    #[test]
    fn three_heads_in_a_row_are_a_holder() {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), 0.7);
        let x_wh = Pose::from_parts(Translation3::new(0.4, 0.2, 0.0), turn);
        let pitch = Holder::PITCH;
        let head = |along: f64| x_wh * Point3::new(along, 0.0, 0.1);
        let heads: Vec<Point3<f64>> =
            [-1.0, 0.0, 1.0, 2.4, 3.4, 4.4].iter().map(|slot| head(slot * pitch)).collect();
        let slots = [-pitch, 0.0, pitch];
        let (found, mut used) = row(&heads, &slots).unwrap();
        used.sort_unstable();
        assert!(used == [0, 1, 2] || used == [3, 4, 5], "{used:?}");
        let centre = if used[0] == 0 { head(0.0) } else { head(3.4 * pitch) };
        assert!((found.translation.vector.xy() - centre.coords.xy()).norm() < 1.0e-9);
        assert!(row(&heads[..2], &slots).is_none());
    }
}
