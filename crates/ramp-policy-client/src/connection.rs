//! The WebSocket to a server. Every message has a largest size, and every exchange an end in time.

use std::fmt;
use std::io::{ErrorKind, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::str::FromStr;
use std::time::{Duration, Instant};

use ramp_kit::source::plain;
use tungstenite::http::Uri;
use tungstenite::protocol::WebSocketConfig;
use tungstenite::{HandshakeError, Message, WebSocket};

use crate::error::PolicyError;

/// The largest message of a server, bytes: ten thousand actions of eight numbers.
const LARGEST: usize = 1 << 20;
/// The longest words of a server in a message, characters.
const LONGEST_WORDS: usize = 200;

/// The address of a server: `ws://HOST:PORT`, with a path behind it where the server wants one.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PolicyUrl {
    uri: Uri,
    host: String,
    port: u16,
}

/// The reason why a text is no address of a server.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum UrlError {
    /// Encryption is not built in.
    #[error("wss is not built in: forward the port, such as by `ssh -L`, and use ws")]
    Secure,
    /// It is not of the form.
    #[error("expected ws://HOST:PORT, such as ws://127.0.0.1:8000")]
    Form,
}

impl FromStr for PolicyUrl {
    type Err = UrlError;

    fn from_str(text: &str) -> Result<PolicyUrl, UrlError> {
        let uri: Uri = text.parse().map_err(|_| UrlError::Form)?;
        match uri.scheme_str() {
            Some("ws") => {}
            Some("wss") => return Err(UrlError::Secure),
            _ => return Err(UrlError::Form),
        }
        let authority = uri.authority().ok_or(UrlError::Form)?;
        let port = authority.port_u16().ok_or(UrlError::Form)?;
        let host = authority.host().trim_matches(['[', ']']).to_string();
        if host.is_empty() || authority.as_str().contains('@') {
            return Err(UrlError::Form);
        }
        Ok(PolicyUrl { host, port, uri })
    }
}

impl fmt::Display for PolicyUrl {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        write!(f, "{}", self.uri.to_string().trim_end_matches('/'))
    }
}

/// A stream on which every read and write ends at a moment, however slowly the other side sends.
struct Timed {
    stream: TcpStream,
    end: Instant,
}

impl Timed {
    fn left(&self) -> std::io::Result<Duration> {
        let left = self.end.saturating_duration_since(Instant::now());
        if left.is_zero() { Err(ErrorKind::TimedOut.into()) } else { Ok(left) }
    }
}

/// The error of a socket whose time is over has different kinds on different systems.
fn timed_out(error: std::io::Error) -> std::io::Error {
    match error.kind() {
        ErrorKind::WouldBlock | ErrorKind::TimedOut => ErrorKind::TimedOut.into(),
        _ => error,
    }
}

impl Read for Timed {
    fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
        self.stream.set_read_timeout(Some(self.left()?))?;
        self.stream.read(buffer).map_err(timed_out)
    }
}

impl Write for Timed {
    fn write(&mut self, buffer: &[u8]) -> std::io::Result<usize> {
        self.stream.set_write_timeout(Some(self.left()?))?;
        self.stream.write(buffer).map_err(timed_out)
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.stream.flush()
    }
}

/// The answer of a server.
pub(crate) enum Heard {
    Bytes(Vec<u8>),
    /// The words of a server that cannot answer, or that has nothing to say.
    Words(String),
}

/// A connection to a server.
pub(crate) struct Connection {
    socket: WebSocket<Timed>,
}

impl Connection {
    /// Connects. It is over at `end`.
    pub(crate) fn open(url: &PolicyUrl, end: Instant) -> Result<Connection, PolicyError> {
        let no = |why: String| PolicyError::Connect(why);
        let addresses =
            (url.host.as_str(), url.port).to_socket_addrs().map_err(|error| no(error.to_string()))?;
        let mut last = "the host has no address".to_string();
        for address in addresses {
            let left = end.saturating_duration_since(Instant::now()).max(Duration::from_millis(1));
            match TcpStream::connect_timeout(&address, left) {
                Ok(stream) => return Connection::greet(url, stream, end),
                Err(error) => last = error.to_string(),
            }
        }
        Err(no(last))
    }

