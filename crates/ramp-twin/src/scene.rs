//! The part of a twin that is built once and never changes: MuJoCo's model, the names and ids of its bodies,
//! and the physics that the episode drew from its world. Twins that were duplicated share one.

use std::collections::BTreeMap;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use ramp_assembly::{Penetration, Truth};
use ramp_render::looks::HOUSING;
use ramp_render::{Looks, Scene as Picture};
use ramp_robot::arm::ArmModel;
use ramp_robot::{DOF, Track};
use ramp_world::Physics;

use crate::cameras::Cameras;
use crate::clamp::Clamp;
use crate::engine::body_pose;
use crate::fault::Start;
use crate::joint_friction::JointFriction;
use crate::layout::Layout;
use crate::mjcf::{Printed, SceneOptions, scene_xml};
use crate::pieces;
use crate::setup::{Setup, TwinError};
use crate::touch::Pads;

/// Everything of a twin that does not change during an episode.
pub(crate) struct Scene {
    pub model: Arc<MjModel>,
    /// The model as MJCF.
    pub xml: String,
    pub arm: ArmModel,
    pub track: Track,
    /// Name and MuJoCo body of each beam and peg.
    pub parts: Vec<(String, usize)>,
    /// Name and MuJoCo body of each holder.
    pub holders: Vec<(String, usize)>,
    /// The holder in which each peg starts, by the peg's name.
    pub in_holder: BTreeMap<String, String>,
    /// The clamp of the base beam; `None` for one that gives nothing.
    pub clamp: Option<Clamp>,
    /// For each geom: does it belong to a beam, a peg or a holder?
    is_part: Vec<bool>,
    /// For each geom: the index in `parts` of the beam or peg to which it belongs.
    pub(crate) part_of: Vec<Option<usize>>,
    /// Bodies of the arm: its links, the hand and the fingers.
    pub arm_bodies: Vec<usize>,
    /// Site of the wrist sensor.
    pub wrist_site: usize,
    /// Bodies of the hand and of both fingers. The wrist sensor's reading does not contain their weight.
    pub hand_bodies: [usize; 3],
    /// The values that the episode drew from its world.
    pub physics: Physics,
    pub friction: JointFriction,
    /// Whether torques other than those of the motors act on the joints: friction, or a mass that the
    /// controller does not know.
    pub loaded: bool,
    pub cameras: Cameras,
    /// The pads with tactile sensors; `None` in a world without.
    pub pads: Option<Pads>,
}

impl Scene {
    /// Compiles the scene with every part at its place in `layout`, changed by the world's table and the
    /// fault's `start`.
    ///
    /// # Errors
    /// [`TwinError::Scene`] when MuJoCo refuses it, [`TwinError::Missing`] when a body or site is not in it.
    pub fn new(
        setup: &Setup,
        mut layout: Layout,
        options: &SceneOptions,
        start: &Start,
    ) -> Result<Scene, TwinError> {
        let physics = setup.world.draw(setup.seed);
        layout.tilt(&physics.table);
        layout.pegs.retain(|(name, _)| Some(name) != start.missing.as_ref());
        Scene::compile(setup, physics, layout, options, start)
    }

    /// Compiles the scene with every part exactly at its place in `layout`.
    ///
    /// # Errors
    /// As [`Scene::new`].
    pub fn compile(
        setup: &Setup,
        physics: Physics,
        layout: Layout,
        options: &SceneOptions,
        start: &Start,
    ) -> Result<Scene, TwinError> {
        let base = &setup.assembly.beams[setup.assembly.base].beam.name;
        let printed = Printed { physics: &physics, seed: setup.seed };
        let xml =
            scene_xml(&setup.assembly.kit, setup.arm, &layout, base, start.loose_holders, &printed, options);
        let model = MjModel::from_xml_string(&xml).map_err(|error| TwinError::Scene(error.to_string()))?;
        let find = |kind, name: &str| {
            model.name_to_id(kind, name).ok_or_else(|| TwinError::Missing(name.to_string()))
        };
        let body = |name: &str| find(MjtObjBase::mjOBJ_BODY, name);
        let named = |name: &String| Ok::<_, TwinError>((name.clone(), body(name)?));
        let parts = layout.beams.iter().chain(&layout.pegs).map(|(name, _)| named(name));
        let parts = parts.collect::<Result<Vec<_>, _>>()?;
        let holders = layout.holders.iter().map(|(name, _)| named(name)).collect::<Result<Vec<_>, _>>()?;
        let names = parts.iter().map(|(name, _)| name.clone()).collect();
        let part_bodies: Vec<usize> = parts.iter().chain(&holders).map(|(_, id)| *id).collect();
        let bodies = model.geom_bodyid().iter().map(|id| pieces::part_of(&model, *id as usize));
        let bodies: Vec<usize> = bodies.collect();
        let is_part = bodies.iter().map(|id| part_bodies.contains(id)).collect();
        let part_of = |id: &usize| parts.iter().position(|(_, body)| id == body);
        let part_of = bodies.iter().map(part_of).collect();
        let rigid = parts.iter().filter(|(name, _)| layout.rigid.contains(name)).map(|(_, id)| *id);
        let frame: Vec<usize> = std::iter::once(body(base)?).chain(rigid).collect();
        let clamp = Clamp::new(&model, &frame, physics.table.clamp_give);
        let pads = setup.world.has_touch().then(|| Pads::new(&model, setup.arm.finger.pads.len()));
        let covered = start.covered.as_ref().map(|(tag, _)| *tag);
        Ok(Scene {
            xml,
            arm: setup.arm.clone(),
            track: setup.track,
            parts,
            holders,
            in_holder: layout.in_holder,
            clamp,
            is_part,
            part_of,
            arm_bodies: arm_bodies(&model, body("link0")?),
            wrist_site: find(MjtObjBase::mjOBJ_SITE, "wrist")?,
            hand_bodies: [body("hand")?, body("finger1")?, body("finger2")?],
            friction: JointFriction::new(&physics.friction, &physics.arm),
            loaded: physics.friction.coulomb != [0.0; DOF] || physics.arm.unknown_mass != 0.0,
            cameras: Cameras::new(setup, names, covered, &physics),
            physics,
            pads: pads.transpose()?,
            model: Arc::new(model),
        })
    }

