//! The client of a served twin's cell.

use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;

use ramp_robot::Touch;

use crate::cell::{Answer, ImageHead, Question};
use crate::error::FrankaError;

/// The longest line of an answer, bytes, and the largest image.
const LONGEST: u64 = 1 << 20;
const LARGEST: usize = 1 << 26;

/// A connected cell.
pub(crate) struct Cell {
    address: String,
    stream: BufReader<TcpStream>,
    /// The answer about the fingers is on its way.
    feels: bool,
}

impl Cell {
    pub fn connect(address: &str) -> Result<Cell, FrankaError> {
        let failed = |error| FrankaError::Cell { address: address.to_string(), error };
        let stream = TcpStream::connect(address).map_err(failed)?;
        stream.set_nodelay(true).map_err(failed)?;
        Ok(Cell { address: address.to_string(), stream: BufReader::new(stream), feels: false })
    }

    /// Asks, and waits for the answer.
    pub fn ask(&mut self, question: &Question) -> Result<Answer, FrankaError> {
        self.touch_asked()?;
        self.send(question)?;
        self.answer()
    }

    /// Asks what the fingers feel, without waiting: [`Cell::touch_asked`] has the answer.
    pub fn ask_touch(&mut self) -> Result<(), FrankaError> {
        self.feels = true;
        self.send(&Question::Touch)
    }

    /// The reading that was last asked for; `None` without a question, or without sensors.
    pub fn touch_asked(&mut self) -> Result<Option<Touch>, FrankaError> {
        if !std::mem::take(&mut self.feels) {
            return Ok(None);
        }
        match self.answer()? {
            Answer::Touch { fingers } => Ok(Some(Touch { fingers: fingers.map(Into::into) })),
            Answer::Refused { .. } => Ok(None),
            other => Err(self.unexpected(&other)),
        }
    }

    fn send(&mut self, question: &Question) -> Result<(), FrankaError> {
        let mut line = serde_json::to_vec(question).map_err(|error| self.wrong(&error.to_string()))?;
        line.push(b'\n');
        self.stream.get_mut().write_all(&line).map_err(|error| self.failed(error))
    }

    /// The next answer.
    pub fn answer(&mut self) -> Result<Answer, FrankaError> {
        let mut line = String::new();
        let read = (&mut self.stream).take(LONGEST).read_line(&mut line);
        read.map_err(|error| self.failed(error))?;
        serde_json::from_str(&line).map_err(|error| self.wrong(&error.to_string()))
    }

    /// The pixels of an image whose head has come.
    pub fn pixels(&mut self, head: &ImageHead) -> Result<Vec<u8>, FrankaError> {
        let count = head.width.saturating_mul(head.height).saturating_mul(3);
        if count > LARGEST {
            return Err(self.wrong(&format!("an image of {} by {}", head.width, head.height)));
        }
        let mut pixels = vec![0; count];
        self.stream.read_exact(&mut pixels).map_err(|error| self.failed(error))?;
        Ok(pixels)
    }

    /// The depths of an image, after its pixels.
    ///
    /// # Errors
    /// When there are fewer.
    pub fn depth(&mut self, head: &ImageHead) -> Result<Vec<u16>, FrankaError> {
        // As many pixels have been read, so the number is no larger than an image may be.
        let mut bytes = vec![0; 2 * head.width * head.height];
        self.stream.read_exact(&mut bytes).map_err(|error| self.failed(error))?;
        Ok(bytes.as_chunks().0.iter().map(|pair| u16::from_le_bytes(*pair)).collect())
    }

    /// Something in an answer is wrong.
    pub fn wrong(&self, why: &str) -> FrankaError {
        FrankaError::CellAnswer { address: self.address.clone(), why: why.to_string() }
    }

    /// An answer to another question, or a refusal.
    pub fn unexpected(&self, answer: &Answer) -> FrankaError {
        match answer {
            Answer::Refused { why } => self.wrong(why),
            other => self.wrong(&format!("an unexpected answer: {other:?}")),
        }
    }

    fn failed(&self, error: std::io::Error) -> FrankaError {
        FrankaError::Cell { address: self.address.clone(), error }
    }
}
