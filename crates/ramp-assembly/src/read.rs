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
//! Ours are `name` and `class` on `<assembly>` (otherwise the stem of the file and what it begins with) and `yaw`
//! on `<component>`: the direction of the beam in the assembly frame, in degrees, where the connections leave it
//! open and the usual one is not meant.

use crate::assembly::{Assembly, Class, Connection, JointRef, PlacedBeam};
use crate::check::{self, MAX_BEAMS, Overlap, Solids};
use crate::pose::{self, Misfit, Piece, Planar};
use nalgebra::{Translation3, UnitQuaternion, Vector3};
use ramp_kit::joint::AXIS_HEIGHT;
use ramp_kit::source::{Element, Fault, FormProblem, Problem, SourceFile, nearest, parse_xml, shorten};
use ramp_kit::{Kit, Pose};
use std::collections::HashMap;
use std::ops::Range;
use std::path::Path;

/// What is wrong with a goal, and where.
pub type GoalError = Fault<GoalProblem>;

/// What can be wrong with a goal.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GoalProblem {
    /// The form of the file.
    #[error(transparent)]
    Form(#[from] FormProblem),
    /// A beam that the kit does not have.
    #[error("the kit has no beam `{found}`")]
    UnknownBeam {
        /// What the file has.
        found: String,
        /// The most similar beam.
        nearest: Option<String>,
    },
    /// A beam that stands in a connection but is no component.
    #[error("`{beam}` is no component of this goal")]
    NotDeclared {
        /// The beam.
        beam: String,
    },
    /// A component that stands in no connection.
    #[error("`{beam}` stands in no connection")]
    NotConnected {
        /// The beam.
        beam: String,
    },
    /// A component that no chain of connections joins with the base.
    #[error("no chain of connections leads from `{beam}` to the base `{base}`")]
    Loose {
        /// The beam.
        beam: String,
        /// The base.
        base: String,
    },
    /// A beam that is a component twice.
    #[error("`{beam}` is a component twice")]
    DuplicateBeam {
        /// The beam.
        beam: String,
    },
    /// More beams than the search for an order can take.
    #[error("this goal has {found} components, expected at most {MAX_BEAMS}")]
    TooManyBeams {
        /// How many it has.
        found: usize,
    },
    /// No component is the base.
    #[error("no component is the base")]
    NoBase,
    /// Two components are the base.
    #[error("`{first}` and `{second}` are both the base")]
    TwoBases {
        /// The first.
        first: String,
        /// The second.
        second: String,
    },
    /// The base is a beam that lies on the sheet.
    #[error("`{found}` is the base, but in the kit it lies on the sheet")]
    BaseNotClamped {
        /// The base.
        found: String,
        /// The beam that is clamped to the table.
        clamped: Option<String>,
    },
    /// A yaw on the base.
    #[error("the base has a yaw, but it is what yaws are measured from")]
    BaseYaw,
    /// No connections.
    #[error("this goal has no connections")]
    NoConnections,
    /// A connection that another one is named like.
    #[error("the connection `{name}` is there twice")]
    DuplicateConnection {
        /// The name.
        name: String,
    },
    /// Not two elements.
    #[error("the connection `{connection}` has {found} elements, expected 2")]
    Elements {
        /// The connection.
        connection: String,
        /// How many it has.
        found: usize,
    },
    /// A joint that the beam does not have.
    #[error("`{beam}` has no joint `{found}`")]
    UnknownJoint {
        /// What the file has.
        found: String,
        /// The beam.
        beam: String,
        /// The beam that has a joint of that name.
        owner: Option<String>,
        /// The most similar joint of the beam.
        nearest: Option<String>,
    },
    /// A beam joined with itself.
    #[error("the connection `{connection}` joins `{beam}` with itself")]
    SameBeam {
        /// The connection.
        connection: String,
        /// The beam.
        beam: String,
    },
    /// Two females or two males.
    #[error("the connection `{connection}` joins two {kind} joints, {first} and {second}")]
    SameKind {
        /// The connection.
        connection: String,
        /// `male` or `female`.
        kind: &'static str,
        /// The one joint, with its type.
        first: String,
        /// The other.
        second: String,
    },
    /// A joint in two connections.
    #[error("`{joint}` is used in `{first}` already")]
    JointTwice {
        /// The joint.
        joint: String,
        /// The connection that has it.
        first: String,
    },
    /// More connections than pegs.
    #[error("this goal needs {needed} pegs, and the kit has {there}")]
    TooFewPegs {
        /// One for each connection.
        needed: usize,
        /// How many there are.
        there: usize,
    },
    /// Holes that do not meet.
    #[error(
        "the holes of `{female}` and `{male}` are {distance:.2} mm apart where the other connections put them"
    )]
    HolesApart {
        /// The one joint.
        female: String,
        /// The other.
        male: String,
        /// In mm.
        distance: f64,
    },
    /// A male that enters a female at an angle that does not fit.
    #[error("`{male}` would enter `{female}` at {angle:.1}° from straight, expected at most {limit:.1}°")]
    Angle {
        /// The joint around.
        female: String,
        /// The joint inside.
        male: String,
        /// In degrees.
        angle: f64,
        /// In degrees.
        limit: f64,
    },
    /// The search for poses was given up.
    #[error("the beams of this goal can be placed in too many ways")]
    TooHard,
    /// Beams that reach into each other.
    #[error("`{first}` and `{second}` overlap by {depth:.2} mm")]
    Overlap {
        /// The one beam.
        first: String,
        /// The other.
        second: String,
        /// In mm.
        depth: f64,
        /// Where a joint that is open to one side only has its opening, when that may be the reason.
        opening: Option<String>,
    },
    /// No order of insertions.
    #[error("no order of straight insertions builds this goal: {}", stuck_words(beams))]
    Stuck {
        /// The beams that hold each other.
        beams: Vec<String>,
    },
}

