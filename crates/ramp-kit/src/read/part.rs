//! The joint types that a kit adds, and the four dimensions of its printed parts.

use super::measure::MM;
use super::problem::{KitError, KitProblem, Node, Result, Text};
use crate::dimensions::{Dimensions, MALE_TIP, STEM_RADIUS, WALL};
use crate::joint::{JointForm, JointType};
use std::ops::RangeInclusive;

/// Thickness of walls, mm: printable and strong enough.
const WALLS: RangeInclusive<f64> = 1.0..=6.0;
/// Gaps between parts, mm; without a gap no part fits into another.
const CLEARANCES: RangeInclusive<f64> = 0.05..=1.0;
/// Square extrusions, mm.
const EXTRUSIONS: RangeInclusive<f64> = 15.0..=30.0;
/// Peg holes, mm: around the stem, and within the head.
const HOLES: RangeInclusive<f64> = 2e3 * STEM_RADIUS + 0.1..=12.0;
/// From a hole to the floor of a socket, or to the end of a cavity, mm.
const REACH: RangeInclusive<f64> = 1.0..=200.0;
/// The angle of a bent male end, degrees.
const TURNS: RangeInclusive<f64> = -60.0..=60.0;
/// Smallest angle of a bent male end, degrees.
const LEAST_TURN: f64 = 5.0;

/// The four dimensions; the default is the benchmark's.
pub(super) fn read_dimensions(node: Node<'_>) -> Result<Dimensions> {
    node.check_attributes(&["wall", "clearance", "extrusion", "hole"])?;
    let number = |attribute, range: RangeInclusive<f64>, nominal: f64| match node.optional(attribute) {
        Some(value) => Ok(value.number(range, "mm")? * MM),
        None => Ok::<f64, KitError>(nominal),
    };
    let nominal = Dimensions::BENCHMARK;
    Ok(Dimensions {
        wall: number("wall", WALLS, nominal.wall)?,
        clearance: number("clearance", CLEARANCES, nominal.clearance)?,
        extrusion: number("extrusion", EXTRUSIONS, nominal.extrusion)?,
        peg_hole: number("hole", HOLES, nominal.peg_hole)?,
    })
}

/// A joint type added by the kit.
pub(super) fn read_part(node: Node<'_>) -> Result<JointType> {
    node.check_attributes(&["name", "mates", "place", "socket", "cavity", "open", "feet", "turn"])?;
    let value = node.required("name")?;
    let name = value.name()?;
    let choice = |attribute, yes: &str, no: &str, expected| {
        let value = node.required(attribute)?;
        if value.text() == yes || value.text() == no {
            return Ok(value.text() == yes);
        }
        Err(value.bad_choice(expected))
    };
    let bad = |at: &Text<'_>, why: &str| {
        Err(at.fault(KitProblem::BadPart { part: name.to_string(), why: why.to_string() }))
    };
    let male = choice("mates", "male", "female", "male or female")?;
    let end = choice("place", "end", "middle", "end or middle")?;
    for (attribute, allowed, why) in [
        ("cavity", !male, "only a female has a cavity"),
        ("open", !male, "only a female has an opening"),
        ("feet", male && end, "only a male end has feet"),
        ("turn", male && end, "only a male end can be turned"),
    ] {
        if let Some(value) = node.optional(attribute).filter(|_| !allowed) {
            return bad(&value, why);
        }
    }
    let one_sided = !male && choice("open", "one", "both", "one or both")?;
    let cavity = if male { 0.0 } else { node.required("cavity")?.number(REACH, "mm")? * MM };
    let feet = node.optional("feet").map_or(Ok(false), |value| value.flag())?;
    let turn = match node.optional("turn") {
        None => 0.0,
        Some(value) => {
            let degrees = value.number(TURNS, "degrees")?;
            if degrees.abs() < LEAST_TURN {
                return bad(&value, "the turn of a male end is at least 5°");
            }
            degrees.to_radians()
        }
    };
    let value = node.required("socket")?;
    let socket_offset = value.number(REACH, "mm")? * MM;
    let form = JointForm { name: "", male, end, one_sided, socket_offset, cavity, feet, turn };
    let body = Dimensions::BENCHMARK.body();
    if !male && form.entry_angle(body) <= 0.0 {
        return bad(&node.required("cavity")?, "a male of 26.6 mm does not go into its cavity");
    }
    let least = if male { form.least_socket_offset().max(MALE_TIP - WALL) } else { cavity + WALL };
    if socket_offset < least - 1e-9 {
        let why = format!("its socket needs to be {:.2} mm or more from the hole", least / MM);
        return bad(&value, &why);
    }
    Ok(JointType::added(name, form))
}
