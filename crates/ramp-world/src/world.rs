//! A world, and the numbers that an episode draws from it.

use std::fmt::Write;
use std::path::Path;
use std::sync::LazyLock;

use ramp_robot::random::Stream;
use ramp_source::{Fault, SourceFile, nearest, shorten};

use crate::groups::{GROUPS, Physics};
use crate::quantity::{Numbers, Quantity, Spread};
use crate::read::{Kind, Quantities, WorldFault, WorldProblem, read};

/// The worlds that are part of the program: their names and files.
const BUILT_IN: [(&str, &str); 3] = [
    ("ideal", include_str!("../../../data/worlds/ideal.toml")),
    ("real", include_str!("../../../data/worlds/real.toml")),
    ("hard", include_str!("../../../data/worlds/hard.toml")),
];

/// The file of a world.
const KIND: Kind = Kind { name: "world", groups: GROUPS, drawn: true };

/// A world: what an episode's physics are drawn from.
#[derive(Clone, Debug)]
pub struct World {
    /// Its name.
    pub name: String,
    /// Its description.
    pub about: String,
    /// Its file.
    pub text: String,
    quantities: Quantities,
}

/// Quantities that world files of earlier versions do not give, and what they have there: group, field, and
/// the value, for all of a list.
const ADDED: [(&str, &str, f64); 12] = [
    ("controller", "recovery", 0.0),
    ("sensing", "encoder_step", 0.0),
    ("sensing", "encoder_noise", 0.0),
    ("gripper", "width_step", 0.0),
    ("touch", "fitted", 0.0),
    ("touch", "force_noise", 0.1),
    ("touch", "force_drift", 0.1),
    ("touch", "drift_time", 60.0),
    ("touch", "range", 20.0),
    ("touch", "interval", 0.01),
    ("touch", "centre_noise", 0.0005),
    ("touch", "centre_force", 2.0),
];

/// End of the name of a world that differs from another one in that the fingers have tactile sensors.
const WITH_TOUCH: &str = "+touch";

/// The world files of the program, and each again with tactile sensors.
static SHIPPED: LazyLock<Vec<World>> = LazyLock::new(|| {
    // The files are part of the program, and a test reads them.
    let read = |(name, text): &(&str, &str)| {
        let file = SourceFile::new(&format!("data/worlds/{name}.toml"), text);
        match World::complete(&file) {
            Ok(world) => world,
            Err(fault) => panic!("{fault:#}"),
        }
    };
    let mut worlds: Vec<World> = BUILT_IN.iter().map(read).collect();
    let with_touch: Vec<World> = worlds.iter().map(World::with_touch).collect();
    worlds.extend(with_touch);
    worlds
});

