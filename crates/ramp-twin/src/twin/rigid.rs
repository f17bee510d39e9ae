//! A twin whose standing frame is one rigid body.
//!
//! The parts of the frame are fixed where they are at that moment, so that the engine solves no contact
//! among them. What the twin knew and felt goes on.

use std::collections::BTreeSet;
use std::sync::Arc;

use mujoco_rs::prelude::*;
use ramp_robot::DOF;

use super::{Twin, Workspace};
use crate::engine::body_pose;
use crate::fault::Start;
use crate::layout::Layout;
use crate::mjcf::SceneOptions;
use crate::scene::Scene;
use crate::setup::{Setup, TwinError};

impl Twin {
    /// The same world, in which the parts `rigid` are one body with the clamped beam: where they are now, at
    /// rest. The clamp holds them all and gives by the forces on all of them. `setup` and `options` are those
    /// of this twin, without a fault.
    ///
    /// # Errors
    /// When MuJoCo refuses the scene.
    pub fn with_rigid(
        &self,
        setup: &Setup,
        rigid: BTreeSet<String>,
        options: &SceneOptions,
    ) -> Result<Twin, TwinError> {
        let here = |parts: &[(String, usize)]| {
            parts.iter().map(|(name, body)| (name.clone(), body_pose(&self.data, *body))).collect()
        };
        let is_beam = |(name, _): &&(String, usize)| setup.assembly.kit.beam(name).is_some();
        let beams: Vec<_> = self.scene.parts.iter().filter(is_beam).cloned().collect();
        let pegs: Vec<_> = self.scene.parts.iter().filter(|it| !is_beam(it)).cloned().collect();
        let layout = Layout {
            beams: here(&beams),
            holders: here(&self.scene.holders),
            pegs: here(&pegs),
            in_holder: self.scene.in_holder.clone(),
            unplaced: None,
            rigid,
        };
        let physics = self.scene.physics.clone();
        let scene = Scene::compile(setup, physics, layout, options, &Start::new(setup))?;
        let mut data = MjData::new(Arc::clone(&scene.model));
        // The arm and the fingers come first in both models.
        data.qpos_mut()[..DOF + 2].copy_from_slice(&self.data.qpos()[..DOF + 2]);
        data.qvel_mut()[..DOF + 2].copy_from_slice(&self.data.qvel()[..DOF + 2]);
        for ((_, from), (_, to)) in self.scene.parts.iter().zip(&scene.parts) {
            copy_free(&self.scene.model, &self.data, *from, &scene.model, &mut data, *to);
        }
        data.ctrl_mut().copy_from_slice(self.data.ctrl());
        data.qfrc_applied_mut()[..DOF].copy_from_slice(&self.data.qfrc_applied()[..DOF]);
        data.forward();
        let workspace = Workspace::new(&scene);
        Ok(Twin { scene: Arc::new(scene), data, state: self.state.clone(), workspace })
    }
}

/// Copies position and velocity of a part, if it is free in both models.
fn copy_free(
    model: &MjModel,
    data: &MjData<Arc<MjModel>>,
    body: usize,
    other_model: &MjModel,
    other: &mut MjData<Arc<MjModel>>,
    other_body: usize,
) {
    let joint = |model: &MjModel, body: usize| {
        let joint = usize::try_from(model.body_jntadr()[body]).ok()?;
        let position = usize::try_from(model.jnt_qposadr()[joint]).ok()?;
        Some((position, usize::try_from(model.jnt_dofadr()[joint]).ok()?))
    };
    let (Some((q, v)), Some((other_q, other_v))) = (joint(model, body), joint(other_model, other_body))
    else {
        return;
    };
    other.qpos_mut()[other_q..other_q + 7].copy_from_slice(&data.qpos()[q..q + 7]);
    other.qvel_mut()[other_v..other_v + 6].copy_from_slice(&data.qvel()[v..v + 6]);
}
