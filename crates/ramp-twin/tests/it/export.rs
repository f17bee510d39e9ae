//! The scene for other programs: its cameras, and its form for an older MuJoCo.

use mujoco_rs::prelude::*;
use mujoco_rs::wrappers::mj_model::MjtObjBase;
use nalgebra::{Matrix3, Vector3};
use ramp_robot::{Camera, Robot, Track};
use ramp_testing::GoalFiles;
use ramp_twin::ForMujoco;

#[test]
fn an_exported_scene_has_the_twins_cameras() {
    let twin = GoalFiles::new("easy-1").twin(Track::State, 2);
    let x_wt = twin.observe().x_wt;
    for version in [ForMujoco::Newest, ForMujoco::V3_3] {
        let model = MjModel::from_xml_string(&twin.export(version, &[])).unwrap();
        let mut data = MjData::new(&model);
        data.qpos_mut().copy_from_slice(twin.qpos());
        data.forward();
        for camera in Camera::ALL {
            let id = model.name_to_id(MjtObjBase::mjOBJ_CAMERA, camera.name()).unwrap();
            let known = twin.true_camera(camera);
            let x_wc = known.x_wc(&x_wt);
            let at = Vector3::from_column_slice(&data.cam_xpos()[id]);
            assert!((at - x_wc.translation.vector).norm() < 1e-3, "{camera:?}: {at}");
            // It looks along its own -z, and y is up in the image.
            let axes = Matrix3::from_row_slice(&data.cam_xmat()[id]);
            assert!((axes * -Vector3::z()).dot(&(x_wc.rotation * Vector3::z())) > 0.9999);
            assert!((axes * Vector3::x()).dot(&(x_wc.rotation * Vector3::x())) > 0.9999);
            let half = (400.0 / known.focal[1]).atan();
            assert!((model.cam_fovy()[id] - 2.0 * half.to_degrees()).abs() < 1e-9);
        }
    }
}

/// Words that MuJoCo 3.3 does not know are not in its scene.
#[test]
fn a_scene_for_an_older_version_has_no_newer_words() {
    let twin = GoalFiles::new("easy-1").twin(Track::State, 1);
    let newest = twin.export(ForMujoco::Newest, &[]);
    let older = twin.export(ForMujoco::V3_3, &[("start", twin.qpos())]);
    for word in ["integrator=\"discrete\"", "sleep"] {
        assert!(newest.contains(word) && !older.contains(word), "{word}");
    }
    assert!(older.contains("integrator=\"implicitfast\"") && older.contains("inertiafromgeom=\"false\""));
    assert!(older.contains("<key name=\"start\""));
}
