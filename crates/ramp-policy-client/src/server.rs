//! A policy server: its address, and what it said of its policy.

use std::time::{Duration, Instant};

use crate::connection::{Connection, Heard, PolicyUrl};
use crate::error::PolicyError;
use crate::metadata::Metadata;

/// A policy server that has said what its policy is.
pub struct PolicyServer {
    url: PolicyUrl,
    metadata: Metadata,
}

impl PolicyServer {
    /// Connects to a server, reads its metadata, and closes the connection, within `limit`.
    ///
    /// # Errors
    /// If it cannot be reached, or is no policy server that fits this robot.
    pub fn find(url: &PolicyUrl, limit: Duration) -> Result<PolicyServer, PolicyError> {
        let (mut connection, metadata) = greet(url, Instant::now() + limit)?;
        connection.close();
        Ok(PolicyServer { url: url.clone(), metadata })
    }

    /// Its address.
    pub fn url(&self) -> &PolicyUrl {
        &self.url
    }

    /// Its metadata.
    pub fn metadata(&self) -> &Metadata {
        &self.metadata
    }

    /// A connection for an episode, by `end`. One that was open since the command began would have been
    /// closed by a server that expects answers to its pings.
    pub(crate) fn connect(&self, end: Instant) -> Result<Connection, PolicyError> {
        let (connection, metadata) = greet(&self.url, end)?;
        if metadata.sha256 == self.metadata.sha256 { Ok(connection) } else { Err(PolicyError::Changed) }
    }
}

/// A new connection, and what the server says first.
fn greet(url: &PolicyUrl, end: Instant) -> Result<(Connection, Metadata), PolicyError> {
    let mut connection = Connection::open(url, end)?;
    match connection.hear(end)? {
        Heard::Words(words) => Err(PolicyError::Failed(words)),
        Heard::Bytes(bytes) => Ok((connection, Metadata::read(&bytes).map_err(PolicyError::Wrong)?)),
    }
}
