//! The scene as MJCF for other programs: with the cameras of the twin, and on request for an older MuJoCo.

use std::fmt::Write;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, CameraModel, Pose};

use crate::mjcf::{INTEGRATOR, LEAST_MASS, SLEEP};
use crate::twin::Twin;

/// The version of MuJoCo that an exported scene is written for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ForMujoco {
    /// 3.13 and newer: the twin's own scene.
    #[default]
    Newest,
    /// 3.3 and newer: another integrator, and no part sleeps, so motions differ from the twin's.
    V3_3,
}

/// The integrator of MuJoCo 3.3 that is nearest to the twin's.
const INTEGRATOR_3_3: &str = "integrator=\"implicitfast\"";
/// MuJoCo 3.3 would compute the centre of mass of bodies whose shapes have no mass, and refuse them.
const MASSES_3_3: &str = "inertiafromgeom=\"false\"";

impl Twin {
    /// The scene as MJCF with the cameras of this episode and named keyframes, each a full set of positions
    /// ([`Twin::qpos`]).
    pub fn export(&self, version: ForMujoco, keyframes: &[(&str, &[f64])]) -> String {
        let tip = self.hand_tip();
        let [wrist, birds_eye] =
            [Camera::Wrist, Camera::BirdsEye].map(|camera| element(camera, &self.true_camera(camera), tip));
        let mut xml = self.scene().replacen("<site name=\"tip\"", &format!("{wrist}<site name=\"tip\""), 1);
        xml = xml.replacen("</worldbody>", &format!("{birds_eye}</worldbody>"), 1);
        if version == ForMujoco::V3_3 {
            xml = xml.replacen(INTEGRATOR, INTEGRATOR_3_3, 1).replacen(SLEEP, "", 1);
            xml = xml.replacen(LEAST_MASS, &format!("{LEAST_MASS} {MASSES_3_3}"), 1);
        }
        if !keyframes.is_empty() {
            let mut block = String::from("<keyframe>\n");
            for (name, qpos) in keyframes {
                let numbers: Vec<String> = qpos.iter().map(f64::to_string).collect();
                let _ = writeln!(block, "<key name=\"{name}\" qpos=\"{}\"/>", numbers.join(" "));
            }
            xml = xml.replace("</mujoco>\n", &(block + "</keyframe>\n</mujoco>\n"));
        }
        xml
    }
}

/// A camera of the twin as an element of its body: the hand, whose `tip` (m) lies along its z, or the world.
/// The distortion of the lens is left out.
fn element(camera: Camera, model: &CameraModel, tip: f64) -> String {
    let x_bc = match model.mount {
        Mount::Tip(x_tc) => Pose::translation(0.0, 0.0, tip) * x_tc,
        Mount::World(x_wc) => x_wc,
    };
    // MuJoCo's cameras look along −z, with y up.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let x_bm = x_bc * Pose::from_parts(Translation3::identity(), turn);
    let (p, q) = (x_bm.translation.vector, x_bm.rotation);
    let fovy = 2.0 * (model.height as f64 / 2.0 / model.focal[1]).atan().to_degrees();
    format!(
        "<camera name=\"{}\" pos=\"{} {} {}\" quat=\"{} {} {} {}\" fovy=\"{fovy}\" resolution=\"{} {}\"/>\n",
        camera.name(),
        p.x,
        p.y,
        p.z,
        q.w,
        q.i,
        q.j,
        q.k,
        model.width,
        model.height
    )
}
