//! Recordings of an episode for the Rerun viewer (`.rrd`): the moving scene in 3D, the wrist force and the
//! actions, on one time line. They need a program built with the feature `rerun`; without it, a recording is
//! an error that says so.

use std::path::Path;

use miette::{Report, miette};
use ramp_twin::{Setup, Twin};

/// A recording in progress.
pub struct Recording {
    #[cfg(feature = "rerun")]
    inner: inner::Recording,
}

impl Recording {
    /// Starts a recording of an episode of this setup.
    ///
    /// # Errors
    /// If the file cannot be written, the parts cannot be drawn, or the program was built without `rerun`.
    #[cfg(feature = "rerun")]
    pub fn new(path: &Path, setup: &Setup) -> Result<Recording, Report> {
        if path.extension().is_none_or(|ending| ending != "rrd") {
            return Err(miette!(help = "end the file's name in .rrd", "{} is no Rerun file", path.display()));
        }
        Ok(Recording { inner: inner::Recording::new(path, setup)? })
    }

    #[cfg(not(feature = "rerun"))]
    pub fn new(_: &Path, _: &Setup) -> Result<Recording, Report> {
        Err(miette!(
            help = "build it with `cargo build --release --features rerun`; the log beside the result (.mcap) is there without",
            "this program was built without Rerun"
        ))
    }

    /// Records a sample if one is due. `action` is the agent's current action, `seated` the number of seated
    /// pegs.
    ///
    /// # Errors
    /// If the file cannot be written.
    #[cfg_attr(
        not(feature = "rerun"),
        allow(clippy::unused_self, clippy::unnecessary_wraps, unused_variables)
    )]
    pub fn show(&mut self, twin: &Twin, action: &str, seated: usize) -> Result<(), Report> {
        #[cfg(feature = "rerun")]
        self.inner.show(twin, action, seated)?;
        Ok(())
    }

    /// Writes the remaining samples.
    ///
    /// # Errors
    /// If the file cannot be written.
    #[cfg_attr(not(feature = "rerun"), allow(clippy::unused_self, clippy::unnecessary_wraps))]
    pub fn end(self) -> Result<(), Report> {
        #[cfg(feature = "rerun")]
        self.inner.end()?;
        Ok(())
    }
}

#[cfg(feature = "rerun")]
mod inner {
    use std::path::Path;
    use std::sync::Arc;

    use miette::{IntoDiagnostic, Report, miette};
    use nalgebra::{Quaternion, Vector6};
    use ramp_render::looks::{Looks, Surface};
    use ramp_robot::{Pose, Robot};
    use ramp_twin::{Setup, Twin};
    use rerun::{RecordingStream, RecordingStreamBuilder};

    /// Sampling interval, s.
    const SHOWN: f64 = 0.04;
    /// Edge length and thickness of the drawn table, m.
    const TABLE: [f32; 2] = [1.2, 0.01];
    /// Linear intensity at which the sRGB transfer function turns from linear to a power law, and its
    /// exponent (IEC 61966-2-1).
    const SRGB: (f32, f32) = (0.003_130_8, 2.4);

    pub struct Recording {
        stream: RecordingStream,
        looks: Arc<Looks>,
        next: f64,
        action: String,
    }

    impl Recording {
        pub fn new(path: &Path, setup: &Setup) -> Result<Recording, Report> {
            crate::output::make_folder_of(path)?;
            let looks = Looks::shared(&setup.assembly.kit, setup.arm).into_diagnostic()?;
            // Derive the recording's id from its content, so that the same episode gives the same id.
            let title = format!("{}, track {}, seed {}", setup.assembly.name, setup.track.name(), setup.seed);
            let stream = RecordingStreamBuilder::new("ramp")
                .recording_id(title.clone())
                .save(path)
                .into_diagnostic()?;
            stream.send_recording_name(title).into_diagnostic()?;
            let recording = Recording { stream, looks, next: 0.0, action: String::new() };
            recording.scenery()?;
            Ok(recording)
        }

