//! The cell around the arm: readings of parts and images, for the same client, over a connection of its own.
//! Franka's protocol has neither.

use std::io::{ErrorKind, Read};
use std::net::{TcpListener, TcpStream};

use ramp_franka::cell::{Answer, Question};
use ramp_robot::{Camera, ImageWidth, PERIOD, Robot};

use crate::images::{ImageThread, Order, send_answer};
use crate::plant::Plant;

/// The longest question, bytes.
const LONGEST: usize = 4096;

/// An image that a client waits for.
struct Due {
    camera: Camera,
    width: Option<ImageWidth>,
    /// Periods until it is there.
    periods: u64,
}

/// The connection of the cell, for one client.
pub(crate) struct Cell {
    client: Option<TcpStream>,
    inbox: Vec<u8>,
    /// The image that is due.
    due: Option<Due>,
    images: ImageThread,
}

impl Cell {
    /// Before any client.
    pub fn new() -> Cell {
        Cell { client: None, inbox: Vec::new(), due: None, images: ImageThread::new() }
    }

    /// Takes a client that waits. A second one is refused.
    pub fn accept(&mut self, listener: &TcpListener) {
        let Ok((stream, _)) = listener.accept() else { return };
        if self.client.is_none() && stream.set_nonblocking(true).and(stream.set_nodelay(true)).is_ok() {
            self.client = Some(stream);
            self.inbox.clear();
        }
    }

    /// Answers what the client asks, unless an image is under way; `message` is the number of the arm's last
    /// state.
    pub fn listen(&mut self, plant: &mut Plant, message: u64) {
        self.deliver(plant, message);
        if self.images.is_busy() {
            return;
        }
        let Some(stream) = &mut self.client else { return };
        let mut buffer = [0; 512];
        loop {
            match stream.read(&mut buffer) {
                Ok(0) => {
                    self.client = None;
                    self.due = None;
                    return;
                }
                Ok(count) => self.inbox.extend_from_slice(&buffer[..count]),
                Err(error) if error.kind() == ErrorKind::WouldBlock => break,
                Err(_) => {
                    self.client = None;
                    return;
                }
            }
            if self.inbox.len() > LONGEST {
                self.client = None;
                return;
            }
        }
        while let Some(end) = self.inbox.iter().position(|byte| *byte == b'\n') {
            let line: Vec<u8> = self.inbox.drain(..=end).collect();
            let answer = match serde_json::from_slice(&line) {
                Ok(question) => self.answer(plant, &question),
                Err(error) => Answer::Refused { why: error.to_string() },
            };
            self.say(&answer);
            self.deliver(plant, message);
            if self.images.is_busy() {
                return;
            }
        }
    }

    fn answer(&mut self, plant: &mut Plant, question: &Question) -> Answer {
        let refused = |error: ramp_robot::RobotError| Answer::Refused { why: error.to_string() };
        match question {
            Question::Parts => plant.twin.read_parts().map_or_else(refused, |parts| Answer::Parts {
                parts: parts.iter().map(Into::into).collect(),
            }),
            Question::Expose => plant.twin.expose().map_or_else(refused, |()| Answer::Done),
            Question::Touch => match plant.twin.observe().touch {
                Some(touch) => Answer::Touch { fingers: touch.fingers.each_ref().map(Into::into) },
                None => Answer::Refused { why: "the fingers have no tactile sensors".to_string() },
            },
            Question::Image { camera, width } => self.begin_image(plant, *camera, *width),
        }
    }

    fn begin_image(&mut self, plant: &mut Plant, camera: Camera, pixels: Option<u64>) -> Answer {
        let width = pixels.and_then(ImageWidth::new);
        if pixels.is_some() && width.is_none() {
            let (least, most) = (ImageWidth::LEAST, ImageWidth::MOST);
            return Answer::Refused { why: format!("`width`: expected {least} to {most} pixels") };
        }
        match plant.twin.begin_image(camera) {
            Ok(periods) => {
                self.due = Some(Due { camera, width, periods });
                Answer::Wait { periods }
            }
            Err(error) => Answer::Refused { why: error.to_string() },
        }
    }

    /// A period has passed.
    pub fn passed(&mut self) {
        if let Some(due) = &mut self.due {
            due.periods = due.periods.saturating_sub(1);
        }
    }

    /// Begins to draw the image that is due now, and takes back the sensor of one that was sent.
    pub fn deliver(&mut self, plant: &mut Plant, message: u64) {
        if let Some(drawn) = self.images.sent() {
            plant.twin.drawn(drawn);
        }
        let Some(Due { camera, width, periods: 0 }) = self.due else { return };
        self.due = None;
        let Some(client) = self.client.as_ref().and_then(|client| client.try_clone().ok()) else { return };
        match plant.twin.due_image(camera, width) {
            Ok(drawing) => {
                // Images are stamped on the arm's clock, which is the number of its state.
                let age = (plant.twin.time() - drawing.time()) / PERIOD;
                let message = message.saturating_sub(age.round() as u64);
                self.images.begin(Order { drawing, client, message });
            }
            Err(error) => self.say(&Answer::Refused { why: error.to_string() }),
        }
    }

    fn say(&mut self, answer: &Answer) {
        if let Some(client) = &mut self.client {
            send_answer(client, answer, &[]);
        }
    }
}
