//! Parameters of searches and of pressing.

parameters! {
    /// The compliant search of an insertion that stalls on an edge.
    SearchParameters {
        /// Distance from its place at which an inserted beam is seated. A peg closes twice that gap.
        seated: f64 = "m", 1e-5, 0.02;
        /// Longest duration of a search. Chosen.
        longest: f64 = "s", 0.0, 600.0;
        /// Time without motion after which the beam is swung. A beam that is not wedged advances by
        /// `progress` in that time.
        patience: f64 = "s", 0.0, 60.0;
        /// Duration of the growth of the swing.
        growth: f64 = "s", 0.01, 60.0;
        /// Period after which the swing starts small again.
        cycle: f64 = "s", 0.01, 600.0;
        /// Least advance within a search's `pace_time`. With less, the search ends.
        pace_distance: f64 = "m", 0.0, 0.1;
        /// Interval between looks at a part that does not advance: it may have moved in the hand.
        look_every: f64 = "s", 0.1, 600.0;
        /// Progress that counts as having moved.
        progress: f64 = "m", 0.0, 0.05;
        /// Time in which the tip comes back to where it is wanted, and follows a swing. Chosen: as a swing
        /// takes.
        keep_time: f64 = "s", 0.02, 10.0;
    }
}

parameters! {
    /// First contact: how the hand comes down on a part while no grasp has shown how high the arm really is,
    /// and its search for the slots of a beam that it has missed.
    FeelParameters {
        /// Height over the grasp from which the hand comes down slowly. Errors of an arm and of its table are
        /// up to 2 mm in the world `hard`.
        over: f64 = "m", 0.0, 0.05;
        /// Share of the limits of the joints' velocities of that descent: about 0.03 m/s. A contact pushes
        /// with less than half of a reflex.
        velocity: f64 = "", 0.005, 1.0;
        /// Rise of the force at which it ends: the hand stands on something. Chosen.
        limit: f64 = "N", 1.0, 50.0;
        /// Difference from the width over the ribs on the sides of an extrusion up to which closed fingers
        /// stand beside its slots. Chosen.
        beside: f64 = "m", 1e-5, 0.01;
        /// Height by which the hand is raised to come down on the slots: twice an arm's error.
        raise: f64 = "m", 1e-3, 0.02;
        /// The same if the blocks over the ribs stand on the sides: the hand is far too low.
        raise_blocks: f64 = "m", 1e-3, 0.05;
        /// Largest error of the arm's heights that a search for the slots teaches: what is more is an error
        /// of the beam's height.
        learned: f64 = "m", 1e-4, 0.02;
        /// Way down from there in which the ribs have to find the slots.
        depth: f64 = "m", 1e-3, 0.05;
        /// Speed of that way. Chosen.
        speed: f64 = "m/s", 1e-4, 0.1;
        /// Force of each finger meanwhile. Chosen: enough to slide in, too little to hold.
        force: f64 = "N", 0.1, 50.0;
        /// Force from below at which the way ends. Chosen.
        stands: f64 = "N", 1.0, 50.0;
    }
}

