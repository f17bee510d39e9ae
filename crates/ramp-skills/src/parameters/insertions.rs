//! Parameters of insertions.

parameters! {
    /// Common parameters of all insertions of a held beam.
    InsertionParameters {
        /// Height over the insertion path at which a beam is brought to the start of its insertion.
        clear: f64 = "m", 0.0, 0.1;
        /// Distance from there at which a beam may be when it comes down on the table first. Chosen.
        near: f64 = "m", 0.0, 0.1;
        /// The same for its rotation. Chosen.
        near_turn: f64 = "rad", 0.0, 1.0;
        /// Least height over the path from which it is pushed in.
        lowest: f64 = "m", 0.0, 0.02;
        /// Speed of an insertion. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Its acceleration. Chosen: the tip returns to its line within the first millimetres.
        acceleration: f64 = "m/s²", 0.01, 10.0;
        /// Speed of a push through a sleeve that little holds: faster, and the sleeve is dragged along before
        /// the force tells it.
        loose_speed: f64 = "m/s", 1e-3, 0.5;
        /// Acceleration of such a push.
        loose_acceleration: f64 = "m/s²", 0.01, 10.0;
        /// Step of a push that is watched: an arm whose own friction exceeds the force of a sleeve that
        /// it drags along looks after each. Chosen.
        watched_step: f64 = "m", 1e-3, 0.5;
        /// Shift of the sleeve that is seen then, beyond the errors of one image. Chosen.
        watched_moved: f64 = "m", 1e-4, 0.1;
        /// Force against the motion at which such a push stops however slowly it rises. Chosen: half of the
        /// force at which the hand yields.
        loose_most: f64 = "N", 0.5, 100.0;
        /// Speed before the males come to the mouths of their joints. Chosen.
        free_speed: f64 = "m/s", 1e-3, 0.5;
        /// Distance from its place at which a male reaches the mouth of its joint: it stalls there at 35 mm
        /// at most.
        mouth: f64 = "m", 0.0, 0.2;
        /// Wait between the motion and the look. Chosen.
        rest: f64 = "s", 0.0, 10.0;
        /// Speed at which a jammed beam is backed out. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// Force at which a beam that is backed out has caught on an edge. Chosen: more than the friction of
        /// a joint.
        back_limit: f64 = "N", 0.5, 100.0;
        /// Largest distance of an end from the start of the insertion after backing out. An end further away
        /// is still in its joint. Chosen.
        back_short: f64 = "m", 1e-3, 0.1;
        /// Distance of an end from the start of the insertion after the search for the way out from which the
        /// beam is taken for caught. Chosen: well beyond the mouth of a joint.
        back_caught: f64 = "m", 1e-3, 0.5;
        /// Largest uncertainty of the joints that are to meet, 1 σ. An unchamfered edge is blocked unless it
        /// meets its female within 0.3 mm.
        known: f64 = "m", 1e-5, 0.1;
        /// Shift of the beams that an insertion meets.
        bump: f64 = "m", 0.0, 0.05;
        /// Rotation of those beams.
        bump_turn: f64 = "°", 0.0, 45.0;
        /// Shift of a pinned sleeve by friction.
        sleeve_bump: f64 = "m", 0.0, 0.05;
        /// Rotation of a pinned sleeve by friction.
        sleeve_bump_turn: f64 = "°", 0.0, 45.0;
        /// Shift of a loosely held sleeve.
        loose_bump: f64 = "m", 0.0, 0.05;
        /// Rotation of a loosely held sleeve.
        loose_bump_turn: f64 = "°", 0.0, 45.0;
        /// Time without motion in a compliant search after which more than an edge blocks the beam.
        stuck: f64 = "s", 0.0, 600.0;
        /// Number of attempts at an insertion. Chosen.
        tries: usize = "", 1.0, 20.0;
    }
}

parameters! {
    /// Inserts a male of the held beam into the assembly.
    AssembleParameters {
        /// Force against the motion at which an insertion stops. Chosen.
        limit: f64 = "N", 0.5, 100.0;
        /// The same through a loosely held sleeve, as a rise of the force over its running mean: a beam on
        /// the table turns at 0.7 N at its end.
        loose_limit: f64 = "N", 0.05, 100.0;
        /// That limit at the least, as a share of the usual error of the force in free space: with much
        /// friction in its joints, an arm in motion feels that much without a touch.
        loose_usual: f64 = "", 0.0, 10.0;
        /// Number of further pushes for a beam that stops in such a sleeve. Chosen.
        loose_pushes: usize = "", 0.0, 100.0;
        /// A push that gains less has met an edge.
        loose_gain: f64 = "m", 0.0, 0.1;
        /// Distance by which the beam then backs off. Chosen.
        loose_back: f64 = "m", 0.0, 0.05;
        /// Height offsets from the believed place that are then tried in turn.
        loose_offsets: [f64; 6] = "m", -0.01, 0.01;
        /// Height over the table at which a beam slides that stands on it.
        height: f64 = "m", 0.0, 0.01;
        /// Speed at which a beam in its joints is brought to its place. Chosen.
        seat_speed: f64 = "m/s", 1e-3, 0.5;
        /// Distance of a joint across the insertion path from which a beam at its place is not in its
        /// joints: a female is 33 mm high, and its beam sags by less.
        beside: f64 = "m", 1e-3, 0.1;
    }
}

parameters! {
    /// Puts the held beam as a cap over males of the assembly.
    CapParameters {
        /// Force against the motion at which a cap stops. A cap that meets its males needs 5 N. More force on
        /// one male alone rotates it in the hand.
        limit: f64 = "N", 0.5, 100.0;
        /// Force with which a cap is pressed to its place after a search.
        press: f64 = "N", 0.5, 100.0;
        /// Distance from its place at which an end of a cap is blocked. A male that rests on a face is 22 mm
        /// short.
        blocked: f64 = "m", 1e-4, 0.1;
        /// Distance from its place after the sweep at which an end is searched for once more: no later push
        /// can seat it.
        short: f64 = "m", 1e-4, 0.1;
        /// Distance of the setpoint beyond the goal, which seats each end on its stop wall.
        overdrive: f64 = "m", 0.0, 0.02;
        /// Distance by which a cap is pressed below its height, onto the table.
        down: f64 = "m", 0.0, 0.02;
        /// Downward tilt of the leading edge while it passes over an end at an angle: the largest undetected
        /// rotation of a beam in the hand, since that end's corner clears the edge of the plate by no more
        /// than its own sag.
        lean: f64 = "°", 0.0, 20.0;
        /// Distance from its place at which a cap's lower plate is under such an end: the end's corner
        /// reaches 15 mm past the hole, the plate 13.3 mm. A cap tilted down for longer would lift the end,
        /// which then falls into the hole of the plate.
        under: f64 = "m", 0.0, 0.1;
        /// Angle between an end's axis and the insertion direction from which the end is at an angle.
        angled: f64 = "°", 0.0, 90.0;
        /// Amplitude of the final rotation back and forth, so that both ends meet their walls.
        sweep: f64 = "°", 0.0, 20.0;
        /// Speed of that rotation. Chosen.
        sweep_speed: f64 = "m/s", 1e-3, 0.5;
    }
}
