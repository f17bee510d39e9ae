//! The geometric report on an assembly.

use super::order::find_order;
use super::solids::{Gap, Overlap, Solids};
use crate::assembly::{Assembly, Connection, Insertion};

/// The geometric report on an assembly.
#[derive(Clone, Debug, PartialEq)]
pub struct Report {
    /// Fit of each connection, in the order of the file.
    pub fits: Vec<Fit>,
    /// The smallest gap between two beams, and their indices, the smaller one first.
    pub smallest_gap: Option<Gap>,
    /// Beams that overlap.
    pub overlaps: Vec<Overlap>,
    /// An order of straight insertions that builds it; `None` when none exists.
    pub insertions: Option<Vec<Insertion>>,
}

/// Fit of a connection.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Distance between the two holes, m.
    pub residual: f64,
    /// The smallest gap between the two beams, m; 0 when they touch or overlap.
    pub gap: f64,
}

/// Computes the report anew from the assembly's poses and connections alone.
///
/// ```
/// # use std::path::Path;
/// # let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
/// let kit = ramp_kit::read_kit(&data.join("kit.xml"))?;
/// let goal = ramp_assembly::read_goal(&data.join("goals/easy-3.xml"), &kit)?;
/// let report = ramp_assembly::report(&goal);
/// assert!(report.fits.iter().all(|fit| fit.residual < 1e-6 && (fit.gap - 0.3e-3).abs() < 1e-6));
/// assert!(report.overlaps.is_empty());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn report(assembly: &Assembly) -> Report {
    let solids = Solids::new(&assembly.beams);
    let fit = |c: &Connection| Fit {
        residual: nalgebra::distance(&assembly.p_a_hole(c.male), &assembly.p_a_hole(c.female)),
        gap: solids.gap(c.male.beam, c.female.beam),
    };
    Report {
        fits: assembly.connections.iter().map(fit).collect(),
        smallest_gap: solids.smallest_gap(),
        overlaps: solids.overlaps(),
        insertions: find_order(&assembly.beams, assembly.base, &assembly.connections, &assembly.paths).ok(),
    }
}
