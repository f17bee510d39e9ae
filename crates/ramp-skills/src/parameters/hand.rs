//! Parameters of the hand: impedance, force guard, grasping, carrying and releasing.

parameters! {
    /// The hand: impedance, guard, fingers.
    HandParameters {
        /// Stiffness of the hand in contact, along and about the axes of the world. Chosen.
        stiffness: [f64; 6] = "N/m, N·m/rad", 1.0, 5000.0;
        /// Distance to the commanded width at which the fingers count as open.
        opened: f64 = "m", 1e-5, 0.02;
        /// Largest angular speed of a straight motion. Chosen.
        turn_speed: f64 = "rad/s", 0.01, 3.0;
        /// Acceleration of a straight motion. Chosen: the inertial force of the hand is then 3 N.
        acceleration: f64 = "m/s²", 0.05, 10.0;
        /// Angular acceleration. Chosen.
        turn_acceleration: f64 = "rad/s²", 0.05, 50.0;
        /// Fractions of a joint's velocity limit between which a straight motion slows down to a creep.
        /// Chosen.
        hurry: [f64; 2] = "", 0.05, 1.0;
        /// Time without motion after which the fingers have closed or opened. With 0.04 s, fingers whose ribs
        /// slide into a slot count as closed too early.
        still: f64 = "s", 0.001, 1.0;
        /// Longest interval between width readings of a gripper. A Franka hand sends ten per second.
        told_every: f64 = "s", 0.001, 1.0;
        /// Force on the wrist at which a motion is aborted. A cap is swept back and forth with up to 38 N,
        /// and fingers that descend around a beam may rub along it with 30 N.
        guard: f64 = "N", 5.0, 200.0;
        /// Duration of the compliant retreat after that. Chosen.
        yield_time: f64 = "s", 0.0, 5.0;
        /// Duration of the halt of a motion through free space. Chosen: from its largest velocity, joint 2
        /// of a Panda slows down by 6.9 rad/s², of 7.5 that it may.
        halt: f64 = "s", 0.01, 5.0;
        /// Time for a motion to settle. The filter of the wrist sensor has a time constant of 20 ms.
        rest: f64 = "s", 0.0, 10.0;
        /// Joint speed below which the arm is at rest. Chosen: 0.1 mm in the duration of a look.
        at_rest: f64 = "rad/s", 1e-5, 0.1;
        /// Longest wait for the arm to come to rest.
        settled: f64 = "s", 0.0, 10.0;
        /// Distance to the setpoint at which a hand at rest has arrived. Chosen: a tenth of the clearance of
        /// a joint.
        arrived: [f64; 2] = "m, rad", 0.0, 0.1;
        /// Time at rest further away after which the hand is blocked by more than friction. The arm's
        /// compensation overcomes friction in that time.
        stuck: f64 = "s", 0.0, 1.0;
        /// Change of the wrist force while carrying from which the held part counts as pushed. Carrying a
        /// beam alone changes it by 5 N at most.
        pushed_force: f64 = "N", 0.1, 200.0;
        /// The same for the moment. Carrying a part alone changes it by up to 0.64 N·m, mostly by the
        /// friction of the joints.
        pushed_moment: f64 = "N·m", 0.01, 20.0;
        /// The same at the least, over the error of the force in free space: with an error of 1.6 N, the
        /// moment errs by up to 0.95 N·m while the arm carries a beam.
        pushed_usual: f64 = "m", 0.0, 10.0;
    }
}

parameters! {
    /// The trim of a straight motion that must keep its line.
    TrimParameters {
        /// Time in which the tip returns to its line. Chosen: several times that of the hand's impedance.
        time: f64 = "s", 0.02, 10.0;
        /// Largest shift of the setpoint: with the hand's stiffness, a force equal to friction.
        most: f64 = "m", 0.0, 0.01;
        /// Largest rotation of the setpoint.
        most_turn: f64 = "rad", 0.0, 0.05;
        /// Error of the force in free space up to which these bounds hold. With more, joint friction is
        /// larger, and they grow in proportion: in the world `real` the error is 0.4 to 1.3 N, in `hard` 2.7
        /// to 4.1 N.
        smooth: f64 = "N", 0.1, 50.0;
    }
}

