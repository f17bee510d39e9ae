//! Parameters of searches and of pressing.

parameters! {
    /// The compliant search: what an insertion does when it stalls on an edge.
    SearchParameters {
        /// Distance from its place at which an inserted beam is seated. A peg pulls twice as much together.
        seated: f64 = "m", 1e-5, 0.02;
        /// The longest search. Chosen.
        longest: f64 = "s", 0.0, 600.0;
        /// How long a beam may stand still before it is swung. A beam that nothing wedges goes on by `progress` meanwhile.
        patience: f64 = "s", 0.0, 60.0;
        /// How long the swing grows.
        growth: f64 = "s", 0.01, 60.0;
        /// After what time the swing begins small again.
        cycle: f64 = "s", 0.01, 600.0;
        /// A beam that comes on by no more than this in a search's `pace_time` is not searched for any further.
        pace_distance: f64 = "m", 0.0, 0.1;
        /// How often a part that does not move is looked at: it may have moved in the hand.
        look_every: f64 = "s", 0.1, 600.0;
        /// Progress that counts as having moved.
        progress: f64 = "m", 0.0, 0.05;
    }
}

parameters! {
    /// Touches that tell heights.
    TouchParameters {
        /// A height known this well needs no touch, 1 σ.
        trusted: f64 = "m", 0.0, 0.01;
        /// Force with which a beam is pressed flat on the table: at its end it turns the hand by as much as friction does.
        press: f64 = "N", 0.5, 50.0;
        /// Speed with which it comes down. Chosen.
        press_speed: f64 = "m/s", 1e-4, 0.1;
        /// How far below where the table is believed the setpoint goes: to press against the stiffness of the hand, and as far as
        /// the height may be off.
        further: f64 = "m", 0.0, 0.02;
        /// How long the hand presses. Chosen.
        flat: f64 = "s", 0.0, 5.0;
        /// How well the height is known then, 1 σ. Chosen: what a printed face is off.
        known: f64 = "m", 1e-6, 0.01;
        /// Speed with which the beam leaves what it touched. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// How far a beam backs off from an edge before it touches the floor of the sleeve.
        back: f64 = "m", 0.0, 0.1;
        /// How far below the beam that floor is, about.
        depth: f64 = "m", 0.0, 0.02;
        /// Rise of the force at which it has met the floor. Chosen.
        force: f64 = "N", 0.1, 50.0;
        /// Speed of that touch. Chosen.
        speed: f64 = "m/s", 1e-4, 0.1;
    }
}

parameters! {
    /// The motion of a compliant search: a push along the insertion path, and swings across it.
    ComplianceParameters {
        /// Push along the path, when it begins and when the search has taken long. Through sleeves 4 N: with more, friction
        /// holds the edge against the search, but an arm's own friction may take all of it. A loose beam on the table slides
        /// at 1.4 N and turns at 0.7 N at its end. A cap needs more than the light end weighs.
        force: [f64; 2] = "N", 0.0, 50.0;
        /// Swing across the path, when it begins and when it has grown. With a cap it must be wider than the frame
        /// gives way.
        across: [f64; 2] = "m", 0.0, 0.05;
        /// How often it swings across.
        across_rate: f64 = "Hz", 0.0, 20.0;
        /// Swing up and down, when it begins and when it has grown.
        up: [f64; 2] = "m", 0.0, 0.05;
        /// How often it swings up and down.
        up_rate: f64 = "Hz", 0.0, 20.0;
        /// Swing about the vertical, when it has grown.
        yaw: f64 = "rad", 0.0, 0.5;
        /// How often it swings about the vertical.
        yaw_rate: f64 = "Hz", 0.0, 20.0;
        /// Swing about the horizontal across the path, when it has grown.
        roll: f64 = "rad", 0.0, 0.5;
        /// How often it swings about that.
        roll_rate: f64 = "Hz", 0.0, 20.0;
        /// In so long a search must come on, or it ends: a cap that stalls long is aside of an end, and is put on anew.
        pace_time: f64 = "s", 0.1, 600.0;
        /// This near to its place the beam is in, and the search ends.
        near: f64 = "m", 1e-5, 0.02;
    }
}