impl World {
    /// The names of the worlds that are part of the program.
    pub fn names() -> impl Iterator<Item = &'static str> {
        SHIPPED.iter().map(|world| world.name.as_str())
    }

    /// The world of that name that is part of the program.
    pub fn shipped(name: &str) -> Option<&'static World> {
        SHIPPED.iter().find(|world| world.name == name)
    }

    /// The world of version 0.1: a perfect arm.
    pub fn ideal() -> &'static World {
        &SHIPPED[0]
    }

    /// Reads a world file.
    ///
    /// # Errors
    /// The first error in the file.
    pub fn read(path: &Path) -> Result<World, WorldFault> {
        World::from_source(&SourceFile::read(path)?)
    }

    /// As [`World::read`], for a file that is already in memory. A file that gives not all quantities names
    /// the world whose quantities hold for the others.
    ///
    /// ```
    /// use ramp_source::SourceFile;
    /// use ramp_world::World;
    ///
    /// let text = r#"
    /// name = "sticky"
    /// based_on = "real"
    /// [friction]
    /// coulomb = { value = 0.5, unit = "N·m", source = "measured on our arm" }
    /// "#;
    /// let world = World::from_source(&SourceFile::new("sticky.toml", text)).unwrap();
    /// assert_eq!(world.draw(1).friction.coulomb, [0.5; 7]);
    /// ```
    ///
    /// # Errors
    /// As [`World::read`].
    pub fn from_source(file: &SourceFile) -> Result<World, WorldFault> {
        let content = read(file, &KIND)?;
        let Some((base, span)) = content.based_on else { return World::complete(file) };
        let Some(base) = World::shipped(&base) else {
            let problem = WorldProblem::Unknown {
                place: "the program".to_string(),
                nearest: nearest(&base, World::names()).map(str::to_string),
                found: shorten(&base),
            };
            return Err(Fault::new(problem, file.place(span)));
        };
        let mut quantities = base.quantities.clone();
        quantities.extend(content.quantities);
        Ok(World { name: content.name, about: content.about, text: file.text().to_string(), quantities })
    }

    /// A world whose file gives all quantities, but for those of [`ADDED`].
    fn complete(file: &SourceFile) -> Result<World, WorldFault> {
        let mut content = read(file, &KIND)?;
        for (group, field, value) in ADDED {
            let source = "absent from the file".to_string();
            let absent = || Quantity { value: vec![value], spread: Spread::Fixed, source };
            content.quantities.entry((group, field)).or_insert_with(absent);
        }
        let all =
            GROUPS.iter().flat_map(|(group, _, fields)| fields.iter().map(move |field| (*group, field.name)));
        let mut lacking = all.filter(|key| !content.quantities.contains_key(key));
        if let Some((group, field)) = lacking.next() {
            let problem = WorldProblem::Lacking {
                place: "the world, which is based on no other,".to_string(),
                lacking: format!("{group}.{field}"),
            };
            return Err(Fault::new(problem, file.place(0..0)));
        }
        Ok(World {
            name: content.name,
            about: content.about,
            text: file.text().to_string(),
            quantities: content.quantities,
        })
    }

    /// Each quantity of the world, in the order of [`GROUPS`].
    pub fn quantities(
        &self,
    ) -> impl Iterator<Item = (&'static str, &'static crate::Field, &crate::Quantity)> {
        GROUPS.iter().flat_map(move |(group, _, fields)| {
            fields.iter().filter_map(move |field| {
                let quantity = self.quantities.get(&(*group, field.name))?;
                Some((*group, field, quantity))
            })
        })
    }

    /// The numbers of the episode with this seed, each as a list: group, field, numbers.
    pub fn numbers(&self, seed: u64) -> Vec<(&'static str, &'static str, Vec<f64>)> {
        self.quantities()
            .map(|(group, field, quantity)| {
                // Each quantity has its own stream, so that one that is added or changed leaves the others as
                // they were.
                let mut stream = Stream::new(seed, &format!("world-{group}-{}", field.name));
                (group, field.name, quantity.draw(field, &mut stream))
            })
            .collect()
    }

    /// The physics of the episode with this seed.
    pub fn draw(&self, seed: u64) -> Physics {
        let numbers: Numbers =
            self.numbers(seed).into_iter().map(|(group, field, numbers)| ((group, field), numbers)).collect();
        match Physics::from_numbers(&numbers) {
            Some(physics) => physics,
            // A world holds every quantity in its form: `complete` and `read` see to that.
            None => unreachable!("world {} is not complete", self.name),
        }
    }

    /// This world with one quantity fixed at a value: all numbers of a list. For sweeps.
    ///
    /// # Errors
    /// A message about the wrong name or value.
    pub fn with(&self, quantity: &str, value: f64) -> Result<World, String> {
        let known = || self.quantities().map(|(group, field, _)| format!("{group}.{}", field.name));
        let found = self
            .quantities()
            .find(|(group, field, _)| format!("{group}.{}", field.name) == quantity)
            .map(|(group, field, quantity)| (group, field, quantity.value.len()));
        let Some((group, field, length)) = found else {
            let names: Vec<String> = known().collect();
            let near = nearest(quantity, names.iter().map(String::as_str));
            let near = near.map_or(String::new(), |near| format!(" (did you mean `{near}`?)"));
            return Err(format!("a world has no `{}`{near}", shorten(quantity)));
        };
        if !(field.least..=field.most).contains(&value) {
            return Err(format!(
                "found {quantity} = {value}, expected a number from {} to {} {}",
                field.least, field.most, field.unit
            ));
        }
        let mut world = self.clone();
        let fixed = crate::Quantity {
            value: vec![value; length],
            spread: crate::Spread::Fixed,
            source: "a sweep".to_string(),
        };
        world.quantities.insert((group, field.name), fixed);
        world.name = format!("{}+{quantity}-{value}", self.name);
        world.text = world.to_toml();
        Ok(world)
    }

    /// This world with tactile sensors in the fingers.
    fn with_touch(&self) -> World {
        let mut world = self.clone();
        if let Some(fitted) = world.quantities.get_mut(&("touch", "fitted")) {
            *fitted = Quantity {
                value: vec![1.0],
                spread: Spread::Fixed,
                source: format!("world `{}`, with tactile sensors", self.name),
            };
        }
        world.name = format!("{}{WITH_TOUCH}", self.name);
        world.about = format!("World `{}` with tactile sensors in the fingers.", self.name);
        world.text = world.to_toml();
        world
    }

    /// Whether the fingers have tactile sensors in this world: in all of its episodes or in none.
    pub fn has_touch(&self) -> bool {
        self.quantities.get(&("touch", "fitted")).is_some_and(|fitted| fitted.value[0] >= 0.5)
    }

    /// The world as a file that gives all quantities.
    pub fn to_toml(&self) -> String {
        let quoted = |text: &str| toml_text(text);
        let mut text = format!("name = {}\n", quoted(&self.name));
        if !self.about.is_empty() {
            let _ = writeln!(text, "about = {}", quoted(&self.about));
        }
        let mut last = "";
        for (group, field, quantity) in self.quantities() {
            if group != last {
                let _ = writeln!(text, "\n[{group}]");
                last = group;
            }
            let numbers: Vec<String> = quantity.value.iter().map(|value| format!("{value:?}")).collect();
            let same = quantity.value.iter().all(|value| Some(value) == quantity.value.first());
            let value = if same { numbers[0].clone() } else { format!("[{}]", numbers.join(", ")) };
            let spread = match quantity.spread {
                Spread::Fixed => String::new(),
                Spread::Within(size) => format!(", within = {size:?}"),
                Spread::Share(size) => format!(", share = {size:?}"),
                Spread::Sigma(size) => format!(", sigma = {size:?}"),
            };
            let unit = if field.unit.is_empty() {
                String::new()
            } else {
                format!(", unit = {}", quoted(field.unit))
            };
            let source = quoted(&quantity.source);
            let _ = writeln!(text, "{} = {{ value = {value}{spread}{unit}, source = {source} }}", field.name);
        }
        text
    }
}

