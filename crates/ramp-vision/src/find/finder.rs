//! All parts in an image.

use super::lying::Lying;
use super::part::View;
use super::sighting::{Oddity, SHEET, Sighting};
use crate::detect::{Detection, TagFinder};
use crate::image::{Grey, SightError};
use ramp_kit::Kit;
use ramp_kit::tags::{self, TagPlace};
use ramp_robot::{CameraModel, Image};
use std::collections::BTreeMap;

/// Finds the parts of a kit in images.
pub struct PartFinder {
    places: BTreeMap<u32, TagPlace>,
    order: Vec<String>,
    tags: TagFinder,
}

impl PartFinder {
    /// A finder for a kit.
    ///
    /// # Errors
    /// When the detector does not start.
    pub fn new(kit: &Kit) -> Result<PartFinder, SightError> {
        let mut places: BTreeMap<u32, TagPlace> =
            tags::places(kit).into_iter().map(|place| (place.id, place)).collect();
        let sheet = TagPlace {
            id: tags::SHEET_ID,
            part: SHEET.to_string(),
            x_pg: tags::x_wg_sheet(kit),
            edge: kit.sheet.tag_edge,
        };
        places.insert(sheet.id, sheet);
        let beams = kit.beams.iter().map(|beam| beam.name.clone());
        let order = beams.chain(kit.pegs.iter().map(|peg| peg.name.clone())).collect();
        Ok(PartFinder { places, order, tags: TagFinder::new()? })
    }

    /// Poses of the tags on the parts.
    pub fn places(&self) -> &BTreeMap<u32, TagPlace> {
        &self.places
    }

    /// Finds the parts in an image. `camera` is the camera model that the robot reports, and `lying` the
    /// prior of parts that nothing has touched.
    ///
    /// # Errors
    /// When nothing can be seen in the image at all.
    pub fn find(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        lying: &[Lying],
    ) -> Result<Sighting, SightError> {
        let grey = Grey::new(image, camera)?;
        let detections = self.tags.find(&grey)?;
        let mut sighting = Sighting { time: image.time, ..Sighting::default() };
        let mut by_part: BTreeMap<&str, Vec<(&TagPlace, &Detection)>> = BTreeMap::new();
        for detection in &detections {
            match self.places.get(&detection.id) {
                Some(place) => by_part.entry(&place.part).or_default().push((place, detection)),
                None => sighting.oddities.push(Oddity::UnknownTag { id: detection.id }),
            }
        }
        let view = View { grey: &grey, camera, x_wc: camera.x_wc(&image.x_wt) };
        // The sheet lies on the table, whatever happens.
        let sheet = Lying { part: SHEET.to_string(), height: 0.0, flipped: false, sigma: Lying::SIGMA };
        for name in self.order.iter().map(String::as_str).chain([SHEET]) {
            let Some(seen) = by_part.get(name) else { continue };
            let lying = lying.iter().chain([&sheet]).find(|lying| lying.part == name);
            match view.part(name, seen, lying, &mut sighting.oddities) {
                Some(part) if name == SHEET => sighting.sheet = Some(part),
                Some(part) => sighting.parts.push(part),
                None => {}
            }
        }
        sighting.detections = detections;
        Ok(sighting)
    }
}
