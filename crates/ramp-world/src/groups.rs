//! The quantities of a world in groups, from the joints of the arm outwards to the table.

use crate::quantity::Numbers;

quantities! {
    /// Friction of the arm's joints between the torque that is commanded and the motion: the model of
    /// bristles of Canudas de Wit, Olsson, Åström and Lischinsky (1995).
    Friction {
        /// Dry friction of each joint while it moves.
        coulomb: [f64; 7] = "N·m", 0.0, 20.0;
        /// Friction of each joint that grows with its speed.
        viscous: [f64; 7] = "N·m·s/rad", 0.0, 50.0;
        /// Share by which the friction of a joint that begins to move exceeds that of a moving one.
        breakaway: f64 = "", 0.0, 3.0;
        /// The speed at which most of that excess has vanished (Stribeck).
        stribeck: f64 = "rad/s", 0.001, 1.0;
        /// Share by which the friction of each joint is larger forwards than in the mean of both directions.
        asymmetry: [f64; 7] = "", -0.9, 0.9;
        /// Deflection of a joint before it breaks away.
        presliding: f64 = "rad", 2e-5, 0.01;
        /// The share of the dry friction that acts past the torque sensor, on the side of the link, and is
        /// not measured.
        past_sensor: f64 = "", 0.0, 1.0;
    }
}

quantities! {
    /// The arm: inertia of its drives, and the errors of its model.
    Arm {
        /// Inertia of each drive, at the joint.
        armature: [f64; 7] = "kg·m²", 0.001, 2.0;
        /// Constant error of the position that each joint reports: the remainder after a calibration.
        offset: [f64; 7] = "rad", -0.05, 0.05;
        /// The same, as a wave over one revolution of the joint: its amplitude.
        wave: [f64; 7] = "rad", -0.05, 0.05;
        /// Phase of that wave.
        wave_begin: [f64; 7] = "rad", -3.2, 3.2;
        /// Mass at the hand that the gravity compensation does not know.
        unknown_mass: f64 = "kg", -0.5, 0.5;
        /// Position of that mass, in the hand's frame.
        unknown_centre: [f64; 3] = "m", -0.2, 0.2;
    }
}

quantities! {
    /// The arm's controller from a command to torques, and its conditions for a stop of the arm.
    Controller {
        /// Largest rate of a commanded torque. The inner loops keep to it; commanded torques that exceed it
        /// are refused.
        torque_rate: f64 = "N·m/s", 10.0, 1e9;
        /// The share of the friction before the torque sensor that the inner loop compensates by what it
        /// measures.
        compensation: f64 = "", 0.0, 1.0;
        /// Rate at which that compensation follows.
        compensation_rate: f64 = "1/s", 1.0, 500.0;
        /// Relative error of the controller's own model of each joint's dry friction. The compensation stays
        /// within twice the model.
        model_error: [f64; 7] = "", -0.9, 2.0;
        /// The external force at which the arm stops by reflex.
        reflex_force: f64 = "N", 20.0, 1e6;
        /// The external torque of a joint at which it does.
        reflex_torque: f64 = "N·m", 10.0, 1e6;
        /// Time for which the arm stands after a stop by reflex or for the speed of a joint, until it is
        /// ready again; 0: such a stop is final.
        recovery: f64 = "s", 0.0, 60.0;
    }
}

quantities! {
    /// The line between the program and the arm.
    Line {
        /// Delay of a command, in whole control periods of 1 ms.
        delay: f64 = "ms", 0.0, 50.0;
        /// Probability in each control period that commands begin to be lost. The last torque is held
        /// meanwhile.
        lost: f64 = "", 0.0, 0.1;
        /// Mean number of commands lost in a row. 20 in a row stop the arm.
        lost_row: f64 = "", 1.0, 50.0;
        /// Time for which the arm stands after such a stop.
        recovery: f64 = "s", 0.0, 60.0;
    }
}

