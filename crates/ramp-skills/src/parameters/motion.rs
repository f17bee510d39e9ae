//! Parameters of motions through free space, of looks, and of what counts as aligned.

parameters! {
    /// Motions through free space.
    TravelParameters {
        /// Height of the tip while it travels. A held beam then clears the pegs that stand in the holders.
        height: f64 = "m", 0.02, 0.6;
        /// Distance that motions keep from everything. Chosen.
        margin: f64 = "m", 0.0, 0.05;
        /// Share of the limits of the joints' velocities that motions of the empty hand use. Chosen: the rest
        /// is for the controller.
        velocity: f64 = "", 0.01, 1.0;
        /// The same of their accelerations. With 0.8 the hand rings at stops, and its inertia comes near to
        /// the guard's force.
        acceleration: f64 = "", 0.01, 1.0;
        /// The same of their velocities with a part in the hand.
        held_velocity: f64 = "", 0.01, 1.0;
        /// The same of their accelerations with a part in the hand: what it weighs more counts as a push.
        held_acceleration: f64 = "", 0.01, 1.0;
        /// Share of the limits of the joints' jerks that all motions use. Chosen.
        jerk: f64 = "", 0.01, 1.0;
        /// Time in which the acceleration may change between its extremes. The arm's controller swings when
        /// it changes faster.
        ramp: f64 = "s", 0.0, 0.5;
        /// A place that brings a joint nearer to an end of its range is used only where there is no other:
        /// what is done there in contact needs room. Chosen.
        least_margin: f64 = "rad", 0.0, 3.0;
        /// Distance from the ends of the joints' ranges beyond which more is no better. Chosen.
        good_margin: f64 = "rad", 0.0, 3.0;
        /// What a second of the way to a grasp, and on from there, counts against a radian of that distance.
        /// Chosen.
        time_cost: f64 = "rad/s", 0.0, 10.0;
        /// Speed with which the hand retreats to travelling height. Chosen.
        retreat_speed: f64 = "m/s", 0.001, 1.0;
        /// How far beside the hand a free place is looked for, when it stands where no motion can begin.
        /// Chosen.
        back_out: [f64; 4] = "m", 0.001, 0.5;
        /// Speed with which it goes there: it may touch something. Chosen.
        back_out_speed: f64 = "m/s", 0.001, 1.0;
    }
}

parameters! {
    /// Looks: how often, and how well a thing must be known.
    LookParameters {
        /// Longest series of looks. What is not known well enough by then has to be found by contact.
        longest: f64 = "s", 0.0, 600.0;
        /// How long before the hand arrives at a place to look from the cameras are exposed: it is nearly at
        /// rest by then. Chosen.
        ahead: f64 = "s", 0.0, 1.0;
        /// How often a camera looks again from where it is before it goes to another place. Chosen: a look
        /// takes a tenth of the time that a way does.
        again: usize = "", 1.0, 100.0;
        /// How often a camera looks at the tag of the sheet to find out where it is. Chosen.
        calibrating: usize = "", 0.0, 100.0;
        /// How well a part must be known along the table before it is grasped, 1 σ. The fingers centre it, so
        /// that half a millimetre is enough.
        graspable: f64 = "m", 1e-5, 0.1;
        /// How well its height must be known, 1 σ. The ribs of the fingers have 1 mm of room in a beam's
        /// slots.
        graspable_height: f64 = "m", 1e-5, 0.1;
        /// How well the heights of a peg and its hole must be known to tell whether the peg is seated, 1 σ.
        /// The referee asks for 0.5 mm.
        seated_known: f64 = "m", 1e-5, 0.1;
        /// How well the ends of a beam must be known to tell whether it is aligned, 1 σ.
        ends_known: f64 = "m", 1e-5, 0.1;
    }
}

parameters! {
    /// How far the beams and pegs of the assembly stand from where they should.
    AlignmentParameters {
        /// A beam this near to its place is left alone. Well below what a peg or the chamfers of a cap take.
        good: f64 = "m", 1e-5, 0.05;
        /// Horizontal distance between two holes that a peg still pulls together: its cone takes 1.7 mm.
        peggable: f64 = "m", 1e-5, 0.05;
        /// The same for holes that a peg could not pass, though they seemed near enough.
        told_apart: f64 = "m", 1e-5, 0.05;
        /// How often the beams of a connection are pushed, one after another, while one of them does not
        /// follow. Chosen.
        rounds: usize = "", 1.0, 10.0;
        /// A hole this near to a peg tells nothing of how its beam is turned.
        short: f64 = "m", 0.0, 1.0;
        /// A beam that lies loose may be this far off its place: another one goes through it all the same.
        displaced: f64 = "m", 1e-5, 0.1;
        /// How well the height of a beam that stands is known, 1 σ.
        level: f64 = "m", 1e-6, 0.1;
        /// An upright peg this near to a hole, along the table, stands in it.
        fallen: f64 = "m", 1e-5, 0.1;
    }
}