parameters! {
    /// Rise of a force over its running mean: detects contact when the measured force includes bias and
    /// friction.
    RiseParameters {
        /// Time after the start of a motion in which its force counts as that of free motion: joint friction
        /// steps up then.
        begin: f64 = "s", 0.0, 1.0;
        /// Share of the setpoint's speed at which the tip follows it, and a motion has begun. Chosen.
        follows: f64 = "", 0.0, 1.0;
        /// Time constant of the smoothing of both speeds. Chosen: the encoders' noise.
        smooth: f64 = "s", 0.001, 1.0;
        /// Largest rise of the force while a motion begins, as a multiple of the usual error of the force in
        /// free space: friction of the joints made it 2.5 times that at most. More is an obstacle.
        friction: f64 = "", 0.0, 100.0;
        /// The same at the least.
        least: f64 = "N", 0.0, 100.0;
        /// Time constant of the running mean: contact with an edge is faster, friction changes more slowly.
        mean: f64 = "s", 0.01, 10.0;
    }
}

parameters! {
    /// The sense of touch, where the fingers have tactile sensors.
    FeltParameters {
        /// Time constant of the smoothing of their forces. Chosen: three readings.
        smooth: f64 = "s", 0.001, 1.0;
        /// Pressing force of both fingers below which a held part may slip. Chosen: well within the range of
        /// the sensors.
        press: f64 = "N", 0.1, 1000.0;
        /// Commanded force of the gripper above which it means to hold a part firmly. Chosen.
        told: f64 = "N", 0.1, 1000.0;
    }
}

parameters! {
    /// Grasps: widths and forces of the fingers, and when a part counts as held.
    GripParameters {
        /// Distance between the fingers at which the ribs pass beside an extrusion on the sheet.
        beam_open: f64 = "m", 0.023, 0.08;
        /// Distance between the fingers when they release a beam in the assembly, where there is more room. A
        /// beam that droops on release moves sideways by up to 2.5 mm and must not hang on a rib.
        beam_release: f64 = "m", 0.023, 0.08;
        /// Distance between the fingers at which the blocks pass beside a peg's head.
        peg_open: f64 = "m", 0.049, 0.08;
        /// Difference between a part's width and the commanded closing width. Chosen.
        squeeze: f64 = "m", 0.0, 0.02;
        /// Force of each finger on a part. Chosen.
        force: f64 = "N", 1.0, 140.0;
        /// Force of each finger that opens or moves freely. Chosen.
        opening_force: f64 = "N", 1.0, 140.0;
        /// Least distance of a finger's middle from the end of a bare extrusion: half its width plus the
        /// errors of vision and arm. With 1 mm less, one in forty grasps beside a joint landed on it.
        finger_room: f64 = "m", 0.0, 0.05;
        /// Step between grasp candidates along a link. Chosen.
        step: f64 = "m", 5e-4, 0.1;
        /// Shift of a part in the hand from which it counts as lost.
        strayed: f64 = "m", 1e-4, 0.1;
        /// The same for a beam along its own axis.
        slipped: f64 = "m", 1e-4, 0.2;
        /// Number of looks at a part that was pushed in the hand until its pose is known again. Chosen.
        looks: usize = "", 0.0, 100.0;
        /// Distance beside the fingers at which a pushed part must be visible.
        beside: f64 = "m", 0.0, 0.5;
        /// Largest height uncertainty of that point, 1 σ; above it, the part cannot be seen in the hand.
        unseen: f64 = "m", 1e-5, 0.1;
        /// Difference between measured and expected finger width beyond which the part is not held.
        width_tolerance: f64 = "m", 1e-4, 0.02;
        /// Gap before a part from which stopped fingers do not hold it and are closed again.
        short: f64 = "m", 1e-5, 0.02;
        /// Number of times the fingers are then closed. Chosen.
        closings: usize = "", 1.0, 20.0;
        /// Increase in width from which stopped fingers count as opened. Fingers that sprang back to their
        /// opening for a peg do not count as opened.
        opened: f64 = "m", 0.0, 0.02;
        /// Distance by which fingers open that have closed on something wider than they open for the part:
        /// a joint. Chosen.
        off: f64 = "m", 0.0, 0.02;
        /// Angle to the table beyond which a beam in the hand is tilted.
        tilted: f64 = "rad", 1e-3, 1.5;
    }
}