quantities! {
    /// The arm's sensors of force, torque and position.
    Sensing {
        /// 1: a force sensor is mounted at the wrist. 0: the wrench at the wrist is estimated from the
        /// torques of the joints.
        wrist_sensor: f64 = "", 0.0, 1.0;
        /// Noise of the wrist sensor's force before its filter (1 σ).
        force_noise: f64 = "N", 0.0, 10.0;
        /// The same for its moment.
        moment_noise: f64 = "N·m", 0.0, 1.0;
        /// Bias of the wrist sensor's force along its axes.
        force_bias: [f64; 3] = "N", -20.0, 20.0;
        /// The same for its moment.
        moment_bias: [f64; 3] = "N·m", -2.0, 2.0;
        /// 1: the reported torques are measured on the links. 0: they are those of the motors.
        torque_sensors: f64 = "", 0.0, 1.0;
        /// Noise of each joint's torque sensor (1 σ).
        torque_noise: f64 = "N·m", 0.0, 1.0;
        /// Bias of each joint's torque sensor.
        torque_bias: [f64; 7] = "N·m", -5.0, 5.0;
        /// The same, as a wave over one revolution of the joint: its amplitude.
        torque_wave: [f64; 7] = "N·m", -5.0, 5.0;
        /// Bandwidth of the estimate of the wrench.
        bandwidth: f64 = "Hz", 0.5, 200.0;
        /// Step of the joint positions that the encoders report; 0: none.
        encoder_step: f64 = "rad", 0.0, 0.01;
        /// Noise of those positions before the step (1 σ).
        encoder_noise: f64 = "rad", 0.0, 0.01;
    }
}

quantities! {
    /// The gripper.
    Gripper {
        /// Time from a command to the motion of the fingers. A gripper with a dead time finishes its motion
        /// before it accepts another command.
        dead_time: f64 = "s", 0.0, 5.0;
        /// Interval between two reports of its width.
        told_every: f64 = "s", 0.001, 1.0;
        /// Step of the width that it reports; 0: none.
        width_step: f64 = "m", 0.0, 0.005;
    }
}

quantities! {
    /// The tactile sensors in the pads of the fingers.
    Touch {
        /// 1: each finger has a tactile sensor. 0: the fingers have none.
        fitted: f64 = "", 0.0, 1.0;
        /// Noise of each force that a sensor reports (1 σ).
        force_noise: f64 = "N", 0.0, 5.0;
        /// Drift of each force since the last zero (1 σ); it changes slowly.
        force_drift: f64 = "N", 0.0, 5.0;
        /// Time constant of that drift.
        drift_time: f64 = "s", 1.0, 1e5;
        /// The largest force along each axis that a sensor reports; it reports a larger one as this.
        range: f64 = "N", 0.1, 1e4;
        /// Interval between two readings.
        interval: f64 = "s", 0.001, 1.0;
        /// Noise of the centre of pressure along each axis of the pad (1 σ).
        centre_noise: f64 = "m", 0.0, 0.01;
        /// Force at which a sensor begins to report a centre of pressure.
        centre_force: f64 = "N", 0.0, 100.0;
    }
}

quantities! {
    /// The cameras.
    Cameras {
        /// Time from the end of an exposure until the image is available.
        latency: f64 = "s", 0.001, 1.0;
        /// Largest additional delay of an image, drawn for each.
        jitter: f64 = "s", 0.0, 1.0;
        /// From the beginning of an exposure until that of the next at the earliest.
        interval: f64 = "s", 0.0, 1.0;
        /// Error of each camera's calibration along each axis (1 σ).
        position_error: f64 = "m", 0.0, 0.02;
        /// The same about each axis.
        angle_error: f64 = "rad", 0.0, 0.05;
        /// Error of each camera's focal length (1 σ), as a share: what the calibration of its lens leaves.
        focal_error: f64 = "", 0.0, 0.02;
        /// The same of its principal point, along each side of the image.
        centre_error: f64 = "pixels", 0.0, 20.0;
        /// Light, relative to that for the nominal exposure.
        light: f64 = "", 0.2, 3.0;
        /// Light of the lamp's reflection in aluminium, relative to white.
        glint: f64 = "", 0.0, 2.0;
        /// The largest share by which a part is lighter or darker than its material; each part draws its own.
        tone: f64 = "", 0.0, 0.5;
        /// White noise of the disparity of depth, at the full size of an image (1 σ).
        depth_noise: f64 = "pixels", 0.0, 1.0;
        /// Bias of the disparity that changes slowly over the image, and stays as it is (1 σ).
        depth_bias: f64 = "pixels", 0.0, 1.0;
        /// Share of the image in which nearer surfaces spread over what is beside them.
        depth_spread: f64 = "", 0.0, 1.0;
        /// Share of shiny metal without depth.
        depth_holes: f64 = "", 0.0, 1.0;
    }
}

