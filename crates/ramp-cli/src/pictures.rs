//! Optional films and Rerun recordings of a run or a replay.

use std::path::PathBuf;

use miette::Report;
use ramp_episode::Progress;
use ramp_twin::{Setup, Twin};

use crate::film::{self, Film};
use crate::output::check_place;
use crate::recording::Recording;

/// Options for films and recordings.
#[derive(clap::Args)]
pub struct Arguments {
    /// Also write a film at eightfold speed: a GIF, or with ffmpeg an MP4
    #[arg(long, value_name = "FILE")]
    video: Option<PathBuf>,
    /// Camera of the film
    #[arg(long, value_enum, default_value_t = film::From::Free, requires = "video")]
    video_from: film::From,
    /// Also record scene, forces and actions for the Rerun viewer (.rrd); needs a program built with the
    /// feature `rerun`
    #[arg(long, value_name = "FILE")]
    rerun: Option<PathBuf>,
}

impl Arguments {
    /// Whether there is anything to draw.
    #[cfg(feature = "franka")]
    pub fn any(&self) -> bool {
        self.video.is_some() || self.rerun.is_some()
    }
}

/// Films and recordings in progress.
pub struct Pictures {
    film: Option<Film>,
    recording: Option<Recording>,
    /// The counted things, for a person.
    unit: &'static str,
    error: Option<Report>,
}

impl Pictures {
    /// Starts the files.
    ///
    /// # Errors
    /// If a file cannot be written, or a part cannot be drawn.
    pub fn new(arguments: &Arguments, setup: &Setup) -> Result<Pictures, Report> {
        for path in [&arguments.video, &arguments.rerun].into_iter().flatten() {
            check_place(path)?;
        }
        let film = arguments.video.as_ref().map(|path| Film::new(path, setup, arguments.video_from));
        let recording = arguments.rerun.as_ref().map(|path| Recording::new(path, setup));
        let unit = setup.task.unit();
        Ok(Pictures { film: film.transpose()?, recording: recording.transpose()?, unit, error: None })
    }

    /// Adds the current state. An error does not stop the episode; it is reported at the end.
    pub fn show(&mut self, twin: &Twin, action: &str, progress: &Progress) {
        if self.error.is_none() {
            self.error = self.try_to_show(twin, action, progress).err();
        }
    }

    fn try_to_show(&mut self, twin: &Twin, action: &str, progress: &Progress) -> Result<(), Report> {
        if let Some(film) = &mut self.film {
            film.show(twin, &format!("{action}   {} of {} {}", progress.seated, progress.pegs, self.unit))?;
        }
        if let Some(recording) = &mut self.recording {
            recording.show(twin, action, progress.seated)?;
        }
        Ok(())
    }

    /// Finishes the files.
    ///
    /// # Errors
    /// The first error.
    pub fn end(self) -> Result<(), Report> {
        if let Some(error) = self.error {
            return Err(error);
        }
        if let Some(film) = self.film {
            film.end()?;
        }
        self.recording.map_or(Ok(()), Recording::end)
    }
}
