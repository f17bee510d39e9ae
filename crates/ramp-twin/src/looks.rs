//! Meshes that show the arm in MuJoCo's own pictures. They collide with nothing; collision geometry is in the
//! arm file.

use std::fmt::Write;
use std::sync::OnceLock;

use ramp_render::looks::{ArmSurface, arm_surfaces};

/// The meshes of the arm called `arm`; empty for an arm without meshes.
fn meshes(arm: &str) -> &'static [ArmSurface] {
    static KNOWN: [(&str, OnceLock<Vec<ArmSurface>>); 2] =
        [("panda", OnceLock::new()), ("fr3", OnceLock::new())];
    let known = KNOWN.iter().find(|(name, _)| *name == arm);
    known.map_or(&[], |(_, meshes)| meshes.get_or_init(|| arm_surfaces(arm)))
}

/// The `<mesh>` assets of the arm.
pub fn assets(arm: &str) -> String {
    let mut xml = String::new();
    for (number, mesh) in meshes(arm).iter().enumerate() {
        let _ = write!(xml, "<mesh name=\"look{number}\" inertia=\"shell\" vertex=\"");
        for [x, y, z] in &mesh.vertices {
            let _ = write!(xml, "{x:.4} {y:.4} {z:.4} ");
        }
        xml.push_str("\" face=\"");
        for index in &mesh.indices {
            let _ = write!(xml, "{index} ");
        }
        xml.push_str("\"/>\n");
    }
    xml
}

/// The geoms that show `body`.
pub fn geoms(arm: &str, body: &str) -> String {
    let mut xml = String::new();
    for (number, mesh) in meshes(arm).iter().enumerate().filter(|(_, mesh)| mesh.body == body) {
        let [r, g, b, a] = mesh.rgba;
        let _ =
            write!(xml, "<geom class=\"look\" mesh=\"look{number}\" rgba=\"{r:.3} {g:.3} {b:.3} {a:.3}\"/>");
    }
    xml
}