fn stuck_words(beams: &[String]) -> String {
    match beams {
        [] => String::new(),
        [one] => format!("`{one}` cannot be moved to its place"),
        [most @ .., last] => {
            let most: Vec<String> = most.iter().map(|name| format!("`{name}`")).collect();
            format!("{} and `{last}` block each other", most.join(", "))
        }
    }
}

impl Problem for GoalProblem {
    fn label(&self) -> String {
        match self {
            GoalProblem::Form(form) => form.label(),
            GoalProblem::UnknownBeam { .. } => "unknown beam".into(),
            GoalProblem::NotDeclared { .. } => "not declared".into(),
            GoalProblem::NotConnected { .. } | GoalProblem::Loose { .. } => "not connected".into(),
            GoalProblem::DuplicateBeam { .. } | GoalProblem::DuplicateConnection { .. } => {
                "again here".into()
            }
            GoalProblem::TooManyBeams { .. } => "too many".into(),
            GoalProblem::NoBase => "expected one base=\"True\" in here".into(),
            GoalProblem::TwoBases { .. } => "the second base".into(),
            GoalProblem::BaseNotClamped { .. } => "not the clamped beam".into(),
            GoalProblem::BaseYaw => "expected no yaw".into(),
            GoalProblem::NoConnections => "expected a <connection>".into(),
            GoalProblem::Elements { .. } => "expected 2 elements".into(),
            GoalProblem::UnknownJoint { .. } => "unknown joint".into(),
            GoalProblem::SameBeam { .. } => "the same beam".into(),
            GoalProblem::SameKind { .. } => "expected one male and one female".into(),
            GoalProblem::JointTwice { .. } => "again here".into(),
            GoalProblem::TooFewPegs { .. } => "no peg is left for this one".into(),
            GoalProblem::HolesApart { .. } => "these do not meet".into(),
            GoalProblem::Angle { .. } => "these do not fit".into(),
            GoalProblem::TooHard => "expected fewer open beams".into(),
            GoalProblem::Overlap { .. } => "overlaps".into(),
            GoalProblem::Stuck { .. } => "cannot be built".into(),
        }
    }

    fn help(&self) -> Option<String> {
        match self {
            GoalProblem::Form(form) => form.help(),
            GoalProblem::UnknownBeam { nearest: Some(name), .. } => Some(format!("did you mean `{name}`?")),
            GoalProblem::UnknownJoint { owner: Some(owner), found, .. } => {
                Some(format!("`{found}` is a joint of `{owner}`"))
            }
            GoalProblem::UnknownJoint { nearest: Some(name), .. } => Some(format!("did you mean `{name}`?")),
            GoalProblem::NotDeclared { beam } => Some(format!("add <component beam=\"{beam}\"/>")),
            GoalProblem::Overlap { opening, .. } => opening.clone(),
            GoalProblem::BaseNotClamped { clamped: Some(beam), .. } => {
                Some(format!("the clamped beam is `{beam}`"))
            }
            _ => None,
        }
    }
}

type Result<T, E = GoalError> = std::result::Result<T, E>;
type Node<'a> = Element<'a, GoalProblem>;