    /// The poses of all bodies that `looks` can draw. The housing of the wrist camera moves with the hand.
    pub fn picture(&self, data: &MjData<Arc<MjModel>>, looks: &Looks) -> Picture {
        let place = |(index, body): (usize, &Arc<ramp_render::looks::Body>)| {
            let name = if body.name == HOUSING { "hand" } else { &body.name };
            Some((index, body_pose(data, self.model.name_to_id(MjtObjBase::mjOBJ_BODY, name)?)))
        };
        Picture { bodies: looks.bodies().iter().enumerate().filter_map(place).collect() }
    }

    /// The true poses of all parts at this robot time (s).
    pub fn truth(&self, data: &MjData<Arc<MjModel>>, time: f64) -> Truth {
        Truth { time, x_wp: self.parts.iter().map(|(_, id)| body_pose(data, *id)).collect() }
    }

    /// Beams and pegs that are deeper in each other now than `least` (m), each pair once for each contact.
    pub fn penetrations(&self, data: &MjData<Arc<MjModel>>, least: f64) -> impl Iterator<Item = Penetration> {
        let part = |geom: i32| usize::try_from(geom).ok().and_then(|geom| *self.part_of.get(geom)?);
        data.contact().iter().filter(move |contact| -contact.dist > least).filter_map(move |contact| {
            let (one, other) = (part(contact.geom[0])?, part(contact.geom[1])?);
            Some(Penetration { parts: [one.min(other), one.max(other)], depth: -contact.dist })
        })
    }

    /// Deepest penetration between two parts (beams, pegs, holders) now, m; 0 without one.
    pub fn deepest_penetration(&self, data: &MjData<Arc<MjModel>>) -> f64 {
        let is_part = |geom: &i32| {
            usize::try_from(*geom).ok().and_then(|geom| self.is_part.get(geom)).copied() == Some(true)
        };
        let of_parts = data.contact().iter().filter(|contact| contact.geom.iter().all(is_part));
        of_parts.map(|contact| -contact.dist).fold(0.0, f64::max)
    }
}

impl Scene {
    /// The deepest contact of a beam or peg with anything now: the names of both, and its depth, m.
    pub fn deepest_contact(&self, data: &MjData<Arc<MjModel>>) -> Option<([String; 2], f64)> {
        let part = |geom: i32| usize::try_from(geom).ok().and_then(|geom| *self.part_of.get(geom)?);
        let with_part =
            data.contact().iter().filter(|contact| contact.geom.iter().any(|geom| part(*geom).is_some()));
        let deepest = with_part.min_by(|one, other| one.dist.total_cmp(&other.dist))?;
        let name = |geom: i32| match part(geom) {
            Some(index) => self.parts[index].0.clone(),
            None => {
                let body = usize::try_from(geom).ok().and_then(|geom| self.model.geom_bodyid().get(geom));
                let body = body.and_then(|body| usize::try_from(*body).ok()).filter(|body| *body > 0);
                let name = body.and_then(|body| self.model.id_to_name(MjtObjBase::mjOBJ_BODY, body));
                name.unwrap_or("the table").to_string()
            }
        };
        Some((deepest.geom.map(name), -deepest.dist))
    }
}

/// The body `base` and all bodies that hang on it.
fn arm_bodies(model: &MjModel, base: usize) -> Vec<usize> {
    let mut found = vec![base];
    // A body comes after the body on which it hangs.
    for (body, parent) in model.body_parentid().iter().enumerate().skip(1) {
        if usize::try_from(*parent).is_ok_and(|parent| found.contains(&parent)) {
            found.push(body);
        }
    }
    found
}
