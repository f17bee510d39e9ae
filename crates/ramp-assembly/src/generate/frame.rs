//! Frames of any size: rails across, columns between them, for a kit that is extended as needed.
//!
//! A rail has its females at fixed positions along X; the first rail is the clamped beam. Columns
//! connect two rails. A slot that takes a column from below takes none from above, so columns are
//! offset like bricks. Some columns are two storeys long and pass through the rail between. Every
//! insertion path leads towards −Y, one rail after the other, so an order always exists.

use super::dice::Dice;
use super::goal_file::{goal_name, goal_xml};
use super::request::{GenerateError, Generated, Request};
use crate::assembly::Class;
use crate::read::read_goal_str;
use ramp_kit::joint::SOCKET_DEPTH;
use ramp_kit::{Beam, Joint, JointType, Kit, Link, Side};

/// Heights of storeys to choose from, m: between the holes of a column. The shortest has room for
/// its two ends and for the fingers between them.
const STOREYS: [f64; 6] = [0.140, 0.145, 0.150, 0.155, 0.160, 0.170];
/// Number of attempts per frame. Chosen so that a request rarely fails: at least nine attempts of
/// ten succeed.
const ATTEMPTS: usize = 20;
/// Distance of the slots that a wide rail has beyond the clamped beam's, m.
const BEYOND: f64 = 0.1262;

/// A slot of a rail, numbered from the left.
#[derive(Clone, Copy, PartialEq)]
enum Slot {
    Free,
    /// Holds the lower end of a column.
    Start,
    /// Holds the upper end of a column, or lets one pass.
    Taken,
}

struct Column {
    name: String,
    slot: usize,
    from: usize,
    to: usize,
}

struct Builder<'a> {
    kit: Kit,
    base: &'a Beam,
    /// Positions of the slots along X, m, and flags for those of the clamped beam.
    slots: Vec<f64>,
    base_slots: std::ops::Range<usize>,
    /// The state of each rail's slots; rail 0 is the clamped beam.
    rails: Vec<Vec<Slot>>,
    storeys: Vec<f64>,
    columns: Vec<Column>,
}

/// A frame of `request.beams` beams.
pub(crate) fn frame(
    kit: &Kit,
    base: usize,
    request: Request,
    dice: &mut Dice,
) -> Result<Generated, GenerateError> {
    let Request { beams: count, seed, class } = request;
    let not_found = GenerateError::NotFound { beams: count, seed, class };
    let base = &kit.beams[base];
    // Larger frames are wider, otherwise they would be towers.
    let wings = match count {
        0..=30 => 0,
        31..=70 => 2,
        _ => 4,
    };
    let holes = base.joints.iter().filter(|joint| !joint.kind.is_male()).map(|joint| joint.offset);
    let inner: Vec<f64> = holes.collect();
    let (Some(first), Some(last)) = (inner.first().copied(), inner.last().copied()) else {
        return Err(not_found);
    };
    let left = (1..=wings).rev().map(|k| first - f64::from(k) * BEYOND);
    let right = (1..=wings).map(|k| last + f64::from(k) * BEYOND);
    let slots: Vec<f64> = left.chain(inner.iter().copied()).chain(right).collect();
    let begin = wings as usize;
    let base_slots = begin..begin + inner.len();
    // The extended kit has no pegs: no lab has printed that many.
    let kit = Kit { pegs: Vec::new(), holders: Vec::new(), ..kit.clone() };
    for _ in 0..ATTEMPTS {
        let mut builder = Builder {
            kit: kit.clone(),
            base,
            slots: slots.clone(),
            base_slots: base_slots.clone(),
            rails: Vec::new(),
            storeys: Vec::new(),
            columns: Vec::new(),
        };
        if builder.fill(count, class, dice)
            && let Some(made) = builder.finish(request, dice)
        {
            return Ok(made);
        }
    }
    Err(not_found)
}

