//! Parameters of the hand: its impedance and its guard, how it grasps, carries and lets go.

parameters! {
    /// The hand: impedance, guard, fingers.
    HandParameters {
        /// Stiffness of the hand in contact, along and about the axes of the world. Chosen.
        stiffness: [f64; 6] = "N/m, N·m/rad", 1.0, 5000.0;
        /// This near to the wanted width the fingers are open.
        opened: f64 = "m", 1e-5, 0.02;
        /// Fastest turn of a straight motion. Chosen.
        turn_speed: f64 = "rad/s", 0.01, 3.0;
        /// How fast a straight motion gains and loses speed. Chosen: what the hand weighs is then 3 N.
        acceleration: f64 = "m/s²", 0.05, 10.0;
        /// The same for a turn. Chosen.
        turn_acceleration: f64 = "rad/s²", 0.05, 50.0;
        /// The shares of a joint's largest velocity between which a straight motion slows down to a creep. Chosen.
        hurry: [f64; 2] = "", 0.05, 1.0;
        /// How long the fingers stand still when they have closed or opened. With 0.04 s, fingers whose ribs slide into a slot
        /// count as closed on the way.
        still: f64 = "s", 0.001, 1.0;
        /// How often a gripper tells its width at least. A Franka hand does so ten times a second.
        told_every: f64 = "s", 0.001, 1.0;
        /// Force on the wrist at which a motion is broken off. A cap is swept to and fro with up to 38 N, and fingers that come
        /// down around a beam may brush along it with 30 N.
        guard: f64 = "N", 5.0, 200.0;
        /// How long the hand yields after that. Chosen.
        yield_time: f64 = "s", 0.0, 5.0;
        /// How long the hand waits until a motion has faded. The filter of the wrist sensor has a time constant of 20 ms.
        rest: f64 = "s", 0.0, 10.0;
        /// Speed of the joints below which the arm is still. Chosen: a tenth of a millimetre in the time of a look.
        at_rest: f64 = "rad/s", 1e-5, 0.1;
        /// How long the hand waits at most until the arm is still.
        settled: f64 = "s", 0.0, 10.0;
        /// A hand that is still this near to where it is pulled has arrived. Chosen: a tenth of the clearance of a joint.
        arrived: [f64; 2] = "m, rad", 0.0, 0.1;
        /// One that is still for so long further away is held by more than friction, which the arm's compensation overcomes by
        /// then.
        stuck: f64 = "s", 0.0, 1.0;
        /// What is held has been pushed when the force at the wrist changes by more while it is carried. A beam that is only
        /// carried changes it by 5 N at most.
        pushed_force: f64 = "N", 0.1, 200.0;
        /// The same for the moment: a carried beam changes it by 0.13 N·m at most.
        pushed_moment: f64 = "N·m", 0.01, 20.0;
    }
}

parameters! {
    /// The trim of a straight motion that must keep its line.
    TrimParameters {
        /// Time in which the tip comes back to its line. Chosen: several times that of the hand's impedance.
        time: f64 = "s", 0.02, 10.0;
        /// How fast such a motion gains and loses speed. Chosen: in the first millimetres the tip comes back to its line.
        acceleration: f64 = "m/s²", 0.01, 10.0;
        /// How far the setpoint is shifted at most: with the hand's stiffness a force of as much as friction takes.
        most: f64 = "m", 0.0, 0.01;
        /// How far it is turned at most.
        most_turn: f64 = "rad", 0.0, 0.05;
    }
}

parameters! {
    /// The rise of a force over its running mean: what a motion meets when the measured force has a bias and holds friction.
    RiseParameters {
        /// How long after a motion begins its force is taken for that of the free motion: friction in the joints steps up then.
        begin: f64 = "s", 0.0, 1.0;
        /// Time constant of the running mean: an edge is met faster, friction changes more slowly.
        mean: f64 = "s", 0.01, 10.0;
    }
}

