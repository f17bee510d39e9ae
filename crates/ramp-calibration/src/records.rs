//! Recordings in files: images, and tables of numbers.

use std::path::{Path, PathBuf};

use nalgebra::{Quaternion, Translation3, UnitQuaternion};
use ramp_robot::{Camera, Image, Pose};
use ramp_source::{ReadError, plain, read_bytes, read_text, shorten};

use crate::error::CalibrationError;

/// Largest size of a table, bytes: ten minutes of 22 numbers a millisecond.
const LARGEST_TABLE: usize = 128 << 20;
/// Largest size of an image file, bytes.
const LARGEST_IMAGE: usize = 64 << 20;
/// Most images of a folder. Each takes a byte a pixel while all of them are adjusted.
const MOST_IMAGES: usize = 200;
/// Most pixels of an image, millions.
const MOST_PIXELS: u64 = 12;
/// Largest coordinate, m.
const FARTHEST: f64 = 10.0;
/// Name of the table of tip poses beside the images.
pub const POSES: &str = "poses.csv";

/// A row of a table of a CSV file.
struct Row {
    file: String,
    line: usize,
    cells: csv::StringRecord,
}

fn name(path: &Path) -> String {
    plain(&path.display().to_string(), usize::MAX)
}

fn wrong(file: &str, line: usize, found: &str, expected: &str) -> CalibrationError {
    let (found, expected) = (found.to_string(), expected.to_string());
    CalibrationError::Entry { file: file.to_string(), line, found, expected }
}

impl Row {
    fn wrong(&self, found: &str, expected: &str) -> CalibrationError {
        wrong(&self.file, self.line, found, expected)
    }

    /// The numbers from the column `from` on, each of at most `most` to both sides.
    fn numbers<const N: usize>(&self, from: usize, most: f64) -> Result<[f64; N], CalibrationError> {
        let mut numbers = [0.0; N];
        for (number, cell) in numbers.iter_mut().zip(self.cells.iter().skip(from)) {
            *number = match cell.parse::<f64>() {
                Ok(value) if value.abs() <= most => value,
                _ => {
                    let found = format!("`{}`", shorten(cell));
                    return Err(self.wrong(&found, &format!("a number from -{most} to {most}")));
                }
            };
        }
        Ok(numbers)
    }
}

/// Reads a table whose first row must be `columns`, and hands over each row below it.
fn read_table(
    path: &Path,
    columns: &[&str],
    mut take: impl FnMut(&Row) -> Result<(), CalibrationError>,
) -> Result<(), CalibrationError> {
    let text = read_text(path, LARGEST_TABLE)?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .comment(Some(b'#'))
        .from_reader(text.as_bytes());
    let head = format!("the columns `{}`", columns.join(","));
    let mut row = Row { file: name(path), line: 1, cells: csv::StringRecord::new() };
    let mut has_head = false;
    loop {
        let is_row = reader.read_record(&mut row.cells).map_err(|error| {
            let line = error.position().map_or(1, |at| at.line() as usize);
            wrong(&row.file, line, "something that is not CSV", "cells separated by commas")
        })?;
        if !is_row {
            break;
        }
        row.line = row.cells.position().map_or(1, |at| at.line() as usize);
        if !has_head {
            if !row.cells.iter().eq(columns.iter().copied()) {
                let found = row.cells.iter().collect::<Vec<_>>().join(",");
                return Err(row.wrong(&format!("`{}`", shorten(&found)), &head));
            }
            has_head = true;
        } else if row.cells.len() == columns.len() {
            take(&row)?;
        } else {
            return Err(row.wrong(&format!("{} cells", row.cells.len()), &columns.len().to_string()));
        }
    }
    if has_head { Ok(()) } else { Err(row.wrong("an empty file", &head)) }
}

/// Reads an image in the PNG format with 8 bits or more a channel; grey ones become colour images.
///
/// # Errors
/// A file that is no such image, or one of more than 12 million pixels.
pub fn read_image(path: &Path) -> Result<Image, CalibrationError> {
    let bytes = read_bytes(path, LARGEST_IMAGE)?;
    let wrong = |why: String| CalibrationError::Image { file: name(path), why };
    let mut decoder = png::Decoder::new(std::io::Cursor::new(bytes));
    decoder.set_transformations(png::Transformations::normalize_to_color8());
    let why =
        |error: png::DecodingError| wrong(format!("cannot be read as PNG: {}", shorten(&error.to_string())));
    let mut reader = decoder.read_info().map_err(why)?;
    let (width, height) = (reader.info().width, reader.info().height);
    if u64::from(width) * u64::from(height) > MOST_PIXELS * 1_000_000 {
        let why = format!("is {width} × {height} pixels, expected at most {MOST_PIXELS} millions");
        return Err(wrong(why));
    }
    let size = reader.output_buffer_size().ok_or_else(|| wrong("is too large".to_string()))?;
    let mut buffer = vec![0; size];
    let info = reader.next_frame(&mut buffer).map_err(why)?;
    buffer.truncate(info.buffer_size());
    let pixels: Vec<u8> = match info.color_type {
        png::ColorType::Rgb => buffer,
        png::ColorType::Rgba => {
            buffer.as_chunks::<4>().0.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect()
        }
        png::ColorType::Grayscale => buffer.iter().flat_map(|grey| [*grey; 3]).collect(),
        png::ColorType::GrayscaleAlpha => {
            buffer.as_chunks::<2>().0.iter().flat_map(|[grey, _]| [*grey; 3]).collect()
        }
        png::ColorType::Indexed => return Err(wrong("has a palette that cannot be read".to_string())),
    };
    let (width, height) = (width as usize, height as usize);
    // The camera's name appears in no message: the file's does.
    Ok(Image { camera: Camera::Wrist, time: 0.0, x_wt: Pose::identity(), width, height, pixels, depth: None })
}