parameters! {
    /// Height measurement by contact.
    TouchParameters {
        /// Height uncertainty below which no contact measurement is needed, 1 σ.
        trusted: f64 = "m", 0.0, 0.01;
        /// Force with which a beam is pressed flat on the table. At the beam's end it rotates the hand by as
        /// much as friction does.
        press: f64 = "N", 0.5, 50.0;
        /// Speed of that descent. Chosen: the impact stays far below the limits of the arm.
        press_speed: f64 = "m/s", 1e-4, 0.1;
        /// Speed of the setpoint while the force grows after the contact. Chosen.
        load_speed: f64 = "m/s", 1e-4, 0.1;
        /// How far the beam is raised off the table afterwards. Chosen: above its sag and the arm's noise.
        raise: f64 = "m", 0.0, 0.02;
        /// Depth of the setpoint below the believed table: the deflection of the hand's stiffness and the
        /// error of the height.
        further: f64 = "m", 0.0, 0.02;
        /// Duration of pressing. Chosen.
        flat: f64 = "s", 0.0, 5.0;
        /// Error of the force in free space from which the hand is rocked while it presses: the friction of
        /// the joints holds it as much askew as a beam that touches with one end alone. Chosen: in the world
        /// `real` the error is at most 1.0 N, in `hard` at least 2.3 N.
        rough: f64 = "N", 0.0, 50.0;
        /// Swing of the hand while it is rocked, at first. Chosen: twice what friction holds.
        rock: f64 = "°", 0.0, 5.0;
        /// Frequency of that swing. Chosen.
        rock_rate: f64 = "Hz", 0.1, 20.0;
        /// Duration of that swing. Chosen.
        rock_time: f64 = "s", 0.0, 5.0;
        /// Height uncertainty afterwards, 1 σ. Chosen: the tolerance of a printed face.
        known: f64 = "m", 1e-6, 0.01;
        /// Speed with which the beam moves away from the contact. Chosen.
        back_speed: f64 = "m/s", 1e-3, 0.5;
        /// Distance by which a beam backs off from an edge before it touches the floor of the sleeve.
        back: f64 = "m", 0.0, 0.1;
        /// Approximate depth of that floor below the beam.
        depth: f64 = "m", 0.0, 0.02;
        /// Rise of the force at contact with the floor. Chosen.
        force: f64 = "N", 0.1, 50.0;
        /// Speed of that touch. Chosen.
        speed: f64 = "m/s", 1e-4, 0.1;
    }
}

parameters! {
    /// The motion of a compliant search: a push along the insertion path, and swings across it.
    ComplianceParameters {
        /// Push along the path, at the start and late in the search. Through sleeves 4 N: with more, friction
        /// holds the edge against the search, but the arm's own friction may absorb all of it. A loose beam
        /// on the table slides at 1.4 N and turns at 0.7 N at its end. A cap needs more than the weight of
        /// its light end.
        force: [f64; 2] = "N", 0.0, 50.0;
        /// Swing across the path, at the start and fully grown. With a cap it must exceed the compliance of
        /// the frame.
        across: [f64; 2] = "m", 0.0, 0.05;
        /// Frequency of the swing across the path.
        across_rate: f64 = "Hz", 0.0, 20.0;
        /// Vertical swing, at the start and fully grown.
        up: [f64; 2] = "m", 0.0, 0.05;
        /// Frequency of the vertical swing.
        up_rate: f64 = "Hz", 0.0, 20.0;
        /// Rotational swing about the vertical axis, fully grown.
        yaw: f64 = "rad", 0.0, 0.5;
        /// Frequency of the swing about the vertical axis.
        yaw_rate: f64 = "Hz", 0.0, 20.0;
        /// Rotational swing about the horizontal axis across the path, fully grown.
        roll: f64 = "rad", 0.0, 0.5;
        /// Frequency of the swing about the horizontal axis.
        roll_rate: f64 = "Hz", 0.0, 20.0;
        /// Share of the trim's bounds up to which the tip is brought back to where it is wanted across the
        /// path. A cap is pressed on the table by what it lacks.
        kept: f64 = "", 0.0, 1.0;
        /// The same for its rotation. Friction of 0.8 N·m in the wrist leaves the hand turned by 1.3°, and
        /// the end of a long beam 5 mm too high.
        kept_turn: f64 = "", 0.0, 1.0;
        /// Time within which a search must advance, or it ends. A cap that stalls for long is beside an end
        /// and is put on again.
        pace_time: f64 = "s", 0.1, 600.0;
        /// Distance from its place at which the beam is inserted and the search ends.
        near: f64 = "m", 1e-5, 0.02;
    }
}

parameters! {
    /// Probing for the mouth of a joint with a held beam.
    ProbeParameters {
        /// Distance between the places of the grid. Chosen: an unchamfered edge passes within 0.3 mm.
        pitch: f64 = "m", 1e-5, 0.01;
        /// Extent of the grid across the path, and upwards, to each side: the errors of a rough arm's
        /// kinematics, and of a height that was touched.
        reach: [f64; 2] = "m", 0.0, 0.02;
        /// Distance by which the beam backs off. Chosen: the trim takes as long to bring it onto the next
        /// line.
        back: f64 = "m", 1e-3, 0.05;
        /// Distance beyond the edge to which it is pushed: with the hand's stiffness, a push of 12 N.
        beyond: f64 = "m", 1e-3, 0.05;
        /// Distance beyond the edge from which it has entered. Chosen: beyond the compliance of a frame.
        entered: f64 = "m", 1e-3, 0.05;
        /// Speed of a probe. Chosen.
        speed: f64 = "m/s", 1e-3, 0.5;
        /// Force that ends a probe. Chosen.
        limit: f64 = "N", 0.5, 100.0;
    }
}

