//! Encodes frames as GIF. The palette comes from the first frame; each frame stores only the changed pixels.

use std::io::BufWriter;
use std::path::Path;

use miette::{IntoDiagnostic, Report};
use ramp_kit::source::WholeFile;
use resvg::tiny_skia;

use super::form::{LAST, SIZE};

/// Display time of a frame, s.
pub const SHOWN: f64 = 0.08;
/// Number of palette colours. One more entry marks unchanged pixels.
const COLOURS: usize = 255;

/// Writer of a GIF file.
pub struct Gif {
    encoder: ::gif::Encoder<BufWriter<WholeFile>>,
    palette: Option<Palette>,
    /// Colours on the screen, as palette indices.
    screen: Vec<u8>,
}

/// Palette of a film, chosen from its first frame.
struct Palette {
    quantiser: color_quant::NeuQuant,
    /// Cached palette index of each 15-bit colour.
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

impl Gif {
    /// Starts an empty film.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn new(path: &Path) -> Result<Gif, Report> {
        let [width, height] = SIZE.map(|edge| edge as u16);
        let file = BufWriter::new(WholeFile::new(path)?);
        let mut encoder = ::gif::Encoder::new(file, width, height, &[]).into_diagnostic()?;
        encoder.set_repeat(::gif::Repeat::Infinite).into_diagnostic()?;
        Ok(Gif { encoder, palette: None, screen: Vec::new() })
    }

    /// Writes the changed rectangle.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn write(&mut self, pixmap: &tiny_skia::Pixmap) -> Result<(), Report> {
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
        // An unchanged frame only extends the display time of the last one.
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
        self.write_part([left, top, right + 1 - left, low + 1 - top], buffer, SHOWN)
    }

    /// Holds the last frame.
    ///
    /// # Errors
    /// If the file cannot be written.
    pub fn end(mut self) -> Result<(), Report> {
        self.write_part([0, 0, 1, 1], vec![COLOURS as u8], LAST)?;
        let file = self.encoder.into_inner().into_diagnostic()?;
        let file = file.into_inner().map_err(std::io::IntoInnerError::into_error).into_diagnostic()?;
        Ok(file.finish()?)
    }

    /// Writes colours into the part of the screen given by left, top, width and height.
    fn write_part(
        &mut self,
        [left, top, width, height]: [usize; 4],
        buffer: Vec<u8>,
        shown: f64,
    ) -> Result<(), Report> {
        let mut colours =
            self.palette.as_ref().map(|palette| palette.quantiser.color_map_rgb()).unwrap_or_default();
        colours.resize(3 * (COLOURS + 1), 0);
        let frame = ::gif::Frame {
            delay: (100.0 * shown).round() as u16,
            dispose: ::gif::DisposalMethod::Keep,
            transparent: Some(COLOURS as u8),
            left: left as u16,
            top: top as u16,
            width: width as u16,
            height: height as u16,
            palette: Some(colours),
            buffer: buffer.into(),
            ..::gif::Frame::default()
        };
        self.encoder.write_frame(&frame).into_diagnostic()
    }
}
