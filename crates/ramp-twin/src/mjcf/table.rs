//! The head of the file, and the table with the sheet on it.

use super::classes::{FEET, HEAD_BOX, HEAD_GRIP, HOLE, OF_ARM, PLATE, REST, SOLID, STEM_ROD, TABLE};
use super::parts::{cone_mesh, nose_mesh};
use super::text::{CONTACT, grip, numbers, placed};
use crate::layout::x_table;
use crate::looks;
use ramp_kit::joint::STEM_RADIUS;
use ramp_kit::{Kit, Pose};
use ramp_world::Physics;
use ramp_world::groups::Parts;
use std::fmt::Write;

/// Half the side of the table, from the origin of W along X and Y, m.
pub(crate) const TABLE_SIDE: f64 = 2.0;
/// The engine's integrator, of MuJoCo 3.13 and newer.
pub(crate) const INTEGRATOR: &str = r#"integrator="discrete""#;
/// Parts that rest sleep, in MuJoCo 3.13 and newer.
pub(crate) const SLEEP: &str = r#"<flag sleep="enable"/>"#;
/// Smallest mass of a body, kg.
pub(crate) const LEAST_MASS: &str = r#"boundmass="1e-6""#;

/// Options, defaults, meshes and lights; `look` names the arm whose meshes are shown, `memory` is in MiB.
pub(super) fn header(xml: &mut String, look: &str, memory: u32, physics: &Physics, stems: Vec<(&str, f64)>) {
    let Parts { friction, metal_friction, peg_friction, table_friction, pad_friction, .. } = &physics.parts;
    let noslip = physics.engine.noslip.round();
    let grip = grip(physics.engine.grip_damping);
    let cones: String =
        stems.iter().map(|(name, radius)| cone_mesh(&format!("cone-{name}"), *radius)).collect();
    let _ = write!(
        xml,
        r#"<mujoco model="ramp">
<compiler angle="radian" autolimits="true" {LEAST_MASS}/>
<option timestep="0.001" {INTEGRATOR} cone="elliptic" impratio="10" noslip_iterations="{noslip}" iterations="100" tolerance="1e-8">{SLEEP}</option>
<size memory="{memory}M"/>
<visual><global offwidth="1280" offheight="800" fovy="40"/><headlight ambient="0.35 0.35 0.35" diffuse="0.4 0.4 0.4"/><map znear="0.005"/></visual>
<default>
<default class="part"><geom mass="0" friction="{friction} 0.005 0.0001" condim="3" {CONTACT} {SOLID} rgba="0.93 0.53 0.18 1"/></default>
<default class="plate"><geom mass="0" friction="{friction} 0.005 0.0001" condim="3" {CONTACT} {PLATE} group="4" rgba="0.93 0.53 0.18 1"/></default>
<default class="hole"><geom mass="0" friction="{friction} 0.005 0.0001" condim="3" {CONTACT} {HOLE} rgba="0.93 0.53 0.18 1"/></default>
<default class="metal"><geom mass="0" friction="{metal_friction} 0.005 0.0001" condim="3" {CONTACT} {SOLID} rgba="0.78 0.80 0.83 1"/></default>
<default class="head"><geom mass="0" friction="{peg_friction} 0.005 0.0001" condim="3" {CONTACT} {HEAD_BOX} group="4" rgba="0.20 0.45 0.80 1"/></default>
<default class="grip"><geom mass="0" friction="{peg_friction} 0.005 0.0001" condim="3" {CONTACT} {HEAD_GRIP} rgba="0.20 0.45 0.80 1"/></default>
<default class="stem"><geom mass="0" friction="{peg_friction} 0.005 0.0001" condim="3" {CONTACT} {STEM_ROD} rgba="0.20 0.45 0.80 1"/></default>
<default class="feet"><geom mass="0" friction="{table_friction} 0.005 0.0001" condim="3" {CONTACT} {FEET} rgba="0.93 0.53 0.18 1"/></default>
<default class="rest"><geom mass="0" friction="{table_friction} 0.005 0.0001" condim="3" {CONTACT} {REST} group="4" rgba="1 0 0 0.2"/></default>
<default class="arm"><geom mass="0" {CONTACT} {OF_ARM} group="3" rgba="0.92 0.93 0.95 1"/></default>
<default class="tool"><geom mass="0" {CONTACT} {OF_ARM} rgba="0.30 0.31 0.34 1"/></default>
<default class="look"><geom type="mesh" mass="0" contype="0" conaffinity="0"/></default>
<default class="pad"><geom mass="0" friction="{pad_friction} 0.01 0.0005" condim="4" priority="1" {grip} {OF_ARM} rgba="0.18 0.19 0.21 1"/></default>
</default>
<asset>
<texture name="sky" type="skybox" builtin="gradient" rgb1="0.85 0.90 0.95" rgb2="0.55 0.62 0.70" width="256" height="256"/>
{}{}{cones}{}
</asset>
<worldbody>
<light pos="0.2 -0.8 2.2" dir="0.1 0.4 -1" directional="true" diffuse="0.55 0.55 0.55" specular="0.1 0.1 0.1"/>
<camera name="overview" fovy="36" pos="1.45 -1.0 0.95" xyaxes="0.6686 0.7436 0 -0.349 0.314 0.882"/>
"#,
        nose_mesh(),
        cone_mesh("cone", STEM_RADIUS),
        looks::assets(look),
    );
}

/// The table and the sheet.
pub(super) fn table(xml: &mut String, kit: &Kit, physics: &Physics) {
    let x_table = x_table(&physics.table);
    let place = if x_table == Pose::identity() { String::new() } else { placed(&x_table) + " " };
    let _ = writeln!(
        xml,
        r#"<geom name="table" type="plane" {place}size="{TABLE_SIDE} {TABLE_SIDE} 0.1" {TABLE} condim="3" friction="{} 0.005 0.0001" {CONTACT} rgba="0.62 0.60 0.57 1"/>"#,
        physics.parts.table_friction
    );
    let [width, height] = kit.sheet.size;
    let [x, y] = kit.sheet.corner;
    let _ = writeln!(
        xml,
        r#"<geom name="sheet" type="box" pos="{}" size="{}" contype="0" conaffinity="0" rgba="0.96 0.96 0.94 1"/>"#,
        numbers(&[x + width / 2.0, y - height / 2.0, 0.0001]),
        numbers(&[width / 2.0, height / 2.0, 0.0002]),
    );
}
