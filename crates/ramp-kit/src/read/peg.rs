//! A peg in a slot of its holder.

use super::names::Names;
use super::problem::{KitProblem, Node, Result};
use crate::beam::{Holder, Peg};
use ramp_source::{nearest, shorten};
use std::collections::HashMap;
use std::ops::Range;

pub(super) fn read_peg(
    node: Node<'_>,
    holders: &[Holder],
    names: &mut Names,
    slots: &mut HashMap<(String, i32), Range<usize>>,
) -> Result<Peg> {
    node.check_attributes(&["name", "marker", "holder", "slot"])?;
    let name = names.take(&node.required("name")?)?;
    let tag = names.take_tag(&node.required("marker")?)?;
    let holder = node.required("holder")?;
    if !holders.iter().any(|known| known.name == holder.text()) {
        let near = nearest(holder.text(), holders.iter().map(|known| known.name.as_str()));
        let found = shorten(holder.text());
        return Err(holder.fault(KitProblem::UnknownHolder { found, nearest: near.map(str::to_string) }));
    }
    let value = node.required("slot")?;
    let slot = i32::try_from(value.integer(-1..=1)?).unwrap_or_default();
    if let Some(first) = slots.insert((holder.text().to_string(), slot), value.span()) {
        let problem = KitProblem::SlotTaken { holder: holder.text().to_string(), slot };
        return Err(value.fault(problem).also(first, "by this one"));
    }
    Ok(Peg { name, tag, holder: holder.text().to_string(), slot })
}
