//! The parts on their sheet, and pictures of them.

use std::sync::{Arc, OnceLock};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::{Kit, Pose, read_kit};
use ramp_render::{Looks, Renderer, Scene, Sensor};
use ramp_robot::{Camera, CameraModel, Image};

use crate::data;

/// Distance from the hand's frame to the tip's, m.
pub const TIP: f64 = 0.1134;

/// All parts of the kit where they start.
pub struct Table {
    /// The benchmark's kit.
    pub kit: Kit,
    /// The shapes and colours of its parts.
    pub looks: Arc<Looks>,
    /// Every part and its pose in the world.
    pub parts: Vec<(String, Pose)>,
}

impl Table {
    /// The kit's parts at their starts; beams without one lie at the assembly frame.
    #[must_use]
    #[allow(clippy::new_without_default)]
    pub fn new() -> Table {
        static LOOKS: OnceLock<Arc<Looks>> = OnceLock::new();
        let kit = read_kit(&data().join("kit.xml")).unwrap();
        let looks = Arc::clone(LOOKS.get_or_init(|| Arc::new(Looks::new(&kit, None).unwrap())));
        let mut parts = Vec::new();
        for beam in &kit.beams {
            let base = kit.x_wa() * Pose::translation(0.0, 0.0, beam.axis_height_on_table());
            parts.push((beam.name.clone(), kit.x_wb_start(beam).unwrap_or(base)));
        }
        for peg in &kit.pegs {
            parts.push((peg.name.clone(), kit.x_wp_start(peg).unwrap()));
        }
        Table { kit, looks, parts }
    }

    /// The pose of a part in the world.
    #[must_use]
    pub fn truth(&self, part: &str) -> Pose {
        self.parts.iter().find(|(name, _)| name == part).unwrap().1
    }

    /// All parts and holders, to be rendered.
    #[must_use]
    pub fn scene(&self) -> Scene {
        let parts = self.parts.iter().map(|(name, x)| (self.looks.body(name).unwrap(), *x));
        let holder = |holder: &ramp_kit::Holder| {
            let at = self.kit.sheet_to_world(holder.centre);
            (self.looks.body(&holder.name).unwrap(), Pose::translation(at.x, at.y, 0.0))
        };
        Scene { bodies: parts.chain(self.kit.holders.iter().map(holder)).collect() }
    }

    /// A renderer for a camera.
    #[must_use]
    pub fn renderer(&self, model: &CameraModel) -> Renderer {
        Renderer::new(Arc::clone(&self.looks), model)
    }

    /// The image of a camera, with the tip at `x_wt`.
    pub fn look(&self, renderer: &mut Renderer, sensor: &mut Sensor, camera: Camera, x_wt: Pose) -> Image {
        let model = CameraModel::nominal(camera, TIP);
        let pixels = renderer.render(&self.scene(), &model.x_wc(&x_wt), sensor);
        let (width, height) = (model.width, model.height);
        Image { camera, time: 0.0, x_wt, width, height, pixels, depth: None }
    }
}

/// A tip pose whose camera is at `eye` (m) and looks straight down, turned and tilted by small angles (rad).
#[must_use]
pub fn tip_above(model: &CameraModel, eye: [f64; 3], turn: f64, tilt: [f64; 2]) -> Pose {
    let down = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let rotation = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turn)
        * UnitQuaternion::from_scaled_axis(Vector3::new(tilt[0], tilt[1], 0.0))
        * down;
    let x_wt = Pose::from_parts(Translation3::identity(), rotation);
    let offset = model.x_wc(&x_wt).translation.vector;
    Translation3::from(Vector3::from(eye) - offset) * x_wt
}
