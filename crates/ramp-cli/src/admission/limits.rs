//! Limits on an entry.

/// Limits on an entry.
#[derive(Clone, Copy, Debug)]
pub struct EntryLimits {
    /// Number of files: ten times those of every goal on every track.
    pub files: usize,
    /// Size of all results together, bytes: ten times that of every goal on every track.
    pub results: u64,
    /// Size of all files together, bytes.
    pub total: u64,
}

/// The limits on every entry.
pub const LIMITS: EntryLimits = EntryLimits { files: 5_000, results: 64 << 20, total: 16 << 30 };
