//! A goal as a picture: the finished assembly from above, with its order of insertions.
//!
//! X points right and Y up; the robot is below the picture. One unit of the drawing is 1 mm.
//!
//! `picture` draws one goal, `legend` the list beside it; both with the `marks`.

mod legend;
mod marks;
mod picture;

use self::marks::PAPER;
use self::picture::Picture;
use crate::assembly::Assembly;
use ramp_kit::strokes::escape;
use std::fmt::Write;

/// Pixels for one millimetre where an SVG is shown at its own size.
const ZOOM: f64 = 1.5;

/// Draws the goal as SVG.
///
/// Text is drawn as strokes, so no fonts are needed; each text is in the `aria-label` of its path.
pub fn draw_svg(assembly: &Assembly) -> String {
    let picture = Picture::new(assembly);
    let mut svg = String::new();
    let [width, height] = picture.size();
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{:.0}" height="{:.0}" viewBox="0 0 {width:.1} {height:.1}" role="img">"#,
        width * ZOOM,
        height * ZOOM,
    );
    let _ = writeln!(svg, "<title>{}</title>", escape(&assembly.name));
    let _ = writeln!(svg, r#"<rect width="100%" height="100%" fill="{PAPER}"/>"#);
    picture.draw(&mut svg);
    svg.push_str("</svg>\n");
    svg
}

/// Draws several goals as one SVG, in rows of three, all at the same scale.
pub fn draw_all_svg(assemblies: &[Assembly]) -> String {
    /// Goals in a row.
    const ROW_LENGTH: usize = 3;
    let pictures: Vec<Picture<'_>> = assemblies.iter().map(Picture::new).collect();
    let sizes: Vec<[f64; 2]> = pictures.iter().map(Picture::size).collect();
    let widths: Vec<f64> = (0..ROW_LENGTH)
        .map(|column| sizes.iter().skip(column).step_by(ROW_LENGTH).map(|size| size[0]).fold(0.0, f64::max))
        .collect();
    let heights: Vec<f64> =
        sizes.chunks(ROW_LENGTH).map(|row| row.iter().map(|size| size[1]).fold(0.0, f64::max)).collect();
    let (width, height): (f64, f64) = (widths.iter().sum(), heights.iter().sum());
    let mut svg = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" width="{width:.0}" height="{height:.0}" viewBox="0 0 {width:.1} {height:.1}" role="img">"#
    );
    let _ = writeln!(svg, "<title>{} goals</title>", assemblies.len());
    let _ = writeln!(svg, r#"<rect width="100%" height="100%" fill="{PAPER}"/>"#);
    for (index, picture) in pictures.iter().enumerate() {
        let (row, column) = (index / ROW_LENGTH, index % ROW_LENGTH);
        let (x, y): (f64, f64) = (widths[..column].iter().sum(), heights[..row].iter().sum());
        let _ = writeln!(svg, r#"<g transform="translate({x:.1} {y:.1})">"#);
        picture.draw(&mut svg);
        svg.push_str("</g>\n");
    }
    svg.push_str("</svg>\n");
    svg
}

/// Draws the goal as PNG, `width` pixels wide (at least 64, at most 8192).
///
/// # Errors
/// A picture that has too many pixels.
#[cfg(feature = "png")]
pub fn draw_png(assembly: &Assembly, width: u32) -> Result<Vec<u8>, DrawError> {
    png(&draw_svg(assembly), width)
}

/// Draws several goals as one PNG, `width` pixels wide, see [`draw_all_svg`].
///
/// # Errors
/// A picture that has too many pixels.
#[cfg(feature = "png")]
pub fn draw_all_png(assemblies: &[Assembly], width: u32) -> Result<Vec<u8>, DrawError> {
    png(&draw_all_svg(assemblies), width)
}

#[cfg(feature = "png")]
fn png(svg: &str, width: u32) -> Result<Vec<u8>, DrawError> {
    use resvg::{tiny_skia, usvg};
    let tree =
        usvg::Tree::from_str(svg, &usvg::Options::default()).map_err(|error| DrawError(error.to_string()))?;
    let width = width.clamp(64, 8192);
    let scale = width as f32 / tree.size().width();
    let height = (tree.size().height() * scale).ceil() as u32;
    let mut pixmap = tiny_skia::Pixmap::new(width, height)
        .ok_or_else(|| DrawError(format!("{width} x {height} pixels are too many")))?;
    resvg::render(&tree, tiny_skia::Transform::from_scale(scale, scale), &mut pixmap.as_mut());
    pixmap.encode_png().map_err(|error| DrawError(error.to_string()))
}

/// A drawing that could not be turned into pixels.
#[cfg(feature = "png")]
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[error("cannot draw the goal: {0}")]
pub struct DrawError(String);
