//! Versions of the files that an episode names. A shipped name belongs to the program: results under such a
//! name are combined only if their file has a hash from this list.

/// Every version, a line each: kind, name, SHA-256, day.
const VERSIONS: &str = include_str!("shipped.txt");

/// A kind of file that an episode names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A world: the physics are drawn from it.
    World,
    /// A start: the places of the parts are drawn from it.
    Start,
}

impl Kind {
    /// For a person, and in the list.
    pub fn name(self) -> &'static str {
        match self {
            Kind::World => "world",
            Kind::Start => "start",
        }
    }
}

/// Hashes of all versions of a shipped file, the oldest first. Empty for a name that was never shipped.
pub fn versions(kind: Kind, name: &str) -> impl Iterator<Item = &'static str> {
    let lines = VERSIONS.lines().filter(|line| !line.starts_with('#'));
    lines.filter_map(move |line| {
        let mut words = line.split_whitespace();
        let is_it = words.next() == Some(kind.name()) && words.next() == Some(name);
        words.next().filter(|_| is_it)
    })
}

/// Whether this file may have this name: the name was never shipped, or it was shipped with this hash.
pub fn may_be_named(kind: Kind, name: &str, sha256: &str) -> bool {
    let mut versions = versions(kind, name).peekable();
    versions.peek().is_none() || versions.any(|version| version == sha256)
}

#[cfg(test)]
mod tests {
    use ramp_world::{Start, World};

    use super::*;
    use crate::sha256;

    #[test]
    fn the_list_ends_with_the_files_of_this_program() {
        for name in World::names() {
            let world = World::shipped(name).unwrap();
            let last = versions(Kind::World, name).last();
            assert_eq!(
                last,
                Some(sha256(world.text.as_bytes()).as_str()),
                "world {name}: add it to shipped.txt"
            );
        }
        for name in Start::names() {
            let start = Start::shipped(name).unwrap();
            let last = versions(Kind::Start, name).last();
            assert_eq!(
                last,
                Some(sha256(start.text.as_bytes()).as_str()),
                "start {name}: add it to shipped.txt"
            );
        }
    }

    #[test]
    fn each_line_has_its_form() {
        let lines = VERSIONS.lines().filter(|line| !line.starts_with('#'));
        for line in lines {
            let words: Vec<&str> = line.split(' ').collect();
            let [kind, _, hash, day] = words[..] else { panic!("{line}") };
            assert!(
                [Kind::World, Kind::Start].map(Kind::name).contains(&kind)
                    && hash.len() == 64
                    && day.len() == 10,
                "{line}"
            );
            assert!(
                hash.bytes().all(|byte| byte.is_ascii_digit() || (b'a'..=b'f').contains(&byte)),
                "{line}"
            );
        }
    }

    #[test]
    fn a_shipped_name_needs_a_shipped_hash() {
        let earlier = versions(Kind::World, "real").next().unwrap();
        assert!(may_be_named(Kind::World, "real", earlier));
        assert!(!may_be_named(Kind::World, "real", &"0".repeat(64)));
        assert!(!may_be_named(Kind::World, "ideal", earlier));
        assert!(may_be_named(Kind::World, "mine", &"0".repeat(64)));
    }
}
