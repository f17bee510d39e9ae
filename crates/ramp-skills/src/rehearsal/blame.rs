//! Turns a refused motion into a fact for the planner.

use ramp_planner::{Entry, Impossible, InTheWay, MotionFact};

use super::outline::Refusal;
use super::scene::Scene;

/// The fact that something is impossible, with the beam of the assembly that is in the way, if one is.
pub fn fact(scene: &Scene, cannot: Impossible, refusal: &Refusal) -> MotionFact {
    let past = refusal.touched.as_deref().and_then(|name| scene.assembly.beam_index(name));
    let past = past.filter(|beam| *beam != scene.assembly.base).map(|beam| {
        let name = scene.assembly.beams[beam].beam.name.clone();
        if scene.now.standing.contains(&beam) { InTheWay::Stands(name) } else { InTheWay::OnSheet(name) }
    });
    MotionFact { cannot, past, because: refusal.because.clone() }
}

/// The beam cannot be brought along its insertion path, whichever link holds it.
pub fn cannot_insert(entry: &Entry) -> Impossible {
    Impossible::Insert { beam: entry.beam.clone(), path: entry.path.clone() }
}
