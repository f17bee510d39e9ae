//! `ramp seeds commit` and `ramp seeds verify`: an organiser's secret that is mixed into the seeds of a
//! bench.

use std::path::{Path, PathBuf};

use miette::{Report, miette};
use ramp_result::secret::{Kept, LENGTH, Promise, Secret, verify};

use crate::output::{print, read_json, refuse_existing, write_json};
use crate::status::{DONE, INCOMPLETE};

/// File that is published before the bench.
const COMMITMENT: &str = "commitment.json";
/// File that is kept secret until after the bench.
const SECRET: &str = "secret.json";
/// Command that writes both files.
const WRITER: &str = "ramp seeds commit";

#[derive(clap::Args)]
pub struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(clap::Subcommand)]
enum Command {
    /// Make a secret for `ramp bench --secret`, and a commitment to it
    Commit(CommitArguments),
    /// Check a secret against its commitment
    Verify(VerifyArguments),
}

#[derive(clap::Args)]
struct CommitArguments {
    /// Folder for commitment.json, to be published now, and secret.json, to be kept back; made if it is not
    /// there
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

#[derive(clap::Args)]
struct VerifyArguments {
    /// The commitments, as published before
    commitment: PathBuf,
    /// The file that was published later
    secret: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<u8, Report> {
    match &arguments.command {
        Command::Commit(arguments) => commit(arguments),
        Command::Verify(arguments) => check(arguments),
    }
}

/// Reads a secret.
///
/// # Errors
/// If the file holds no secret.
pub fn read(path: &Path) -> Result<Secret, Report> {
    let kept: Kept = read_json(path, WRITER)?;
    Secret::from_kept(&kept).map_err(|error| {
        miette!(help = format!("expected a file that `{WRITER}` wrote"), "{}: {error}", path.display())
    })
}

fn commit(arguments: &CommitArguments) -> Result<u8, Report> {
    let [commitment, secret] = [COMMITMENT, SECRET].map(|name| arguments.output.join(name));
    refuse_existing([&commitment, &secret])?;
    let mut bytes = [0; LENGTH];
    getrandom::fill(&mut bytes).map_err(|error| miette!("the system gives no random numbers: {error}"))?;
    let made = Secret::new(bytes);
    write_json(&secret, &made.kept())?;
    write_json(&commitment, &made.promise())?;
    print(&format!(
        "{}\npublish {}; keep {} back\n",
        made.commitment(),
        commitment.display(),
        secret.display()
    ))?;
    Ok(DONE)
}

fn check(arguments: &VerifyArguments) -> Result<u8, Report> {
    let promised: Promise = read_json(&arguments.commitment, WRITER)?;
    let revealed: Kept = read_json(&arguments.secret, WRITER)?;
    match verify(&promised, &revealed) {
        Ok(()) => {
            print(&format!("this is the secret that was promised, for the rules {}\n", promised.rules))?;
            Ok(DONE)
        }
        Err(error) => {
            print(&format!("{error}\n"))?;
            Ok(INCOMPLETE)
        }
    }
}
