//! What the tests of plans share: the goals, and a replayer that knows nothing of the rule files.

// A failed unwrap here is a failed test.
#![allow(clippy::unwrap_used)]
// Every test file uses a part of this.
#![allow(dead_code)]

use ramp_assembly::{Assembly, read_goal};
use ramp_kit::{JointType, Kit, read_kit};
use ramp_planner::{Area, CoarseAction, CoarseStep, Domains, FineAction, Grasp, Item, Place, State, Target};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

pub const EASY: [&str; 3] = ["easy-1", "easy-2", "easy-3"];
/// Goals of the other classes whose plans need nothing that the rules do not have.
pub const HARDER: [&str; 3] = ["medium-1", "hard-1", "hard-2"];

pub fn data() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data")
}

pub fn kit() -> &'static Kit {
    static KIT: LazyLock<Kit> = LazyLock::new(|| read_kit(&data().join("kit.xml")).unwrap());
    &KIT
}

pub fn domains() -> &'static Domains {
    static DOMAINS: LazyLock<Domains> = LazyLock::new(|| Domains::read(&data().join("domains")).unwrap());
    &DOMAINS
}

pub fn goal(name: &str) -> Assembly {
    read_goal(&data().join(format!("goals/{name}.xml")), kit()).unwrap()
}

/// The table while a plan is carried out, as both resolutions see it.
pub struct World<'a> {
    assembly: &'a Assembly,
    kit: &'static Kit,
    stands: Vec<bool>,
    /// The peg in each connection.
    pegs: Vec<Option<String>>,
    misaligned: Vec<bool>,
    lost: Vec<String>,
    // The coarse resolution.
    area: Area,
    hand: Option<Item>,
    // The fine resolution.
    place: Place,
    fine_hand: Option<Item>,
}

type Check = Result<(), String>;

fn require(holds: bool, otherwise: &str) -> Check {
    if holds { Ok(()) } else { Err(otherwise.to_string()) }
}

