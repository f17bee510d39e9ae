//! The task of an episode: a frame is built, or a built frame is taken apart.

use ramp_kit::Kit;

use crate::assembly::Assembly;

/// The task of an episode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Task {
    /// Build the frame from the parts on the sheet.
    #[default]
    Build,
    /// Take the built frame apart, and put each part back in its place on the sheet.
    TakeApart,
}

impl Task {
    /// All tasks.
    pub const ALL: [Task; 2] = [Task::Build, Task::TakeApart];

    /// Its name in options, logs and messages.
    pub fn name(self) -> &'static str {
        match self {
            Task::Build => "build",
            Task::TakeApart => "take-apart",
        }
    }

    /// Its name in results and logs, which do not name the task to build.
    pub fn told(self) -> Option<&'static str> {
        (self != Task::Build).then(|| self.name())
    }

    /// The name of the things that its result counts, for a person.
    pub fn unit(self) -> &'static str {
        match self {
            Task::Build => "pegs",
            Task::TakeApart => "parts back",
        }
    }

    /// The task of that name.
    pub fn named(name: &str) -> Option<Task> {
        Task::ALL.into_iter().find(|task| task.name() == name)
    }
}

impl Assembly {
    /// The pegs that pin the frame where an episode begins with it, by connection: the first peg of each
    /// holder, then the second of each, and so on. So a holder keeps a peg as long as it can, and shows where
    /// it stands. Connections for which the kit has no peg are left out.
    ///
    /// ```
    /// let kit = ramp_kit::read_kit("../../data/kit.xml".as_ref())?;
    /// let goal = ramp_assembly::read_goal("../../data/goals/easy-1.xml".as_ref(), &kit)?;
    /// assert_eq!(goal.built_with(), ["p1", "p4", "p7"]);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn built_with(&self) -> Vec<&str> {
        let Kit { holders, pegs, .. } = &*self.kit;
        let rank = |holder: &str| holders.iter().position(|it| it.name == holder).unwrap_or(usize::MAX);
        let mut pegs: Vec<_> = pegs.iter().collect();
        pegs.sort_by_key(|peg| (peg.slot, rank(&peg.holder)));
        pegs.iter().take(self.connections.len()).map(|peg| peg.name.as_str()).collect()
    }

    /// How many of [`Task::unit`] the result of a task counts: one for each connection, or for each part that
    /// is to be put back.
    pub fn wanted(&self, task: Task) -> usize {
        match task {
            Task::Build => self.connections.len(),
            Task::TakeApart => self.movable_parts().len(),
        }
    }

    /// The parts of the built frame that are not clamped, in the order in which results list them: beams as
    /// in the goal, then the pegs by connection.
    pub fn movable_parts(&self) -> Vec<&str> {
        let beams = self.beams.iter().enumerate().filter(|(index, _)| *index != self.base);
        let beams = beams.map(|(_, placed)| placed.beam.name.as_str());
        beams.chain(self.built_with()).collect()
    }
}
