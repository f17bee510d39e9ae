//! Parameters of free-space motions, of looks, and of alignment.

parameters! {
    /// Motions through free space.
    TravelParameters {
        /// Height of the tip during travel. A held beam then clears the pegs that stand in the holders.
        height: f64 = "m", 0.02, 0.6;
        /// Distance that motions keep from everything. Chosen.
        margin: f64 = "m", 0.0, 0.05;
        /// Fraction of the joint velocity limits that motions of the empty hand use. Chosen: the rest is for
        /// the controller.
        velocity: f64 = "", 0.01, 1.0;
        /// The same for the accelerations. With 0.8 the hand oscillates at stops, and its inertial force
        /// comes close to the guard's force.
        acceleration: f64 = "", 0.01, 1.0;
        /// The same for the velocities with a part in the hand.
        held_velocity: f64 = "", 0.01, 1.0;
        /// The same for the accelerations with a part in the hand: its inertial force counts as a push.
        held_acceleration: f64 = "", 0.01, 1.0;
        /// Share of these with a beam that is brought back to the sheet, in a hand that leans. Measured: at
        /// the whole, a beam of 0.6 m turned by 2° about its axis between the fingers.
        leaning: f64 = "", 0.01, 1.0;
        /// Lean of the hand from which this holds.
        leaning_from: f64 = "rad", 0.01, 3.2;
        /// Share of velocity and acceleration that each stop of the arm leaves, up to four of them. Chosen.
        calmer: f64 = "", 0.1, 1.0;
        /// Fraction of the joint jerk limits that all motions use. Chosen.
        jerk: f64 = "", 0.01, 1.0;
        /// Time in which the acceleration may change between its extremes. The arm's controller oscillates
        /// when it changes faster.
        ramp: f64 = "s", 0.0, 0.5;
        /// Least distance of the joints from their limits. A pose with less is used only if there is no
        /// other, since contact motions need room. Chosen.
        least_margin: f64 = "rad", 0.0, 3.0;
        /// Distance from the joint limits above which more gives no advantage. Chosen.
        good_margin: f64 = "rad", 0.0, 3.0;
        /// Cost of a second of motion to a grasp and onward, relative to a radian of that distance. Chosen.
        time_cost: f64 = "rad/s", 0.0, 10.0;
        /// Speed of the hand's retreat to travelling height. Chosen.
        retreat_speed: f64 = "m/s", 0.001, 1.0;
        /// Distances beside the hand at which a free pose is searched for, when no motion can start from the
        /// current one. Chosen.
        back_out: [f64; 4] = "m", 0.001, 0.5;
        /// Speed of the motion there: it may touch something. Chosen.
        back_out_speed: f64 = "m/s", 0.001, 1.0;
    }
}

parameters! {
    /// Looks: their number, and the accuracy required.
    LookParameters {
        /// Longest series of looks. A part that is still too uncertain afterwards has to be found by contact.
        longest: f64 = "s", 0.0, 600.0;
        /// Time of the exposure before the hand arrives at a viewpoint: the hand is nearly at rest then.
        /// Chosen.
        ahead: f64 = "s", 0.0, 1.0;
        /// Number of looks from one viewpoint before the camera moves to another. Chosen: a look takes a
        /// tenth of the time of a motion.
        again: usize = "", 1.0, 100.0;
        /// Number of looks at the tag of the sheet to calibrate a camera. Chosen.
        calibrating: usize = "", 0.0, 100.0;
        /// Largest horizontal uncertainty of a part before it is grasped, 1 σ. The fingers centre it, so that
        /// half a millimetre is enough.
        graspable: f64 = "m", 1e-5, 0.1;
        /// Largest uncertainty of its height, 1 σ. The ribs of the fingers have 1 mm of clearance in a beam's
        /// slots.
        graspable_height: f64 = "m", 1e-5, 0.1;
        /// Largest uncertainty of the heights of a peg and its hole for judging whether the peg is seated, 1
        /// σ. The referee requires 0.5 mm.
        seated_known: f64 = "m", 1e-5, 0.1;
        /// Largest uncertainty of the ends of a beam for judging whether it is aligned, 1 σ.
        ends_known: f64 = "m", 1e-5, 0.1;
    }
}

parameters! {
    /// Alignment: deviation of the beams and pegs of the assembly from their places.
    AlignmentParameters {
        /// Deviation up to which a beam is left alone, well below what a peg or the chamfers of a cap
        /// tolerate.
        good: f64 = "m", 1e-5, 0.05;
        /// Horizontal distance between two holes that a peg still pulls together: its cone tolerates 1.7 mm.
        peggable: f64 = "m", 1e-5, 0.05;
        /// The same for holes that a peg could not pass although they seemed close enough.
        told_apart: f64 = "m", 1e-5, 0.05;
        /// Number of rounds in which the beams of a connection are pushed in turn while one of them does not
        /// follow. Chosen.
        rounds: usize = "", 1.0, 10.0;
        /// Distance of a hole from a peg below which it does not determine the rotation of its beam.
        short: f64 = "m", 0.0, 1.0;
        /// Tolerated deviation of a loose beam: another one can still be inserted through it.
        displaced: f64 = "m", 1e-5, 0.1;
        /// Horizontal distance between the holes of a pinned connection, beyond what is not known of it, from
        /// which the peg holds one beam alone: its stem fills both holes up to less than a millimetre.
        missed: f64 = "m", 1e-5, 0.1;
        /// Height uncertainty of a standing beam, 1 σ.
        level: f64 = "m", 1e-6, 0.1;
        /// Horizontal distance up to which an upright peg stands in a hole.
        fallen: f64 = "m", 1e-5, 0.1;
        /// Distance of both ends of a beam from its place in the frame up to which it stands there when the
        /// work begins. A free end droops by 3 mm.
        stands: f64 = "m", 1e-5, 0.1;
    }
}
