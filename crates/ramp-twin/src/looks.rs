//! What the arm looks like: the maker's own meshes, from the crate `franka-description` (Apache-2.0). They collide
//! with nothing; collision geometry is in the arm file.

use std::fmt::Write;
use std::sync::OnceLock;

use franka_description::{MeshSet, Robot};

/// A mesh of one colour on one body of the arm, in the body's frame.
struct Mesh {
    body: String,
    rgba: [f32; 4],
    vertices: Vec<[f32; 3]>,
    indices: Vec<u32>,
}

/// The meshes of the arm called `arm`; none for an arm this crate has no meshes of.
fn meshes(arm: &str) -> &'static [Mesh] {
    static PANDA: OnceLock<Vec<Mesh>> = OnceLock::new();
    if arm != "panda" {
        return &[];
    }
    PANDA.get_or_init(|| {
        let set = MeshSet::for_robot(Robot::Fer);
        let mut all = Vec::new();
        for (number, bytes) in set.links.iter().enumerate() {
            read(&format!("link{number}"), bytes, &mut all);
        }
        read("hand", set.hand, &mut all);
        all
    })
}

/// Reads the triangles of a binary glTF file. What it cannot read is left out: looks are not worth an error.
fn read(body: &str, bytes: &[u8], all: &mut Vec<Mesh>) {
    let Ok(file) = gltf::Gltf::from_slice(bytes) else { return };
    let Some(blob) = file.blob.as_deref() else { return };
    for primitive in file.meshes().flat_map(|mesh| mesh.primitives()) {
        let reader = primitive.reader(|_| Some(blob));
        let (Some(positions), Some(indices)) = (reader.read_positions(), reader.read_indices()) else {
            continue;
        };
        all.push(Mesh {
            body: body.to_string(),
            rgba: primitive.material().pbr_metallic_roughness().base_color_factor(),
            vertices: positions.collect(),
            indices: indices.into_u32().collect(),
        });
    }
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