impl ProbeParameters {
    /// The places of the grid, across the path and upwards (m), the nearest to its middle first.
    pub fn places(&self) -> Vec<[f64; 2]> {
        let steps = self.reach.map(|reach| (reach / self.pitch).floor() as i32);
        let at = |step: i32| f64::from(step) * self.pitch;
        let mut places: Vec<[f64; 2]> = (-steps[0]..=steps[0])
            .flat_map(|across| (-steps[1]..=steps[1]).map(move |up| [at(across), at(up)]))
            .collect();
        let far = |place: &[f64; 2]| place[0].hypot(place[1]);
        places.sort_by(|a, b| far(a).total_cmp(&far(b)));
        places
    }
}

parameters! {
    /// The search for a hole with the tip of a held peg.
    PegSearchParameters {
        /// Height of the tip over the female's top plate when the peg is brought over the hole. Chosen.
        over: f64 = "m", 1e-3, 0.1;
        /// Largest uncertainty of a hole before the peg is lowered, 1 σ. A small error is corrected by
        /// contact.
        hole_known: f64 = "m", 1e-5, 0.1;
        /// Depth of the tip below the top plate at which the hole is found.
        found: f64 = "m", 1e-4, 0.02;
        /// Contact force at which the peg has touched the plate.
        touch: f64 = "N", 0.5, 50.0;
        /// Speed at which the peg is lowered onto the plate or lifted off it, and the limit for lowering it
        /// into its hole during a search. Chosen.
        lower_speed: f64 = "m/s", 1e-3, 0.5;
        /// Downward force during the search. Friction holds the tip until the hand leads it by force × 0.3 /
        /// 1500 N/m.
        force: f64 = "N", 0.5, 50.0;
        /// Distance between turns of the spiral: the cone of a hole catches a tip that passes within 1.7 mm.
        pitch: f64 = "m", 1e-5, 0.01;
        /// Speed along the spiral.
        speed: f64 = "m/s", 1e-4, 0.1;
        /// Radius at which the spiral turns back inward. Chosen.
        widest: f64 = "m", 1e-3, 0.1;
        /// Depth below the height of the contact at which the cone of the tip is in a hole. Chosen: a sixth
        /// of the cone.
        caught: f64 = "m", 1e-4, 0.02;
        /// Force with which it is pressed there. Chosen: on its cone, more than the friction of a rough arm
        /// aside.
        sink_force: f64 = "N", 0.5, 50.0;
        /// Time for which it is. Chosen.
        sink_time: f64 = "s", 0.0, 10.0;
        /// Downward force while the wrist measures the contact point of a tilted peg, and during the search
        /// with that peg.
        tilted_force: f64 = "N", 0.5, 50.0;
        /// A peg whose tip is at least this far beside the hand is tilted in it.
        tilted_least: f64 = "m", 1e-4, 0.1;
        /// Error of the moment under load, as a multiple of its error before contact. Chosen: friction
        /// reverses.
        moment_spread: f64 = "", 0.0, 10.0;
        /// Largest distance of the tip of a held peg beside the hand: 16°.
        tilted_most: f64 = "m", 1e-4, 0.1;
        /// Height by which a tilted peg is lifted off the plate to zero the sensor again.
        lift_off: f64 = "m", 0.0, 0.05;
        /// Extent of the search line around the expected contact of the tip with the hole.
        tilted_around: f64 = "m", 0.0, 0.05;
        /// Speed of that search, and of a spiral until the wrist has measured the contact point. The tip of a
        /// tilted peg is near the edge of the plate.
        tilted_speed: f64 = "m/s", 1e-4, 0.1;
        /// Distance of the hand beside a hole in which the tip is, from which on the peg is tilted: beams are
        /// seen more accurately. Chosen.
        tilted_surely: f64 = "m", 1e-4, 0.1;
        /// Stops of a search along the whole line on which the tip of a tilted peg may be, from the mouth
        /// outwards; the first is on the side to which the wrist has the tip. Chosen: 17°.
        tilted_stops: [f64; 3] = "m", -0.05, 0.05;
        /// Speed of a search along the whole line on which the tip of a tilted peg may be. Chosen.
        line_speed: f64 = "m/s", 1e-4, 0.1;
        /// Swing across that line.
        tilted_sway: f64 = "m", 0.0, 0.01;
        /// Speed with which a peg whose tip is in the hole is turned upright. Chosen.
        upright_speed: f64 = "m/s", 1e-3, 0.5;
        /// Number of control periods of 1 ms for which the tip is measured.
        periods: usize = "", 3.0, 10000.0;
    }
}

