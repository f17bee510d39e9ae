//! Pixels as cameras give them, and as agents get them: red, green and blue, row by row from the top left.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

/// Pixels of a frame.
#[derive(Clone, Debug, PartialEq)]
pub enum Pixels {
    /// Red, green and blue of each pixel.
    Rgb(Vec<u8>),
    /// For two pixels of a row each: brightness, blue, brightness, red (V4L2's `YUYV`).
    Yuyv(Vec<u8>),
    /// A JPEG image (V4L2's `MJPG`).
    Jpeg(Vec<u8>),
}

impl Pixels {
    /// Red, green and blue of a frame that is expected to have `own` size, in another `size`; sizes are
    /// pixels in a row, and rows.
    ///
    /// # Errors
    /// The reason why it is no such frame, in words.
    pub(super) fn to_rgb(&self, own: [usize; 2], size: [usize; 2]) -> Result<Vec<u8>, String> {
        let rgb = match self {
            Pixels::Rgb(bytes) => bytes.clone(),
            Pixels::Yuyv(bytes) => bytes.as_chunks().0.iter().flat_map(from_yuyv).collect(),
            Pixels::Jpeg(bytes) => from_jpeg(bytes, own)?,
        };
        let [width, height] = own;
        let count = 3 * width * height;
        if rgb.len() != count {
            return Err(format!("an image of {} bytes, expected {count}", rgb.len()));
        }
        if own == size {
            return Ok(rgb);
        }
        // One sample for each pixel: the nearest.
        let nearest = |pixel: usize, count: usize, own: usize| (2 * pixel + 1) * own / (2 * count);
        let rows = (0..size[1]).map(|row| nearest(row, size[1], height));
        let samples = rows.flat_map(|row| {
            let columns = (0..size[0]).map(|column| nearest(column, size[0], width));
            columns.map(move |column| 3 * (row * width + column))
        });
        Ok(samples.flat_map(|at| [rgb[at], rgb[at + 1], rgb[at + 2]]).collect())
    }
}

/// The marker of Huffman tables in a JPEG image, and the segment of an image that has the usual ones instead,
/// which comes at its beginning. Cameras may leave out both (Motion JPEG in AVI files, OpenDML 1.02).
const TABLES: [u8; 2] = [0xff, 0xc4];
/// See [`TABLES`].
const NO_TABLES: [u8; 9] = *b"\xff\xe0\x00\x07AVI1\x00";
/// See [`TABLES`]: after the marker of an image.
const BEGIN: std::ops::Range<usize> = 2..2;

/// Red, green and blue of a JPEG image of this size.
fn from_jpeg(bytes: &[u8], [width, height]: [usize; 2]) -> Result<Vec<u8>, String> {
    let mut bytes = bytes.to_vec();
    if bytes.len() >= BEGIN.end && !bytes.windows(2).any(|two| two == TABLES) {
        bytes.splice(BEGIN, NO_TABLES);
    }
    let options = DecoderOptions::default().jpeg_set_out_colorspace(ColorSpace::RGB);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(&bytes), options);
    decoder.decode_headers().map_err(|error| error.to_string())?;
    // The size is looked at before anything of it is decoded.
    match decoder.dimensions() {
        Some(size) if size == (width, height) => decoder.decode().map_err(|error| error.to_string()),
        Some((found, rows)) => {
            Err(format!("an image of {found} by {rows} pixels, expected {width} by {height}"))
        }
        None => Err("an image without a size".to_string()),
    }
}

/// Two pixels. Coefficients and ranges: ITU-R BT.601, as the kernel's documentation of `YUYV` says.
fn from_yuyv(&[y0, u, y1, v]: &[u8; 4]) -> [u8; 6] {
    let (u, v) = (f32::from(u) - 128.0, f32::from(v) - 128.0);
    let byte = |value: f32| value.round().clamp(0.0, 255.0) as u8;
    let pixel = |y: u8| {
        let y = 1.164 * (f32::from(y) - 16.0);
        [byte(y + 1.596 * v), byte(y - 0.392 * u - 0.813 * v), byte(y + 2.017 * u)]
    };
    let ([r0, g0, b0], [r1, g1, b1]) = (pixel(y0), pixel(y1));
    [r0, g0, b0, r1, g1, b1]
}

