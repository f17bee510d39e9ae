//! Parameters of the agent and of the skills that insert nothing.

parameters! {
    /// The agent: replanning and checks.
    AgentParameters {
        /// Robot time after which no new plan is begun. Chosen: what is left of an episode builds no more
        /// than a beam and its pegs.
        latest: f64 = "s", 0.0, 1800.0;
        /// Pause before the last try of the same, in which a disturbance of the sight may pass. Chosen.
        pause: f64 = "s", 0.0, 600.0;
        /// Largest uncertainty of two holes for judging whether a peg goes in, 1 σ.
        holes_known: f64 = "m", 1e-5, 0.1;
        /// Distance from its place in the holder above which a peg is no longer fetched. In its hole it can
        /// be 3 mm off.
        peg_strayed: f64 = "m", 1e-4, 0.1;
    }
}

parameters! {
    /// The agent before a build from a start whose parts lie anywhere: finds them, and clears the place where
    /// the frame is to stand.
    ClearParameters {
        /// Images of each camera over each place where parts may lie.
        looks: usize = "", 1.0, 20.0;
        /// Angle about the arm's foot between these places. Chosen: the pictures of the camera on the hand
        /// overlap.
        turn: f64 = "rad", 0.05, 3.2;
        /// Points that are nearer than this to one that was looked at are not looked at again to tell a beam
        /// from others.
        visited: f64 = "m", 1e-3, 0.2;
        /// Least distance of a beam from the places and the paths of the beams of the frame, along the table.
        /// The fingers that hold a beam there need it.
        frame: f64 = "m", 0.0, 0.3;
        /// Least distances at which a beam is laid down beside other parts, so that the fingers fit, one
        /// after another until a place is found.
        beside: [f64; 3] = "m", 0.0, 0.3;
        /// Distance between the places tried on the table. Chosen: about the width of a beam.
        place_step: f64 = "m", 0.005, 0.5;
        /// Distance between the poses along a path of insertion at which it is asked what lies there.
        step: f64 = "m", 1e-3, 0.1;
        /// Number of times that each beam in the way is tried: one may lie beside another that has to go
        /// first.
        rounds: usize = "", 1.0, 10.0;
        /// Height of a beam off its height on the table from which it counts as lying on something else.
        raised: f64 = "m", 1e-3, 0.1;
    }
}

parameters! {
    /// The places on the sheet to which parts are put back when a frame is taken apart.
    SheetPlaceParameters {
        /// Shifts beside an outline that are tried, along x and along y. Chosen: as far as the start `moved`
        /// lays parts.
        shift: [f64; 3] = "m", -0.02, 0.02;
        /// Turns that are tried. Chosen likewise.
        turn: [f64; 5] = "rad", -0.2, 0.2;
        /// Least distances from other parts, one after another until a place is found.
        beside: [f64; 4] = "m", 0.0, 0.1;
        /// Distance from a place, along the table and upward, within which a part is back.
        near: f64 = "m", 1e-3, 0.05;
        /// Turn by which a beam that is back may lie beyond the turns that are tried.
        turn_near: f64 = "rad", 0.0, 0.5;
    }
}

parameters! {
    /// The agent before a build that begins with a frame.
    RepairParameters {
        /// Distance from a place on the sheet within which a part lies there.
        on_sheet: f64 = "m", 1e-3, 0.3;
        /// Distance along its insertion path from which a beam is brought to its place. Chosen: its joints
        /// are still in line.
        along: f64 = "m", 1e-3, 0.2;
    }
}

parameters! {
    /// The agent on a piece of a plan, in an assembly begun by another agent.
    PieceParameters {
        /// Position uncertainty of a beam that another agent inserted, 1 σ, axes of the world.
        beam_position: [f64; 3] = "m", 1e-6, 0.1;
        /// Rotation uncertainty of such a beam.
        beam_rotation: [f64; 3] = "rad", 1e-6, 3.2;
        /// Position uncertainty of a peg that another agent pressed in, 1 σ, axes of the world.
        peg_position: [f64; 3] = "m", 1e-6, 0.1;
        /// Rotation uncertainty of such a peg. Its rotation about its own axis is unknown.
        peg_rotation: [f64; 3] = "rad", 1e-6, 3.2;
        /// Number of rounds in which the holes to be pinned next are looked at and beams pushed. Chosen.
        rounds: usize = "", 0.0, 20.0;
    }
}

