//! Writes all files for making a kit into one folder.
//!
//! A second export replaces only the files of the first one: a list in the folder names them with
//! checksums. If a file was changed or added by hand, the export is refused unless it is forced,
//! and the file is kept.

use crate::beam::Kit;
use crate::bill::{self, Printed};
use crate::drawing::{self, A4, Drawing, LETTER};
use crate::solid::{self, SolidError};
use crate::threemf::Item;
use crate::{guide, sheet, stl, threemf, tiles};
use ramp_source::{MAX_FILE, read_bytes, read_text, write_whole};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// Name of the list of exported files, in their folder.
pub const LIST: &str = "written-by-ramp.txt";
/// Edge of the printer's plate, mm.
pub const PLATE: f64 = 256.0;
/// Margin along the plate's edges, and between two parts on it, mm.
const MARGIN: f64 = 5.0;
const BETWEEN: f64 = 4.0;
/// Size limit of an exported file, bytes.
const LARGEST: usize = 256 << 20;

/// Reasons why a kit could not be exported. Nothing has been written then, unless the system failed
/// half way.
#[derive(Debug, thiserror::Error, miette::Diagnostic)]
#[non_exhaustive]
pub enum ExportError {
    /// A part that cannot be made.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Solid(#[from] SolidError),
    /// Files that are not of an export, or were changed since.
    #[error("would overwrite {}", .files.iter().map(|file| format!("`{}`", file.display())).collect::<Vec<_>>().join(", "))]
    #[diagnostic(help(
        "these were not written by an export, or were changed since; --force overwrites them"
    ))]
    Foreign {
        /// The files.
        files: Vec<PathBuf>,
    },
    /// A part that is larger than the plate.
    #[error("`{part}` does not fit a plate of {PLATE} x {PLATE} mm")]
    TooLarge {
        /// The part.
        part: String,
    },
    /// The writer of the 3MF files failed.
    #[error("cannot pack `{part}`: {why}")]
    Pack {
        /// The file.
        part: String,
        /// Its reason.
        why: String,
    },
    /// The system refused.
    #[error("cannot write {}: {why}", .file.display())]
    Write {
        /// The file or folder.
        file: PathBuf,
        /// The system's reason.
        why: std::io::Error,
    },
}