parameters! {
    /// Grasps: widths and forces of the fingers, and when a part counts as held.
    GripParameters {
        /// Distance between the fingers that lets the ribs pass beside an extrusion on the sheet.
        beam_open: f64 = "m", 0.023, 0.08;
        /// Distance between the fingers when they let go of a beam in the assembly, where there is more room. A beam that
        /// droops as it is let go moves sideways by up to 2.5 mm, and must not hang on a rib.
        beam_release: f64 = "m", 0.023, 0.08;
        /// Distance between the fingers that lets the blocks pass beside a peg's head.
        peg_open: f64 = "m", 0.049, 0.08;
        /// How much further than a part's width the fingers are told to close. Chosen.
        squeeze: f64 = "m", 0.0, 0.02;
        /// Force of each finger on a part. Chosen.
        force: f64 = "N", 1.0, 140.0;
        /// Force of each finger that opens, or moves beside nothing. Chosen.
        opening_force: f64 = "N", 1.0, 140.0;
        /// How near the middle of a finger may come to the end of a bare extrusion: half its width, and what sight and the arm
        /// may be off. With a millimetre less one in forty grasps beside a joint landed on it.
        finger_room: f64 = "m", 0.0, 0.05;
        /// Distance between places at which a grasp is tried along a link. Chosen.
        step: f64 = "m", 5e-4, 0.1;
        /// A part that has moved further than this in the hand has slipped out of it.
        strayed: f64 = "m", 1e-4, 0.1;
        /// The same for a beam along its own axis.
        slipped: f64 = "m", 1e-4, 0.2;
        /// How often a part that was pushed in the hand is looked at before it is known again. Chosen.
        looks: usize = "", 0.0, 100.0;
        /// How far beside the fingers a part that was pushed must be seen.
        beside: f64 = "m", 0.0, 0.5;
        /// How well that point must be known in height, 1 σ; else the part cannot be seen in the hand.
        unseen: f64 = "m", 1e-5, 0.1;
        /// Distance between what the fingers hold and what they should, beyond which the part is not held.
        width_tolerance: f64 = "m", 1e-4, 0.02;
        /// Fingers that stop this far before a part do not hold it, and are closed again.
        short: f64 = "m", 1e-5, 0.02;
        /// How often the fingers are closed then. Chosen.
        closings: usize = "", 1.0, 20.0;
        /// Fingers count as opened when they are so much further apart than where they stopped. Those that sprang back as far
        /// as they open for a peg have not been opened by that.
        opened: f64 = "m", 0.0, 0.02;
        /// Angle to the table beyond which a beam in the hand is tilted.
        tilted: f64 = "rad", 1e-3, 1.5;
    }
}

parameters! {
    /// Carrying: what is held is brought above a place.
    CarryParameters {
        /// How often a part that is pushed while it is carried is looked at. Chosen.
        tries: usize = "", 1.0, 20.0;
        /// An angle by which a part or the hand may be tilted when it lets go.
        tilted: f64 = "rad", 1e-4, 0.5;
        /// How often a held part is brought nearer to a pose in free space. Chosen.
        corrections: usize = "", 1.0, 50.0;
        /// This near to the pose it is there.
        near: f64 = "m", 1e-6, 0.01;
        /// This near to it in rotation.
        near_turn: f64 = "rad", 1e-5, 0.5;
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
    }
}

parameters! {
    /// Letting go, so that the part stays where it is.
    ReleaseParameters {
        /// Force of each finger while the hand turns straight: a beam that is held firmly turns along with it.
        loose_grip: f64 = "N", 0.1, 140.0;
        /// Angle by which a hand that has turned straight may lean.
        straight: f64 = "rad", 1e-4, 0.5;
        /// How often it turns for that. What is left holds against it.
        straightenings: usize = "", 0.0, 50.0;
        /// Force at which it stops turning straight, well below that which breaks every motion off.
        straighten_limit: f64 = "N", 1.0, 100.0;
        /// Force at which an open finger has met the beam that the hand has let go of. Without one it feels less than 7 N.
        beside_limit: f64 = "N", 1.0, 100.0;
        /// A beam follows a finger when it is still off the middle of the open hand by this share of the way to the finger. Chosen.
        followed: f64 = "", 0.1, 1.0;
        /// How often a beam is let go of again when it hangs on a rib. Chosen.
        again: usize = "", 0.0, 20.0;
        /// How much wider than a beam the fingers are when their ribs move freely in its slots without leaving them.
        in_slot: f64 = "m", 0.0, 0.02;
        /// Room of a rib in a slot above and below it: the slot is 5 mm wide, the rib 3 mm thick.
        slot_room: f64 = "m", 0.0, 0.01;
        /// Force at which a rib stands on the lower side of its slot.
        slot_limit: f64 = "N", 0.5, 50.0;
        /// How far down that side is looked for.
        slot_depth: f64 = "m", 0.0, 0.05;
        /// How well the position of a beam is known in which the hand has turned straight, 1 σ, axes of the world.
        stayed_position: [f64; 3] = "m", 1e-6, 0.1;
        /// The same for its rotation.
        stayed_rotation: [f64; 3] = "rad", 1e-6, 1.0;
        /// Force on the table at which a beam lies on it.
        table_limit: f64 = "N", 0.5, 100.0;
        /// How far the hand rises slowly from a beam. Within it the ribs of the fingers leave the slots. Chosen.
        leaving: f64 = "m", 0.0, 0.05;
        /// Speed with which it does. At 0.4 m/s a beam that hung on a finger pressed with 110 N before the wrench told it.
        leaving_speed: f64 = "m/s", 1e-3, 0.5;
        /// How far the hand lifts off from what it let go of. Chosen.
        lift_off: f64 = "m", 1e-3, 0.3;
        /// Speed with which the open hand goes to the middle of the beam. Chosen.
        centre_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which it goes back to a beam that hangs on a rib. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which it turns straight. Chosen.
        straighten_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which it lifts off. Chosen.
        lift_off_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which it looks for the side of a slot. Chosen.
        slot_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed with which it lowers the free end of a beam onto the table. Chosen.
        table_speed: f64 = "m/s", 1e-3, 0.5;
    }
}
