//! Start poses of all parts: those of the kit's sheet, from which the episode's seed moves them as far as its
//! start says, so that no agent can replay a fixed motion.

mod body;
mod outlines;

use std::collections::BTreeMap;

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::Pose;
use ramp_robot::random::Stream;
use ramp_world::Start;
use ramp_world::groups::Table;
use ramp_world::start::Places;

use self::body::Body;
use self::outlines::Outlines;

/// Number of places that are drawn for a part before it stays on its outline.
const TRIES: usize = 1000;

/// Start poses in the world.
#[derive(Clone, Debug)]
pub struct Layout {
    /// Each beam's frame; the clamped beam stands exactly at its place.
    pub beams: Vec<(String, Pose)>,
    /// Each holder's frame: centre of its base, at table level.
    pub holders: Vec<(String, Pose)>,
    /// Each peg's frame, standing in its holder.
    pub pegs: Vec<(String, Pose)>,
    /// The holder in which each peg starts, by the peg's name.
    pub in_holder: BTreeMap<String, String>,
}

impl Layout {
    /// The start of the episode with this seed. Each part in turn is moved from its outline until it is clear
    /// of all others; one for which a thousand draws find no place stays on its outline.
    pub fn new(assembly: &Assembly, start: &Start, seed: u64) -> Layout {
        let kit = &assembly.kit;
        let base = &assembly.beams[assembly.base];
        let outlines = Outlines::new(kit, &base.beam.name, start.trades(), seed);
        let mut bodies: Vec<Body> = Vec::new();
        for beam in &kit.beams {
            if beam.name == base.beam.name {
                bodies.push(Body::beam(beam, kit.x_wa() * base.x_ab));
            } else if let Some(x_wb) = outlines.beam(beam) {
                bodies.push(Body::beam(beam, x_wb));
            }
        }
        for holder in &kit.holders {
            let at = kit.sheet_to_world(holder.centre);
            bodies.push(Body::holder(holder, Pose::translation(at.x, at.y, 0.0)));
        }
        let on_outline: Vec<Pose> = bodies.iter().map(|body| body.x).collect();
        let mut stream = Stream::new(seed, "layout");
        for index in 0..bodies.len() {
            if bodies[index].name == base.beam.name {
                continue;
            }
            let body = &bodies[index];
            let others: Vec<&Body> =
                bodies.iter().enumerate().filter(|(other, _)| *other != index).map(|(_, it)| it).collect();
            let place = (0..TRIES).map(|_| displace(body, &start.places, &mut stream)).find(|x| {
                start.places.clearance == 0.0
                    || others.iter().all(|other| body.is_clear(x, other, start.places.clearance))
            });
            bodies[index].x = place.unwrap_or(bodies[index].x);
        }
        let mut layout =
            Layout { beams: Vec::new(), holders: Vec::new(), pegs: Vec::new(), in_holder: BTreeMap::new() };
        for (body, on_outline) in bodies.iter().zip(on_outline) {
            let Some(holder) = kit.holders.iter().find(|holder| holder.name == body.name) else {
                layout.beams.push((body.name.clone(), body.x));
                continue;
            };
            for (peg, x_wp) in outlines.pegs_in(&holder.name) {
                layout.in_holder.insert(peg.clone(), holder.name.clone());
                layout.pegs.push((peg, body.x * on_outline.inverse() * x_wp));
            }
            layout.holders.push((body.name.clone(), body.x));
        }
        // The order of the parts is the same in every episode.
        layout.pegs.sort_by_key(|(name, _)| kit.pegs.iter().position(|peg| peg.name == *name));
        layout
    }

    /// Moves all parts with a table that is too high and tilted.
    pub fn tilt(&mut self, table: &Table) {
        let x_table = x_table(table);
        if x_table == Pose::identity() {
            return;
        }
        for (_, x) in self.beams.iter_mut().chain(&mut self.holders).chain(&mut self.pegs) {
            *x = x_table * *x;
        }
    }
}

/// A place for a body, from its outline.
fn displace(body: &Body, places: &Places, stream: &mut Stream) -> Pose {
    let shift = Translation3::new(stream.symmetric(places.shift), stream.symmetric(places.shift), 0.0);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(places.turn));
    let there = Translation3::from(body.x * body.middle);
    shift * there * turn * there.inverse() * body.x
}

/// True pose of the table in its nominal frame.
pub(crate) fn x_table(table: &Table) -> Pose {
    let [x, y] = table.tilt;
    let lean = UnitQuaternion::from_scaled_axis(Vector3::new(x, y, 0.0));
    Pose::from_parts(Translation3::new(0.0, 0.0, table.height), lean)
}