/// Reads a goal file.
///
/// # Errors
/// Whatever is wrong with the goal first, with its line and column: the file itself, the names in it, holes that do
/// not meet, beams that overlap, or no way to build it.
pub fn read_goal(path: &Path, kit: &Kit) -> Result<Assembly> {
    let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    read(&SourceFile::read(path)?, &stem, kit)
}

/// Reads a goal from text; `name` is what messages call it.
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
    let stem =
        Path::new(name).file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
    read(&SourceFile::new(name, text), &stem, kit)
}

/// A component as it stands in the file.
struct Component {
    /// Index into the kit's beams.
    beam: usize,
    flipped: bool,
    yaw: Option<f64>,
    span: Range<usize>,
}

/// A connection as it stands in the file.
struct Pair {
    connection: Connection,
    span: Range<usize>,
}

fn read(file: &SourceFile, stem: &str, kit: &Kit) -> Result<Assembly> {
    let document = parse_xml(file)?;
    let root = Node::root(&document, file, "assembly")?;
    root.check_attributes(&["name", "class"])?;
    let name = match root.optional("name") {
        Some(value) => value.name()?.to_string(),
        None => shorten(stem),
    };
    let class = match root.optional("class") {
        Some(value) => match Class::ALL.into_iter().find(|class| class.name() == value.text()) {
            Some(class) => Some(class),
            None => return Err(value.bad_choice("easy, medium or hard")),
        },
        None => Class::ALL.into_iter().find(|class| name.starts_with(class.name())),
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

fn read_components(root: Node<'_>, nodes: &[Node<'_>], kit: &Kit) -> Result<(Vec<Component>, usize)> {
    let mut components: Vec<Component> = Vec::new();
    let mut base: Option<usize> = None;
    for node in nodes {
        node.check_attributes(&["beam", "base", "flipped", "yaw"])?;
        let value = node.required("beam")?;
        let Some(beam) = kit.beams.iter().position(|beam| beam.name == value.text()) else {
            let near = nearest(value.text(), kit.beams.iter().map(|beam| beam.name.as_str()));
            let found = shorten(value.text());
            return Err(value.fault(GoalProblem::UnknownBeam { found, nearest: near.map(str::to_string) }));
        };
        let beam_name = kit.beams[beam].name.clone();
        if let Some(first) = components.iter().find(|component| component.beam == beam) {
            let first = first.span.clone();
            let problem = GoalProblem::DuplicateBeam { beam: beam_name };
            return Err(value.fault(problem).also(first, "first here"));
        }
        let flipped = node.optional("flipped").map_or(Ok(false), |value| value.flag())?;
        let yaw = node.optional("yaw");
        let degrees = yaw.as_ref().map(|value| value.number(-360.0..=360.0, "degrees")).transpose()?;
        let is_base = node.optional("base").map_or(Ok(false), |value| value.flag())?;
        if is_base {
            if let Some(first) = base {
                let first = &components[first];
                let problem =
                    GoalProblem::TwoBases { first: kit.beams[first.beam].name.clone(), second: beam_name };
                return Err(node.fault(problem).also(first.span.clone(), "the first base"));
            }
            // Only a kit that says where its beams lie can say which one is clamped.
            if kit.beams[beam].start.is_some() {
                let clamped = kit.beams.iter().find(|beam| beam.start.is_none());
                let problem = GoalProblem::BaseNotClamped {
                    found: beam_name,
                    clamped: clamped.map(|beam| beam.name.clone()),
                };
                return Err(node.fault(problem));
            }
            if let Some(value) = yaw {
                return Err(value.fault(GoalProblem::BaseYaw));
            }
            base = Some(components.len());
        }
        components.push(Component { beam, flipped, yaw: degrees.map(f64::to_radians), span: node.span() });
    }
    if components.len() > MAX_BEAMS {
        return Err(nodes[MAX_BEAMS].fault(GoalProblem::TooManyBeams { found: components.len() }));
    }
    match base {
        Some(base) => Ok((components, base)),
        None => Err(root.fault(GoalProblem::NoBase)),
    }
}

fn read_connections(
    root: Node<'_>,
    nodes: &[Node<'_>],
    kit: &Kit,
    components: &[Component],
) -> Result<Vec<Pair>> {
    let mut pairs: Vec<Pair> = Vec::new();
    let mut names: HashMap<String, Range<usize>> = HashMap::new();
    let mut used: HashMap<JointRef, (String, Range<usize>)> = HashMap::new();
    for node in nodes {
        node.check_attributes(&["name"])?;
        let value = node.required("name")?;
        let name = value.name()?.to_string();
        if let Some(first) = names.insert(name.clone(), value.span()) {
            let problem = GoalProblem::DuplicateConnection { name };
            return Err(value.fault(problem).also(first, "first here"));
        }
        let elements = node.children(&["element"])?;
        let [first, second] = elements.as_slice() else {
            let problem = GoalProblem::Elements { connection: name, found: elements.len() };
            // The third is one too many; with fewer there is only the connection to point at.
            return Err(elements.get(2).unwrap_or(node).fault(problem));
        };
        let mut joints = Vec::new();
        for element in [first, second] {
            let joint = read_element(*element, kit, components)?;
            let value = element.required("joint")?;
            if let Some((first, at)) = used.insert(joint, (name.clone(), value.span())) {
                let problem = GoalProblem::JointTwice { joint: value.text().to_string(), first };
                return Err(value.fault(problem).also(at, "first here"));
            }
            joints.push(joint);
        }
        let (first_joint, second_joint) = (joints[0], joints[1]);
        let joint = |joint: JointRef| &kit.beams[components[joint.beam].beam].joints[joint.joint];
        if first_joint.beam == second_joint.beam {
            let beam = kit.beams[components[first_joint.beam].beam].name.clone();
            return Err(second.fault(GoalProblem::SameBeam { connection: name, beam }));
        }
        let (female, male) = match (joint(first_joint).kind.is_male(), joint(second_joint).kind.is_male()) {
            (false, true) => (first_joint, second_joint),
            (true, false) => (second_joint, first_joint),
            (both, _) => {
                let words = |at: JointRef| format!("`{}` ({})", joint(at).name, joint(at).kind.name());
                let problem = GoalProblem::SameKind {
                    connection: name,
                    kind: if both { "male" } else { "female" },
                    first: words(first_joint),
                    second: words(second_joint),
                };
                return Err(second.fault(problem).also(first.span(), "with this one"));
            }
        };
        pairs.push(Pair { connection: Connection { name, female, male }, span: node.span() });
    }
    if pairs.is_empty() {
        return Err(root.fault(GoalProblem::NoConnections));
    }
    Ok(pairs)
}

/// The joint that an element names.
fn read_element(node: Node<'_>, kit: &Kit, components: &[Component]) -> Result<JointRef> {
    node.check_attributes(&["component", "joint"])?;
    let value = node.required("component")?;
    let known = components.iter().position(|component| kit.beams[component.beam].name == value.text());
    let Some(beam) = known else {
        let found = shorten(value.text());
        if kit.beam(value.text()).is_some() {
            return Err(value.fault(GoalProblem::NotDeclared { beam: found }));
        }
        let names = components.iter().map(|component| kit.beams[component.beam].name.as_str());
        let nearest = nearest(value.text(), names).map(str::to_string);
        return Err(value.fault(GoalProblem::UnknownBeam { found, nearest }));
    };
    let value = node.required("joint")?;
    let own = &kit.beams[components[beam].beam];
    match own.joint_index(value.text()) {
        Some(joint) => Ok(JointRef { beam, joint }),
        None => {
            let owner = kit.beams.iter().find(|beam| beam.joint_index(value.text()).is_some());
            let near = nearest(value.text(), own.joints.iter().map(|joint| joint.name.as_str()));
            Err(value.fault(GoalProblem::UnknownJoint {
                found: shorten(value.text()),
                beam: own.name.clone(),
                owner: owner.map(|beam| beam.name.clone()),
                nearest: near.map(str::to_string),
            }))
        }
    }
}

/// A goal that has been read but not placed.
struct Draft {
    name: String,
    class: Option<Class>,
    components: Vec<Component>,
    base: usize,
    pairs: Vec<Pair>,
}

/// The pose of a beam in the assembly frame: flipped about its own axis first, then turned, at assembled height.
pub(crate) fn x_ab(pose: &Planar, flipped: bool) -> Pose {
    let roll = if flipped { std::f64::consts::PI } else { 0.0 };
    Pose::from_parts(
        Translation3::new(pose.at.x, pose.at.y, AXIS_HEIGHT),
        UnitQuaternion::from_axis_angle(&Vector3::z_axis(), pose.yaw)
            * UnitQuaternion::from_axis_angle(&Vector3::x_axis(), roll),
    )
}

fn build(file: &SourceFile, root: Node<'_>, kit: &Kit, draft: Draft) -> Result<Assembly> {
    let Draft { name, class, components, base, pairs } = draft;
    let pieces: Vec<Piece<'_>> = components
        .iter()
        .map(|c| Piece { beam: &kit.beams[c.beam], flipped: c.flipped, yaw: c.yaw })
        .collect();
    let connections: Vec<Connection> = pairs.iter().map(|pair| pair.connection.clone()).collect();
    let side = |joint: JointRef| (joint.beam, joint.joint);
    let ties: Vec<_> = connections.iter().map(|c| (side(c.female), side(c.male))).collect();
    let poses = pose::place(&pieces, base, &ties)
        .map_err(|misfit| explain(misfit, file, root, kit, &components, base, &pairs))?;
    let placed = |(component, pose): (&Component, &Planar)| PlacedBeam {
        beam: kit.beams[component.beam].clone(),
        flipped: component.flipped,
        x_ab: x_ab(pose, component.flipped),
    };
    let beams: Vec<PlacedBeam> = components.iter().zip(&poses).map(placed).collect();
    let beam_name = |index: usize| beams[index].beam.name.clone();
    if let Some(overlap) = Solids::new(&beams).overlaps().first() {
        let (first, second) = (&components[overlap.first], &components[overlap.second]);
        let problem = GoalProblem::Overlap {
            first: beam_name(overlap.first),
            second: beam_name(overlap.second),
            depth: overlap.depth * 1e3,
            opening: opening(overlap, &beams, &connections),
        };
        let fault = Fault::new(problem, file.place(second.span.clone()));
        return Err(fault.also(first.span.clone(), "with this one"));
    }
    let insertions = check::find_order(&beams, base, &connections).map_err(|stuck| {
        let problem = GoalProblem::Stuck { beams: stuck.beams.iter().map(|&beam| beam_name(beam)).collect() };
        let mut spans = stuck.beams.iter().map(|&beam| components[beam].span.clone());
        let place = spans.next().unwrap_or_else(|| root.span());
        spans.fold(Fault::new(problem, file.place(place)), |fault, span| fault.also(span, "with this one"))
    })?;
    Ok(Assembly { name, class, beams, base, connections, insertions })
}

/// What to look at when two connected beams overlap and the female is open to one side only.
fn opening(overlap: &Overlap, beams: &[PlacedBeam], connections: &[Connection]) -> Option<String> {
    let both = [overlap.first, overlap.second];
    let between = |c: &&Connection| both.contains(&c.female.beam) && both.contains(&c.male.beam);
    connections.iter().filter(between).find_map(|c| {
        let beam = &beams[c.female.beam].beam;
        let joint = &beam.joints[c.female.joint];
        let side = if joint.opens? == ramp_kit::Side::Left { "left" } else { "right" };
        Some(format!(
            "`{}` is open to the {side} of `{}` only: turn the beam with flipped=\"True\" or yaw=\"…\", or check \
             `opens` in the kit",
            joint.name, beam.name,
        ))
    })
}

/// A misfit in the words of the file.
fn explain(
    misfit: Misfit,
    file: &SourceFile,
    root: Node<'_>,
    kit: &Kit,
    components: &[Component],
    base: usize,
    pairs: &[Pair],
) -> GoalError {
    let beam_name = |index: usize| kit.beams[components[index].beam].name.clone();
    let joint_name =
        |joint: JointRef| kit.beams[components[joint.beam].beam].joints[joint.joint].name.clone();
    let sides = |connection: usize| {
        let Connection { female, male, .. } = &pairs[connection].connection;
        (joint_name(*female), joint_name(*male))
    };
    let at = |connection: usize| file.place(pairs[connection].span.clone());
    match misfit {
        Misfit::Apart { connection, distance } => {
            let (female, male) = sides(connection);
            let problem = GoalProblem::HolesApart { female, male, distance: distance * 1e3 };
            Fault::new(problem, at(connection))
        }
        Misfit::Angle { connection, angle, limit } => {
            let (female, male) = sides(connection);
            let (angle, limit) = (angle.to_degrees(), limit.to_degrees());
            Fault::new(GoalProblem::Angle { female, male, angle, limit }, at(connection))
        }
        Misfit::Loose { beam } => {
            let problem = GoalProblem::Loose { beam: beam_name(beam), base: beam_name(base) };
            Fault::new(problem, file.place(components[beam].span.clone()))
        }
        Misfit::TooHard => root.fault(GoalProblem::TooHard),
    }
}
