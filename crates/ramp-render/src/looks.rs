//! Appearance of all bodies: meshes, tags and the sheet, made once from the kit and the arm file.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

use franka_description::{MeshSet, Robot};
use nalgebra::{Isometry3, Point3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::shape::Cuboid;
use ramp_kit::solid::{self, Solid};
use ramp_kit::tags::{self, TagPlace};
use ramp_kit::{Kit, Pose};
use ramp_robot::arm::{ArmBox, ArmModel};

use crate::error::LooksError;
use crate::mesh::{Colour, Mesh};
use crate::texture::{Cells, Texture};

/// Printed joints and holders, pegs, aluminium, the fingertips, what is mounted on the hand.
const PRINTED: Colour = [0.035, 0.037, 0.042];
const PEG: Colour = [0.50, 0.13, 0.02];
const HOLDER: Colour = [0.16, 0.17, 0.18];
pub(crate) const METAL: Colour = [0.52, 0.54, 0.57];
const TIP: Colour = [0.03, 0.03, 0.033];
const TOOL: Colour = [0.22, 0.23, 0.25];
const PAPER: Colour = [0.8, 0.8, 0.8];
/// Thickness of the board under the calibration sheet, m.
const CARDBOARD: f64 = 4.0e-3;
/// For near and far looks: details that are left out and the longest edge of a triangle (the lens bends
/// longer ones visibly), m.
const NEAR: [f32; 2] = [0.45e-3, 0.045];
const FAR: [f32; 2] = [2.0e-3, 0.06];
/// Details that a shadow does not show, m.
const SHADOW: f32 = 0.008;

/// A tag on a body.
#[derive(Clone, Debug)]
pub struct Sticker {
    /// Its place on the body.
    pub place: TagPlace,
    /// Edge of the white sticker, m.
    pub size: f32,
    /// The pattern printed on it.
    pub cells: Cells,
}

/// A mesh with the outward normals of its triangles.
#[derive(Clone, Debug)]
pub struct Surface {
    /// The mesh.
    pub mesh: Mesh,
    /// One for each triangle.
    pub normals: Vec<[f32; 3]>,
}

/// Something that moves as one piece.
#[derive(Clone, Debug)]
pub struct Body {
    /// The name of the part, holder or link.
    pub name: String,
    /// Its surface for looks from near and from far.
    pub surfaces: [Surface; 2],
    /// A rougher surface that throws its shadow.
    pub shadow: Mesh,
    /// Its tags.
    pub tags: Vec<Sticker>,
    /// Its brightness relative to that of its materials.
    pub tone: f32,
    /// Centre and radius of a ball around it, m.
    pub ball: ([f32; 3], f32),
}

impl Body {
    fn new(name: &str, mesh: Mesh, shadow: Mesh, tags: Vec<Sticker>) -> Body {
        let surfaces = [NEAR, FAR].map(|[detail, edge]| {
            let mesh = mesh.coarse(detail).refined(edge);
            Surface { normals: mesh.normals(), mesh }
        });
        Body { name: name.to_string(), surfaces, ball: mesh.ball(), shadow, tags, tone: 1.0 }
    }
}

/// The looks of a kit, its sheet and an arm. Copies share the bodies in which they do not differ.
#[derive(Clone, Debug)]
pub struct Looks {
    bodies: Vec<Arc<Body>>,
    names: BTreeMap<String, usize>,
    /// The sheet and where it lies: its upper left corner in the world and its size, m.
    pub(crate) sheet: Arc<Texture>,
    pub(crate) sheet_corner: [f32; 2],
    pub(crate) sheet_size: [f32; 2],
    /// The sheet's tag and its pose in the world, if it has one.
    pub(crate) sheet_tag: Option<Sticker>,
    /// Light of the lamp's reflection in aluminium, relative to white.
    pub(crate) glint: f32,
}

/// How a body differs from its drawing.
pub struct Difference<'a> {
    /// The pose to which a point of the drawing (m, in the body's frame) and its surroundings are moved, in
    /// the same frame; `None` for the shape of the drawing.
    pub place: Option<&'a dyn Fn(Point3<f64>) -> Pose>,
    /// Its brightness relative to that of its materials.
    pub tone: f64,
}

/// A finger's box, see the arm file: in the finger's frame, whose z is `tip` further from the tip.
fn finger_box(piece: &ArmBox, tip: f64) -> Cuboid {
    let ([x0, y0, z0], [x1, y1, z1]) = (piece.min, piece.max);
    Cuboid { min: [x0, y0, tip - z1], max: [x1, y1, tip - z0] }
}

