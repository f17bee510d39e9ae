//! Finds the parts in images, from where everything is believed to be.

use nalgebra::Point3;
use ramp_kit::Kit;
use ramp_kit::solid::SolidError;
use ramp_robot::arm::ArmModel;
use ramp_robot::{Camera, CameraModel, Image, Pose};

use super::anywhere::{self, Comparison, Strewn};
use super::canvas::{Canvas, Lens};
use super::leaning;
use super::look::Look;
use super::lost::{Trace, trace};
use super::profile::Photograph;
use super::scene::{Believed, Bodies, Found, Scene, Seen};
use super::solids::surfaces;
use crate::image::{SightError, check_light};

/// Largest share of an image that may be as bright as can be: paper in strong light is, without harm to what
/// lies on it.
const SATURATED: f64 = 0.9;

/// Finds parts without tags.
pub struct SceneFinder {
    bodies: Bodies,
    canvases: [Option<Canvas>; 2],
}

impl SceneFinder {
    /// A finder for a kit and an arm.
    ///
    /// # Errors
    /// Dimensions of which no solid can be made.
    pub fn new(kit: &Kit, arm: &ArmModel) -> Result<SceneFinder, SolidError> {
        let bodies = Bodies {
            surfaces: surfaces(kit, arm)?,
            sheet: kit.sheet.clone(),
            tip: arm.hand.tip,
            finger: arm.finger.origin,
        };
        Ok(SceneFinder { bodies, canvases: [None, None] })
    }

    /// Finds those parts of a scene that are `wanted`. `slack` (m) is how far off a part may seem because the
    /// camera is not quite where its model has it.
    ///
    /// # Errors
    /// An image of the wrong size, or black or saturated.
    pub fn find(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
        wanted: &dyn Fn(&Believed) -> bool,
        slack: f64,
    ) -> Result<Seen, SightError> {
        self.look(image, camera, scene, slack, |look, canvas| look.all(canvas, wanted))
    }

    /// Looks for a peg of a scene that may be anywhere; `None` where nothing has its colour.
    ///
    /// # Errors
    /// As [`SceneFinder::find`].
    pub fn find_lost(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
        part: &Believed,
    ) -> Result<Option<Trace>, SightError> {
        self.look(image, camera, scene, 0.0, |look, canvas| trace(look, canvas, part))
    }

    /// Looks for beams that may lie anywhere on the table: gives those that the scene does not have, each
    /// under the name of one that looks the same, and a pose in the world from which it can be found.
    ///
    /// # Errors
    /// As [`SceneFinder::find`].
    pub fn find_beams_anywhere(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
        wanted: &[Strewn],
    ) -> Result<Vec<(String, Pose)>, SightError> {
        self.look(image, camera, scene, 0.0, |look, canvas| anywhere::beams(look, canvas, wanted))
    }

    /// Looks for a beam that may lean on something, anywhere, with one end on the table; `beam` tells how it
    /// lies flat, and `was` its pose in the world before it was lost.
    ///
    /// # Errors
    /// As [`SceneFinder::find`].
    pub fn find_leaning(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
        beam: &Strewn,
        was: &Pose,
    ) -> Result<Option<Found>, SightError> {
        self.look(image, camera, scene, 0.0, |look, canvas| leaning::beam(look, canvas, beam, was))
    }

    /// Compares beams that may lie in one place, each near a pose in the world, by how they explain an image
    /// from near; `None` where it supports none of them.
    ///
    /// # Errors
    /// As [`SceneFinder::find`].
    pub fn compare(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
        beams: &[(&Strewn, Pose)],
    ) -> Result<Option<Comparison>, SightError> {
        self.look(image, camera, scene, 0.0, |look, canvas| anywhere::compare(look, canvas, beams))
    }

    /// Looks for pegs that stand anywhere in holders: gives the middles of the heads that the scene does not
    /// have, m, in the world.
    ///
    /// # Errors
    /// As [`SceneFinder::find`].
    pub fn find_heads_anywhere(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
    ) -> Result<Vec<Point3<f64>>, SightError> {
        self.look(image, camera, scene, 0.0, anywhere::heads)
    }

    /// The drawing of a scene as a camera would show it, red, green and blue (gamma 2.2) for each pixel of an
    /// image; `None` where it has no body.
    ///
    /// # Errors
    /// As [`SceneFinder::find`].
    pub fn drawing(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
    ) -> Result<Vec<Option<[u8; 3]>>, SightError> {
        self.look(image, camera, scene, 0.0, |look, canvas| {
            look.draw_all(canvas);
            let pixel = |index: usize| {
                let (x, y) = (index % image.width, index / image.width);
                let [dx, dy] = camera.direction([x as f64 + 0.5, y as f64 + 0.5]);
                let at = canvas.lens.project(&Point3::new(dx, dy, 1.0));
                canvas.face_at(at).map(|face| face.colour.map(|light| (light.powf(1.0 / 2.2) * 255.0) as u8))
            };
            (0..image.width * image.height).map(pixel).collect()
        })
    }

    fn look<T>(
        &mut self,
        image: &Image,
        camera: &CameraModel,
        scene: &Scene,
        slack: f64,
        with: impl FnOnce(&Look, &mut Canvas) -> T,
    ) -> Result<T, SightError> {
        let size = [image.width, image.height];
        let expected = [camera.width, camera.height];
        if size != expected || image.pixels.len() != 3 * size[0] * size[1] {
            let (width, height, bytes) = (size[0], size[1], image.pixels.len());
            return Err(SightError::Size { camera: image.camera, width, height, bytes, expected });
        }
        check_light(image, SATURATED)?;
        let slot = usize::from(image.camera != Camera::Wrist);
        let mut canvas = match self.canvases[slot].take() {
            Some(canvas) if canvas.lens == Lens::of(camera) => canvas,
            _ => Canvas::new(camera),
        };
        let photograph = Photograph::new(image, camera, &canvas.lens);
        let x_wc = camera.x_wc(&image.x_wt);
        let look = Look { bodies: &self.bodies, photograph, camera, scene, x_wc, image, slack };
        let found = with(&look, &mut canvas);
        self.canvases[slot] = Some(canvas);
        Ok(found)
    }
}
