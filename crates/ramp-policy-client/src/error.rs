//! Errors of a policy server.

/// The reason why a server gives no actions, as words after "the policy server".
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PolicyError {
    /// Nobody answers at its address.
    #[error("cannot be reached: {0}")]
    Connect(String),
    /// It has not answered, or not read, in time.
    #[error("did not answer in time")]
    Silent,
    /// It has ended the connection, or is no more.
    #[error("closed the connection")]
    Gone,
    /// The connection has failed, or it speaks no WebSocket.
    #[error("broke the connection: {0}")]
    Broken(String),
    /// A message is too long.
    #[error("sent a message of more than {most} bytes")]
    TooLong {
        /// bytes.
        most: usize,
    },
    /// It said in words that it cannot go on.
    #[error("failed: {0}")]
    Failed(String),
    /// A message is not what was expected.
    #[error("sent what is not understood: {0}")]
    Wrong(String),
    /// Another policy than at first is behind the address.
    #[error("has other metadata than when the command began")]
    Changed,
}