/// Name of the body of the calibration sheet.
pub const CALIBRATION_SHEET: &str = "calibration-sheet";

/// Name of the body of the wrist camera's housing on the hand; the camera, which is in it, does not see it.
pub const HOUSING: &str = "housing";

impl Looks {
    /// From the kit and the arm; without an arm, only the parts.
    ///
    /// # Errors
    /// Dimensions of which no solid can be made.
    pub fn new(kit: &Kit, arm: Option<&ArmModel>) -> Result<Looks, LooksError> {
        let mut bodies = Vec::new();
        let places = tags::places(kit);
        let stickers = |part: &str| -> Result<Vec<Sticker>, LooksError> {
            places.iter().filter(|place| place.part == part).map(sticker).collect()
        };
        for beam in &kit.beams {
            let mut mesh = Mesh::default();
            for piece in solid::beam(beam, &kit.dimensions, 0.0)?.iter().filter(|piece| !piece.link) {
                mesh.add_solid(&piece.solid, &Isometry3::identity(), PRINTED);
            }
            for pair in beam.joints.windows(2) {
                let from = pair[0].offset + pair[0].kind.sleeve() - HIDDEN;
                let to = pair[1].offset - pair[1].kind.sleeve() + HIDDEN;
                add_extrusion(&mut mesh, from, to);
            }
            let mut shadow = Mesh::default();
            for shape in ramp_kit::shape::beam_shapes(beam) {
                shadow.add_box(&shape.bounds(), PRINTED);
            }
            bodies.push(Body::new(&beam.name, mesh, shadow, stickers(&beam.name)?));
        }
        let peg = one(&solid::peg(&kit.dimensions)?, PEG);
        for part in &kit.pegs {
            bodies.push(Body::new(&part.name, peg.clone(), peg.coarse(SHADOW), stickers(&part.name)?));
        }
        let holder = one(&solid::holder(&kit.dimensions)?, HOLDER);
        for part in &kit.holders {
            bodies.push(Body::new(&part.name, holder.clone(), holder.coarse(SHADOW), Vec::new()));
        }
        if let Some(arm) = arm {
            arm_bodies(arm, &mut bodies)?;
        }
        let names = bodies.iter().enumerate().map(|(index, body)| (body.name.clone(), index)).collect();
        let sheet_place = TagPlace {
            id: tags::SHEET_ID,
            part: "sheet".to_string(),
            x_pg: tags::x_wg_sheet(kit),
            edge: kit.sheet.tag_edge,
        };
        Ok(Looks {
            bodies: bodies.into_iter().map(Arc::new).collect(),
            names,
            sheet: Arc::new(Texture::sheet(kit, true)?),
            sheet_corner: kit.sheet.corner.map(|value| value as f32),
            sheet_size: kit.sheet.size.map(|value| value as f32),
            sheet_tag: Some(sticker(&sheet_place)?),
            glint: 0.0,
        })
    }

    /// As [`Looks::new`] with an arm, but made only once for each kit and arm that this process sees.
    ///
    /// # Errors
    /// As [`Looks::new`].
    pub fn shared(kit: &Kit, arm: &ArmModel) -> Result<Arc<Looks>, LooksError> {
        Looks::known("with tags", kit, arm, || Looks::new(kit, Some(arm)))
    }

    /// As [`Looks::shared`], without any tag: none on a part, none on the sheet.
    ///
    /// # Errors
    /// As [`Looks::new`].
    pub fn shared_without_tags(kit: &Kit, arm: &ArmModel) -> Result<Arc<Looks>, LooksError> {
        Looks::known("without tags", kit, arm, || Looks::new(kit, Some(arm))?.without_tags(kit))
    }

    fn known(
        kind: &str,
        kit: &Kit,
        arm: &ArmModel,
        make: impl FnOnce() -> Result<Looks, LooksError>,
    ) -> Result<Arc<Looks>, LooksError> {
        static KNOWN: Mutex<Vec<(String, Arc<Looks>)>> = Mutex::new(Vec::new());
        // The debug form holds every number of both.
        let key = format!("{kind}{kit:?}{arm:?}");
        let mut known = KNOWN.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((_, looks)) = known.iter().find(|(other, _)| *other == key) {
            return Ok(Arc::clone(looks));
        }
        let looks = Arc::new(make()?);
        known.push((key, Arc::clone(&looks)));
        Ok(looks)
    }

