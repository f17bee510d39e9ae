//! Action execution: the baseline agent (section IV-B).