quantities! {
    /// The printed parts and the beams.
    Parts {
        /// The largest error of a printed face; each face draws its own.
        face: f64 = "m", 0.0, 0.00024;
        /// The same for the radius of a peg's stem and of a hole.
        radius: f64 = "m", 0.0, 0.00012;
        /// The largest error of a beam's length; each beam draws its own.
        length: f64 = "m", 0.0, 0.003;
        /// The largest lateral displacement of a beam's middle from the line between its ends, as a share of
        /// its length; each beam draws its own.
        bow: f64 = "", 0.0, 0.003;
        /// Coefficient of friction between printed parts.
        friction: f64 = "", 0.02, 2.0;
        /// The same for the aluminium of a beam.
        metal_friction: f64 = "", 0.02, 2.0;
        /// The same for a peg.
        peg_friction: f64 = "", 0.02, 2.0;
        /// The same between a part and the table.
        table_friction: f64 = "", 0.02, 2.0;
        /// The same for the pads of the fingers.
        pad_friction: f64 = "", 0.1, 3.0;
    }
}

quantities! {
    /// The table, and the clamp that holds the first beam.
    Table {
        /// Height error of the table: true height above the assumed one.
        height: f64 = "m", -0.01, 0.01;
        /// Tilt of the table about the axes of the world, x and y.
        tilt: [f64; 2] = "rad", -0.02, 0.02;
        /// Compliance of the clamped beam under a force, along each axis.
        clamp_give: f64 = "m/N", 0.0, 0.0001;
    }
}

quantities! {
    /// Options of the engine for contacts.
    Engine {
        /// Iterations against the creep of contacts that friction holds (MuJoCo's `noslip_iterations`,
        /// rounded). Steps without them take as little as a quarter of the time.
        noslip: f64 = "", 0.0, 100.0;
        /// Damping of the contacts of the fingertips. The larger it is, the less a held part creeps.
        grip_damping: f64 = "1/s", 100.0, 1e5;
    }
}

macro_rules! groups {
    ($($(#[doc = $doc:literal])+ $name:ident: $group:ident,)+) => {
        /// The numbers of one episode.
        #[derive(Clone, Debug, PartialEq)]
        pub struct Physics {
            $($(#[doc = $doc])+ pub $name: $group,)+
        }

        impl Physics {
            pub(crate) fn from_numbers(numbers: &Numbers) -> Option<Physics> {
                Some(Physics { $($name: $group::from_numbers(numbers, stringify!($name))?,)+ })
            }
        }

        /// The groups of a world file: name, description and quantities.
        pub const GROUPS: &[(&str, &str, &[crate::Field])] =
            &[$((stringify!($name), $group::ABOUT, $group::FIELDS),)+];
    };
}

groups! {
    /// Friction of the joints.
    friction: Friction,
    /// The arm.
    arm: Arm,
    /// Its controller.
    controller: Controller,
    /// The line to it.
    line: Line,
    /// Its sensors of force, torque and position.
    sensing: Sensing,
    /// The gripper.
    gripper: Gripper,
    /// The tactile sensors in its fingers.
    touch: Touch,
    /// The cameras.
    cameras: Cameras,
    /// The parts.
    parts: Parts,
    /// The table.
    table: Table,
    /// The engine.
    engine: Engine,
}
