//! Parameters of the agent and of the skills that insert nothing.

parameters! {
    /// The agent: what it does beside its plan.
    AgentParameters {
        /// How often it re-plans before it gives up. Chosen.
        replans: usize = "", 0.0, 100.0;
        /// How well two holes must be known to tell whether a peg goes in, 1 σ.
        holes_known: f64 = "m", 1e-5, 0.1;
        /// A peg further than this from its place in the holder is not fetched any more. In its hole it can
        /// be 3 mm off.
        peg_strayed: f64 = "m", 1e-4, 0.1;
    }
}

parameters! {
    /// The agent on a piece of a plan, in a build that others have begun.
    PieceParameters {
        /// How far a beam that others have inserted may be from its place, 1 σ, axes of the world.
        beam_position: [f64; 3] = "m", 1e-6, 0.1;
        /// How far it may be turned.
        beam_rotation: [f64; 3] = "rad", 1e-6, 3.2;
        /// How far a peg that others have pressed in may be from its place, 1 σ, axes of the world.
        peg_position: [f64; 3] = "m", 1e-6, 0.1;
        /// How far it may be turned. Its turn in its hole is anyone's guess.
        peg_rotation: [f64; 3] = "rad", 1e-6, 3.2;
        /// How often all holes that are to be pinned next are looked at, and beams pushed. Chosen.
        rounds: usize = "", 0.0, 20.0;
    }
}

parameters! {
    /// Moves the hand, and what it holds, from place to place.
    MoveToParameters {
        /// How well the joints that a beam is to meet must be known before it is fetched, 1 σ. Where a beam
        /// is to go is easier to see before it is in the hand.
        known: f64 = "m", 1e-5, 0.1;
        /// How much higher than for its descent a peg is brought over its hole. Chosen.
        above: f64 = "m", 0.0, 0.1;
    }
}

parameters! {
    /// Grasps a part where it stands, and lifts it.
    PickUpParameters {
        /// How far a beam is lifted: off the table.
        lift: f64 = "m", 1e-3, 0.3;
        /// How far a peg is lifted: out of its holder altogether.
        peg_lift: f64 = "m", 1e-3, 0.3;
        /// Speed of the lift. Chosen.
        speed: f64 = "m/s", 1e-3, 1.0;
    }
}

parameters! {
    /// Puts the held part back where it was picked up.
    PutDownParameters {
        /// Height over its place from which a part is lowered. A peg's stem is then above its holder, a beam
        /// above the table.
        above: f64 = "m", 1e-3, 0.3;
        /// Speed with which it is lowered. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Force on the table or the holder at which a part is put down.
        limit: f64 = "N", 0.5, 100.0;
        /// How long the tip of a peg that stands beside the hole of its holder searches for it. Chosen.
        search_time: f64 = "s", 0.0, 600.0;
    }
}

parameters! {
    /// Lays the held beam on the table at its place.
    LayDownParameters {
        /// Speed with which it is lowered. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
    }
}

parameters! {
    /// Slides a beam that stands deeper than its place forward to its place.
    SlideParameters {
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which the beam is brought to its place at the end. Chosen.
        seat_speed: f64 = "m/s", 1e-3, 0.5;
        /// How long the hand waits after the motion before it looks. Chosen.
        rest: f64 = "s", 0.0, 10.0;
        /// Force at which lifting stops.
        lift_limit: f64 = "N", 0.5, 100.0;
        /// Force against the motion at which sliding stops.
        limit: f64 = "N", 0.5, 100.0;
        /// Distance from its place at which the beam is seated. A peg pulls twice as much together.
        seated: f64 = "m", 1e-5, 0.02;
        /// How well the joints that are to meet must be known, 1 σ.
        known: f64 = "m", 1e-5, 0.1;
        /// Steps aside, in turn, when the end meets an edge.
        aside: [f64; 5] = "m", -0.02, 0.02;
        /// How far the slide may move the beams that it joins. Measured: 0.9 mm.
        dragged: f64 = "m", 0.0, 0.05;
        /// How far it may turn them. Chosen.
        dragged_turn: f64 = "°", 0.0, 45.0;
    }
}

parameters! {
    /// Changes the grasp of the held beam to another link.
    RegraspParameters {
        /// Where places are tried on the table, along x of the world.
        table_x: [f64; 2] = "m", -1.0, 1.0;
        /// The same along y.
        table_y: [f64; 2] = "m", -1.0, 1.0;
        /// How far apart the places are.
        step: f64 = "m", 0.005, 0.5;
        /// Height over the table at which a held beam's place is checked.
        over: f64 = "m", 0.0, 0.1;
        /// Height from which it is lowered slowly. Chosen.
        drop: f64 = "m", 0.0, 0.2;
        /// Force on the table at which it lies.
        limit: f64 = "N", 0.5, 100.0;
        /// Speed with which it is lowered. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which the hand goes down to where it lowers the beam slowly. Chosen.
        down_speed: f64 = "m/s", 1e-3, 0.5;
        /// How far the joints must stay from the ends of their ranges.
        room: f64 = "rad", 0.0, 1.0;
    }
}

parameters! {
    /// Grasps a beam in the assembly, and moves it to its nominal place.
    PushParameters {
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Force at which a push stops.
        limit: f64 = "N", 0.5, 100.0;
        /// A beam that stands this far short of its place is inserted further instead.
        short_of: f64 = "m", 1e-4, 0.1;
        /// How far a push may move the beams that are joined with the one that is pushed.
        dragged: f64 = "m", 0.0, 0.05;
        /// How far it may turn them.
        dragged_turn: f64 = "°", 0.0, 45.0;
        /// How often a beam is pushed. Chosen.
        tries: usize = "", 1.0, 20.0;
        /// A beam that is off by less is not pushed: well within what a peg or a cap takes. Chosen.
        near: f64 = "m", 0.0, 0.01;
        /// A beam that is still off by more than this share of what it was before is not pushed again.
        /// Chosen.
        no_nearer: f64 = "", 0.0, 1.0;
        /// Motions of one push at most: friction on the table stops each of them a little short.
        motions: usize = "", 1.0, 50.0;
    }
}

parameters! {
    /// Pins two joints with the held peg.
    FastenParameters {
        /// How well the peg must be known before it is lowered, 1 σ.
        known: f64 = "m", 1e-5, 0.1;
        /// Angle by which the peg may be off upright when it is lowered.
        upright: f64 = "rad", 1e-4, 0.5;
        /// How long a hole is searched near where it was seen, before the peg is thought to be tilted: up to
        /// 4 mm around.
        near_time: f64 = "s", 0.0, 600.0;
        /// Longest search further around. Chosen.
        search_time: f64 = "s", 0.0, 600.0;
        /// Speed with which a peg is drawn out of its hole for another try. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// How far pressing a peg in may move the two beams.
        bump: f64 = "m", 0.0, 0.05;
        /// How far it may turn them.
        bump_turn: f64 = "°", 0.0, 45.0;
        /// How often it is tried. Chosen.
        tries: usize = "", 1.0, 20.0;
    }
}
