//! A TCP connection of a client: whole messages out of a stream, and answers into it. Nothing blocks.

use std::io::{ErrorKind, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream};
use std::time::{Duration, Instant};

use franka::wire::HeaderLayout;

/// The longest message that is taken from a client, bytes: far more than any request has.
const LONGEST: usize = 65536;
/// Time that a client has to read an answer. Chosen: an image takes some milliseconds.
const PATIENCE: Duration = Duration::from_secs(1);
/// Time between two tries to send more to a client that reads slowly.
const NAP: Duration = Duration::from_micros(50);

/// A connected client.
pub(crate) struct Session {
    stream: TcpStream,
    layout: HeaderLayout,
    inbox: Vec<u8>,
    /// The address to which states go; `None` until the client has connected by the protocol.
    pub states: Option<SocketAddr>,
}

/// A message of a client.
pub(crate) enum Message {
    Request(Request),
    Nothing,
    /// The connection is closed, or what came is no message.
    Closed,
}

/// One request.
pub(crate) struct Request {
    pub command: u32,
    pub id: u32,
    pub payload: Vec<u8>,
}

impl Session {
    /// The next client that waits at `listener`, if there is one.
    pub fn accept(listener: &TcpListener, layout: HeaderLayout) -> Option<Session> {
        let (stream, _) = listener.accept().ok()?;
        stream.set_nonblocking(true).ok()?;
        stream.set_nodelay(true).ok()?;
        Some(Session { stream, layout, inbox: Vec::new(), states: None })
    }

    /// Sends states to this port of the client from now on.
    pub fn send_states_to(&mut self, port: u16) {
        self.states = self.stream.peer_addr().ok().map(|peer| SocketAddr::new(peer.ip(), port));
    }

    /// The next message.
    pub fn next(&mut self) -> Message {
        let mut buffer = [0; 2048];
        loop {
            match self.stream.read(&mut buffer) {
                Ok(0) => return Message::Closed,
                Ok(count) => self.inbox.extend_from_slice(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => return Message::Closed,
            }
            if self.inbox.len() > LONGEST {
                break;
            }
        }
        let head = self.layout.header_len();
        let Some((command, id, size)) = self.layout.decode_header(&self.inbox) else {
            return Message::Nothing;
        };
        let size = size as usize;
        if !(head..=LONGEST).contains(&size) {
            return Message::Closed;
        }
        if self.inbox.len() < size {
            return Message::Nothing;
        }
        let payload = self.inbox[head..size].to_vec();
        self.inbox.drain(..size);
        Message::Request(Request { command, id, payload })
    }

    /// Answers a request.
    pub fn answer(&mut self, command: u32, id: u32, payload: &[u8]) {
        let mut message = self.layout.encode_header(command, id, payload.len());
        message.extend_from_slice(payload);
        send(&mut self.stream, &message);
    }
}

/// Sends all bytes, unless the client does not read them for too long. A client that has gone is noticed when
/// it is read from.
pub(crate) fn send(stream: &mut TcpStream, bytes: &[u8]) {
    let begin = Instant::now();
    let mut rest = bytes;
    while !rest.is_empty() && begin.elapsed() < PATIENCE {
        match stream.write(rest) {
            Ok(count) => rest = &rest[count..],
            Err(error) if error.kind() == ErrorKind::WouldBlock => std::thread::sleep(NAP),
            Err(_) => return,
        }
    }
}
