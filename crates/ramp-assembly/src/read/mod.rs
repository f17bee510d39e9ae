//! Reads a goal from XML: the form of the published goals, with a few optional additions.
//!
//! ```xml
//! <assembly name="easy-3" class="easy">
//!   <component beam="b7" base="True"/>
//!   <component beam="b4"/>
//!   <component beam="b8" flipped="True"/>
//!   <connection name="C1">
//!     <element component="b4" joint="b4j1"/>
//!     <element component="b7" joint="b7j1"/>
//!   </connection>
//!   …
//! </assembly>
//! ```
//!
//! Extensions of the published form are `name` and `class` on `<assembly>` (default: the stem of
//! the file, and its first word), and `yaw` on `<component>`: the direction of the beam in the
//! assembly frame, in degrees, where the connections leave it open and the default is wrong.
//!
//! `components` and `connections` read the elements, and `build` makes the assembly of them.

mod build;
mod components;
mod connections;
mod problem;

pub use problem::{GoalError, GoalProblem};

use self::build::{Draft, build};
use self::components::read_components;
use self::connections::{Pair, read_connections};
use self::problem::{Node, Result};
use crate::assembly::{Assembly, Class};
use ramp_kit::Kit;
use ramp_source::{Fault, FormProblem, SourceFile, is_name, parse_xml, shorten};
use std::path::Path;

/// Reads a goal file.
///
/// # Errors
/// The first defect of the goal, with line and column: in the file itself, the names in it, holes
/// that do not meet, beams that overlap, or no order that builds it.
pub fn read_goal(path: &Path, kit: &Kit) -> Result<Assembly> {
    read_goal_file(&SourceFile::read(path)?, kit)
}

/// Reads a goal from text; `name` is its name in messages.
///
/// ```
/// # let data = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data");
/// let kit = ramp_kit::read_kit(&data.join("kit.xml"))?;
/// let text = r#"<assembly>
///   <component beam="b7" base="True"/>
///   <component beam="b4"/>
///   <connection name="C1">
///     <element component="b4" joint="b4j1"/>
///     <element component="b7" joint="b7j1"/>
///   </connection>
/// </assembly>"#;
/// let goal = ramp_assembly::read_goal_str("corner.xml", text, &kit)?;
/// // b4 stands on the first hole of b7, at a right angle to it, and is pushed there towards the robot.
/// assert_eq!(goal.beams[1].x_ab.translation.x, 0.0);
/// assert_eq!(goal.insertions[0].direction.y, -1.0);
///
/// let error = ramp_assembly::read_goal_str("corner.xml", &text.replace("b7j1", "b7j3"), &kit);
/// assert!(error.is_ok(), "there is room for b4 in the middle too");
/// let error = ramp_assembly::read_goal_str("corner.xml", &text.replace("b7j1", "b7j9"), &kit).unwrap_err();
/// assert_eq!(format!("{error:#}"), "corner.xml:6:36: `b7` has no joint `b7j9` (did you mean `b7j1`?)");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// As [`read_goal`].
pub fn read_goal_str(name: &str, text: &str, kit: &Kit) -> Result<Assembly> {
    read_goal_file(&SourceFile::new(name, text), kit)
}

/// Reads a goal from a file whose text is in memory already.
///
/// # Errors
/// As [`read_goal`].
pub fn read_goal_file(file: &SourceFile, kit: &Kit) -> Result<Assembly> {
    let stem = Path::new(file.name()).file_stem().map(|stem| stem.to_string_lossy().into_owned());
    read(file, &stem.unwrap_or_default(), kit)
}

fn read(file: &SourceFile, stem: &str, kit: &Kit) -> Result<Assembly> {
    let document = parse_xml(file)?;
    let root = Node::root(&document, file, "assembly")?;
    root.check_attributes(&["name", "class"])?;
    let name = match root.optional("name") {
        Some(value) => value.name()?.to_string(),
        None if is_name(stem) => stem.to_string(),
        None => return Err(root.fault(FormProblem::FileName { found: shorten(stem) }.into())),
    };
    let class = match root.optional("class") {
        Some(value) => match Class::of_name(value.text()) {
            Some(class) => Some(class),
            None => {
                return Err(
                    value.bad_choice("easy, medium, hard or a set of the open class, such as open-2026")
                );
            }
        },
        None => Class::ALL.into_iter().find(|class| name.starts_with(&class.name())),
    };
    let (mut components, mut connections) = (Vec::new(), Vec::new());
    for child in root.children(&["component", "connection"])? {
        if child.tag() == "component" { components.push(child) } else { connections.push(child) }
    }
    let (components, base) = read_components(root, &components, kit)?;
    let pairs = read_connections(root, &connections, kit, &components)?;
    for (index, component) in components.iter().enumerate() {
        let used = |pair: &Pair| pair.connection.female.beam == index || pair.connection.male.beam == index;
        if !pairs.iter().any(used) {
            let beam = kit.beams[component.beam].name.clone();
            let place = file.place(component.span.clone());
            return Err(Fault::new(GoalProblem::NotConnected { beam }, place));
        }
    }
    if !kit.pegs.is_empty() && pairs.len() > kit.pegs.len() {
        let problem = GoalProblem::TooFewPegs { needed: pairs.len(), there: kit.pegs.len() };
        return Err(Fault::new(problem, file.place(pairs[kit.pegs.len()].span.clone())));
    }
    build(file, root, kit, Draft { name, class, components, base, pairs })
}
