//! A start: where the parts lie when an episode begins, as a file of numbers. The twin draws the places of an
//! episode's parts from it.

use std::path::Path;
use std::sync::LazyLock;

use ramp_source::{Fault, SourceFile};

use crate::quantity::{Field, Numbers, Quantity, Range};
use crate::read::{Kind, Quantities, WorldFault, WorldProblem, read};

/// The starts that are part of the program: their names and files.
const BUILT_IN: [(&str, &str); 4] = [
    ("sheet", include_str!("../../../data/starts/sheet.toml")),
    ("moved", include_str!("../../../data/starts/moved.toml")),
    ("scattered", include_str!("../../../data/starts/scattered.toml")),
    ("jumbled", include_str!("../../../data/starts/jumbled.toml")),
];

quantities! {
    /// Places of the parts at the start.
    Places {
        /// Largest shift of a part or a holder from its outline, along each axis of the table.
        shift: f64 = "m", 0.0, 0.05;
        /// Largest turn of a part or a holder about the vertical.
        turn: f64 = "rad", 0.0, 0.5;
        /// Least distance of two parts. Places that are nearer to each other are drawn again.
        clearance: f64 = "m", 0.0, 0.05;
        /// 1: beams of one shape trade places, and so do pegs. 0: each part lies at its own outline.
        trade: f64 = "", 0.0, 1.0;
    }
}

quantities! {
    /// The region of the table in which parts lie anywhere, at any turn, instead of beside their outlines. A
    /// start gives all of these quantities or none.
    Scatter {
        /// Range of x in the world within which beams, holders and lying pegs lie with all of their length.
        area_x: Range = "m", -1.5, 1.5;
        /// The same along y of the world.
        area_y: Range = "m", -1.5, 1.5;
        /// Range of the distance of the middle of a beam or a holder from the axis of the arm's first joint.
        ring: Range = "m", 0.0, 1.5;
        /// Range of x in the world that no holder reaches into where it is in `frame_y`: the frame is to
        /// stand there. Beams lie there as well.
        frame_x: Range = "m", -1.5, 1.5;
        /// Range of y in the world that belongs to `frame_x`.
        frame_y: Range = "m", -1.5, 1.5;
        /// Least distance of a part from the clamped beam.
        clamped: f64 = "m", 0.0, 0.3;
        /// 1: beams lie on one another, and the pegs lie on the table. 0: beams lie flat on the table, and
        /// the pegs stand in their holders.
        jumble: f64 = "", 0.0, 1.0;
    }
}

/// The group that every start file has.
const PLACES: &str = "places";
/// The group of a start file whose parts lie anywhere.
const SCATTER: &str = "scatter";
/// The groups of a start file: name, description and quantities.
const GROUPS: &[(&str, &str, &[Field])] =
    &[(PLACES, Places::ABOUT, Places::FIELDS), (SCATTER, Scatter::ABOUT, Scatter::FIELDS)];
/// The file of a start.
const KIND: Kind = Kind { name: "start", groups: GROUPS, drawn: false };

/// A start: where the parts lie when an episode begins.
#[derive(Clone, Debug)]
pub struct Start {
    /// Its name.
    pub name: String,
    /// Its description.
    pub about: String,
    /// Its file.
    pub text: String,
    /// Its numbers.
    pub places: Places,
    /// The region in which its parts lie anywhere; `None` where they lie beside their outlines.
    pub scatter: Option<Scatter>,
    quantities: Quantities,
}

static SHIPPED: LazyLock<Vec<Start>> = LazyLock::new(|| {
    // The files are part of the program, and a test reads them.
    let read = |(name, text): &(&str, &str)| {
        let file = SourceFile::new(&format!("data/starts/{name}.toml"), text);
        match Start::from_source(&file) {
            Ok(start) => start,
            Err(fault) => panic!("{fault:#}"),
        }
    };
    BUILT_IN.iter().map(read).collect()
});

/// Each quantity that a start may give, with its group.
fn fields() -> impl Iterator<Item = (&'static str, &'static Field)> {
    GROUPS.iter().flat_map(|(group, _, fields)| fields.iter().map(move |field| (*group, field)))
}

