//! The `ramp` command.

fn main() -> std::process::ExitCode {
    ramp_cli::main()
}