impl Builder<'_> {
    fn count(&self) -> usize {
        self.rails.len() + self.columns.len()
    }

    /// Adds columns and rails until there are `count` beams; `false` when the top rail has no slot
    /// for the last ones.
    fn fill(&mut self, count: usize, class: Option<Class>, dice: &mut Dice) -> bool {
        // Number of columns that may pass through a rail.
        let mut passing = match class {
            Some(Class::Easy) => 0,
            Some(Class::Medium) => 1,
            Some(Class::Hard | Class::Open(_)) | None => usize::MAX,
        };
        let base: Vec<Slot> = (0..self.slots.len())
            .map(|slot| if self.base_slots.contains(&slot) { Slot::Free } else { Slot::Taken })
            .collect();
        self.rails.push(base);
        while self.count() < count {
            let rail = self.rails.len() - 1;
            self.storeys.push(*dice.choose(&STOREYS).unwrap_or(&STOREYS[0]));
            let left = count - self.count();
            let mut above = vec![Slot::Free; self.slots.len()];
            for column in self.columns.iter().filter(|column| column.to == rail + 1) {
                above[column.slot] = Slot::Taken;
            }
            // Columns on the free slots of the top rail; at least two, because a rail needs two
            // supports.
            let free: Vec<usize> =
                (0..self.slots.len()).filter(|&slot| self.rails[rail][slot] == Slot::Free).collect();
            if free.is_empty() && left <= 2 {
                return false;
            }
            let mut chosen: Vec<usize> = free.iter().copied().filter(|_| !dice.once_in(4)).collect();
            if chosen.len() + above.iter().filter(|slot| **slot == Slot::Taken).count() < 2 {
                chosen = free;
            }
            for slot in chosen {
                // Room for the next rail; one or two remaining beams become columns without a rail.
                if self.count() + usize::from(left > 2) >= count {
                    break;
                }
                let middle = slot > 0 && slot + 1 < self.slots.len() && above[slot] == Slot::Free;
                let hard = class == Some(Class::Hard) && self.columns.iter().all(|c| c.to - c.from == 1);
                let long = passing > 0 && middle && (hard || dice.once_in(6));
                let to = if long { rail + 2 } else { rail + 1 };
                passing -= usize::from(long);
                above[slot] = Slot::Taken;
                self.rails[rail][slot] = Slot::Start;
                let name = format!("c{}", self.columns.len() + 1);
                self.columns.push(Column { name, slot, from: rail, to });
            }
            if left > 2 {
                self.rails.push(above);
            }
        }
        // Columns may extend above the top rail.
        while self.storeys.len() <= self.rails.len() {
            self.storeys.push(STOREYS[0]);
        }
        true
    }

    /// A rail: females at every slot. It takes columns from below; a female where a column starts
    /// is open upwards.
    fn rail(&self, number: usize, dice: &mut Dice) -> Beam {
        let name = format!("r{number}");
        let last = self.slots.len() - 1;
        let mut joints = Vec::new();
        for (slot, at) in self.slots.iter().enumerate() {
            let end = slot == 0 || slot == last;
            let kind = if end {
                JointType::InFEnd
            } else if self.roomy(slot) && dice.once_in(3) {
                JointType::AngleF
            } else {
                JointType::ThruF
            };
            let up = self.rails[number][slot] != Slot::Taken;
            let opens = end.then_some(if up { Side::Left } else { Side::Right });
            let name = format!("{name}j{}", slot + 1);
            joints.push(Joint { name, kind, offset: at - self.slots[0], opens, tag: None });
        }
        beam(name, joints)
    }

    /// Whether a long female fits between the neighbouring slots, whatever their type.
    fn roomy(&self, slot: usize) -> bool {
        let apart = |a: usize, b: usize| self.slots[b] - self.slots[a];
        let least = 2.0 * (JointType::AngleF.socket_offset() + SOCKET_DEPTH);
        apart(slot - 1, slot) > least && apart(slot, slot + 1) > least
    }

    /// A column between two rails. A column on feet keeps its height while its free end waits for
    /// the next rail. A column that passes through a rail has no feet, which could not pass, but a
    /// male in its middle and two supporting rails.
    fn column(&self, column: &Column) -> Beam {
        let height = |rail: usize| self.storeys[..rail].iter().sum::<f64>();
        let mut joints = Vec::new();
        for (index, rail) in (column.from..=column.to).enumerate() {
            let end = rail == column.from || rail == column.to;
            let kind = match (end, column.to - column.from) {
                (false, _) => JointType::ThruM,
                (true, 1) => JointType::InMEndFeet,
                (true, _) => JointType::InMEnd,
            };
            let name = format!("{}j{}", column.name, index + 1);
            let offset = height(rail) - height(column.from);
            joints.push(Joint { name, kind, offset, opens: None, tag: None });
        }
        beam(column.name.clone(), joints)
    }

    fn finish(mut self, request: Request, dice: &mut Dice) -> Option<Generated> {
        let rails: Vec<Beam> = (1..self.rails.len()).map(|number| self.rail(number, dice)).collect();
        let columns: Vec<Beam> = self.columns.iter().map(|column| self.column(column)).collect();
        let base_first = self.base_slots.start;
        // The joint of a rail at a slot, with its beam.
        let slot_joint = |rail: usize, slot: usize| -> Option<(&str, &str)> {
            let beam = if rail == 0 { self.base } else { rails.get(rail - 1)? };
            let index = if rail == 0 { slot.checked_sub(base_first)? } else { slot };
            let females = beam.joints.iter().filter(|joint| !joint.kind.is_male());
            Some((beam.name.as_str(), females.into_iter().nth(index)?.name.as_str()))
        };
        let mut pairs = Vec::new();
        for (column, beam) in self.columns.iter().zip(&columns) {
            for (joint, rail) in beam.joints.iter().zip(column.from..self.rails.len()) {
                pairs.push([(beam.name.as_str(), joint.name.as_str()), slot_joint(rail, column.slot)?]);
            }
        }
        let passes = |column: &&Column| column.to - column.from > 1 && column.from + 1 < self.rails.len();
        let through = self.columns.iter().filter(passes).count();
        let class = request.class.unwrap_or(match through {
            0 | 1 => Class::Medium,
            _ => Class::Hard,
        });
        let name = goal_name(class, request);
        // In an order that can be built: a rail's columns, then the rail on them.
        let mut components = vec![(self.base.name.as_str(), false, None)];
        for rail in 1..=self.rails.len() {
            let on = self.columns.iter().zip(&columns).filter(|(column, _)| column.from + 1 == rail);
            components.extend(on.map(|(_, beam)| (beam.name.as_str(), false, None)));
            components.extend(rails.get(rail - 1).map(|beam| (beam.name.as_str(), false, None)));
        }
        let goal = goal_xml(&name, class, &components, &pairs);
        self.kit.beams.extend(rails.iter().chain(&columns).cloned());
        let about = format!("The kit for the goal {name}: as given, and a frame of {} beams.", request.beams);
        let kit = ramp_kit::kit_xml(&self.kit, &about);
        let read = ramp_kit::read_kit_str(&format!("{name}-kit.xml"), &kit).ok()?;
        let assembly = read_goal_str(&format!("{name}.xml"), &goal, &read).ok()?;
        Some(Generated { name, goal, kit: Some(kit), assembly })
    }
}

/// A beam from its joints; the links follow from the joints' positions.
fn beam(name: String, joints: Vec<Joint>) -> Beam {
    let link = |(index, pair): (usize, &[Joint])| {
        let (a, b) = (&pair[0], &pair[1]);
        let length = b.offset - a.offset - a.kind.socket_offset() - b.kind.socket_offset();
        let grasp = [a.offset + a.kind.top_cover(), b.offset - b.kind.top_cover()];
        Link { name: format!("{name}l{}", index + 1), length, grasp }
    };
    let links = joints.windows(2).enumerate().map(link).collect();
    Beam { links, joints, name, start: None }
}