/// The PNG files of a folder, sorted by name.
///
/// # Errors
/// A folder that cannot be read, or one with more than 200 images.
pub fn images_of(folder: &Path) -> Result<Vec<PathBuf>, CalibrationError> {
    let unreadable = |error: std::io::Error| {
        let why = error.to_string();
        CalibrationError::Read(ReadError::Unreadable { file: name(folder), why: shorten(&why) })
    };
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let path = entry.map_err(unreadable)?.path();
        if path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png")) {
            paths.push(path);
        }
        if paths.len() > MOST_IMAGES {
            let why = format!("holds more than {MOST_IMAGES} images");
            return Err(CalibrationError::Image { file: name(folder), why });
        }
    }
    paths.sort();
    Ok(paths)
}

/// The images of a folder with the pose of the tip in the robot's base frame at each, from its table
/// [`POSES`] with the columns `image,x,y,z,qw,qx,qy,qz` (m, and a unit quaternion).
///
/// # Errors
/// The first invalid row: a number, a quaternion that is no unit one, or the name of a file elsewhere.
pub fn read_poses(folder: &Path) -> Result<Vec<(PathBuf, Pose)>, CalibrationError> {
    /// Largest difference of a quaternion's length from 1: rounded to three digits.
    const UNIT: f64 = 2e-3;
    let columns = ["image", "x", "y", "z", "qw", "qx", "qy", "qz"];
    let mut poses: Vec<(PathBuf, Pose)> = Vec::new();
    read_table(&folder.join(POSES), &columns, |row| {
        if poses.len() == MOST_IMAGES {
            return Err(row.wrong("one image more", &format!("at most {MOST_IMAGES}")));
        }
        let image = &row.cells[0];
        if image.is_empty() || image == ".." || image.contains(['/', '\\', ':']) {
            return Err(
                row.wrong(&format!("`{}`", shorten(image)), "the name of an image in the same folder")
            );
        }
        let path = folder.join(image);
        if poses.iter().any(|(other, _)| *other == path) {
            return Err(row.wrong(&format!("`{}` again", shorten(image)), "each image once"));
        }
        let [x, y, z] = row.numbers(1, FARTHEST)?;
        let [qw, qx, qy, qz] = row.numbers(4, 1.0 + UNIT)?;
        let quaternion = Quaternion::new(qw, qx, qy, qz);
        if (quaternion.norm() - 1.0).abs() > UNIT {
            let found = format!("a quaternion of length {:.4}", quaternion.norm());
            return Err(row.wrong(&found, "a unit quaternion qw,qx,qy,qz"));
        }
        let rotation = UnitQuaternion::from_quaternion(quaternion);
        poses.push((path, Pose::from_parts(Translation3::new(x, y, z), rotation)));
        Ok(())
    })?;
    Ok(poses)
}

/// Touched points in the robot's base frame, m, from a table with the columns `x,y,z`.
///
/// # Errors
/// The first invalid row.
pub fn read_points(path: &Path) -> Result<Vec<[f64; 3]>, CalibrationError> {
    let mut points = Vec::new();
    read_table(path, &["x", "y", "z"], |row| {
        points.push(row.numbers(0, FARTHEST)?);
        Ok(())
    })?;
    Ok(points)
}

/// A moment of a recording of the joints.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSample {
    /// s.
    pub time: f64,
    /// Joint positions, rad.
    pub positions: [f64; 7],
    /// Joint velocities, rad/s.
    pub velocities: [f64; 7],
    /// Commanded torques without those against gravity, N·m.
    pub torques: [f64; 7],
}

/// A recording of the joints, from a table with the columns `time`, `q1` to `q7`, `dq1` to `dq7` and `tau1`
/// to `tau7`.
///
/// # Errors
/// The first invalid row, or a time that is not after the one before.
pub fn read_joints(path: &Path) -> Result<Vec<JointSample>, CalibrationError> {
    /// Largest time (s), position (rad), velocity (rad/s) and torque (N·m).
    const MOST: [f64; 4] = [1e6, 10.0, 10.0, 1000.0];
    let each = |name: &'static str| (1..=7).map(move |joint| format!("{name}{joint}"));
    let columns: Vec<String> =
        std::iter::once("time".to_string()).chain(each("q")).chain(each("dq")).chain(each("tau")).collect();
    let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
    let mut samples: Vec<JointSample> = Vec::new();
    read_table(path, &columns, |row| {
        let [time] = row.numbers(0, MOST[0])?;
        if let Some(last) = samples.last().filter(|last| time <= last.time) {
            let found = format!("the time {time} s after {} s", last.time);
            return Err(row.wrong(&found, "times that increase"));
        }
        samples.push(JointSample {
            time,
            positions: row.numbers(1, MOST[1])?,
            velocities: row.numbers(8, MOST[2])?,
            torques: row.numbers(15, MOST[3])?,
        });
        Ok(())
    })?;
    Ok(samples)
}