parameters! {
    /// Pressing a peg until it is seated.
    PressParameters {
        /// Largest force. Chosen.
        force: f64 = "N", 1.0, 100.0;
        /// Rate at which the force grows.
        rate: f64 = "N/s", 0.1, 1000.0;
        /// Largest downward speed while the peg moves freely. Chosen.
        speed: f64 = "m/s", 0.001, 0.5;
        /// Distance to the plate from which the head moves slowly, because the arm's mass would hit the
        /// plate.
        landing: f64 = "m", 0.0, 0.03;
        /// Speed over that distance. At 0.04 m/s the impact force is 43 N with the drives of an FR3, at this
        /// speed 25 N.
        landing_speed: f64 = "m/s", 0.001, 0.5;
        /// Distance to the plate from which fingers are commanded to open whose dead time is longer than the
        /// way from there takes.
        ahead: f64 = "m", 0.0, 0.03;
        /// Time before the fingers may open at which the press ends. Chosen.
        hold: f64 = "s", 0.0, 1.0;
        /// Time without sinking after which the peg has landed and the force grows fast.
        landed: f64 = "s", 0.0, 10.0;
        /// Radius of the circle that keeps a peg from jamming.
        circle: f64 = "m", 0.0, 0.01;
        /// Frequency of the circle.
        circle_rate: f64 = "Hz", 0.0, 20.0;
        /// Duration after which the peg counts as obstructed.
        long: f64 = "s", 0.0, 60.0;
        /// Longest duration of pressing.
        time: f64 = "s", 0.1, 60.0;
        /// Estimated distance to the plate below which a head that does not sink for `stall` rests on the
        /// plate. Cameras measure heights less accurately.
        nearly: f64 = "m", 0.0, 0.03;
        /// Time without sinking after which a head near the plate rests on it.
        stall: f64 = "s", 0.1, 60.0;
        /// Drop in height that counts as sinking.
        sunk: f64 = "m", 1e-6, 0.01;
        /// Time without sinking after which a peg whose stem is still outside stands on the rim of a hole.
        /// Chosen.
        stands: f64 = "s", 0.1, 60.0;
        /// Largest drop in that time for a peg that stands: a held peg creeps in the fingers.
        creep: f64 = "m", 1e-6, 0.01;
        /// Distance of the contact point beside the hand from which a peg on the rim of its hole has rotated
        /// between the fingers. With another obstruction the distance is up to 6.3 mm.
        beside: f64 = "m", 0.0, 0.1;
        /// Distance to the plate at which a head is seated. The referee requires 0.5 mm.
        seated: f64 = "m", 1e-5, 0.01;
        /// Drop under a press below which the press has not moved the head. Cameras repeat a height to this.
        unmoved: f64 = "m", 0.0, 0.01;
        /// Largest error of the height of a head by sight, with a camera on the hand that is mounted 1.2 mm
        /// and 0.5° off. A head that seems higher, and that no press moves, is jammed.
        height_error: f64 = "m", 0.0, 0.01;
        /// Number of times a peg that is not flush is pressed by its head. Chosen.
        tries: usize = "", 0.0, 20.0;
    }
}

#[cfg(test)]
mod tests {
    use crate::parameters::Parameters;

    /// The place where the mouth is believed is probed first, then those beside it, each once.
    #[test]
    fn probes_go_from_the_middle_outwards() {
        let places = Parameters::baseline().probe.places();
        assert_eq!(places.len(), 11 * 3);
        assert_eq!(places[0], [0.0, 0.0]);
        let far = |place: &[f64; 2]| place[0].hypot(place[1]);
        assert!(places.is_sorted_by(|a, b| far(a) <= far(b) && a != b));
    }
}
