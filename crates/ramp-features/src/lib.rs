//! No code: `Cargo.toml` names features of other crates, so that tests, the command and the Python module
//! share what is built.