parameters! {
    /// Carrying the held part to a place.
    CarryParameters {
        /// Number of looks at a part that is pushed while it is carried. Chosen.
        tries: usize = "", 1.0, 20.0;
        /// Largest tilt of the part or the hand on release.
        tilted: f64 = "rad", 1e-4, 0.5;
        /// Number of corrections towards a pose in free space. Chosen.
        corrections: usize = "", 1.0, 50.0;
        /// Distance to the pose at which the part has arrived.
        near: f64 = "m", 1e-6, 0.01;
        /// The same in rotation.
        near_turn: f64 = "rad", 1e-5, 0.5;
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
    }
}

parameters! {
    /// Releasing a part without moving it.
    ReleaseParameters {
        /// Force of each finger while the hand rotates upright: a firmly held beam rotates with it.
        loose_grip: f64 = "N", 0.1, 140.0;
        /// Largest tilt of a hand that counts as upright.
        straight: f64 = "rad", 1e-4, 0.5;
        /// Number of rotations for that. The released part resists them.
        straightenings: usize = "", 0.0, 50.0;
        /// Force at which this rotation stops, well below the force that aborts every motion.
        straighten_limit: f64 = "N", 1.0, 100.0;
        /// Force at which an open finger touches the released beam. Without contact the force is below 7 N.
        beside_limit: f64 = "N", 1.0, 100.0;
        /// A beam sticks to a finger when its offset from the middle of the open hand exceeds this fraction
        /// of the distance to the finger. Chosen.
        followed: f64 = "", 0.1, 1.0;
        /// Force of each finger that opens while its rib is wedged in the slot of a beam. Source: the Franka
        /// Hand's continuous force is 70 N.
        wedged_force: f64 = "N", 1.0, 140.0;
        /// Share of its weight that the rising hand carries from which a beam may hang on a finger, which an
        /// image then decides. Measured: 0.8 to 1 where it hangs, at most 0.4 where it lies; a rough arm
        /// feels as much by its own friction.
        hanging: f64 = "", 0.1, 2.0;
        /// Number of further releases of a beam that hangs on a rib. Chosen.
        again: usize = "", 0.0, 20.0;
        /// Finger opening of those: ribs are out of their slots from 30 mm on, and a neighbour may stand
        /// close by.
        less_open: f64 = "m", 0.03, 0.08;
        /// Steps along the beam in which a place is looked for where the fingers have room to open. Chosen.
        room_step: f64 = "m", 1e-3, 0.1;
        /// Finger opening beyond a beam's width at which the ribs move freely in its slots without leaving
        /// them.
        in_slot: f64 = "m", 0.0, 0.02;
        /// Clearance of a rib in a slot above and below it: the slot is 5 mm wide, the rib 3 mm thick.
        slot_room: f64 = "m", 0.0, 0.01;
        /// Force at which a rib stands on the lower side of its slot.
        slot_limit: f64 = "N", 0.5, 50.0;
        /// Depth of the search for that side.
        slot_depth: f64 = "m", 0.0, 0.05;
        /// Position uncertainty of a beam in which the hand has rotated upright, 1 σ, axes of the world.
        stayed_position: [f64; 3] = "m", 1e-6, 0.1;
        /// The same for its rotation.
        stayed_rotation: [f64; 3] = "rad", 1e-6, 1.0;
        /// Force on the table at which a beam lies on it.
        table_limit: f64 = "N", 0.5, 100.0;
        /// Height of the slow rise from a beam. Within it the ribs of the fingers leave the slots. Chosen.
        leaving: f64 = "m", 0.0, 0.05;
        /// Speed of that rise. At 0.4 m/s, a beam that hung on a finger pressed with 110 N before the wrench
        /// showed it.
        leaving_speed: f64 = "m/s", 1e-3, 0.5;
        /// Height by which the hand lifts off the released part. Chosen.
        lift_off: f64 = "m", 1e-3, 0.3;
        /// Speed of the open hand to the middle of the beam. Chosen.
        centre_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed of the return to a beam that hangs on a rib. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed of the rotation to upright. Chosen.
        straighten_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed of the lift-off. Chosen.
        lift_off_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed of the search for the side of a slot. Chosen.
        slot_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which it lowers the free end of a beam onto the table. Chosen.
        table_speed: f64 = "m/s", 1e-3, 0.5;
        /// Longest time that this motion takes beyond its length over its speed, by which fingers with a dead
        /// time are told to open before its end. Chosen.
        table_time: f64 = "s", 0.0, 1.0;
    }
}
