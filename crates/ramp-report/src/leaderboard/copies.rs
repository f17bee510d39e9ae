//! Detection of calls that an earlier entry has made, to the last bit.

use std::collections::HashMap;

/// The calls of one episode.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Stream {
    /// The track.
    pub track: String,
    /// The goal.
    pub goal: String,
    /// The seed.
    pub seed: u64,
    /// SHA-256 of the calls, in hex.
    pub calls: String,
}

/// An earlier entry with the same calls.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Copy {
    /// Its name.
    pub entry: String,
    /// Its agent.
    pub agent: String,
    /// Number of episodes with equal calls.
    pub episodes: usize,
}

/// The calls of all entries so far, with their first author.
#[derive(Debug, Default)]
pub struct Streams {
    /// Entry and agent.
    first: HashMap<Stream, (String, String)>,
}

impl Streams {
    /// Adds the calls of an entry. Returns the earlier entries with equal calls, by name.
    pub fn add(&mut self, entry: &str, agent: &str, streams: &[Stream]) -> Vec<Copy> {
        let mut copies: Vec<Copy> = Vec::new();
        for stream in streams {
            let (first, whose) =
                self.first.entry(stream.clone()).or_insert_with(|| (entry.to_string(), agent.to_string()));
            if first == entry {
                continue;
            }
            match copies.iter_mut().find(|copy| copy.entry == *first) {
                Some(copy) => copy.episodes += 1,
                None => {
                    copies.push(Copy { entry: first.clone(), agent: whose.clone(), episodes: 1 });
                }
            }
        }
        copies.sort_by(|a, b| a.entry.cmp(&b.entry));
        copies
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_later_one_names_the_earlier_one_and_not_itself() {
        let stream = |seed: u64, calls: &str| Stream {
            track: "tags".into(),
            goal: "easy-1".into(),
            seed,
            calls: calls.into(),
        };
        let mut streams = Streams::default();
        assert!(streams.add("a", "one 1", &[stream(1, "x"), stream(2, "y"), stream(2, "y")]).is_empty());
        let copies = streams.add("b", "two 1", &[stream(1, "x"), stream(2, "y"), stream(3, "y")]);
        assert_eq!(copies, [Copy { entry: "a".into(), agent: "one 1".into(), episodes: 2 }]);
        // Equal calls with another seed belong to another episode.
        assert!(streams.add("c", "three 1", &[stream(3, "x")]).is_empty());
    }
}
