//! Encodes frames as MP4 with ffmpeg, if it is installed.

use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

use miette::{IntoDiagnostic, Report, miette};
use ramp_kit::source::WholeFile;
use resvg::tiny_skia;

use super::form::{LAST, SIZE};

/// Display time of a frame, s.
pub const SHOWN: f64 = 0.04;

/// Writer of an MP4 file.
pub struct Mp4 {
    path: PathBuf,
    file: WholeFile,
    ffmpeg: Child,
    last: Vec<u8>,
}

impl Mp4 {
    /// Starts an empty film.
    ///
    /// # Errors
    /// If ffmpeg is missing.
    pub fn new(path: &Path) -> Result<Mp4, Report> {
        let [width, height] = SIZE;
        let file = WholeFile::new(path)?;
        let ffmpeg = Command::new("ffmpeg")
            .args(["-y", "-loglevel", "error", "-f", "rawvideo", "-pixel_format", "rgba"])
            .args(["-video_size", &format!("{width}x{height}"), "-framerate", &(1.0 / SHOWN).to_string()])
            .args(["-i", "-", "-pix_fmt", "yuv420p", "-movflags", "+faststart"])
            .args(["-f", "mp4"])
            // Keep a file name that starts with a dash from being read as an option.
            .arg(Path::new(".").join(file.place()))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .map_err(|error| {
                let why = match error.kind() {
                    ErrorKind::NotFound => "there is no ffmpeg on the PATH".to_string(),
                    _ => format!("ffmpeg cannot be started: {error}"),
                };
                miette!(
                    help = "install ffmpeg, or end the file's name in .gif",
                    "{} cannot be written: {why}",
                    path.display()
                )
            })?;
        Ok(Mp4 { path: path.to_path_buf(), file, ffmpeg, last: Vec::new() })
    }

    /// Adds a frame.
    ///
    /// # Errors
    /// If ffmpeg accepts no more frames.
    pub fn write(&mut self, pixmap: &tiny_skia::Pixmap) -> Result<(), Report> {
        self.last = pixmap.data().to_vec();
        self.write_last()
    }

    fn write_last(&mut self) -> Result<(), Report> {
        let Some(input) = &mut self.ffmpeg.stdin else { return Ok(()) };
        input
            .write_all(&self.last)
            .map_err(|error| miette!("ffmpeg does not write {}: {error}", self.path.display()))
    }

    /// Holds the last frame, and waits until the file is written.
    ///
    /// # Errors
    /// If ffmpeg fails.
    pub fn end(mut self) -> Result<(), Report> {
        for _ in 0..(LAST / SHOWN) as usize {
            self.write_last()?;
        }
        drop(self.ffmpeg.stdin.take());
        let status = self.ffmpeg.wait().into_diagnostic()?;
        if !status.success() {
            return Err(miette!("ffmpeg could not write {}", self.path.display()));
        }
        Ok(self.file.finish()?)
    }
}