        /// Logs the static scene: the table, and the shape of each body in its own frame.
        fn scenery(&self) -> Result<(), Report> {
            let stream = &self.stream;
            stream.log_static("world", &rerun::ViewCoordinates::RIGHT_HAND_Z_UP()).into_diagnostic()?;
            let [edge, thick] = TABLE;
            let table = rerun::Boxes3D::from_centers_and_half_sizes(
                [[0.0, 0.0, -thick]],
                [[edge / 2.0, edge / 2.0, thick / 2.0]],
            );
            let grey = rerun::Color::from_rgb(150, 150, 150);
            let table = table.with_colors([grey]).with_fill_mode(rerun::FillMode::Solid);
            stream.log_static("world/table", &table).into_diagnostic()?;
            let axes = rerun::SeriesLines::new().with_names(["x, N", "y, N", "z, N"]);
            stream.log_static("wrist/force", &axes).into_diagnostic()?;
            for body in self.looks.bodies() {
                stream.log_static(path_of(&body.name), &mesh(&body.surfaces[0])).into_diagnostic()?;
            }
            Ok(())
        }

        pub fn show(&mut self, twin: &Twin, action: &str, seated: usize) -> Result<(), Report> {
            let time = twin.time();
            self.stream.set_duration_secs("robot_time", time);
            if action != self.action {
                action.clone_into(&mut self.action);
                self.stream.log("actions", &rerun::TextLog::new(action)).into_diagnostic()?;
            }
            if time < self.next {
                return Ok(());
            }
            self.next += SHOWN;
            for (index, x_wb) in twin.picture(&self.looks).bodies {
                let body = &self.looks.bodies()[index];
                self.stream.log(path_of(&body.name), &transform(&x_wb)).into_diagnostic()?;
            }
            let observation = twin.observe();
            self.stream.log("world/tip", &transform(&observation.x_wt)).into_diagnostic()?;
            let wrench: Vector6<f64> = observation.wrench;
            let force = [wrench[0], wrench[1], wrench[2]];
            self.stream.log("wrist/force", &rerun::Scalars::new(force)).into_diagnostic()?;
            let figures = [("fingers/width", observation.width), ("referee/seated", seated as f64)];
            for (name, value) in figures {
                self.stream.log(name, &rerun::Scalars::single(value)).into_diagnostic()?;
            }
            Ok(())
        }

        pub fn end(self) -> Result<(), Report> {
            self.stream
                .flush_blocking()
                .map_err(|error| miette!("the recording could not be written: {error}"))
        }
    }

    fn path_of(body: &str) -> String {
        format!("world/{body}")
    }

    fn transform(x: &Pose) -> rerun::Transform3D {
        let [x_, y, z] = x.translation.vector.map(|value| value as f32).into();
        let q: &Quaternion<f64> = x.rotation.quaternion();
        let turn = [q.i, q.j, q.k, q.w].map(|value| value as f32);
        rerun::Transform3D::from_translation_rotation([x_, y, z], rerun::Quaternion::from_xyzw(turn))
    }

    /// A mesh with separate vertices per triangle, so that each triangle keeps its own colour and normal.
    fn mesh(surface: &Surface) -> rerun::Mesh3D {
        let mesh = &surface.mesh;
        let corners = || mesh.triangles.iter().flatten();
        let colours = mesh.colours.iter().flat_map(|colour| {
            let [red, green, blue] = colour.map(shade);
            [rerun::Color::from_rgb(red, green, blue); 3]
        });
        let normals = surface.normals.iter().flat_map(|normal| [*normal; 3]);
        let triangles = 0..mesh.triangles.len() as u32;
        rerun::Mesh3D::new(corners().map(|corner| mesh.points[*corner as usize]))
            .with_triangle_indices(triangles.map(|index| [3 * index, 3 * index + 1, 3 * index + 2]))
            .with_vertex_normals(normals)
            .with_vertex_colors(colours)
    }

    /// Converts linear intensity to sRGB.
    fn shade(light: f32) -> u8 {
        let (knee, power) = SRGB;
        let light = light.clamp(0.0, 1.0);
        let shade = if light < knee { 12.92 * light } else { 1.055 * light.powf(1.0 / power) - 0.055 };
        (255.0 * shade).round() as u8
    }
}
