//! The goal as plain data for an agent.

use ramp_assembly::Assembly;
use ramp_kit::{joint, tags};
use ramp_robot::arm::ArmModel;
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, CameraModel, Robot, Track};
use serde_json::{Value, json};

use crate::observation::pose;
use crate::protocol::PROTOCOL;
use ramp_log::Sources;
use ramp_world::start::Scatter;
use ramp_world::{Range, Start};

/// The goal, as an agent gets it.
pub struct GoalMessage<'a> {
    assembly: &'a Assembly,
    arm: &'a ArmModel,
    track: Track,
    start: &'a Start,
    texts: Sources<'a>,
    /// The part of it that is to be done, if not all.
    task: Option<Value>,
}

impl<'a> GoalMessage<'a> {
    /// A goal, with the texts of its files.
    pub fn new(
        assembly: &'a Assembly,
        arm: &'a ArmModel,
        track: Track,
        start: &'a Start,
        texts: Sources<'a>,
    ) -> GoalMessage<'a> {
        GoalMessage { assembly, arm, track, start, texts, task: None }
    }

    /// With a task: a step of it that is to be done alone.
    #[must_use]
    pub fn with_task(mut self, task: Value) -> GoalMessage<'a> {
        self.task = Some(task);
        self
    }

    /// The arm.
    pub fn arm(&self) -> &ArmModel {
        self.arm
    }

    /// As plain data. Neither the seed nor where anything really is can be found in it.
    pub fn to_json(&self, robot: &dyn Robot) -> Value {
        let assembly = self.assembly;
        let kit = &assembly.kit;
        let pegs: Vec<Value> = kit
            .pegs
            .iter()
            .map(|peg| json!({"name": peg.name, "x_wp_sheet": kit.x_wp_start(peg).as_ref().map(pose)}))
            .collect();
        let hand = &self.arm.hand;
        let mut goal = json!({
            "protocol": PROTOCOL,
            "name": assembly.name,
            "class": assembly.class.map(|class| class.name()),
            "track": self.track.name(),
            "start": {
                "name": self.start.name,
                "shift": self.start.places.shift,
                "turn": self.start.places.turn,
                "trade": self.start.trades() && self.track.has_tags(),
                "anywhere": self.start.scatter.as_ref().map(anywhere),
            },
            "period": ramp_robot::PERIOD,
            "time_limit": ramp_robot::TIME_LIMIT,
            "beams": self.beams(),
            "pegs": pegs,
            "dimensions": dimensions(),
            "connections": self.connections(),
            "insertions": self.insertions(),
            "arm": {
                "name": self.arm.name,
                "joints": self.joints(),
                "hand": {"position": hand.position, "quat_wxyz": hand.quat_wxyz, "tip": hand.tip},
                "home": self.arm.home,
            },
            "cameras": {
                Camera::Wrist.name(): camera(&robot.camera(Camera::Wrist)),
                Camera::BirdsEye.name(): camera(&robot.camera(Camera::BirdsEye)),
            },
            "tags": self.tags(),
            "sheet_tag": self.sheet_tag(),
            "files": {"goal": self.texts.goal, "kit": self.texts.kit},
        });
        if let Some(task) = &self.task {
            goal["task"] = task.clone();
        }
        goal
    }

    /// As plain data for a planner: what is to be built of what, and no robot.
    pub fn to_planner_json(&self) -> Value {
        let assembly = self.assembly;
        let pegs: Vec<&str> = assembly.kit.pegs.iter().map(|peg| peg.name.as_str()).collect();
        json!({
            "name": assembly.name,
            "class": assembly.class.map(|class| class.name()),
            "beams": self.beams(),
            "pegs": pegs,
            "connections": self.connections(),
            "insertions": self.insertions(),
            "files": {"goal": self.texts.goal, "kit": self.texts.kit},
        })
    }

    /// As plain data for a finder of parts: what may be seen, and by which tags.
    pub fn to_finder_json(&self) -> Value {
        let mut goal = self.to_planner_json();
        goal["track"] = self.track.name().into();
        goal["dimensions"] = dimensions();
        goal["tags"] = self.tags().into();
        goal["sheet_tag"] = self.sheet_tag().into();
        goal
    }

    /// The tags on the parts; none on a track without.
    fn tags(&self) -> Vec<Value> {
        let tagged = self.track.has_tags();
        let place = |it: &tags::TagPlace| json!({"id": it.id, "part": it.part, "x_pg": pose(&it.x_pg), "edge": it.edge});
        tags::places(&self.assembly.kit).iter().filter(|_| tagged).map(place).collect()
    }

    /// The tag on the sheet, if it has one.
    fn sheet_tag(&self) -> Option<Value> {
        let kit = &self.assembly.kit;
        self.track.has_tags().then(|| {
            json!({
                "id": tags::SHEET_ID, "x_wg": pose(&tags::x_wg_sheet(kit)), "edge": kit.sheet.tag_edge,
            })
        })
    }

    /// The beams with their joints and links, at the goal and on the sheet.
    fn beams(&self) -> Vec<Value> {
        let assembly = self.assembly;
        let kit = &assembly.kit;
        let x_wa = kit.x_wa();
        assembly
            .beams
            .iter()
            .map(|placed| {
                let joints: Vec<Value> = placed
                    .beam
                    .joints
                    .iter()
                    .enumerate()
                    .map(|(index, joint)| {
                        let hole = placed.beam.p_b_hole(index);
                        json!({
                            "name": joint.name,
                            "kind": joint.kind.name(),
                            "p_b": [hole.x, hole.y, hole.z],
                        })
                    })
                    .collect();
                let links: Vec<Value> = placed
                    .beam
                    .links
                    .iter()
                    .map(|link| json!({"name": link.name, "grasp": link.grasp}))
                    .collect();
                json!({
                    "name": placed.beam.name,
                    "flipped": placed.flipped,
                    "clamped": placed.beam.name == assembly.beams[assembly.base].beam.name,
                    "x_wb_goal": pose(&(x_wa * placed.x_ab)),
                    "x_wb_sheet": kit.x_wb_start(&placed.beam).as_ref().map(pose),
                    "joints": joints,
                    "links": links,
                })
            })
            .collect()
    }

    /// The connections by the names of their joints.
    fn connections(&self) -> Vec<Value> {
        let assembly = self.assembly;
        assembly
            .connections
            .iter()
            .map(|it| {
                json!({
                    "name": it.name,
                    "female": assembly.joint_name(it.female),
                    "male": assembly.joint_name(it.male),
                })
            })
            .collect()
    }

    /// The straight motions that insert the beams, in their order.
    fn insertions(&self) -> Vec<Value> {
        let assembly = self.assembly;
        let x_wa = assembly.kit.x_wa();
        assembly
            .insertions
            .iter()
            .map(|it| {
                let direction = x_wa.rotation * it.direction.into_inner();
                json!({
                    "beam": assembly.beams[it.beam].beam.name,
                    "direction_w": [direction.x, direction.y, direction.z],
                    "distance": it.distance,
                })
            })
            .collect()
    }

    /// The joints of the arm with their limits.
    fn joints(&self) -> Vec<Value> {
        self.arm
            .joints
            .iter()
            .map(|joint| {
                json!({
                    "position": joint.position,
                    "quat_wxyz": joint.quat_wxyz,
                    "range": joint.range,
                    "velocity": joint.velocity,
                    "acceleration": joint.acceleration,
                    "jerk": joint.jerk,
                    "torque": joint.torque,
                })
            })
            .collect()
    }
}

/// Dimensions of the parts, m.
fn dimensions() -> Value {
    json!({
        "female_height": joint::FEMALE_HEIGHT,
        "hole_radius": joint::HOLE_RADIUS,
        "peg_head_width": joint::HEAD_WIDTH,
        "peg_head_height": joint::HEAD_HEIGHT,
        "peg_stem_length": joint::STEM_LENGTH,
        "peg_stem_radius": joint::STEM_RADIUS,
    })
}

/// The region in which parts lie anywhere.
fn anywhere(scatter: &Scatter) -> Value {
    let range = |range: &Range| [range.from, range.to];
    json!({
        "area_x": range(&scatter.area_x),
        "area_y": range(&scatter.area_y),
        "ring": range(&scatter.ring),
        "jumble": scatter.jumble >= 0.5,
    })
}

fn camera(model: &CameraModel) -> Value {
    let (fixed_to, x) = match &model.mount {
        Mount::Tip(x_tc) => ("tip", x_tc),
        Mount::World(x_wc) => ("world", x_wc),
    };
    json!({
        "width": model.width,
        "height": model.height,
        "focal": model.focal,
        "centre": model.centre,
        "distortion": model.distortion,
        "fixed_to": fixed_to,
        "pose": pose(x),
    })
}
