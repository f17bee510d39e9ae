//! Parameters of the belief, the cameras that correct it, and the diagnosis of faults.

parameters! {
    /// The belief: uncertainty of part poses, and how it grows. All are standard deviations.
    BeliefParameters {
        /// Position of a part before it is detected: it lies on its outline on the sheet. If the start moves
        /// the parts further, the position along the table is that uncertain.
        on_sheet: [f64; 3] = "m", 1e-7, 1.0;
        /// Rotation of a part before it is detected: it lies flat.
        on_sheet_turn: [f64; 3] = "°", 1e-4, 90.0;
        /// Position of the clamped beam, each axis.
        clamped: f64 = "m", 1e-7, 0.1;
        /// Rotation of the clamped beam, each axis.
        clamped_turn: f64 = "°", 1e-4, 90.0;
        /// Largest position error of the clamped beam, above a table's error in height and tilt. A detection
        /// further away is a misreading.
        clamped_most: f64 = "m", 0.0, 0.1;
        /// Growth of the position uncertainty of any part per second, each axis.
        resting: f64 = "m", 0.0, 0.1;
        /// Growth of the rotation uncertainty per second.
        resting_turn: f64 = "°", 0.0, 90.0;
        /// Growth of the position uncertainty of a held part per metre of travel, axes of the tip. As the
        /// hand accelerates and decelerates, the part creeps along the fingers' faces, by 1.5 mm on a long
        /// path.
        carried: [f64; 3] = "m", 0.0, 0.1;
        /// Growth of the rotation uncertainty of a held part per metre of travel.
        carried_turn: f64 = "°", 0.0, 90.0;
        /// Shift of a part as the fingers close on it: across the closing direction, along it, along the
        /// hand.
        gripped: [f64; 3] = "m", 0.0, 0.1;
        /// Rotation of a part as the fingers close on it, about the same axes.
        gripped_turn: [f64; 3] = "°", 0.0, 90.0;
        /// Position uncertainty of a part that the closed fingers have centred.
        centred: f64 = "m", 1e-7, 0.1;
        /// Rotation uncertainty of a part that the closed fingers have squared.
        centred_turn: f64 = "°", 1e-4, 90.0;
        /// Shift of a part when the fingers release it, each axis.
        released: f64 = "m", 0.0, 0.1;
        /// How far it may turn.
        released_turn: [f64; 3] = "°", 0.0, 90.0;
        /// Shift of a held part that is pushed, axes of the tip.
        pushed: [f64; 3] = "m", 0.0, 0.1;
        /// How far it may turn.
        pushed_turn: [f64; 3] = "°", 0.0, 90.0;
        /// Rotation of a held part that is pushed, about the line from one finger to the other.
        pushed_roll: f64 = "°", 0.0, 90.0;
        /// A reading with a larger normalised innovation squared is rejected until the next one confirms it.
        /// With six degrees of freedom, noise alone exceeds it once in two million.
        gate: f64 = "", 1.0, 1000.0;
        /// A sighting by a camera at its nominal place with a larger normalised innovation squared shows that
        /// the camera is elsewhere. With six degrees of freedom, noise alone exceeds it once in twenty.
        misplaced: f64 = "", 1.0, 1000.0;
        /// Share of a new reading in the running mean of innovations that detects small motions of a part.
        drift: f64 = "", 0.001, 1.0;
        /// Number of consecutive images with a different pose of a part after which the new pose is accepted.
        doubts: usize = "", 1.0, 100.0;
        /// Position of a part whose pose was found to differ from the belief, each axis.
        doubted: f64 = "m", 1e-7, 1.0;
        /// Its rotation.
        doubted_turn: f64 = "°", 1e-4, 90.0;
        /// Position of such a part in the hand, where it may have tilted but not moved far.
        doubted_held: f64 = "m", 1e-7, 1.0;
        /// Its rotation in the hand.
        doubted_held_turn: f64 = "°", 1e-4, 90.0;
        /// The same for a beam on the track `colour` that neither is held nor found where it is believed: it
        /// may have been pushed.
        strayed: f64 = "m", 1e-7, 1.0;
        /// See `strayed`.
        strayed_turn: f64 = "°", 1e-4, 90.0;
        /// Position of a part that slipped out of the fingers: it may lie anywhere below.
        lost: f64 = "m", 1e-7, 1.0;
        /// Its rotation.
        lost_turn: f64 = "°", 1e-4, 90.0;
        /// Position of a peg that was set upright in its hole.
        reckoned: f64 = "m", 1e-7, 0.1;
        /// Its rotation.
        reckoned_turn: f64 = "°", 1e-4, 90.0;
        /// A part counts as level when the z component of its z axis is this large: within 0.25°. A beam that
        /// one female alone holds hangs by more.
        level: f64 = "", 0.5, 1.0;
        /// Rotation uncertainty beyond which the orientation of a part counts as unknown.
        tilted: f64 = "°", 1e-4, 90.0;
        /// Position uncertainty from which a part no longer counts as an obstacle.
        anywhere: f64 = "m", 1e-4, 1.0;
        /// Position uncertainty below which the place of an untouched part on the sheet counts as known.
        found: f64 = "m", 1e-7, 0.1;
        /// A part found further than this from its believed position is reported as an event.
        astray: f64 = "m", 1e-5, 1.0;
    }
}

