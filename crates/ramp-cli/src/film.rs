//! Films of an episode, drawn by the cameras' renderer, with a caption of the action and the clock. The
//! format is GIF, or MP4 if ffmpeg is installed.

mod form;
mod gif;
mod mp4;

use std::path::Path;

use miette::{IntoDiagnostic, Report, miette};
use nalgebra::Point3;
use ramp_kit::strokes::{self, Align};
use ramp_render::free_camera::FreeCamera;
use ramp_render::looks::HOUSING;
use ramp_render::{Looks, Renderer, Sensor};
use ramp_robot::{Camera, CameraModel, Robot};
use ramp_twin::{Setup, Twin};
use resvg::{tiny_skia, usvg};

use crate::output::make_folder_of;
use form::SIZE;

/// Supersampling factor, for smooth edges.
const FINER: usize = 2;
/// Playback speed relative to robot time.
const SPEED: f64 = 8.0;
/// Offset from the free camera's target to the camera, m, and its focal length in image widths.
const OFFSET: [f64; 3] = [0.68, -0.80, 0.66];
const FOCAL: f64 = 1.05;
/// Height of the target, m.
const LOOKED_AT: f64 = 0.14;

/// Camera that the film is taken with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum From {
    /// A free camera that follows the work
    Free,
    /// The camera on the wrist
    Wrist,
    /// The camera over the table
    BirdsEye,
}

/// A film in progress.
pub struct Film {
    from: From,
    model: CameraModel,
    free: FreeCamera,
    renderer: Renderer,
    sensor: Sensor,
    writer: Writer,
    next: f64,
    title: String,
    caption: String,
}

/// Encoder of the frames.
enum Writer {
    Gif(gif::Gif),
    Mp4(mp4::Mp4),
}

impl Writer {
    fn new(path: &Path) -> Result<Writer, Report> {
        match path.extension().and_then(|ending| ending.to_str()) {
            Some("gif") => {
                make_folder_of(path)?;
                Ok(Writer::Gif(gif::Gif::new(path)?))
            }
            Some("mp4") => {
                make_folder_of(path)?;
                Ok(Writer::Mp4(mp4::Mp4::new(path)?))
            }
            _ => Err(miette!(
                help = "end the file's name in .gif or .mp4",
                "{} is neither a GIF nor an MP4 file",
                path.display()
            )),
        }
    }

    /// Display time of a frame, s.
    fn shown(&self) -> f64 {
        match self {
            Writer::Gif(_) => gif::SHOWN,
            Writer::Mp4(_) => mp4::SHOWN,
        }
    }
}

impl Film {
    /// Starts a film of an episode of this setup.
    ///
    /// # Errors
    /// If the file cannot be written or the parts cannot be drawn.
    pub fn new(path: &Path, setup: &Setup, from: From) -> Result<Film, Report> {
        let looks = Looks::shared(&setup.assembly.kit, setup.arm).into_diagnostic()?;
        let [width, height] = SIZE;
        let (w, h) = (width * FINER, height * FINER);
        let free = FreeCamera::new([w, h], FOCAL, OFFSET);
        let model = match from {
            From::Free => free.model().clone(),
            From::Wrist => scaled(CameraModel::nominal(Camera::Wrist, setup.arm.hand.tip), w),
            From::BirdsEye => scaled(CameraModel::nominal(Camera::BirdsEye, setup.arm.hand.tip), w),
        };
        let renderer = Renderer::new(looks, &model);
        let writer = Writer::new(path)?;
        let track = setup.track.name();
        let title = format!("{}, track {track}, seed {}", setup.assembly.name, setup.seed);
        Ok(Film {
            from,
            model,
            free,
            renderer,
            sensor: Sensor::ideal(),
            writer,
            next: 0.0,
            title,
            caption: String::new(),
        })
    }