/// A text as TOML has it.
pub(crate) fn toml_text(text: &str) -> String {
    let mut quoted = String::from("\"");
    for letter in text.chars() {
        match letter {
            '"' | '\\' => quoted.extend(['\\', letter]),
            letter if letter.is_control() => {
                let _ = write!(quoted, "\\u{:04X}", u32::from(letter));
            }
            letter => quoted.push(letter),
        }
    }
    quoted.push('"');
    quoted
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    fn fault(text: &str) -> String {
        format!("{:#}", World::from_source(&SourceFile::new("mine.toml", text)).unwrap_err())
    }

    /// Every world of the program is complete, and says the same again as a file.
    #[test]
    fn shipped_worlds_hold_all_quantities() {
        for name in World::names() {
            let world = World::shipped(name).unwrap();
            let again = World::from_source(&SourceFile::new("again.toml", &world.to_toml())).unwrap();
            assert_eq!(again.numbers(7), world.numbers(7));
            assert_eq!(again.about, world.about);
        }
    }

    /// The file of a version that did not have the steps of the sensors or recoveries from a reflex is still
    /// a world, without them.
    #[test]
    fn a_file_without_a_later_quantity_is_read() {
        let real = World::shipped("real").unwrap();
        let mut group = "";
        let mut is_added = |line: &'static str| {
            group = if line.starts_with('[') { line.trim_matches(['[', ']']) } else { group };
            ADDED.iter().any(|(of, field, _)| *of == group && line.starts_with(field))
        };
        let earlier: String =
            real.text.lines().filter(|line| !is_added(line)).map(|line| format!("{line}\n")).collect();
        assert_eq!(earlier.lines().count() + ADDED.len(), real.text.lines().count());
        let world = World::from_source(&SourceFile::new("earlier.toml", &earlier)).unwrap();
        let (before, now) = (world.draw(3), real.draw(3));
        assert_eq!((before.sensing.encoder_step, before.gripper.width_step), (0.0, 0.0));
        assert!(before.controller.recovery == 0.0 && now.controller.recovery > 0.0);
        assert!(now.sensing.encoder_step > 0.0 && now.gripper.width_step > 0.0);
        assert_eq!((before.friction, before.parts), (now.friction, now.parts));
    }

    /// Nothing of the ideal world is drawn.
    #[test]
    fn the_ideal_world_is_the_same_in_every_episode() {
        assert_eq!(World::ideal().draw(1), World::ideal().draw(2));
        let real = World::shipped("real").unwrap();
        assert_ne!(real.draw(1), real.draw(2));
        assert_eq!(real.draw(1), real.draw(1));
    }

    /// A change of one quantity does not change the numbers drawn for the others.
    #[test]
    fn quantities_are_drawn_apart() {
        let real = World::shipped("real").unwrap();
        let swept = real.with("friction.coulomb", 0.7).unwrap();
        let (one, other) = (real.draw(3), swept.draw(3));
        assert_eq!(other.friction.coulomb, [0.7; 7]);
        assert_eq!((one.arm, one.sensing, one.table), (other.arm, other.sensing, other.table));
        let again = World::from_source(&SourceFile::new("again.toml", &swept.text)).unwrap();
        assert_eq!(again.draw(3), swept.draw(3));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_place() {
        let given = |line: &str| format!("name = \"mine\"\nbased_on = \"real\"\n[friction]\n{line}\n");
        for (text, expected) in [
            ("name = \"mine\"\n".to_string(), "mine.toml:1:1: the world, which is based on no other, lacks"),
            ("based_on = \"real\"\n".to_string(), "mine.toml:1:1: the world lacks `name`"),
            ("name = \"../x\"\n".to_string(), "mine.toml:1:8: found name = \"../x\", expected"),
            (
                "name = \"mine\"\nbased_on = \"reel\"\n".to_string(),
                "mine.toml:2:12: the program has no `reel` (did you mean `real`?)",
            ),
            (given("columb = 1"), "mine.toml:4:1: [friction] has no `columb` (did you mean `coulomb`?)"),
            (given("coulomb = 1"), "mine.toml:4:11: found coulomb = 1, expected a table"),
            (given("coulomb = { value = 1, source = \"x\" }"), "mine.toml:4:11: `coulomb` lacks `unit`"),
            (given("breakaway = { value = 1 }"), "mine.toml:4:13: `breakaway` lacks `source`"),
            (
                given("coulomb = { value = 99, unit = \"N·m\", source = \"x\" }"),
                "mine.toml:4:21: found coulomb = 99, expected a number, or a list of 7, from 0 to 20 N·m",
            ),
            (
                given("coulomb = { value = [1, 2], unit = \"N·m\", source = \"x\" }"),
                "mine.toml:4:21: found coulomb = [1, 2], expected",
            ),
            (
                given("coulomb = { value = 1, unit = \"Nm\", source = \"x\" }"),
                "mine.toml:4:31: found unit = \"Nm\", expected \"N·m\"",
            ),
            (
                given("breakaway = { value = 1, within = 1, share = 1, source = \"x\" }"),
                "mine.toml:4:35: found within = 1, expected one of",
            ),
            (given("breakaway = { value = nan, source = \"x\" }"), "mine.toml:4:23: found breakaway = nan"),
        ] {
            let found = fault(&text);
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
    }
}