parameters! {
    /// The search for a hole with the tip of a held peg.
    PegSearchParameters {
        /// Height of the tip over the female's top plate when the peg is brought over the hole. Chosen.
        over: f64 = "m", 1e-3, 0.1;
        /// How well a hole must be known before the peg is lowered, 1 σ: one that is missed by little is found by contact.
        hole_known: f64 = "m", 1e-5, 0.1;
        /// Depth of the tip below the top plate at which the hole is found.
        found: f64 = "m", 1e-4, 0.02;
        /// Force at which the peg has touched the plate.
        touch: f64 = "N", 0.5, 50.0;
        /// Speed with which the peg is lowered onto the plate or lifted off it, and the most with which a search lets it down into
        /// its hole. Chosen.
        lower_speed: f64 = "m/s", 1e-3, 0.5;
        /// Force down during the search. Friction holds the tip until the hand is ahead of it by force × 0.3 / 1500 N/m.
        force: f64 = "N", 0.5, 50.0;
        /// Distance between turns of the spiral: the cone of a hole catches a tip that passes within 1.7 mm.
        pitch: f64 = "m", 1e-5, 0.01;
        /// Speed along the spiral.
        speed: f64 = "m/s", 1e-4, 0.1;
        /// Radius at which the spiral goes back inward. Chosen.
        widest: f64 = "m", 1e-3, 0.1;
        /// Force down while the wrist measures where the tip of a tilted peg presses, and while that peg is searched with.
        tilted_force: f64 = "N", 0.5, 50.0;
        /// A peg whose tip is at least this far beside the hand is tilted in it.
        tilted_least: f64 = "m", 1e-4, 0.1;
        /// By how many times as much as before contact the moment may be off under load. Chosen: friction turns round.
        moment_spread: f64 = "", 0.0, 10.0;
        /// The tip of a peg that the fingers hold is no further beside the hand: 16°.
        tilted_most: f64 = "m", 1e-4, 0.1;
        /// How far a tilted peg is lifted off the plate to take zero again.
        lift_off: f64 = "m", 0.0, 0.05;
        /// How far around the place where its tip should meet the hole the line of the search goes.
        tilted_around: f64 = "m", 0.0, 0.05;
        /// Speed of that search, and of a spiral until the wrist has told where the tip presses: that of a tilted peg is near the
        /// edge of the plate.
        tilted_speed: f64 = "m/s", 1e-4, 0.1;
        /// Swing across that line.
        tilted_sway: f64 = "m", 0.0, 0.01;
        /// Speed with which a peg whose tip is in the hole is turned upright. Chosen.
        upright_speed: f64 = "m/s", 1e-3, 0.5;
        /// How many control periods of 1 ms the tip is measured for.
        periods: usize = "", 3.0, 10000.0;
    }
}

parameters! {
    /// Pressing a peg until it is seated.
    PressParameters {
        /// Largest force. Chosen.
        force: f64 = "N", 1.0, 100.0;
        /// Growth of the force.
        rate: f64 = "N/s", 0.1, 1000.0;
        /// Fastest motion down while the peg falls freely. Chosen.
        speed: f64 = "m/s", 0.001, 0.5;
        /// This near to the plate the head goes slowly: the arm's mass behind it would strike the plate.
        landing: f64 = "m", 0.0, 0.03;
        /// How fast it goes then. At 0.04 m/s the force of the stop is 43 N with the drives of an FR3, at this speed 25 N.
        landing_speed: f64 = "m/s", 0.001, 0.5;
        /// So long after it has sunk last it has landed, and the force grows fast.
        landed: f64 = "s", 0.0, 10.0;
        /// Radius of the circle that keeps a peg from jamming.
        circle: f64 = "m", 0.0, 0.01;
        /// How often the circle is made.
        circle_rate: f64 = "Hz", 0.0, 20.0;
        /// A peg that takes so long is held up by something.
        long: f64 = "s", 0.0, 60.0;
        /// Longest pressing.
        time: f64 = "s", 0.1, 60.0;
        /// A head that seems this near to the plate and does not sink for a time stands on it: eyes tell heights less exactly.
        nearly: f64 = "m", 0.0, 0.03;
        /// That time.
        stall: f64 = "s", 0.1, 60.0;
        /// It has sunk when it is so much lower.
        sunk: f64 = "m", 1e-6, 0.01;
        /// A peg whose stem is still outside and that does not sink for so long stands on the mouth of a hole. Chosen.
        stands: f64 = "s", 0.1, 60.0;
        /// It stands if it gets no lower than this meanwhile: what the fingers hold creeps in them.
        creep: f64 = "m", 1e-6, 0.01;
        /// A peg that stands on the mouth of its hole and presses this far beside the hand has turned between the fingers. One
        /// that is held up by something else presses up to 6.3 mm beside it.
        beside: f64 = "m", 0.0, 0.1;
        /// A head this near to the plate is seated. The referee asks for 0.5 mm.
        seated: f64 = "m", 1e-5, 0.01;
        /// How often a peg that is not flush is pressed by its head. Chosen.
        tries: usize = "", 0.0, 20.0;
    }
}