#[cfg(test)]
mod tests {
    // A failed unwrap here is a failed test.
    #![allow(clippy::unwrap_used)]

    use super::*;

    /// A JPEG image of 32 by 16 pixels that grows red to the right and green downwards.
    const JPEG: &[u8] = include_bytes!("../../tests/data/gradient.jpg");

    /// Red grows to the right and green downwards, also in a small image.
    #[test]
    fn a_jpeg_image_is_the_right_way_up() {
        for size in [[32, 16], [8, 4]] {
            let rgb = Pixels::Jpeg(JPEG.to_vec()).to_rgb([32, 16], size).unwrap();
            let pixel = |x: usize, y: usize| &rgb[3 * (y * size[0] + x)..][..2];
            let ([left, top], [right, bottom]) =
                ([pixel(0, 0)[0], pixel(0, 0)[1]], [pixel(size[0] - 1, 0)[0], pixel(0, size[1] - 1)[1]]);
            assert!(left < 60 && right > 180 && top < 60 && bottom > 180, "{left} {right} {top} {bottom}");
        }
    }

    /// White, black and the three colours of a test bar come out as such.
    #[test]
    fn yuyv_becomes_the_colours_that_were_seen() {
        for (yuv, rgb) in [
            ([235, 128, 128], [255, 255, 255]),
            ([16, 128, 128], [0, 0, 0]),
            ([81, 90, 240], [254, 0, 0]),
            ([145, 54, 34], [0, 255, 1]),
            ([41, 240, 110], [0, 0, 255]),
        ] {
            let [y, u, v] = yuv;
            let found = Pixels::Yuyv(vec![y, u, y, v]).to_rgb([2, 1], [2, 1]).unwrap();
            for pixel in found.chunks(3) {
                for (found, expected) in pixel.iter().zip(rgb) {
                    assert!(found.abs_diff(expected) <= 2, "{yuv:?}: {pixel:?}, expected {rgb:?}");
                }
            }
        }
    }

    /// Cameras leave out the tables of Huffman codes, which are always the same.
    #[test]
    fn a_camera_s_jpeg_needs_no_tables() {
        let whole = JPEG.to_vec();
        // Segments of tables: marker FF C4, and a length that counts itself.
        let (mut bare, mut at) = (Vec::new(), 0);
        while at < whole.len() {
            if whole[at..].starts_with(&[0xff, 0xc4]) {
                at += 2 + usize::from(u16::from_be_bytes([whole[at + 2], whole[at + 3]]));
            } else {
                bare.push(whole[at]);
                at += 1;
            }
        }
        assert!(bare.len() + 100 < whole.len());
        let size = [32, 16];
        let [seen, expected] = [bare, whole].map(|bytes| Pixels::Jpeg(bytes).to_rgb(size, size).unwrap());
        assert_eq!(seen, expected);
    }

    /// An image of a size that was not calibrated is refused, and not stretched.
    #[test]
    fn an_image_of_another_size_is_refused() {
        let jpeg = Pixels::Jpeg(JPEG.to_vec());
        assert_eq!(jpeg.to_rgb([32, 16], [16, 8]).unwrap().len(), 3 * 16 * 8);
        assert!(jpeg.to_rgb([64, 32], [64, 32]).unwrap_err().contains("32 by 16"));
        assert!(Pixels::Rgb(vec![0; 9]).to_rgb([2, 2], [2, 2]).unwrap_err().contains("9 bytes"));
        assert!(Pixels::Jpeg(vec![1, 2, 3]).to_rgb([2, 2], [2, 2]).is_err());
    }
}
