//! A folder of generated pages. Old pages that are not written again are removed.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use miette::{Report, miette};
use ramp_result::write_whole;

/// A folder of pages.
pub struct Site {
    folder: PathBuf,
    written: HashSet<String>,
}

impl Site {
    /// Creates the folder if it is missing.
    pub fn open(folder: &Path) -> Result<Site, Report> {
        std::fs::create_dir_all(folder)
            .map_err(|error| miette!("cannot make the folder {}: {error}", folder.display()))?;
        Ok(Site { folder: folder.to_path_buf(), written: HashSet::new() })
    }

    /// Writes a page atomically.
    pub fn write(&mut self, name: &str, text: &str) -> Result<(), Report> {
        write_whole(&self.folder.join(name), text)?;
        self.written.insert(name.to_string());
        Ok(())
    }

    /// Removes the pages that were not written and whose names begin with one of `stems`.
    pub fn remove_others(&self, stems: &[&str]) -> Result<(), Report> {
        let fail = |error| miette!("{} cannot be cleared: {error}", self.folder.display());
        for entry in std::fs::read_dir(&self.folder).map_err(fail)? {
            let entry = entry.map_err(fail)?;
            let name = entry.file_name().to_string_lossy().into_owned();
            let ours = name.ends_with(".html") && stems.iter().any(|stem| name.starts_with(stem));
            if ours && !self.written.contains(&name) {
                std::fs::remove_file(entry.path()).map_err(fail)?;
            }
        }
        Ok(())
    }
}
