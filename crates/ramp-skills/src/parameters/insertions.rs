//! Parameters of insertions.

parameters! {
    /// What all insertions of a held beam share.
    InsertionParameters {
        /// How high over its insertion path a beam is brought to where its insertion begins.
        clear: f64 = "m", 0.0, 0.1;
        /// Least height over the path from which it is pushed in.
        lowest: f64 = "m", 0.0, 0.02;
        /// Speed of an insertion. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed before the males come to the mouths of their joints. Chosen.
        free_speed: f64 = "m/s", 1e-3, 0.5;
        /// How far from its place a male comes to the mouth of its joint: it stalls there at 35 mm at most.
        mouth: f64 = "m", 0.0, 0.2;
        /// How long the hand waits after the motion before it looks. Chosen.
        rest: f64 = "s", 0.0, 10.0;
        /// Speed with which a jammed beam is backed out. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// Force at which a beam that is backed out has caught on an edge. Chosen: more than the friction of
        /// a joint.
        back_limit: f64 = "N", 0.5, 100.0;
        /// How far an end of a beam that was backed out may be from where the insertion began: one that is
        /// further has stayed in its joint. Chosen.
        back_short: f64 = "m", 1e-3, 0.1;
        /// How well the joints that are to meet must be known, 1 σ. An unchamfered edge stops dead unless it
        /// meets its female within 0.3 mm.
        known: f64 = "m", 1e-5, 0.1;
        /// How far an insertion may move the beams that it meets.
        bump: f64 = "m", 0.0, 0.05;
        /// How far it may turn them.
        bump_turn: f64 = "°", 0.0, 45.0;
        /// How far friction may move a sleeve that pegs hold.
        sleeve_bump: f64 = "m", 0.0, 0.05;
        /// How far it may turn it.
        sleeve_bump_turn: f64 = "°", 0.0, 45.0;
        /// How far a sleeve may be moved that little holds.
        loose_bump: f64 = "m", 0.0, 0.05;
        /// How far it may be turned.
        loose_bump_turn: f64 = "°", 0.0, 45.0;
        /// A beam that a compliant search finds standing still for so long at a time has met more than an
        /// edge.
        stuck: f64 = "s", 0.0, 600.0;
        /// How often an insertion is tried. Chosen.
        tries: usize = "", 1.0, 20.0;
    }
}

parameters! {
    /// Inserts a male of the held beam into the assembly.
    AssembleParameters {
        /// Force against the motion at which an insertion stops. Chosen.
        limit: f64 = "N", 0.5, 100.0;
        /// The same through a sleeve that little holds, as a rise of the force over its running mean: a beam
        /// on the table turns at 0.7 N at its end.
        loose_limit: f64 = "N", 0.05, 100.0;
        /// How often a beam that stops in such a sleeve is pushed on. Chosen.
        loose_pushes: usize = "", 0.0, 100.0;
        /// A push that gains less has met an edge.
        loose_gain: f64 = "m", 0.0, 0.1;
        /// How far the beam then goes back. Chosen.
        loose_back: f64 = "m", 0.0, 0.05;
        /// How much higher than believed its place is tried then, one after the other.
        loose_offsets: [f64; 6] = "m", -0.01, 0.01;
        /// How high a beam that stands on the table slides over it.
        height: f64 = "m", 0.0, 0.01;
        /// Speed with which a beam in its joints is brought to its place. Chosen.
        seat_speed: f64 = "m/s", 1e-3, 0.5;
    }
}

parameters! {
    /// Puts the held beam as a cap over males of the assembly.
    CapParameters {
        /// Force against the motion at which a cap stops. One that finds its males takes 5 N; more on one of
        /// them alone turns it in the hand.
        limit: f64 = "N", 0.5, 100.0;
        /// Force with which a cap is pressed to its place over what it was searched past.
        press: f64 = "N", 0.5, 100.0;
        /// An end of a cap this far before its place is blocked. A male that stands on a face stands 22 mm
        /// before it.
        blocked: f64 = "m", 1e-4, 0.1;
        /// An end this far before its place after the sweep is searched for once more: no push gets it there
        /// later.
        short: f64 = "m", 1e-4, 0.1;
        /// How far the setpoint is pulled past the goal: it seats each end on its stop wall.
        overdrive: f64 = "m", 0.0, 0.02;
        /// How far a cap is pressed below its height, onto the table.
        down: f64 = "m", 0.0, 0.02;
        /// How far its leading edge leans down while it passes over an end at an angle: as much as a beam may
        /// hang turned in the hand unseen, since that end's corner clears the edge of the plate by no more
        /// than its own sag.
        lean: f64 = "°", 0.0, 20.0;
        /// So far before its place a cap's lower plate is under such an end: its corner reaches 15 mm past
        /// the hole, the plate 13.3 mm. Nose down for longer, it would lift the end, which then falls into
        /// the hole of the plate.
        under: f64 = "m", 0.0, 0.1;
        /// An end is at an angle when its axis is so far from the insertion direction.
        angled: f64 = "°", 0.0, 90.0;
        /// Turn to and fro at the end, so that both ends find their walls.
        sweep: f64 = "°", 0.0, 20.0;
        /// Speed of that turn. Chosen.
        sweep_speed: f64 = "m/s", 1e-3, 0.5;
    }
}
