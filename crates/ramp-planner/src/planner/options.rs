//! Options of the search.

/// Options of the search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Prove that no plan has fewer coarse actions; takes much longer.
    pub optimal: bool,
    /// Plan each task on the part of the goal around it.
    pub zoom: bool,
    /// Find the fine actions too.
    pub fine: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options { optimal: false, zoom: true, fine: true }
    }
}