    /// The same with one more body, the calibration sheet ([`ramp_kit::board`]) on a stiff board.
    ///
    /// # Errors
    /// A tag that the family does not have.
    pub fn with_calibration_sheet(mut self) -> Result<Looks, LooksError> {
        let [x, y] = [0.297 / 2.0, 0.210 / 2.0];
        let mut mesh = Mesh::default();
        mesh.add_box(&Cuboid { min: [-x, -y, -CARDBOARD], max: [x, y, 0.0] }, PAPER);
        let tags = ramp_kit::board::places().iter().map(sticker).collect::<Result<_, _>>()?;
        self.names.insert(CALIBRATION_SHEET.to_string(), self.bodies.len());
        self.bodies.push(Arc::new(Body::new(CALIBRATION_SHEET, mesh.clone(), mesh, tags)));
        Ok(self)
    }

    /// The same with the tag of that id covered with white, wherever it sticks on a part.
    #[must_use]
    pub fn with_covered_tag(&self, id: u32) -> Looks {
        let mut looks = self.clone();
        for body in &mut looks.bodies {
            if body.tags.iter().all(|sticker| sticker.place.id != id) {
                continue;
            }
            for sticker in &mut Arc::make_mut(body).tags {
                if sticker.place.id == id {
                    sticker.cells = sticker.cells.blank();
                }
            }
        }
        looks
    }

    /// Makes a body differ from its drawing.
    pub fn change(&mut self, name: &str, difference: &Difference) {
        let Some(body) = self.body(name).and_then(|index| self.bodies.get_mut(index)) else { return };
        let body = Arc::make_mut(body);
        body.tone = difference.tone as f32;
        let Some(place) = difference.place else { return };
        let moved = |points: &mut [[f32; 3]]| {
            for point in points {
                let p = place(Point3::from(point.map(f64::from))).translation.vector;
                *point = [p.x as f32, p.y as f32, p.z as f32];
            }
        };
        for surface in &mut body.surfaces {
            moved(&mut surface.mesh.points);
            surface.normals = surface.mesh.normals();
        }
        moved(&mut body.shadow.points);
        for sticker in &mut body.tags {
            let x = &mut sticker.place.x_pg;
            let there = place(Point3::from(x.translation.vector));
            *x = Pose::from_parts(there.translation, there.rotation * x.rotation);
        }
        body.ball = body.surfaces[0].mesh.ball();
    }

    /// The same with the lamp's reflection in aluminium so bright, relative to white.
    #[must_use]
    pub fn with_glint(mut self, glint: f64) -> Looks {
        self.glint = glint as f32;
        self
    }

    /// The same without any tag: none on a part, none on the sheet of the kit.
    ///
    /// # Errors
    /// A sheet that cannot be drawn.
    pub fn without_tags(mut self, kit: &Kit) -> Result<Looks, LooksError> {
        self.sheet = Arc::new(Texture::sheet(kit, false)?);
        self.sheet_tag = None;
        for body in &mut self.bodies {
            Arc::make_mut(body).tags.clear();
        }
        Ok(self)
    }

    /// All bodies.
    pub fn bodies(&self) -> &[Arc<Body>] {
        &self.bodies
    }

    /// The index of the body of that name.
    pub fn body(&self, name: &str) -> Option<usize> {
        self.names.get(name).copied()
    }
}

/// Length of an extrusion's end that is drawn inside its socket, m: the gap is visible.
const HIDDEN: f64 = 3.0e-3;

/// The sides of an extrusion from x = `from` to x = `to`, m.
fn add_extrusion(mesh: &mut Mesh, from: f64, to: f64) {
    let profile = solid::profile();
    let Some(outline) = profile.first() else { return };
    // Points of its rounded corners that lie closer than this are left out, mm.
    const CLOSE: f64 = 0.9;
    let mut corners: Vec<[f64; 2]> = Vec::new();
    for point in outline {
        let far = |last: &[f64; 2]| (point[0] - last[0]).hypot(point[1] - last[1]) > CLOSE;
        if corners.last().is_none_or(far) {
            corners.push(*point);
        }
    }
    let count = corners.len() as u32;
    let points = [from, to].into_iter().flat_map(|x| {
        // The outline goes anticlockwise seen from +x.
        corners.iter().map(move |[y, z]| [x, y * 1e-3, z * 1e-3])
    });
    let points: Vec<[f64; 3]> = points.collect();
    let triangles = (0..count).flat_map(|here| {
        let next = (here + 1) % count;
        [[here, next, here + count], [next, next + count, here + count]]
    });
    mesh.add(points, triangles, METAL);
}

