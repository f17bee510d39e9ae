//! A part of an assembly as an assembly of its own: what can be built while some of its beams are missing.

use crate::assembly::{Assembly, Connection, JointRef, PlacedBeam};
use crate::check::find_order;
use crate::paths::Paths;
use std::sync::Arc;

impl Assembly {
    /// The assembly of some of its beams alone: those of `keep`, which gets an index into `beams`, and the
    /// base, in the same order. Connections keep their names. `None` where no order of insertions builds it.
    ///
    /// ```
    /// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
    /// let whole = ramp_assembly::read_goal("../../data/goals/easy-3.xml".as_ref(), &kit)?;
    /// let last = whole.beams.len() - 1;
    /// let rest = whole.of_beams(|beam| beam != last).ok_or("it cannot be built")?;
    /// assert_eq!(rest.beams.len(), last);
    /// assert!(rest.connections.iter().all(|it| whole.connection_index(&it.name).is_some()));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn of_beams(&self, keep: impl Fn(usize) -> bool) -> Option<Assembly> {
        let kept: Vec<usize> =
            (0..self.beams.len()).filter(|beam| *beam == self.base || keep(*beam)).collect();
        let new = |old: usize| kept.iter().position(|beam| *beam == old);
        let side = |joint: JointRef| Some(JointRef { beam: new(joint.beam)?, ..joint });
        let connection = |it: &Connection| {
            let (female, male) = (side(it.female)?, side(it.male)?);
            Some(Connection { name: it.name.clone(), female, male })
        };
        let connections: Vec<Connection> = self.connections.iter().filter_map(connection).collect();
        let beams: Vec<PlacedBeam> = kept.iter().map(|beam| self.beams[*beam].clone()).collect();
        let base = new(self.base)?;
        let paths = Paths::new(&beams, base, &connections);
        let insertions = find_order(&beams, base, &connections, &paths).ok()?;
        let (name, class, kit) = (self.name.clone(), self.class, Arc::clone(&self.kit));
        Some(Assembly { name, class, kit, beams, base, connections, insertions, paths: Arc::new(paths) })
    }
}