impl Start {
    /// The names of the starts that are part of the program.
    pub fn names() -> impl Iterator<Item = &'static str> {
        BUILT_IN.iter().map(|(name, _)| *name)
    }

    /// The start of that name that is part of the program.
    pub fn shipped(name: &str) -> Option<&'static Start> {
        SHIPPED.iter().find(|start| start.name == name)
    }

    /// Every part on its own outline, as in the paper.
    pub fn sheet() -> &'static Start {
        &SHIPPED[0]
    }

    /// The benchmark's start: it takes eyes to build from it.
    pub fn moved() -> &'static Start {
        &SHIPPED[1]
    }

    /// Parts lie anywhere on the table: a build from it begins by clearing the place of the frame.
    pub fn scattered() -> &'static Start {
        &SHIPPED[2]
    }

    /// As [`Start::scattered`], with beams on one another, and pegs that lie.
    pub fn jumbled() -> &'static Start {
        &SHIPPED[3]
    }

    /// Reads a start file.
    ///
    /// # Errors
    /// The first error in the file.
    pub fn read(path: &Path) -> Result<Start, WorldFault> {
        Start::from_source(&SourceFile::read(path)?)
    }

    /// As [`Start::read`], for a file that is already in memory.
    ///
    /// ```
    /// use ramp_source::SourceFile;
    /// use ramp_world::Start;
    ///
    /// let text = r#"
    /// name = "wide"
    /// [places]
    /// shift = { value = 0.01, unit = "m", source = "our table" }
    /// turn = { value = 0.1, unit = "rad", source = "our table" }
    /// clearance = { value = 0.0, unit = "m", source = "our table" }
    /// trade = { value = 1, source = "our table" }
    /// "#;
    /// let start = Start::from_source(&SourceFile::new("wide.toml", text)).unwrap();
    /// assert_eq!(start.places.shift, 0.01);
    /// ```
    ///
    /// # Errors
    /// As [`Start::read`].
    pub fn from_source(file: &SourceFile) -> Result<Start, WorldFault> {
        let content = read(file, &KIND)?;
        let given =
            |group: &'static str, field: &Field| content.quantities.contains_key(&(group, field.name));
        let scattered = Scatter::FIELDS.iter().any(|field| given(SCATTER, field));
        let form = fields().filter(|(group, _)| *group == PLACES || scattered);
        if let Some((group, field)) = form.into_iter().find(|(group, field)| !given(group, field)) {
            let lacking = format!("{group}.{}", field.name);
            let problem = WorldProblem::Lacking { place: "the start".to_string(), lacking };
            return Err(Fault::new(problem, file.place(0..0)));
        }
        let quantities = content.quantities;
        let numbers: Numbers = quantities.iter().map(|(key, it)| (*key, it.value.clone())).collect();
        let Some(places) = Places::from_numbers(&numbers, PLACES) else {
            unreachable!("a start holds every quantity in its form: `read` sees to that");
        };
        Ok(Start {
            name: content.name,
            about: content.about,
            text: file.text().to_string(),
            places,
            scatter: Scatter::from_numbers(&numbers, SCATTER),
            quantities,
        })
    }

    /// Each quantity that a start may give, in the order of [`Places::FIELDS`] and [`Scatter::FIELDS`], with
    /// the start's own; `None` for one that it does not give.
    pub fn quantities(&self) -> impl Iterator<Item = (&'static Field, Option<&Quantity>)> {
        fields().map(|(group, field)| (field, self.quantities.get(&(group, field.name))))
    }

    /// Whether parts of one shape trade places.
    pub fn trades(&self) -> bool {
        self.places.trade >= 0.5
    }
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn shipped_starts_can_be_read() {
        for name in Start::names() {
            let start = Start::shipped(name).unwrap();
            assert_eq!(start.name, name);
            let given = start.quantities().filter(|(_, quantity)| quantity.is_some()).count();
            let scatter = if start.scatter.is_some() { Scatter::FIELDS.len() } else { 0 };
            assert_eq!(given, Places::FIELDS.len() + scatter);
        }
        assert!(Start::scattered().scatter.as_ref().is_some_and(|it| it.jumble == 0.0));
        assert!(Start::jumbled().scatter.as_ref().is_some_and(|it| it.jumble == 1.0));
        assert!(Start::moved().trades() && !Start::sheet().trades());
    }

    #[test]
    fn wrong_files_are_reported_with_their_place() {
        let scattered = |from: &str, to: &str| {
            let text = &Start::scattered().text;
            assert!(text.contains(from), "{from}");
            text.replace(from, to)
        };
        let reversed = scattered("ring = { value = [0.36, 0.64]", "ring = { value = [0.64, 0.36]");
        let single = scattered("ring = { value = [0.36, 0.64]", "ring = { value = 0.5");
        let lacking = scattered("jumble", "# jumble");
        for (text, expected) in [
            (
                reversed.as_str(),
                "mine.toml:13:18: found ring = [0.64, 0.36], expected a list of two, the smaller one first, \
                 from 0 to 1.5 m",
            ),
            (
                single.as_str(),
                "mine.toml:13:18: found ring = 0.5, expected a list of two, the smaller one first, from 0 to \
                 1.5 m",
            ),
            (lacking.as_str(), "mine.toml:1:1: the start lacks `scatter.jumble`"),
            ("name = \"mine\"\n", "mine.toml:1:1: the start lacks `places.shift`"),
            ("name = \"mine\"\nbased_on = \"moved\"\n", "mine.toml:2:1: a start has no `based_on`"),
            ("name = \"mine\"\n[placs]\n", "mine.toml:2:2: a start has no `placs` (did you mean `places`?)"),
            (
                "name = \"mine\"\n[places]\nshift = { value = 1, unit = \"m\", source = \"x\" }\n",
                "mine.toml:3:19: found shift = 1, expected a number from 0 to 0.05 m",
            ),
            (
                "name = \"mine\"\n[places]\nshift = { value = 0, within = 1, unit = \"m\", source = \"x\" }\n",
                "mine.toml:3:22: `shift` has no `within`",
            ),
        ] {
            let found = format!("{:#}", Start::from_source(&SourceFile::new("mine.toml", text)).unwrap_err());
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
    }
}
