//! Parts that touch as one of them falls asleep wake together.
//!
//! MuJoCo lets the parts of an island fall asleep together, by the contacts of the step before. A part that
//! comes to touch another one in the very step in which it falls asleep is in an island of its own. Later the
//! engine wakes one of the two alone, finds that it touches one that sleeps, and ends the whole program. So
//! the islands of parts that touch are joined, as if they had fallen asleep together.

use std::sync::Arc;

use mujoco_rs::mujoco_c::{mj_collision, mj_kinematics, mjModel, mjtEnableBit};
use mujoco_rs::prelude::*;

/// Joins the islands of sleeping parts that touch.
#[derive(Clone, Default)]
pub(crate) struct Couples {
    /// Of each tree: the next one of its island, or a negative number if it was awake before the step.
    before: Vec<i32>,
    /// The physics, in which contacts are looked for.
    copy: Option<MjData<Arc<MjModel>>>,
}

impl Couples {
    /// Before a step.
    pub fn begin(&mut self, data: &MjData<Arc<MjModel>>) {
        self.before.clear();
        self.before.extend_from_slice(data.tree_asleep());
    }

    /// After it: whether a part fell asleep in it.
    pub fn fell_asleep(&self, data: &MjData<Arc<MjModel>>) -> bool {
        self.before.iter().zip(data.tree_asleep()).any(|(before, now)| *before < 0 && *now >= 0)
    }

    /// Joins the islands of sleeping parts that touch. `view` is the data's model, as the engine is to see
    /// it.
    pub fn join(&mut self, data: &mut MjData<Arc<MjModel>>, mut view: mjModel) {
        let copy = self.copy.get_or_insert_with(|| data.clone());
        copy.qpos_mut().copy_from_slice(data.qpos());
        view.opt.enableflags &= !(mjtEnableBit::mjENBL_SLEEP as i32);
        #[expect(unsafe_code, reason = "the engine's own search takes no model but the data's")]
        // SAFETY: `view` is the data's model but for a flag and what can touch something. The engine keeps no
        // pointer to it.
        unsafe {
            mj_kinematics(&raw const view, copy.ffi_mut());
            mj_collision(&raw const view, copy.ffi_mut());
        }
        let model = copy.model();
        let tree = |geom: i32| {
            let body = *model.geom_bodyid().get(usize::try_from(geom).ok()?)?;
            usize::try_from(*model.body_treeid().get(usize::try_from(body).ok()?)?).ok()
        };
        let touching = copy.contact().iter().filter(|contact| contact.exclude == 0);
        for contact in touching {
            let Some((one, other)) = tree(contact.geom[0]).zip(tree(contact.geom[1])) else { continue };
            let asleep = data.tree_asleep();
            if asleep[one] >= 0 && asleep[other] >= 0 && !together(asleep, one, other) {
                #[expect(unsafe_code, reason = "the binding cannot know that cycles stay cycles")]
                // SAFETY: two cycles whose next ones are exchanged are one cycle of the same trees.
                unsafe { data.tree_asleep_mut() }.swap(one, other);
            }
        }
    }
}

/// Whether two trees are of one island: a cycle of next ones.
fn together(next: &[i32], one: usize, other: usize) -> bool {
    let mut tree = one;
    for _ in 0..next.len() {
        if tree == other {
            return true;
        }
        match next.get(tree).and_then(|next| usize::try_from(*next).ok()) {
            Some(following) if following != one => tree = following,
            _ => return false,
        }
    }
    false
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// Two cubes that sleep apart from each other, and are moved until they touch, are one island then.
    #[test]
    fn cubes_that_touch_as_they_fall_asleep_wake_together() {
        let cube = |x: f64| {
            format!(
                r#"<body pos="{x} 0 0.05"><freejoint/><geom type="box" size="0.05 0.05 0.05" mass="1"/></body>"#
            )
        };
        let scene = format!(
            r#"<mujoco><option><flag sleep="enable"/></option><worldbody><geom type="plane" size="1 1 1"/>{}{}</worldbody></mujoco>"#,
            cube(0.0),
            cube(0.2)
        );
        let mut data = MjData::new(Arc::new(MjModel::from_xml_string(&scene).unwrap()));
        let mut couples = Couples::default();
        while data.tree_asleep().iter().any(|next| *next < 0) {
            data.step();
        }
        assert!(!together(data.tree_asleep(), 0, 1));
        couples.begin(&data);
        data.qpos_mut()[7] = 0.0999;
        let view = data.model().ffi().clone();
        assert!(!couples.fell_asleep(&data));
        couples.before = vec![-1; 2];
        assert!(couples.fell_asleep(&data));
        couples.join(&mut data, view);
        assert!(together(data.tree_asleep(), 0, 1) && together(data.tree_asleep(), 1, 0));
    }
}