fn sticker(place: &TagPlace) -> Result<Sticker, LooksError> {
    let cells = Cells::new(place.id, place.edge).ok_or(LooksError::Tag(place.id))?;
    // Nine cells and as much white around as a part's sticker has.
    let size = place.edge * tags::STICKER / tags::BLACK_EDGE;
    Ok(Sticker { place: place.clone(), size: size as f32, cells })
}

fn one(solid: &Solid, colour: Colour) -> Mesh {
    let mut mesh = Mesh::default();
    mesh.add_solid(solid, &Isometry3::identity(), colour);
    mesh
}

/// Links `link0` to `link7`, `hand`, `finger1` and `finger2`, in their own frames.
fn arm_bodies(arm: &ArmModel, bodies: &mut Vec<Body>) -> Result<(), LooksError> {
    let mut add = |name: &str, mesh: Mesh| {
        let shadow = mesh.coarse(0.02);
        bodies.push(Body::new(name, mesh, shadow, Vec::new()));
    };
    let mut links: BTreeMap<String, Mesh> = BTreeMap::new();
    for surface in arm_surfaces(&arm.name) {
        // Painted sheet metal throws back four fifths of the light at most.
        let [r, g, b] = [0, 1, 2].map(|channel| surface.rgba[channel] * 0.8);
        let points = surface.vertices.iter().map(|point| point.map(f64::from));
        let triangles = surface.indices.chunks_exact(3).map(|corners| [corners[0], corners[1], corners[2]]);
        links.entry(surface.body).or_default().add(points, triangles, [r, g, b]);
    }
    for (name, mesh) in links {
        add(&name, mesh);
    }
    let mut housing = Mesh::default();
    for piece in arm.hand.boxes.iter().skip(1) {
        housing.add_box(&Cuboid { min: piece.min, max: piece.max }, TOOL);
    }
    add(HOUSING, housing);
    let tip = arm.hand.tip - arm.finger.origin;
    // Drawn with z towards the hand and y the way it closes; its plate ends at the pads' outer face.
    let outer = arm.finger.pads.first().map_or(0.0, |pad| pad.max[1]);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI);
    let x_ft: Pose = Pose::from_parts(Translation3::new(0.0, outer, tip), turn);
    let mut finger = Mesh::default();
    finger.add_solid(&solid::fingertip()?, &x_ft, TIP);
    for piece in &arm.finger.boxes {
        finger.add_box(&finger_box(piece, tip), TOOL);
    }
    add("finger1", finger.clone());
    add("finger2", finger);
    Ok(())
}

/// A surface of one colour on one body of the arm, in the body's frame.
#[derive(Clone, Debug)]
pub struct ArmSurface {
    /// `link0` to `link7` or `hand`.
    pub body: String,
    /// Red, green, blue and opacity, linear.
    pub rgba: [f32; 4],
    /// Corners, m.
    pub vertices: Vec<[f32; 3]>,
    /// Three for each triangle.
    pub indices: Vec<u32>,
}

/// The maker's own meshes of the arm called `arm`, from the crate `franka-description` (Apache-2.0); empty
/// for an arm without meshes in this crate.
pub fn arm_surfaces(arm: &str) -> Vec<ArmSurface> {
    let robot = match arm {
        "panda" => Robot::Fer,
        "fr3" => Robot::Fr3,
        _ => return Vec::new(),
    };
    let mut all = Vec::new();
    let set = MeshSet::for_robot(robot);
    for (number, bytes) in set.links.iter().enumerate() {
        read(&format!("link{number}"), bytes, &mut all);
    }
    read("hand", set.hand, &mut all);
    all
}

/// Reads the triangles of a binary glTF file. What it cannot read is left out: looks are not worth an error.
fn read(body: &str, bytes: &[u8], all: &mut Vec<ArmSurface>) {
    let Ok(file) = gltf::Gltf::from_slice(bytes) else { return };
    let Some(blob) = file.blob.as_deref() else { return };
    for primitive in file.meshes().flat_map(|mesh| mesh.primitives()) {
        let reader = primitive.reader(|_| Some(blob));
        let (Some(positions), Some(indices)) = (reader.read_positions(), reader.read_indices()) else {
            continue;
        };
        all.push(ArmSurface {
            body: body.to_string(),
            rgba: primitive.material().pbr_metallic_roughness().base_color_factor(),
            vertices: positions.collect(),
            indices: indices.into_u32().collect(),
        });
    }
}
