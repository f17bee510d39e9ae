//! The classes of goals: three of the paper, and the sets of the open class.

use std::fmt;

/// The begin of the name of each open class.
const OPEN: &str = "open-";
/// The begin of the name of a set that an organiser holds back.
const HELD: &str = "held-";
/// Hexadecimal digits in the name of such a set.
const DIGITS: usize = 8;

/// A class of goals. Each set of the open class is a class of its own, so that results of two sets are
/// never put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Class {
    /// Square insertions and one cap.
    Easy,
    /// With one beam that passes through another, or one at an oblique angle.
    Medium,
    /// With several of both.
    Hard,
    /// A set of the open class.
    Open(OpenSet),
}

/// A set of the open class.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum OpenSet {
    /// The set of a seed.
    Seed(u64),
    /// The set of an organiser's secret: the first four bytes of the secret's commitment.
    Held(u32),
}

impl Class {
    /// The three classes of the nine goals, in order of difficulty.
    pub const ALL: [Class; 3] = [Class::Easy, Class::Medium, Class::Hard];

    /// The name in files, in results and on the command line: `easy`, `medium`, `hard`, `open-2026`,
    /// `open-held-3fa9c1d2`.
    pub fn name(self) -> String {
        self.to_string()
    }

    /// The class of this name.
    ///
    /// ```
    /// use ramp_assembly::{Class, OpenSet};
    /// assert_eq!(Class::of_name("open-2026"), Some(Class::Open(OpenSet::Seed(2026))));
    /// assert_eq!(Class::of_name("open-held-3fa9c1d2").unwrap().name(), "open-held-3fa9c1d2");
    /// assert_eq!(Class::of_name("open-02026"), None);
    /// ```
    pub fn of_name(name: &str) -> Option<Class> {
        let named = |class: &Class| class.name() == name;
        Class::ALL.into_iter().chain(Class::open(name)).find(named)
    }

    /// The set that a name may mean. Other spellings of a number are left to [`Class::of_name`].
    fn open(name: &str) -> Option<Class> {
        let set = name.strip_prefix(OPEN)?;
        Some(Class::Open(match set.strip_prefix(HELD) {
            Some(digits) => OpenSet::Held(u32::from_str_radix(digits, 16).ok()?),
            None => OpenSet::Seed(set.parse().ok()?),
        }))
    }

    /// The set of the open class that the goal of this name is in.
    ///
    /// ```
    /// # use ramp_assembly::Class;
    /// assert_eq!(Class::of_open_goal("open-2026-small-07"), Class::of_name("open-2026"));
    /// assert_eq!(Class::of_open_goal("open-2026"), None);
    /// ```
    pub fn of_open_goal(name: &str) -> Option<Class> {
        Size::of_goal_name(name)?;
        let (rest, _number) = name.rsplit_once('-')?;
        let (class, _size) = rest.rsplit_once('-')?;
        Class::of_name(class)
    }

    /// True for a set of the open class.
    pub fn is_open(self) -> bool {
        matches!(self, Class::Open(_))
    }
}

/// The sizes of the goals of the open class, by the number of beams.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Size {
    /// 3 or 4 beams.
    Small,
    /// 5 beams.
    Medium,
    /// 6 or 7 beams.
    Large,
}

impl Size {
    /// All three, the smallest first.
    pub const ALL: [Size; 3] = [Size::Small, Size::Medium, Size::Large];

    /// The name in names of goals.
    pub fn name(self) -> &'static str {
        match self {
            Size::Small => "small",
            Size::Medium => "medium",
            Size::Large => "large",
        }
    }

    /// Numbers of beams of a goal of this size, the clamped one included.
    pub fn beams(self) -> &'static [usize] {
        match self {
            Size::Small => &[3, 4],
            Size::Medium => &[5],
            Size::Large => &[6, 7],
        }
    }

    /// The size of the goal of the open class of this name, such as `open-2026-small-07`.
    pub fn of_goal_name(name: &str) -> Option<Size> {
        let (set, _number) = name.strip_prefix(OPEN)?.rsplit_once('-')?;
        let (_, size) = set.rsplit_once('-')?;
        Size::ALL.into_iter().find(|known| known.name() == size)
    }
}

impl fmt::Display for Class {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Class::Easy => f.write_str("easy"),
            Class::Medium => f.write_str("medium"),
            Class::Hard => f.write_str("hard"),
            Class::Open(OpenSet::Seed(seed)) => write!(f, "{OPEN}{seed}"),
            Class::Open(OpenSet::Held(bytes)) => write!(f, "{OPEN}{HELD}{bytes:0DIGITS$x}"),
        }
    }
}
