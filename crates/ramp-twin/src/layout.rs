//! Start poses of all parts: those of the kit's sheet, from which the episode's seed moves them as far as its
//! start says, or places anywhere on the table, so that no agent can replay a fixed motion.

mod body;
mod outlines;
mod scattered;

use std::collections::{BTreeMap, BTreeSet};

use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_assembly::Assembly;
use ramp_kit::{Kit, Pose};
use ramp_robot::Track;
use ramp_robot::random::Stream;
use ramp_world::Start;
use ramp_world::groups::Table;
use ramp_world::start::Places;

use self::body::Body;
use self::outlines::Outlines;

/// Number of places that are drawn for a part before it stays on its outline.
const TRIES: usize = 1000;

/// Start poses in the world.
#[derive(Clone, Debug, Default)]
pub struct Layout {
    /// Each beam's frame; the clamped beam stands exactly at its place.
    pub beams: Vec<(String, Pose)>,
    /// Each holder's frame: centre of its base, at table level.
    pub holders: Vec<(String, Pose)>,
    /// Each peg's frame, standing in its holder.
    pub pegs: Vec<(String, Pose)>,
    /// The holder in which each peg starts, by the peg's name.
    pub in_holder: BTreeMap<String, String>,
    /// Beams and pegs that are one rigid body with the clamped beam. Without any, contact alone holds parts.
    pub rigid: BTreeSet<String>,
    /// The part for which no place was found, if any: no twin is made of such a layout.
    pub unplaced: Option<String>,
}

impl Layout {
    /// The start of the episode with this seed. Where parts lie anywhere, each place is drawn until it is
    /// clear of all others and within reach, and if none is found for a part the draw starts over. Else each
    /// part in turn is moved from its outline until it is clear of all others, and the hand can still grip
    /// each link that it could grip with all parts on their outlines; one for which a thousand draws find no
    /// place stays on its outline.
    pub fn new(assembly: &Assembly, start: &Start, seed: u64) -> Layout {
        Layout::draw(assembly, start, true, seed)
    }

    /// The start of an episode on its track: where no tag tells parts of one shape apart, each is called by
    /// the outline on which it lies, and by [its place](ramp_kit::lookalike) where there are no outlines.
    pub fn on_track(assembly: &Assembly, start: &Start, track: Track, seed: u64) -> Layout {
        Layout::draw(assembly, start, track.has_tags(), seed)
    }

    fn draw(assembly: &Assembly, start: &Start, tags: bool, seed: u64) -> Layout {
        let trades = start.trades() && tags;
        if let Some(scatter) = &start.scatter {
            return match scattered::draw(assembly, start.places.clearance, scatter, tags, seed) {
                Ok(places) => Layout::anywhere(&assembly.kit, &places),
                Err(part) => Layout { unplaced: Some(part), ..Layout::default() },
            };
        }
        let kit = &assembly.kit;
        let base = &assembly.beams[assembly.base];
        let outlines = Outlines::new(kit, &base.beam.name, trades, seed);
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
        let needed = grippable(&bodies);
        let mut stream = Stream::new(seed, "layout");
        for index in 0..bodies.len() {
            if bodies[index].name == base.beam.name {
                continue;
            }
            let found = (0..TRIES).any(|_| {
                bodies[index].x = displace(&bodies[index], &on_outline[index], &start.places, &mut stream);
                start.places.clearance == 0.0
                    || is_clear(&bodies, index, start.places.clearance) && grips(&bodies, &needed)
            });
            if !found {
                bodies[index].x = on_outline[index];
            }
        }
        let mut layout = Layout::default();
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

    /// Parts at these poses in the world, by name: each peg that has none stands in its holder.
    fn anywhere(kit: &Kit, places: &BTreeMap<String, Pose>) -> Layout {
        let find = |name: &String| Some((name.clone(), *places.get(name)?));
        let mut layout = Layout {
            beams: kit.beams.iter().filter_map(|beam| find(&beam.name)).collect(),
            holders: kit.holders.iter().filter_map(|holder| find(&holder.name)).collect(),
            ..Layout::default()
        };
        for peg in &kit.pegs {
            if let Some(lying) = find(&peg.name) {
                layout.pegs.push(lying);
                continue;
            }
            let holder = kit.holders.iter().find(|holder| holder.name == peg.holder);
            let (Some(holder), Some(x_wp)) = (holder, kit.x_wp_start(peg)) else { continue };
            let at = kit.sheet_to_world(holder.centre);
            let x_hp = Translation3::new(-at.x, -at.y, 0.0) * x_wp;
            if let Some(x_wh) = places.get(&holder.name) {
                layout.pegs.push((peg.name.clone(), x_wh * x_hp));
                layout.in_holder.insert(peg.name.clone(), holder.name.clone());
            }
        }
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

/// All bodies but one.
fn others(bodies: &[Body], but: usize) -> Vec<&Body> {
    bodies.iter().enumerate().filter(|(index, _)| *index != but).map(|(_, body)| body).collect()
}

/// Whether a body is at least `clearance` (m) from all others.
fn is_clear(bodies: &[Body], index: usize, clearance: f64) -> bool {
    let body = &bodies[index];
    others(bodies, index).iter().all(|other| body.is_clear(&body.x, other, clearance))
}

/// Which links of each body the hand can grip.
fn grippable(bodies: &[Body]) -> Vec<Vec<bool>> {
    (0..bodies.len()).map(|index| bodies[index].grippable(&others(bodies, index))).collect()
}

/// Whether the hand can grip all links that it has to.
fn grips(bodies: &[Body], needed: &[Vec<bool>]) -> bool {
    grippable(bodies).iter().flatten().zip(needed.iter().flatten()).all(|(can, needs)| *can || !needs)
}

/// A place for a body whose outline is at `on_outline`.
fn displace(body: &Body, on_outline: &Pose, places: &Places, stream: &mut Stream) -> Pose {
    let shift = Translation3::new(stream.symmetric(places.shift), stream.symmetric(places.shift), 0.0);
    let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), stream.symmetric(places.turn));
    let there = Translation3::from(on_outline * body.middle);
    shift * there * turn * there.inverse() * on_outline
}

/// True pose of the table in its nominal frame.
pub(crate) fn x_table(table: &Table) -> Pose {
    let [x, y] = table.tilt;
    let lean = UnitQuaternion::from_scaled_axis(Vector3::new(x, y, 0.0));
    Pose::from_parts(Translation3::new(0.0, 0.0, table.height), lean)
}