parameters! {
    /// The cameras: their calibration, and the trust in their images.
    EyesParameters {
        /// Position error of a camera's calibration, 1 σ, as the benchmark disturbs it.
        calibration: f64 = "m", 1e-7, 0.1;
        /// Rotation error, 1 σ.
        calibration_turn: f64 = "°", 1e-4, 45.0;
        /// Smallest position error that calibration leaves.
        remains: f64 = "m", 1e-9, 0.1;
        /// Smallest rotation error that calibration leaves.
        remains_turn: f64 = "°", 1e-5, 45.0;
        /// Number of known points needed to calibrate a camera.
        enough: usize = "", 4.0, 100000.0;
        /// Factor on the covariance that the pose estimator gives: errors of images taken from one place are
        /// correlated.
        common: f64 = "", 1.0, 1000.0;
        /// Without tags, a camera that has moved by so much relative to a part sees it from another place.
        /// The factor does not count for the first image from there, unless the part is in the hand.
        elsewhere: f64 = "m", 0.0, 1.0;
        /// The same as a turn.
        elsewhere_turn: f64 = "°", 0.0, 180.0;
        /// Position uncertainty from which a peg without tags is looked for everywhere in an image.
        lost: f64 = "m", 1e-4, 1.0;
        /// Number of images from above that have not shown a part yet, after which it is looked for at its
        /// places in the frame and elsewhere on the table. Without tags.
        mislaid: usize = "", 1.0, 10000.0;
        /// Number of images without a tag that should have been visible, after which the tag counts as
        /// covered or missing.
        missed: usize = "", 1.0, 10000.0;
        /// Least distance of a visible tag from the border of the image.
        border: f64 = "pixels", 0.0, 1000.0;
        /// Least edge length of a visible tag.
        legible: f64 = "pixels", 0.0, 1000.0;
        /// Least cosine of the angle between the normal of a visible tag and the line of sight.
        facing: f64 = "", 0.0, 1.0;
        /// Largest age of an image when it is requested. An older one is outdated, and another one is taken.
        /// Chosen: longer than eight exposures in a row and their transfer.
        stale: f64 = "s", 0.01, 60.0;
        /// Time limit for waiting on a camera that repeats its image.
        patience: f64 = "s", 0.0, 600.0;
        /// Interval between requests meanwhile, and the wait when no camera shows anything.
        pause: f64 = "s", 0.001, 60.0;
        /// Number of consecutive empty images after which a camera counts as broken.
        broken: usize = "", 1.0, 1000.0;
    }
}

parameters! {
    /// Diagnosis of faults: thresholds for a moved, slipped or biased state.
    DiagnosisParameters {
        /// Largest distance of a peg from the place where it was found, in an undisturbed holder. A peg has 1
        /// mm of clearance in its hole.
        in_place: f64 = "m", 1e-5, 0.1;
        /// Mean offset of the pegs of one holder from which the holder counts as moved.
        holder_off: f64 = "m", 1e-5, 0.1;
        /// Shift of a part in the hand from which it counts as slipped.
        slip: f64 = "m", 1e-5, 0.1;
        /// Rotation of a part in the hand from which it counts as slipped.
        slip_turn: f64 = "°", 0.01, 90.0;
        /// Displacement of one end from which a beam of the assembly counts as moved.
        moved: f64 = "m", 1e-5, 0.1;
        /// Number of standard deviations from which a deviation is significant.
        sure: f64 = "", 0.1, 100.0;
        /// Deviation of the force in free space from the weight of the held part that indicates a sensor
        /// bias: twelve times the noise of the filtered reading.
        biased: f64 = "N", 0.01, 100.0;
        /// Multiple of the force measured before the first grasp that is added to that threshold. Chosen.
        usual: f64 = "", 0.0, 10.0;
        /// Time for which the inertia of the hand acts on the wrist sensor after the hand stops.
        rest: f64 = "s", 0.0, 10.0;
    }
}