    fn greet(url: &PolicyUrl, stream: TcpStream, end: Instant) -> Result<Connection, PolicyError> {
        // An observation is one message, which is sent at once.
        let _ = stream.set_nodelay(true);
        let config = WebSocketConfig::default().max_message_size(Some(LARGEST)).max_frame_size(Some(LARGEST));
        let stream = Timed { stream, end };
        match tungstenite::client::client_with_config(url.uri.clone(), stream, Some(config)) {
            Ok((socket, _)) => Ok(Connection { socket }),
            Err(HandshakeError::Failure(error)) => Err(failed(error)),
            Err(HandshakeError::Interrupted(_)) => Err(PolicyError::Silent),
        }
    }

    /// Sends a message.
    pub(crate) fn send(&mut self, bytes: Vec<u8>, end: Instant) -> Result<(), PolicyError> {
        self.socket.get_mut().end = end;
        self.socket.send(Message::Binary(bytes.into())).map_err(failed)
    }

    /// The next message.
    pub(crate) fn hear(&mut self, end: Instant) -> Result<Heard, PolicyError> {
        self.socket.get_mut().end = end;
        loop {
            match self.socket.read().map_err(failed)? {
                Message::Binary(bytes) => return Ok(Heard::Bytes(bytes.into())),
                Message::Text(words) => return Ok(Heard::Words(last_words(words.as_str()))),
                Message::Close(_) => return Err(PolicyError::Gone),
                // Answered by the library.
                Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
            }
        }
    }

    /// Another handle of its stream.
    ///
    /// # Errors
    /// If the system has no more handles.
    pub(crate) fn stream(&self) -> std::io::Result<TcpStream> {
        self.socket.get_ref().stream.try_clone()
    }

    /// Says goodbye, as far as that takes no time.
    pub(crate) fn close(&mut self) {
        self.socket.get_mut().end = Instant::now() + Duration::from_millis(100);
        let _ = self.socket.close(None);
        let _ = self.socket.flush();
    }
}

/// The end of what a server said in words: a traceback ends with its error.
fn last_words(words: &str) -> String {
    let words = words.trim();
    let from = words.char_indices().rev().nth(LONGEST_WORDS - 1).map_or(0, |(index, _)| index);
    plain(&words[from..], LONGEST_WORDS)
}

/// The reason why the exchange has failed.
fn failed(error: tungstenite::Error) -> PolicyError {
    match error {
        tungstenite::Error::Io(error) if error.kind() == ErrorKind::TimedOut => PolicyError::Silent,
        tungstenite::Error::Io(error) => PolicyError::Broken(plain(&error.to_string(), LONGEST_WORDS)),
        tungstenite::Error::Capacity(_) => PolicyError::TooLong { most: LARGEST },
        tungstenite::Error::ConnectionClosed | tungstenite::Error::AlreadyClosed => PolicyError::Gone,
        tungstenite::Error::Protocol(
            tungstenite::error::ProtocolError::ResetWithoutClosingHandshake
            | tungstenite::error::ProtocolError::HandshakeIncomplete,
        ) => PolicyError::Gone,
        other => PolicyError::Broken(plain(&other.to_string(), LONGEST_WORDS)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_address_has_a_host_and_a_port() {
        for good in ["ws://127.0.0.1:8000", "ws://[::1]:80", "ws://gpu.lab:9/path"] {
            assert_eq!(good.parse::<PolicyUrl>().unwrap().to_string(), good);
        }
        for bad in ["127.0.0.1:8000", "http://h:1", "ws://h", "ws://:1", "ws://u:p@h:1", "", "ws://h:99999"] {
            assert_eq!(bad.parse::<PolicyUrl>(), Err(UrlError::Form), "{bad}");
        }
        assert_eq!("wss://h:1".parse::<PolicyUrl>(), Err(UrlError::Secure));
    }
}