parameters! {
    /// Moves the hand and the held part from place to place.
    MoveToParameters {
        /// Largest uncertainty of the joints that a beam is to meet before it is fetched, 1 σ. Its place is
        /// easier to see before the beam is in the hand.
        known: f64 = "m", 1e-5, 0.1;
        /// Additional height at which a peg is brought over its hole, above the start of its descent. Chosen.
        above: f64 = "m", 0.0, 0.1;
    }
}

parameters! {
    /// Grasps a part where it stands, and lifts it.
    PickUpParameters {
        /// Height by which a beam is lifted off the table.
        lift: f64 = "m", 1e-3, 0.3;
        /// Height by which a peg is lifted, fully out of its holder.
        peg_lift: f64 = "m", 1e-3, 0.3;
        /// Speed of the lift. Chosen.
        speed: f64 = "m/s", 1e-3, 1.0;
        /// Speed of the lift of a beam that leans on something, until it is level. Chosen.
        leaning_speed: f64 = "m/s", 1e-3, 1.0;
    }
}

parameters! {
    /// Puts the held part back where it was picked up.
    PutDownParameters {
        /// Height over its place from which a part is lowered. A peg's stem is then above its holder, a beam
        /// above the table.
        above: f64 = "m", 1e-3, 0.3;
        /// Speed at which a peg is lowered. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Height over the table down to which a beam is lowered fast. Chosen.
        near: f64 = "m", 1e-3, 0.1;
        /// Speed at which it is lowered down to there. Chosen.
        down_speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed from there on. At 0.05 m/s the table wedged the ribs of the fingers in the slots of a beam
        /// in one of ten, and the beam came along with the hand.
        beam_speed: f64 = "m/s", 1e-3, 0.5;
        /// Force on the table or the holder at which a part is put down.
        limit: f64 = "N", 0.5, 100.0;
        /// Longest search for the hole of the holder with the tip of a peg. Chosen.
        search_time: f64 = "s", 0.0, 600.0;
    }
}

parameters! {
    /// Lays the held beam on the table at its place.
    LayDownParameters {
        /// Speed at which it is lowered. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
    }
}

parameters! {
    /// Draws a beam out of the assembly.
    TakeOutParameters {
        /// Number of tries.
        tries: usize = "", 1.0, 20.0;
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Distance of the closed fingers from a beam's width from which their ribs are wedged at the edges
        /// of its slots. Measured: at most 0.1 mm in the slots, 0.3 to 0.9 mm wedged.
        wedged: f64 = "m", 1e-5, 0.01;
        /// Force at which lifting it level stops.
        lift_limit: f64 = "N", 0.5, 100.0;
        /// Force against the motion at which drawing stops, and a search begins.
        limit: f64 = "N", 0.5, 100.0;
        /// Distance beyond the start of its insertion path to which it is drawn out. Chosen.
        beyond: f64 = "m", 0.0, 0.05;
        /// Shift of the beams that it was joined to. Chosen.
        bump: f64 = "m", 0.0, 0.05;
        /// Rotation of those beams. Chosen.
        bump_turn: f64 = "°", 0.0, 45.0;
    }
}

parameters! {
    /// Slides a beam of the assembly back, deeper than its place.
    SlideBackParameters {
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Force at which lifting it level stops.
        lift_limit: f64 = "N", 0.5, 100.0;
        /// Force against the motion at which sliding stops, and a search begins.
        limit: f64 = "N", 0.5, 100.0;
        /// Distance from its deep place at which it counts as slid back. Chosen.
        short: f64 = "m", 1e-4, 0.05;
        /// Shift of the beams that it was joined to. Chosen.
        bump: f64 = "m", 0.0, 0.05;
        /// Rotation of those beams. Chosen.
        bump_turn: f64 = "°", 0.0, 45.0;
    }
}

parameters! {
    /// Pulls a peg out of its connection.
    PullOutParameters {
        /// Number of tries.
        tries: usize = "", 1.0, 20.0;
        /// Height by which it is pulled up, fully out of both joints.
        height: f64 = "m", 0.01, 0.3;
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Shift of the two beams. Chosen.
        bump: f64 = "m", 0.0, 0.05;
        /// Rotation of the two beams. Chosen.
        bump_turn: f64 = "°", 0.0, 45.0;
    }
}

