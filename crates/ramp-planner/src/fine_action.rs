//! The actions of the fine resolution: what skills execute. Each action is one entry of one table.
//!
//! An entry gives the name of the action in the rules and in a plan's JSON, and its fields in the order of
//! the rules. Each field has a [`Parameter`], which says how its value is read from an answer of the rules
//! and written as a term of them. So whoever adds an action adds an entry here, its words below, and a skill.

use crate::place::{Grasp, Item, Place, Target};
use serde::{Deserialize, Serialize};
use std::fmt::{self, Display};

/// How a field of an action stands in the rules.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Parameter {
    /// A place of the hand.
    Place,
    /// An item that is fetched.
    Item,
    /// The item in the hand.
    Held,
    /// A grasp of an item.
    Grasp,
    /// A beam, by name.
    Beam,
    /// A joint or a link of a beam, by name.
    Name,
    /// The joints of the action's beam that come to lie in sleeves. The rules do not name them.
    Sleeved,
    /// The joints of the action's beam that receive. The rules do not name them.
    Receiving,
    /// A connection, by its name in the goal.
    Connection,
    /// The female joint of the action's connection. The rules do not name it.
    Female,
    /// The male joint of the action's connection. The rules do not name it.
    Male,
    /// The peg for the action's connection. The rules do not name it.
    Peg,
}

/// The value of a field.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    Place(Place),
    Item(Item),
    Grasp(Grasp),
    Name(String),
    Names(Vec<String>),
}

macro_rules! values {
    ($($kind:ident: $ty:ty),*) => {
        $(
            impl From<$ty> for Value {
                fn from(value: $ty) -> Value {
                    Value::$kind(value)
                }
            }

            impl TryFrom<Value> for $ty {
                type Error = ();

                fn try_from(value: Value) -> Result<$ty, ()> {
                    match value {
                        Value::$kind(value) => Ok(value),
                        _ => Err(()),
                    }
                }
            }
        )*
    };
}

values!(Place: Place, Item: Item, Grasp: Grasp, Name: String, Names: Vec<String>);

