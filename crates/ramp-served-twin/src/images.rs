//! The thread that draws images and sends them, so that no cycle of the arm waits for either.

use std::net::TcpStream;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};

use ramp_franka::cell::{Answer, ImageHead};
use ramp_twin::{Drawing, Drawn, Renderers};

use crate::session::send;

/// An image to draw, and its way to the client.
pub(crate) struct Order {
    pub drawing: Drawing,
    pub client: TcpStream,
    /// The number of the arm's state at the middle of the exposure.
    pub message: u64,
}

/// The thread, which has one image at a time. It ends with this handle.
pub(crate) struct ImageThread {
    orders: Sender<Order>,
    sent: Receiver<Drawn>,
    busy: bool,
}

impl ImageThread {
    pub fn new() -> ImageThread {
        let (orders, to_draw) = channel::<Order>();
        let (done, sent) = channel();
        std::thread::spawn(move || {
            let mut renderers = Renderers::default();
            for Order { drawing, mut client, message } in to_draw {
                let drawn = drawing.draw(&mut renderers);
                send_image(&mut client, &drawn, message);
                if done.send(drawn).is_err() {
                    break;
                }
            }
        });
        ImageThread { orders, sent, busy: false }
    }

    /// Whether an image is being drawn or sent.
    pub fn is_busy(&self) -> bool {
        self.busy
    }

    /// Draws an image, and sends it. Only when it is not busy.
    pub fn begin(&mut self, order: Order) {
        self.busy = self.orders.send(order).is_ok();
    }

    /// The image that has been sent, once.
    pub fn sent(&mut self) -> Option<Drawn> {
        if !self.busy {
            return None;
        }
        let sent = self.sent.try_recv();
        self.busy = matches!(sent, Err(TryRecvError::Empty));
        sent.ok()
    }
}

fn send_image(client: &mut TcpStream, drawn: &Drawn, message: u64) {
    let image = drawn.image();
    let head = ImageHead {
        camera: image.camera,
        width: image.width,
        height: image.height,
        message,
        x_wt: (&image.x_wt).into(),
        depth: image.depth.is_some(),
    };
    send_answer(client, &Answer::Image(head), &image.pixels);
    send(client, &image.depth_bytes());
}

/// Sends an answer as a line, and these bytes after it.
pub(crate) fn send_answer(client: &mut TcpStream, answer: &Answer, bytes: &[u8]) {
    // Answers are plain numbers and words: they always become JSON.
    let Ok(mut line) = serde_json::to_vec(answer) else { return };
    line.push(b'\n');
    send(client, &line);
    send(client, bytes);
}
