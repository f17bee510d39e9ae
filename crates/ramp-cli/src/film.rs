//! Films of an episode as GIF, drawn by the renderer of the cameras, with a caption of the action and the clock.

use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;

use miette::{IntoDiagnostic, Report, miette};
use nalgebra::{Matrix3, Point3, Rotation3, Translation3, UnitQuaternion, Vector3};
use ramp_kit::strokes::{self, Align};
use ramp_render::looks::HOUSING;
use ramp_render::{Looks, Renderer, Sensor};
use ramp_robot::camera::Mount;
use ramp_robot::{Camera, CameraModel, Pose, Robot};
use ramp_twin::{Setup, Twin};
use resvg::{tiny_skia, usvg};

/// Pixels of a film.
const SIZE: [usize; 2] = [800, 500];
/// It is drawn so many times larger, so that edges are smooth.
const FINER: usize = 2;
/// Hundredths of a second that a frame is shown, and robot seconds from one to the next.
const SHOWN: u16 = 8;
const STEP: f64 = 0.64;
/// How long the last frame stands, in hundredths of a second.
const LAST: u16 = 300;
/// From what the free camera looks at to the camera, m, and its focal length in widths of the image.
const OFFSET: [f64; 3] = [0.68, -0.80, 0.66];
const FOCAL: f64 = 1.05;
/// Height of what it looks at, m.
const LOOKED_AT: f64 = 0.14;
/// The free camera moves on when the tip is further than this from the middle, in halves of the image.
const AWAY: f64 = 0.7;
/// Colours of the palette; one more stands for what has not changed.
const COLOURS: usize = 255;

/// Whose eyes the film is seen through.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum From {
    /// A free camera that follows the work
    Free,
    /// The camera on the wrist
    Wrist,
    /// The camera over the table
    BirdsEye,
}

/// A film that is being made.
pub struct Film {
    from: From,
    looks: Arc<Looks>,
    model: CameraModel,
    renderer: Renderer,
    sensor: Sensor,
    encoder: gif::Encoder<BufWriter<File>>,
    palette: Option<Palette>,
    /// Colours on the screen, as numbers of the palette.
    screen: Vec<u8>,
    next: f64,
    /// What the free camera looks at, m.
    target: Option<Point3<f64>>,
    title: String,
    caption: String,
}

/// The colours of a film, chosen from its first frame.
struct Palette {
    quantiser: color_quant::NeuQuant,
    /// For each colour of 15 bits its number, once it was asked for.
    known: Vec<Option<u8>>,
}

impl Palette {
    fn number(&mut self, pixel: &[u8]) -> u8 {
        let [r, g, b] = [pixel[0], pixel[1], pixel[2]];
        let key = usize::from(r >> 3) << 10 | usize::from(g >> 3) << 5 | usize::from(b >> 3);
        let quantiser = &self.quantiser;
        *self.known[key].get_or_insert_with(|| {
            let middle = [r, g, b].map(|value| value & 0xf8 | 4);
            quantiser.index_of(&[middle[0], middle[1], middle[2], 255]) as u8
        })
    }
}

impl Film {
    /// A film of an episode of this setup.
    ///
    /// # Errors
    /// A file that cannot be written or parts that cannot be drawn.
    pub fn new(path: &Path, setup: &Setup, from: From) -> Result<Film, Report> {
        let looks = Looks::shared(setup.kit, setup.arm).into_diagnostic()?;
        let [width, height] = SIZE;
        let (w, h) = (width * FINER, height * FINER);
        let model = match from {
            From::Free => CameraModel {
                width: w,
                height: h,
                focal: [FOCAL * w as f64; 2],
                centre: [w as f64 / 2.0, h as f64 / 2.0],
                distortion: [0.0; 5],
                mount: Mount::World(Pose::identity()),
            },
            From::Wrist => scaled(CameraModel::nominal(Camera::Wrist, setup.arm.hand.tip), w),
            From::BirdsEye => scaled(CameraModel::nominal(Camera::BirdsEye, setup.arm.hand.tip), w),
        };
        let renderer = Renderer::new(Arc::clone(&looks), &model);
        let file = File::create(path).into_diagnostic()?;
        let mut encoder =
            gif::Encoder::new(BufWriter::new(file), width as u16, height as u16, &[]).into_diagnostic()?;
        encoder.set_repeat(gif::Repeat::Infinite).into_diagnostic()?;
        let track = setup.track.name();
        let title = format!("{}, track {track}, seed {}", setup.assembly.name, setup.seed);
        Ok(Film {
            from,
            looks,
            model,
            renderer,
            sensor: Sensor::ideal(),
            encoder,
            palette: None,
            screen: Vec::new(),
            next: 0.0,
            target: None,
            title,
            caption: String::new(),
        })
    }