    /// Adds a frame if one is due.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn show(&mut self, twin: &Twin, action: &str) -> Result<(), Report> {
        action.clone_into(&mut self.caption);
        if twin.time() < self.next {
            return Ok(());
        }
        self.next += SPEED * self.writer.shown();
        let pixels = self.draw(twin)?;
        match &mut self.writer {
            Writer::Gif(gif) => gif.write(&pixels),
            Writer::Mp4(mp4) => mp4.write(&pixels),
        }
    }

    /// Holds the last frame.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn end(self) -> Result<(), Report> {
        match self.writer {
            Writer::Gif(gif) => gif.end(),
            Writer::Mp4(mp4) => mp4.end(),
        }
    }

    fn draw(&mut self, twin: &Twin) -> Result<tiny_skia::Pixmap, Report> {
        let looks = twin.looks().into_diagnostic()?;
        let mut scene = twin.picture(&looks);
        let x_wt = twin.observe().x_wt;
        let x_wc = match self.from {
            From::Free => {
                let tip = x_wt.translation.vector;
                self.free.follow(Point3::new(tip.x, tip.y, LOOKED_AT))
            }
            From::Wrist => {
                let housing = looks.body(HOUSING);
                scene.bodies.retain(|(index, _)| Some(*index) != housing);
                self.model.x_wc(&x_wt)
            }
            From::BirdsEye => self.model.x_wc(&x_wt),
        };
        self.renderer.dress(looks);
        let pixels = self.renderer.render(&scene, &x_wc, &mut self.sensor);
        let [width, height] = SIZE;
        let mut pixmap = tiny_skia::Pixmap::new(width as u32, height as u32)
            .ok_or_else(|| miette!("a film of {width} × {height} pixels"))?;
        let stride = 3 * width * FINER;
        for (index, out) in pixmap.data_mut().chunks_exact_mut(4).enumerate() {
            let from = index / width * FINER * stride + index % width * FINER * 3;
            for (channel, out) in out[..3].iter_mut().enumerate() {
                let at = |dx: usize, dy: usize| u16::from(pixels[from + dy * stride + dx * 3 + channel]);
                *out = ((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8;
            }
            out[3] = 255;
        }
        self.write_caption(&mut pixmap, twin.time())?;
        Ok(pixmap)
    }

    fn write_caption(&self, pixmap: &mut tiny_skia::Pixmap, time: f64) -> Result<(), Report> {
        let [width, height] = SIZE.map(|edge| edge as f64);
        let band = 34.0;
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\
             <rect x=\"0\" y=\"{}\" width=\"{width}\" height=\"{band}\" fill=\"#101418\" fill-opacity=\"0.85\"/>",
            height - band
        );
        let line = height - 11.5;
        let clock = format!("{time:.1} s");
        strokes::text(&mut svg, [14.0, line], Align::Left, 13.0, "#ffffff", &clock);
        let size = strokes::fit(&self.caption, 13.0, 440.0);
        strokes::text(&mut svg, [100.0, line], Align::Left, size, "#ffd180", &self.caption);
        let size = strokes::fit(&self.title, 10.0, 230.0);
        let title_width = strokes::width(&self.title, size);
        strokes::text(
            &mut svg,
            [width - 14.0 - title_width, line],
            Align::Left,
            size,
            "#b0bec5",
            &self.title,
        );
        svg.push_str("</svg>");
        let tree = usvg::Tree::from_str(&svg, &usvg::Options::default()).into_diagnostic()?;
        resvg::render(&tree, tiny_skia::Transform::identity(), &mut pixmap.as_mut());
        Ok(())
    }
}

/// The same camera with another width in pixels. The height follows from the film's aspect ratio.
fn scaled(model: CameraModel, width: usize) -> CameraModel {
    let scale = width as f64 / model.width as f64;
    CameraModel {
        width,
        height: (model.height as f64 * scale).round() as usize,
        focal: model.focal.map(|value| value * scale),
        centre: model.centre.map(|value| value * scale),
        ..model
    }
}