/// Declares the actions: name of the kind, name in rules and JSON, fields with their parameter and type.
macro_rules! fine_actions {
    ($(
        $(#[$doc:meta])*
        $kind:ident = $name:literal { $($(#[$field_doc:meta])* $field:ident: $parameter:ident as $ty:ty,)* }
    )*) => {
        /// An action of the fine resolution: what a skill executes.
        #[derive(Clone, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
        #[serde(tag = "action")]
        pub enum FineAction {
            $($(#[$doc])* #[serde(rename = $name)] $kind { $($(#[$field_doc])* $field: $ty,)* },)*
        }

        /// A kind of fine action: [`FineAction`] without its fields. The key of a table of skills.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum ActionKind {
            $(#[doc = concat!("[`FineAction::", stringify!($kind), "`].")] $kind,)*
        }

        impl ActionKind {
            /// All kinds, in the order of the table.
            pub const ALL: &[ActionKind] = &[$(ActionKind::$kind),*];

            /// Its name, as in the rules and in a plan's JSON.
            pub fn name(self) -> &'static str {
                match self {
                    $(ActionKind::$kind => $name,)*
                }
            }

            /// How the fields stand in the rules.
            pub(crate) fn parameters(self) -> &'static [Parameter] {
                match self {
                    $(ActionKind::$kind => &[$(Parameter::$parameter),*],)*
                }
            }
        }

        impl FineAction {
            /// Its kind.
            pub fn kind(&self) -> ActionKind {
                match self {
                    $(FineAction::$kind { .. } => ActionKind::$kind,)*
                }
            }

            /// The action of a kind with these values of its fields; `None` where number or types of values
            /// do not fit.
            pub(crate) fn new(kind: ActionKind, values: Vec<Value>) -> Option<FineAction> {
                let mut values = values.into_iter();
                let action = match kind {
                    $(ActionKind::$kind => FineAction::$kind {
                        $($field: values.next()?.try_into().ok()?,)*
                    },)*
                };
                values.next().is_none().then_some(action)
            }

            /// The values of its fields.
            pub(crate) fn values(&self) -> Vec<Value> {
                match self {
                    $(FineAction::$kind { $($field),* } => vec![$($field.clone().into()),*],)*
                }
            }
        }
    };
}

fine_actions! {
    /// Move the hand, and the held part, along the graph of places.
    Move = "move" {
        /// The destination.
        to: Place as Place,
    }
    /// Grasp an item and lift it.
    PickUp = "pick_up" {
        /// The item.
        item: Item as Item,
        /// How.
        grasp: Grasp as Grasp,
    }
    /// Let go of the held item and retreat.
    PutDown = "put_down" {
        /// The held item.
        item: Held as Item,
    }
    /// Insert a joint of the held beam into a joint of the assembly.
    AssembleSquare = "assemble_square" {
        /// The held beam.
        beam: Beam as String,
        /// Its joint that enters or receives, for example `b4j1`.
        joint: Name as String,
    }
    /// Insert a joint of the held beam at an angle, along the beam's own axis.
    AssembleAngled = "assemble_angled" {
        /// The held beam.
        beam: Beam as String,
        /// Its joint that enters.
        joint: Name as String,
    }
    /// Slide the held beam through sleeves and insert its end.
    AssembleThrough = "assemble_through" {
        /// The held beam.
        beam: Beam as String,
        /// Its joint that enters in the end.
        joint: Name as String,
        /// Its joints that come to lie in sleeves, from j1 on.
        through: Sleeved as Vec<String>,
    }
    /// Insert the held beam deeper than its place; [`Plan::entries`](crate::Plan::entries) gives the depth.
    AssembleDeep = "assemble_deep" {
        /// The held beam.
        beam: Beam as String,
        /// Its joint that enters.
        joint: Name as String,
    }
    /// Cap: one or more joints of the assembly enter the held beam.
    AssembleCap = "assemble_cap" {
        /// The held beam.
        beam: Beam as String,
        /// Its joints that receive.
        joints: Receiving as Vec<String>,
    }
    /// Lay the held beam down at its place.
    LayDown = "lay_down" {
        /// The held beam.
        beam: Beam as String,
    }
    /// Grasp a beam that stands deeper than its place, lift it level, slide it forward to its place, let go.
    Slide = "slide" {
        /// The beam.
        beam: Beam as String,
        /// The link to hold it by.
        link: Name as String,
    }
    /// Set the held beam down on the way and hold it by another link.
    Regrasp = "regrasp" {
        /// The held beam.
        beam: Beam as String,
        /// The link to hold it by from now on.
        link: Name as String,
    }
    /// Pin two joints with the held peg, and let go of it.
    Fasten = "fasten" {
        /// The connection's name in the goal.
        connection: Connection as String,
        /// Its female joint.
        female: Female as String,
        /// Its male joint.
        male: Male as String,
        /// The held peg.
        peg: Peg as String,
    }
    /// Grasp a beam in the assembly, bring it to its nominal place, let go.
    Push = "push" {
        /// The beam.
        beam: Beam as String,
        /// The link to hold it by.
        link: Name as String,
    }
    /// Grasp a beam in the assembly, and draw it out to the start of its insertion path.
    TakeOut = "take_out" {
        /// The beam.
        beam: Beam as String,
        /// The link to hold it by.
        link: Name as String,
    }
    /// Grasp a peg by its head, and pull it out of its connection.
    PullOut = "pull_out" {
        /// The connection's name in the goal.
        connection: Connection as String,
        /// The peg.
        peg: Peg as String,
    }
    /// Grasp a beam in the assembly, slide it back deeper than its place, so that another can be drawn off,
    /// let go.
    SlideBack = "slide_back" {
        /// The beam.
        beam: Beam as String,
        /// The link to hold it by.
        link: Name as String,
    }
}

impl ActionKind {
    /// The kind of that name ([`ActionKind::name`]), with `-` for `_` as well.
    pub fn named(name: &str) -> Option<ActionKind> {
        let name = name.replace('-', "_");
        ActionKind::ALL.iter().copied().find(|kind| kind.name() == name)
    }

    /// Does the action work on the assembly? The others move the hand, and pick up, put down or regrasp a
    /// part.
    pub fn is_assembling(self) -> bool {
        use ActionKind::{Move, PickUp, PutDown, Regrasp};
        !matches!(self, Move | PickUp | PutDown | Regrasp)
    }
}

impl FineAction {
    /// The part that the hand works with: the one that the action names first; for [`FineAction::Fasten`] and
    /// [`FineAction::PullOut`] the peg.
    pub fn part(&self) -> Option<&str> {
        match self {
            FineAction::Move { to } => to.part(),
            FineAction::PickUp { item, .. } | FineAction::PutDown { item } => Some(item.name()),
            FineAction::AssembleSquare { beam, .. }
            | FineAction::AssembleAngled { beam, .. }
            | FineAction::AssembleThrough { beam, .. }
            | FineAction::AssembleDeep { beam, .. }
            | FineAction::AssembleCap { beam, .. }
            | FineAction::LayDown { beam }
            | FineAction::Slide { beam, .. }
            | FineAction::Regrasp { beam, .. }
            | FineAction::Push { beam, .. }
            | FineAction::TakeOut { beam, .. }
            | FineAction::SlideBack { beam, .. } => Some(beam),
            FineAction::Fasten { peg, .. } | FineAction::PullOut { peg, .. } => Some(peg),
        }
    }

    /// The connection that the action pins or unpins, or over whose hole it brings a peg, by its name in the
    /// goal.
    pub fn connection(&self) -> Option<&str> {
        match self {
            FineAction::Fasten { connection, .. }
            | FineAction::PullOut { connection, .. }
            | FineAction::Move {
                to:
                    Place::Approach(Target::Connection(connection))
                    | Place::Target(Target::Connection(connection)),
            } => Some(connection),
            _ => None,
        }
    }

    /// The link by which the action grasps a beam.
    pub fn link(&self) -> Option<&str> {
        match self {
            FineAction::PickUp { grasp: Grasp::Link(link), .. }
            | FineAction::Slide { link, .. }
            | FineAction::Regrasp { link, .. }
            | FineAction::Push { link, .. }
            | FineAction::TakeOut { link, .. }
            | FineAction::SlideBack { link, .. } => Some(link),
            _ => None,
        }
    }

    /// The same action with other pegs: `rename` gives each peg's new name.
    #[must_use]
    pub(crate) fn with_pegs(&self, rename: impl Fn(&str) -> String) -> FineAction {
        let item = |item: Item| match item {
            Item::Peg(peg) => Item::Peg(rename(&peg)),
            beam @ Item::Beam(_) => beam,
        };
        let fields = self.kind().parameters().iter().zip(self.values());
        let values = fields.map(|field| match field {
            (Parameter::Peg, Value::Name(peg)) => Value::Name(rename(&peg)),
            (_, Value::Item(of)) => Value::Item(item(of)),
            (_, Value::Place(Place::Input(of))) => Value::Place(Place::Input(item(of))),
            (_, value) => value,
        });
        FineAction::new(self.kind(), values.collect()).unwrap_or_else(|| self.clone())
    }
}

impl Display for FineAction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            FineAction::Move { to } => write!(f, "move to {to}"),
            FineAction::PickUp { item, grasp } => write!(f, "pick up {item} by {grasp}"),
            FineAction::PutDown { item } => write!(f, "put down {item}"),
            FineAction::AssembleSquare { beam, joint } => write!(f, "insert {beam} by {joint}"),
            FineAction::AssembleAngled { beam, joint } => write!(f, "insert {beam} at an angle by {joint}"),
            FineAction::AssembleThrough { beam, joint, through } => {
                write!(f, "slide {beam} in by {joint} until {} is in its sleeve", through.join(", "))
            }
            FineAction::LayDown { beam } => write!(f, "lay down {beam} at its place"),
            FineAction::AssembleDeep { beam, joint } => write!(f, "insert {beam} too deep by {joint}"),
            FineAction::Slide { beam, link } => write!(f, "slide {beam} forward by {link}"),
            FineAction::Regrasp { beam, link } => write!(f, "regrasp {beam} by {link}"),
            FineAction::AssembleCap { beam, joints } => write!(f, "cap with {beam} at {}", joints.join(", ")),
            FineAction::Fasten { connection, female, male, peg } => {
                write!(f, "fasten {connection} ({male}-{female}) with {peg}")
            }
            FineAction::Push { beam, link } => write!(f, "push {beam} by {link}"),
            FineAction::TakeOut { beam, link } => write!(f, "draw {beam} out by {link}"),
            FineAction::PullOut { connection, peg } => write!(f, "pull {peg} out of {connection}"),
            FineAction::SlideBack { beam, link } => write!(f, "slide {beam} back by {link}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An action is the same after its values were read and put together again.
    #[test]
    fn actions_are_their_values() {
        for text in [
            r#"{"action":"move","to":{"approach":{"connection":"C1"}}}"#,
            r#"{"action":"pick_up","item":{"beam":"b4"},"grasp":{"link":"b4l1"}}"#,
            r#"{"action":"assemble_through","beam":"b4","joint":"b4j1","through":["b4j2"]}"#,
            r#"{"action":"fasten","connection":"C1","female":"b7j1","male":"b4j1","peg":"p1"}"#,
        ] {
            let action: FineAction = serde_json::from_str(text).unwrap();
            assert_eq!(FineAction::new(action.kind(), action.values()), Some(action.clone()));
            assert_eq!(FineAction::new(action.kind(), Vec::new()), None);
            let same = serde_json::to_string(&action).unwrap();
            assert_eq!(same, text);
        }
    }
}
