//! Parameters of the belief, of the eyes that correct it, and of what it says about faults.

parameters! {
    /// The belief: how well parts are known, and what makes them less well known. All are standard deviations.
    BeliefParameters {
        /// Position of a part before it is seen: it lies on the outlines of the sheet.
        on_sheet: [f64; 3] = "m", 1e-7, 1.0;
        /// Rotation of a part before it is seen: it lies flat.
        on_sheet_turn: [f64; 3] = "°", 1e-4, 90.0;
        /// Position of the clamped beam, each axis.
        clamped: f64 = "m", 1e-7, 0.1;
        /// Rotation of the clamped beam, each axis.
        clamped_turn: f64 = "°", 1e-4, 90.0;
        /// It may be this far off its place, more than a table's height and lean: what is seen further away was misread.
        clamped_most: f64 = "m", 0.0, 0.1;
        /// What a second adds to the position of any part, each axis.
        resting: f64 = "m", 0.0, 0.1;
        /// What a second adds to its rotation.
        resting_turn: f64 = "°", 0.0, 90.0;
        /// What a metre of travel adds to the position of a part between the fingers, axes of the tip. As the hand speeds up and
        /// slows down, it creeps along the fingers' faces, by 1.5 mm on a long way.
        carried: [f64; 3] = "m", 0.0, 0.1;
        /// What it adds to the rotation.
        carried_turn: f64 = "°", 0.0, 90.0;
        /// How far the fingers may shift a part as they close on it: across the closing direction, along it, along the hand.
        gripped: [f64; 3] = "m", 0.0, 0.1;
        /// How far they may turn it about the same axes.
        gripped_turn: [f64; 3] = "°", 0.0, 90.0;
        /// How well the fingers, once closed, centre a part.
        centred: f64 = "m", 1e-7, 0.1;
        /// How well they turn it square to themselves.
        centred_turn: f64 = "°", 1e-4, 90.0;
        /// How far a part may move as the fingers let go of it, each axis.
        released: f64 = "m", 0.0, 0.1;
        /// How far it may turn.
        released_turn: [f64; 3] = "°", 0.0, 90.0;
        /// How far a part that is pushed may move between the fingers, axes of the tip.
        pushed: [f64; 3] = "m", 0.0, 0.1;
        /// How far it may turn.
        pushed_turn: [f64; 3] = "°", 0.0, 90.0;
        /// How far it may turn about the line from one finger to the other.
        pushed_roll: f64 = "°", 0.0, 90.0;
        /// A reading with a greater normalised innovation squared is not believed before the next one confirms it. With six
        /// degrees of freedom, chance alone exceeds it once in two million.
        gate: f64 = "", 1.0, 1000.0;
        /// Share of a new reading in the running mean of innovations that tells of a part that has moved a little.
        drift: f64 = "", 0.001, 1.0;
        /// So many images in a row that show a part lying otherwise, and it is believed that it does.
        doubts: usize = "", 1.0, 100.0;
        /// Position of a part that lies otherwise than was believed, each axis.
        doubted: f64 = "m", 1e-7, 1.0;
        /// Its rotation.
        doubted_turn: f64 = "°", 1e-4, 90.0;
        /// The same in the hand, where it may have tilted, but not gone far.
        doubted_held: f64 = "m", 1e-7, 1.0;
        /// Its rotation in the hand.
        doubted_held_turn: f64 = "°", 1e-4, 90.0;
        /// Position of a part that slipped out of the fingers: it may be anywhere below.
        lost: f64 = "m", 1e-7, 1.0;
        /// Its rotation.
        lost_turn: f64 = "°", 1e-4, 90.0;
        /// Position of a peg that was set upright in its hole.
        reckoned: f64 = "m", 1e-7, 0.1;
        /// Its rotation.
        reckoned_turn: f64 = "°", 1e-4, 90.0;
        /// A part counts as level when the z component of its z axis is this large: within 0.25°. A beam that one female alone
        /// holds hangs by more.
        level: f64 = "", 0.5, 1.0;
        /// Beyond this, nothing is known of how a part lies.
        tilted: f64 = "°", 1e-4, 90.0;
        /// A part whose place is known no better than this is no obstacle.
        anywhere: f64 = "m", 1e-4, 1.0;
        /// A part found further than this from where it was believed is worth an event.
        astray: f64 = "m", 1e-5, 1.0;
    }
}

parameters! {
    /// The eyes: cameras, their calibration, and what images are trusted for.
    EyesParameters {
        /// How far a camera may be from where the robot says it is, 1 σ: the benchmark's error of calibration.
        calibration: f64 = "m", 1e-7, 0.1;
        /// How far it may be turned.
        calibration_turn: f64 = "°", 1e-4, 45.0;
        /// What remains of that at best.
        remains: f64 = "m", 1e-9, 0.1;
        /// What remains of the turn.
        remains_turn: f64 = "°", 1e-5, 45.0;
        /// Known points that are enough to calibrate a camera by.
        enough: usize = "", 4.0, 100000.0;
        /// How much larger than the finder says the covariance of a part in an image is taken to be: images taken from one place
        /// have errors in common.
        common: f64 = "", 1.0, 1000.0;
        /// A tag that was never found in so many images in which it should have been in sight is covered or gone.
        missed: usize = "", 1.0, 10000.0;
        /// A tag is in sight this far from the border of the image.
        border: f64 = "pixels", 0.0, 1000.0;
        /// A tag is in sight when its edges are this long.
        legible: f64 = "pixels", 0.0, 1000.0;
        /// A tag is in sight when it faces the camera this much: the cosine of the angle.
        facing: f64 = "", 0.0, 1.0;
        /// An image that was exposed this long before it is asked for tells of another moment, and another one is taken. Chosen:
        /// above what eight exposures in a row and their way take.
        stale: f64 = "s", 0.01, 60.0;
        /// How long the agent waits for a camera that repeats its image.
        patience: f64 = "s", 0.0, 600.0;
        /// How often it asks the camera meanwhile, and how long it waits when no camera shows anything.
        pause: f64 = "s", 0.001, 60.0;
        /// So many images in a row that show nothing at all, and a camera counts as broken.
        broken: usize = "", 1.0, 1000.0;
    }
}

parameters! {
    /// The causes of faults: what counts as moved, slipped, off.
    DiagnosisParameters {
        /// A peg is this far from its outline at most when nobody has touched its holder: the start is disturbed by 1 mm and 1°
        /// about the holder's middle, and a peg has a millimetre of room in its hole.
        in_place: f64 = "m", 1e-5, 0.1;
        /// When pegs of one holder are on average this far off, the holder has moved.
        holder_off: f64 = "m", 1e-5, 0.1;
        /// A part that moves in the hand by more has slipped.
        slip: f64 = "m", 1e-5, 0.1;
        /// A part that turns in the hand by more has slipped.
        slip_turn: f64 = "°", 0.01, 90.0;
        /// A beam that stands has moved when one of its ends is further from where it was.
        moved: f64 = "m", 1e-5, 0.1;
        /// So many standard deviations are no chance.
        sure: f64 = "", 0.1, 100.0;
        /// A force in free space that is further from what the held part weighs tells of a sensor that is off: twelve times the
        /// noise of its filtered reading.
        biased: f64 = "N", 0.01, 100.0;
        /// So many times the force that was measured before anything was grasped is added to that. Chosen.
        usual: f64 = "", 0.0, 10.0;
        /// How long the hand's own mass acts on the wrist sensor after the hand stops.
        rest: f64 = "s", 0.0, 10.0;
    }
}