/// A file of an export.
#[derive(Clone, Debug, PartialEq)]
pub struct File {
    /// Its path in the folder, with `/` between folders.
    pub path: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// All exported files, in memory: the same kit gives the same bytes.
///
/// # Errors
/// Parts that cannot be made, or are larger than the plate.
pub fn files(kit: &Kit) -> Result<Vec<File>, ExportError> {
    let mut files = Vec::new();
    let mut add = |path: String, bytes: Vec<u8>| files.push(File { path, bytes });
    let printed = bill::printed(kit)?;
    for part in &printed {
        let mesh = part.solid.mesh();
        add(format!("stl/{}.stl", part.name), stl::write(&mesh, &part.name));
        let item = Item { name: &part.name, mesh: &mesh, places: vec![[0.0; 3]] };
        add(format!("3mf/{}.3mf", part.name), pack(&part.name, &[item])?);
    }
    for (length, _) in bill::lengths(kit) {
        let name = format!("extrusion-{}", bill::length_words(length));
        let solid = solid::extrusion(length * 1e3)?;
        add(format!("bought/{name}.stl"), stl::write(&solid.mesh(), &name));
    }
    for (index, plate) in plates(&printed)?.iter().enumerate() {
        let name = format!("plate-{:02}", index + 1);
        let items: Vec<Item<'_>> = plate
            .iter()
            .map(|(part, mesh, places)| Item { name: part, mesh, places: places.clone() })
            .collect();
        add(format!("plates/{name}.3mf"), pack(&name, &items)?);
    }
    let rows = bill::bill(kit, &printed);
    add("bill-of-parts.csv".into(), bill::csv(&rows).into_bytes());
    add("bill-of-parts.md".into(), bill::table(kit, &rows).into_bytes());
    add("cutting-list.csv".into(), bill::cutting_list(kit).into_bytes());
    let mut draw = |name: &str, title: &str, pages: &[Drawing]| {
        add(format!("{name}.pdf"), drawing::pdf(title, pages));
        for (index, page) in pages.iter().enumerate() {
            let number = if pages.len() > 1 { format!("-{}", index + 1) } else { String::new() };
            add(format!("{name}{number}.svg"), page.svg().into_bytes());
        }
    };
    let whole = sheet::start_sheet(kit)?;
    draw("sheet", "RAMP start sheet", std::slice::from_ref(&whole));
    draw("tags", "RAMP tags", &sheet::tag_sheets(kit, A4));
    draw("guide", "RAMP assembly guide", &guide::guide(kit)?);
    for (name, [width, height]) in [("calibration", A4), ("calibration-letter", LETTER)] {
        let page = sheet::calibration_sheet([height, width]);
        draw(name, &page.title, std::slice::from_ref(&page));
    }
    for (name, paper) in [("a4", A4), ("letter", LETTER)] {
        let pages = tiles::tiles(&whole, paper);
        add(format!("sheet-tiles-{name}.pdf"), drawing::pdf("RAMP start sheet in tiles", &pages));
    }
    add("tags-letter.pdf".into(), drawing::pdf("RAMP tags", &sheet::tag_sheets(kit, LETTER)));
    Ok(files)
}

fn pack(name: &str, items: &[Item<'_>]) -> Result<Vec<u8>, ExportError> {
    threemf::write(name, items)
        .map_err(|error| ExportError::Pack { part: name.to_string(), why: error.to_string() })
}

/// A plate: for each part its name, its surface as oriented for printing, and the positions of its
/// copies.
type Plate = Vec<(String, solid::Mesh, Vec<[f64; 3]>)>;

/// Arranges all parts on plates, in rows, deepest first.
fn plates(printed: &[Printed]) -> Result<Vec<Plate>, ExportError> {
    struct Part<'a> {
        name: &'a str,
        mesh: solid::Mesh,
        low: [f64; 3],
        size: [f64; 2],
    }
    let mut copies: Vec<usize> = Vec::new();
    let mut parts: Vec<Part<'_>> = Vec::new();
    for (index, part) in printed.iter().enumerate() {
        let mesh = part.solid.rotated(part.lay).mesh();
        let [low, high] = mesh.bounds();
        let size = [high[0] - low[0], high[1] - low[1]];
        if size.iter().any(|edge| *edge > PLATE - 2.0 * MARGIN) || high[2] - low[2] > PLATE {
            return Err(ExportError::TooLarge { part: part.name.clone() });
        }
        parts.push(Part { name: &part.name, mesh, low, size });
        copies.extend(std::iter::repeat_n(index, part.count));
    }
    copies.sort_by(|&a, &b| parts[b].size[1].total_cmp(&parts[a].size[1]).then(a.cmp(&b)));
    let mut plates: Vec<Plate> = Vec::new();
    // The next free position, and the depth of its row.
    let (mut x, mut y, mut depth) = (f64::INFINITY, f64::INFINITY, 0.0);
    for index in copies {
        let Part { name, mesh, low, size } = &parts[index];
        if x + size[0] > PLATE - MARGIN {
            (x, y, depth) = (MARGIN, y + depth + BETWEEN, size[1]);
        }
        if y + size[1] > PLATE - MARGIN {
            plates.push(Plate::new());
            (x, y, depth) = (MARGIN, MARGIN, size[1]);
        }
        let place = [x - low[0], y - low[1], -low[2]];
        x += size[0] + BETWEEN;
        let Some(plate) = plates.last_mut() else { continue };
        match plate.iter_mut().find(|(part, ..)| part == name) {
            Some((_, _, places)) => places.push(place),
            None => plate.push((name.to_string(), mesh.clone(), vec![place])),
        }
    }
    Ok(plates)
}

/// Writes a kit into a folder, which is created if it is missing. Returns the files, in the order
/// of their names in the folder.
///
/// # Errors
/// [`ExportError::Foreign`] for files there that are not of an export, unless `force`; parts that
/// cannot be made; errors of the system.
pub fn export(kit: &Kit, folder: &Path, force: bool) -> Result<Vec<PathBuf>, ExportError> {
    let files = files(kit)?;
    let list = folder.join(LIST);
    let before: HashMap<String, u64> =
        read_text(&list, MAX_FILE).map(|text| parse_list(&text)).unwrap_or_default();
    let mut foreign = Vec::new();
    for file in &files {
        let path = folder.join(&file.path);
        let known = |there: Vec<u8>| there == file.bytes || before.get(&file.path) == Some(&checksum(&there));
        // A link counts as an existing file, wherever it points.
        let ours = path.symlink_metadata().is_err_and(|error| error.kind() == std::io::ErrorKind::NotFound)
            || read_bytes(&path, LARGEST).is_ok_and(known);
        if !ours {
            foreign.push(path);
        }
    }
    if !foreign.is_empty() && !force {
        return Err(ExportError::Foreign { files: foreign });
    }
    let failed = |file: &Path| {
        let file = file.to_path_buf();
        move |why| ExportError::Write { file, why }
    };
    let mut written = Vec::new();
    let mut text =
        String::from("What `ramp kit export` wrote here, each with a checksum; it overwrites only these.\n");
    for file in &files {
        let path = folder.join(&file.path);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(failed(parent))?;
        }
        write_whole(&path, &file.bytes).map_err(|error| failed(&path)(error.source))?;
        // Writing to a string does not fail.
        let _ = writeln!(text, "{:016x} {}", checksum(&file.bytes), file.path);
        written.push(path);
    }
    write_whole(&list, text).map_err(|error| failed(&list)(error.source))?;
    written.sort();
    Ok(written)
}

fn parse_list(text: &str) -> HashMap<String, u64> {
    let line = |line: &str| {
        let (sum, path) = line.split_once(' ')?;
        Some((path.to_string(), u64::from_str_radix(sum, 16).ok()?))
    };
    text.lines().filter_map(line).collect()
}

/// FNV-1a, to detect changed files.
fn checksum(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}