    /// Adds a frame when it is time for one.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn show(&mut self, twin: &Twin, action: &str) -> Result<(), Report> {
        action.clone_into(&mut self.caption);
        if twin.time() < self.next {
            return Ok(());
        }
        self.next += STEP;
        let pixels = self.draw(twin)?;
        self.write(&pixels, SHOWN)
    }

    /// Lets the last frame stand for a while.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn end(mut self) -> Result<(), Report> {
        let nothing = vec![COLOURS as u8];
        self.write_part([0, 0, 1, 1], nothing, LAST)
    }

    fn draw(&mut self, twin: &Twin) -> Result<tiny_skia::Pixmap, Report> {
        let mut scene = twin.picture(&self.looks);
        let x_wt = twin.observe().x_wt;
        let x_wc = match self.from {
            From::Free => self.follow(&x_wt),
            From::Wrist => {
                let housing = self.looks.body(HOUSING);
                scene.bodies.retain(|(index, _)| Some(*index) != housing);
                self.model.x_wc(&x_wt)
            }
            From::BirdsEye => self.model.x_wc(&x_wt),
        };
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

    /// Where the free camera stands: it looks at one place until the tip has gone too far from it.
    fn follow(&mut self, x_wt: &Pose) -> Pose {
        let tip = x_wt.translation.vector;
        let view = |target: &Point3<f64>| {
            let back = Vector3::from(OFFSET);
            let forward = -back.normalize();
            let right = forward.cross(&Vector3::z()).normalize();
            let axes = Matrix3::from_columns(&[right, forward.cross(&right), forward]);
            let rotation = UnitQuaternion::from_rotation_matrix(&Rotation3::from_matrix_unchecked(axes));
            Pose::from_parts(Translation3::from(target.coords + back), rotation)
        };
        if let Some(target) = &self.target {
            let x_wc = view(target);
            let place =
                self.model.project(&(x_wc.inverse() * Point3::from(Vector3::new(tip.x, tip.y, LOOKED_AT))));
            let away = |pixel: [f64; 2]| {
                let half = [self.model.width as f64 / 2.0, self.model.height as f64 / 2.0];
                (0..2).any(|axis| (pixel[axis] - half[axis]).abs() > AWAY * half[axis])
            };
            if !place.is_none_or(away) {
                return x_wc;
            }
        }
        let target = Point3::new(tip.x, tip.y, LOOKED_AT);
        self.target = Some(target);
        view(&target)
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

    /// Writes the rectangle that has changed.
    fn write(&mut self, pixmap: &tiny_skia::Pixmap, shown: u16) -> Result<(), Report> {
        let [width, height] = SIZE;
        let palette = self.palette.get_or_insert_with(|| Palette {
            quantiser: color_quant::NeuQuant::new(5, COLOURS, pixmap.data()),
            known: vec![None; 1 << 15],
        });
        let numbers: Vec<u8> = pixmap.data().chunks_exact(4).map(|pixel| palette.number(pixel)).collect();
        let first = self.screen.is_empty();
        let changed = |index: usize| first || self.screen[index] != numbers[index];
        let mut around: Option<[usize; 4]> = None;
        for index in (0..numbers.len()).filter(|index| changed(*index)) {
            let (x, y) = (index % width, index / width);
            let [left, top, right, low] = around.unwrap_or([x, y, x, y]);
            around = Some([left.min(x), top.min(y), right.max(x), low.max(y)]);
        }
        // A frame that shows nothing new keeps the old one on for longer.
        let [left, top, right, low] = around.unwrap_or([0, height - 1, 0, height - 1]);
        let unchanged = COLOURS as u8;
        let mut buffer = Vec::with_capacity((right + 1 - left) * (low + 1 - top));
        for y in top..=low {
            for x in left..=right {
                let index = y * width + x;
                buffer.push(if changed(index) { numbers[index] } else { unchanged });
            }
        }
        self.screen = numbers;
        self.write_part([left, top, right + 1 - left, low + 1 - top], buffer, shown)
    }

    /// Writes colours into a part of the screen: left, top, width and height.
    fn write_part(
        &mut self,
        [left, top, width, height]: [usize; 4],
        buffer: Vec<u8>,
        shown: u16,
    ) -> Result<(), Report> {
        let mut colours =
            self.palette.as_ref().map(|palette| palette.quantiser.color_map_rgb()).unwrap_or_default();
        colours.resize(3 * (COLOURS + 1), 0);
        let frame = gif::Frame {
            delay: shown,
            dispose: gif::DisposalMethod::Keep,
            transparent: Some(COLOURS as u8),
            left: left as u16,
            top: top as u16,
            width: width as u16,
            height: height as u16,
            palette: Some(colours),
            buffer: buffer.into(),
            ..gif::Frame::default()
        };
        self.encoder.write_frame(&frame).into_diagnostic()
    }
}

/// The same camera with another width in pixels; its height follows the film's form.
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
