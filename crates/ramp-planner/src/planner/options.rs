//! What a caller may ask of the search.

/// How a plan is searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options {
    /// Prove that no plan has fewer coarse actions; takes much longer.
    pub optimal: bool,
    /// Look at no more of the goal at a time than what matters there.
    pub zoom: bool,
    /// Find the fine actions, too.
    pub fine: bool,
}

impl Default for Options {
    fn default() -> Options {
        Options { optimal: false, zoom: true, fine: true }
    }
}