parameters! {
    /// Slides a beam that stands deeper than its place forward to its place.
    SlideParameters {
        /// Speed. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed at which the beam is finally brought to its place. Chosen.
        seat_speed: f64 = "m/s", 1e-3, 0.5;
        /// Wait between the motion and the look. Chosen.
        rest: f64 = "s", 0.0, 10.0;
        /// Force at which lifting stops.
        lift_limit: f64 = "N", 0.5, 100.0;
        /// Force against the motion at which sliding stops.
        limit: f64 = "N", 0.5, 100.0;
        /// The same in all tries after the first: a rough arm feels its own friction and that of the sleeve.
        most: f64 = "N", 0.5, 100.0;
        /// Distance from its place at which the beam is seated. A peg closes twice that gap.
        seated: f64 = "m", 1e-5, 0.02;
        /// Largest uncertainty of the joints that are to meet, 1 σ.
        known: f64 = "m", 1e-5, 0.1;
        /// Lateral steps that are tried in turn when the end meets an edge.
        aside: [f64; 5] = "m", -0.02, 0.02;
        /// Shift of the beams that the slide joins. Measured: 0.9 mm.
        dragged: f64 = "m", 0.0, 0.05;
        /// Rotation of those beams. Chosen.
        dragged_turn: f64 = "°", 0.0, 45.0;
    }
}

parameters! {
    /// Changes the grasp of the held beam to another link.
    RegraspParameters {
        /// Range of the places tried on the table, along x of the world.
        table_x: [f64; 2] = "m", -1.0, 1.0;
        /// The same along y.
        table_y: [f64; 2] = "m", -1.0, 1.0;
        /// Distance between these places.
        step: f64 = "m", 0.005, 0.5;
        /// Height over the table at which the place of a held beam is checked.
        over: f64 = "m", 0.0, 0.1;
        /// Height from which it is lowered slowly. Chosen.
        drop: f64 = "m", 0.0, 0.2;
        /// Force on the table at which it lies.
        limit: f64 = "N", 0.5, 100.0;
        /// Speed at which it is lowered. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Speed of the hand down to where it lowers the beam slowly. Chosen.
        down_speed: f64 = "m/s", 1e-3, 0.5;
        /// Least distance of the joints from their limits.
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
        /// Distance short of its place from which a beam is inserted further instead.
        short_of: f64 = "m", 1e-4, 0.1;
        /// Shift of the beams that are joined to a pushed beam.
        dragged: f64 = "m", 0.0, 0.05;
        /// Rotation of those beams.
        dragged_turn: f64 = "°", 0.0, 45.0;
        /// Number of pushes of one beam. Chosen.
        tries: usize = "", 1.0, 20.0;
        /// Deviation below which a beam is not pushed: well within the tolerance of a peg or a cap. Chosen.
        near: f64 = "m", 0.0, 0.01;
        /// Remaining fraction of the deviation above which a beam is not pushed again. Chosen.
        no_nearer: f64 = "", 0.0, 1.0;
        /// Distance by which a push that leaves more than that share must bring the beam nearer, or it was
        /// the last. Chosen.
        gained: f64 = "m", 1e-4, 0.1;
        /// Largest number of motions in one push: friction on the table stops each of them a little short.
        motions: usize = "", 1.0, 50.0;
    }
}

parameters! {
    /// Pins two joints with the held peg.
    FastenParameters {
        /// Largest uncertainty of the peg before it is lowered, 1 σ.
        known: f64 = "m", 1e-5, 0.1;
        /// Largest tilt of the peg when it is lowered.
        upright: f64 = "rad", 1e-4, 0.5;
        /// Duration of the search up to 4 mm around the detected hole, before the peg is assumed to be
        /// tilted.
        near_time: f64 = "s", 0.0, 600.0;
        /// Longest search further around. Chosen.
        search_time: f64 = "s", 0.0, 600.0;
        /// Speed at which a peg is drawn out of its hole for another attempt. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// Shift of the two beams by pressing a peg in.
        bump: f64 = "m", 0.0, 0.05;
        /// Rotation of those beams.
        bump_turn: f64 = "°", 0.0, 45.0;
        /// Number of attempts. Chosen.
        tries: usize = "", 1.0, 20.0;
    }
}