impl<'a> World<'a> {
    pub fn new(assembly: &'a Assembly, state: &State) -> World<'a> {
        let named = |names: &[String]| -> Vec<bool> {
            assembly.beams.iter().map(|placed| names.contains(&placed.beam.name)).collect()
        };
        let mut stands = named(&state.in_assembly);
        stands[assembly.base] = true;
        let fastened: BTreeMap<&str, &str> =
            state.fastened.iter().map(|(c, p)| (c.as_str(), p.as_str())).collect();
        let pegs = assembly.connections.iter().map(|c| fastened.get(c.name.as_str()).map(|p| p.to_string()));
        World {
            assembly,
            kit: kit(),
            stands,
            pegs: pegs.collect(),
            misaligned: named(&state.misaligned),
            lost: state.lost_pegs.clone(),
            area: Area::Input,
            hand: None,
            place: Place::Above(Area::Input),
            fine_hand: None,
        }
    }

    /// Carries out a whole plan and checks that it reaches the goal.
    pub fn run(&mut self, steps: &[CoarseStep]) -> Check {
        for (index, step) in steps.iter().enumerate() {
            self.step(step).map_err(|why| format!("step {} ({}): {why}", index + 1, step.coarse))?;
        }
        require(self.stands.iter().all(|stands| *stands), "a beam is missing")?;
        require(self.pegs.iter().all(Option::is_some), "a peg is missing")?;
        require(self.hand.is_none(), "the hand is not free")?;
        let aside = self.place == Place::Above(Area::Intermediate);
        require(steps.is_empty() || aside, "the hand does not stand aside")
    }

    /// Carries out one coarse action and the fine actions under it.
    pub fn step(&mut self, step: &CoarseStep) -> Check {
        let stood = self.stands.clone();
        self.coarse(&step.coarse)?;
        let mut effect = None;
        for action in &step.fine {
            if let Some(done) = self.fine(action, &stood).map_err(|why| format!("{action}: {why}"))? {
                require(effect.replace(done).is_none(), "the fine actions do more than the coarse one")?;
            }
        }
        // What the fine actions did is what the coarse action says.
        let expected = match &step.coarse {
            CoarseAction::Move { .. } => None,
            other => Some(other.clone()),
        };
        require(effect == expected, "the fine actions do something else than the coarse one")?;
        require(self.fine_hand == self.hand, "the hand holds something else than it should")?;
        let area = match &self.place {
            Place::Above(area) => *area,
            Place::Input(_) => Area::Input,
            Place::Approach(_) | Place::Target(_) => Area::Assembly,
        };
        require(area == self.area, "the hand is in another area")
    }

    /// What a planner that starts over would be told, everything in the hand being back where it started.
    pub fn state(&self) -> State {
        let named = |which: &[bool]| -> Vec<String> {
            let beams = self.assembly.beams.iter().enumerate();
            let chosen = beams.filter(|(index, _)| which[*index] && *index != self.assembly.base);
            chosen.map(|(_, placed)| placed.beam.name.clone()).collect()
        };
        let connections = self.assembly.connections.iter().zip(&self.pegs);
        State {
            in_assembly: named(&self.stands),
            fastened: connections.filter_map(|(c, p)| Some((c.name.clone(), p.clone()?))).collect(),
            misaligned: named(&self.misaligned),
            lost_pegs: self.lost.clone(),
        }
    }

    // ---- The coarse resolution ----------------------------------------------------------------------------

    fn coarse(&mut self, action: &CoarseAction) -> Check {
        let line = |area: &Area| match area {
            Area::Input => 0i32,
            Area::Intermediate => 1,
            Area::Assembly => 2,
        };
        match action {
            CoarseAction::Move { to } => {
                require((line(to) - line(&self.area)).abs() == 1, "the areas are not neighbours")?;
                self.area = *to;
            }
            CoarseAction::PickUp { item } => {
                require(self.area == Area::Input, "the hand is not over the sheet")?;
                require(self.hand.is_none(), "the hand is not empty")?;
                match item {
                    Item::Beam(beam) => require(!self.stands[self.beam(beam)?], "the beam is built in")?,
                    Item::Peg(peg) => {
                        require(self.kit.peg(peg).is_some(), "there is no such peg")?;
                        require(!self.lost.contains(peg), "the peg is lost")?;
                        require(!self.pegs.iter().flatten().any(|used| used == peg), "the peg is used")?;
                    }
                }
                self.hand = Some(item.clone());
            }
            CoarseAction::PutDown { item } => {
                require(self.area == Area::Input, "the hand is not over the sheet")?;
                require(self.hand.as_ref() == Some(item), "the hand does not hold it")?;
                self.hand = None;
            }
            CoarseAction::Assemble { beam } => self.assemble(beam)?,
            CoarseAction::Fasten { connection, peg } => self.fasten(connection, peg)?,
            CoarseAction::Push { beam } => {
                let beam = self.beam(beam)?;
                require(self.area == Area::Assembly, "the hand is not over the assembly")?;
                require(self.hand.is_none(), "the hand is not empty")?;
                require(self.stands[beam], "the beam is not in the assembly")?;
                self.misaligned[beam] = false;
            }
        }
        Ok(())
    }

    fn assemble(&mut self, name: &str) -> Check {
        let beam = self.beam(name)?;
        require(self.area == Area::Assembly, "the hand is not over the assembly")?;
        require(self.hand == Some(Item::Beam(name.to_string())), "the hand does not hold it")?;
        for connection in 0..self.pegs.len() {
            let open = self.closed(connection) && self.pegs[connection].is_none();
            require(!open, "a connection waits for its peg")?;
        }
        let partners: Vec<(usize, usize)> = self.partners(beam);
        let standing: Vec<usize> = partners.iter().filter(|p| self.stands[p.1]).map(|p| p.1).collect();
        require(!standing.is_empty(), "there is nothing to rest on")?;
        require(
            standing.iter().all(|other| !self.misaligned[*other]),
            "a beam that it meets is off its place",
        )?;
        // Ends that enter beams which stand already: one at the most. Sleeves to pass through: all stand.
        let mut entered = Vec::new();
        for &(connection, other) in &partners {
            let male = self.assembly.connections[connection].male;
            let thru = self.kind(male) == JointType::ThruM;
            if male.beam == beam && thru {
                require(self.stands[other], "the sleeve that it passes through is missing")?;
            } else if male.beam == beam && self.stands[other] {
                entered.push(other);
            } else if male.beam == other && self.stands[other] && thru {
                return Err("it is the sleeve of a beam that stands".to_string());
            }
        }
        entered.dedup();
        require(entered.len() <= 1, "it enters two beams that stand")?;
        // An insertion moves what it meets and no peg holds.
        for other in standing {
            let pegged = self.partners(other).iter().any(|(connection, _)| self.pegs[*connection].is_some());
            self.misaligned[other] |= other != self.assembly.base && !pegged;
        }
        self.stands[beam] = true;
        self.hand = None;
        Ok(())
    }

    fn fasten(&mut self, name: &str, peg: &str) -> Check {
        let connection = self.connection(name)?;
        require(self.area == Area::Assembly, "the hand is not over the assembly")?;
        require(self.hand == Some(Item::Peg(peg.to_string())), "the hand does not hold the peg")?;
        require(self.closed(connection), "a beam of the connection is not in the assembly")?;
        require(self.pegs[connection].is_none(), "there is a peg already")?;
        let pair = &self.assembly.connections[connection];
        let sides = [pair.female.beam, pair.male.beam];
        require(sides.iter().all(|beam| !self.misaligned[*beam]), "a beam is off its place")?;
        self.pegs[connection] = Some(peg.to_string());
        self.hand = None;
        for beam in sides {
            let partners = self.partners(beam);
            let awaits = partners.iter().any(|(_, other)| !self.stands[*other]);
            let pinned = partners.iter().all(|(c, _)| !self.closed(*c) || self.pegs[*c].is_some());
            // Held where the other beam is clamped, or meets a third one.
            let held = partners.iter().filter(|(c, other)| {
                let elsewhere = |(d, third): &(usize, usize)| self.closed(*d) && *third != beam;
                self.closed(*c)
                    && (*other == self.assembly.base || self.partners(*other).iter().any(elsewhere))
            });
            if beam != self.assembly.base && awaits && pinned && held.count() < 2 {
                self.misaligned[beam] = true;
            }
        }
        Ok(())
    }

    // ---- The fine resolution ------------------------------------------------------------------------------

    /// Carries out a fine action; gives the coarse action that it amounts to, if it is more than a move. `stood`
    /// says which beams stood before.
    fn fine(&mut self, action: &FineAction, stood: &[bool]) -> Result<Option<CoarseAction>, String> {
        let empty = self.fine_hand.is_none();
        Ok(Some(match action {
            FineAction::Move { to } => {
                require(near(&self.place, to), "the places are not neighbours")?;
                require(empty || !matches!(to, Place::Target(_)), "with something in the hand")?;
                self.place = to.clone();
                return Ok(None);
            }
            FineAction::PickUp { item, grasp } => {
                require(empty, "the hand is not empty")?;
                require(self.place == Place::Input(item.clone()), "the hand is not where the item starts")?;
                match (item, grasp) {
                    (Item::Beam(beam), Grasp::Link(link)) => self.wide_enough(beam, link)?,
                    (Item::Peg(_), Grasp::Head) => {}
                    _ => return Err("such an item is not held so".to_string()),
                }
                self.fine_hand = Some(item.clone());
                CoarseAction::PickUp { item: item.clone() }
            }
            FineAction::PutDown { item } => {
                require(self.fine_hand.as_ref() == Some(item), "the hand does not hold it")?;
                require(self.place == Place::Input(item.clone()), "the hand is not where the item starts")?;
                self.fine_hand = None;
                CoarseAction::PutDown { item: item.clone() }
            }
            FineAction::AssembleSquare { beam, joint } => {
                let (enters, _) = self.meets(beam, stood)?;
                require(enters.contains(joint), "this joint enters nothing")?;
                self.let_go(Item::Beam(beam.clone()), Target::Beam(beam.clone()))?;
                CoarseAction::Assemble { beam: beam.clone() }
            }
            FineAction::AssembleCap { beam, joints } => {
                let (enters, receives) = self.meets(beam, stood)?;
                require(enters.is_empty(), "a joint of it enters another: that is no cap")?;
                require(!joints.is_empty() && *joints == receives, "these are not the joints that receive")?;
                self.let_go(Item::Beam(beam.clone()), Target::Beam(beam.clone()))?;
                CoarseAction::Assemble { beam: beam.clone() }
            }
            FineAction::Fasten { connection, female, male, peg } => {
                let pair = &self.assembly.connections[self.connection(connection)?];
                let joints = [self.assembly.joint_name(pair.female), self.assembly.joint_name(pair.male)];
                require(joints == [female, male], "these are not its joints")?;
                self.let_go(Item::Peg(peg.clone()), Target::Connection(connection.clone()))?;
                CoarseAction::Fasten { connection: connection.clone(), peg: peg.clone() }
            }
            FineAction::Push { beam, link } => {
                require(empty, "the hand is not empty")?;
                let there = Place::Target(Target::Beam(beam.clone()));
                require(self.place == there, "the hand is not at the beam")?;
                self.wide_enough(beam, link)?;
                CoarseAction::Push { beam: beam.clone() }
            }
        }))
    }

    fn let_go(&mut self, item: Item, of: Target) -> Check {
        require(self.fine_hand == Some(item), "the hand does not hold it")?;
        require(self.place == Place::Approach(of.clone()), "the hand is not at its approach")?;
        self.fine_hand = None;
        self.place = Place::Target(of);
        Ok(())
    }

    /// The joints of a beam that enter a beam which stands, and those that receive one, from j1 to jn.
    fn meets(&self, name: &str, stood: &[bool]) -> Result<(Vec<String>, Vec<String>), String> {
        let beam = self.beam(name)?;
        let (mut enters, mut receives) = (Vec::new(), Vec::new());
        for (index, joint) in self.assembly.beams[beam].beam.joints.iter().enumerate() {
            for connection in &self.assembly.connections {
                let Some((mine, other)) = self.assembly.sides(connection, beam) else { continue };
                if mine.joint == index && stood[other.beam] {
                    let list = if connection.male == mine { &mut enters } else { &mut receives };
                    list.push(joint.name.clone());
                }
            }
        }
        Ok((enters, receives))
    }

    /// The fingertips are 20 mm wide; with 1 mm to each side, 5 mm must be left to choose from.
    fn wide_enough(&self, beam: &str, link: &str) -> Check {
        let beam = &self.assembly.beams[self.beam(beam)?].beam;
        let link = beam.links.iter().find(|l| l.name == link).ok_or("the beam has no such link")?;
        require(link.grasp[1] - link.grasp[0] >= 27.0e-3, "the link is too short")
    }

    // ---- Looking up ---------------------------------------------------------------------------------------

    fn beam(&self, name: &str) -> Result<usize, String> {
        self.assembly.beam_index(name).ok_or_else(|| format!("there is no beam {name}"))
    }

    fn connection(&self, name: &str) -> Result<usize, String> {
        self.assembly.connection_index(name).ok_or_else(|| format!("there is no connection {name}"))
    }

    fn kind(&self, joint: ramp_assembly::JointRef) -> JointType {
        self.assembly.beams[joint.beam].beam.joints[joint.joint].kind
    }

    fn closed(&self, connection: usize) -> bool {
        let pair = &self.assembly.connections[connection];
        self.stands[pair.female.beam] && self.stands[pair.male.beam]
    }

    /// The connections of a beam with the beam at the other side.
    fn partners(&self, beam: usize) -> Vec<(usize, usize)> {
        let connections = self.assembly.connections.iter().enumerate();
        connections.filter_map(|(i, c)| Some((i, self.assembly.sides(c, beam)?.1.beam))).collect()
    }
}

/// The graph of places.
fn near(from: &Place, to: &Place) -> bool {
    let one_way = |a: &Place, b: &Place| {
        use Area::{Assembly, Input, Intermediate};
        matches!(
            (a, b),
            (Place::Above(Input), Place::Above(Intermediate) | Place::Input(_))
                | (Place::Above(Intermediate), Place::Above(Assembly))
                | (Place::Above(Assembly), Place::Approach(_) | Place::Target(_))
        )
    };
    one_way(from, to) || one_way(to, from)
}
