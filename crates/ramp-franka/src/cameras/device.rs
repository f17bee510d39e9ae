//! A camera of this computer that Video4Linux knows: any USB camera (UVC), among others.

use std::io;
use std::path::PathBuf;
use std::time::{Duration, Instant};

#[cfg(target_os = "linux")]
use linuxvideo::format::{PixFormat, PixelFormat};
#[cfg(target_os = "linux")]
use linuxvideo::stream::ReadStream;

use super::pixels::Pixels;
use super::stream::{Frame, FrameSource};
use crate::error::FrankaError;

/// Time that a camera has for a frame before it counts as broken, and the length of a nap while it is waited
/// for.
const PATIENCE: Duration = Duration::from_secs(1);
const NAP: Duration = Duration::from_millis(1);

/// A camera of a station.
#[derive(Clone, Debug, PartialEq)]
pub struct DeviceSettings {
    /// The device, such as `/dev/video0`.
    pub device: PathBuf,
    /// The form of its frames.
    pub format: Format,
    /// Time from the middle of an exposure until its frame is here.
    pub latency: Duration,
}

/// The form of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// JPEG images.
    Mjpeg,
    /// Brightness of each pixel, colour of each second one.
    Yuyv,
}

/// An open camera.
pub(super) struct Device {
    #[cfg(target_os = "linux")]
    stream: ReadStream,
    format: Format,
    latency: Duration,
}

#[cfg(target_os = "linux")]
impl Device {
    /// Opens a camera for frames of this size: pixels in a row, and rows.
    pub fn open(settings: &DeviceSettings, [width, height]: [usize; 2]) -> Result<Device, FrankaError> {
        let DeviceSettings { device, format, latency } = settings;
        let failed = |why: String| FrankaError::Camera { name: device.display().to_string(), why };
        let opened = linuxvideo::Device::open(device).map_err(|error| failed(error.to_string()))?;
        let wanted = match format {
            Format::Mjpeg => PixelFormat::MJPG,
            Format::Yuyv => PixelFormat::YUYV,
        };
        let asked = PixFormat::new(width as u32, height as u32, wanted);
        let capture = opened.video_capture(asked).map_err(|error| failed(error.to_string()))?;
        // A driver may change what it was asked for.
        let got = capture.format();
        if (got.width() as usize, got.height() as usize, got.pixel_format()) != (width, height, wanted) {
            return Err(failed(format!(
                "it gives {} by {} pixels as {}, expected {width} by {height} as {wanted}",
                got.width(),
                got.height(),
                got.pixel_format()
            )));
        }
        let stream = capture.into_stream().map_err(|error| failed(error.to_string()))?;
        Ok(Device { stream, format: *format, latency: *latency })
    }
}

#[cfg(target_os = "linux")]
impl FrameSource for Device {
    fn next(&mut self) -> io::Result<Frame> {
        let begin = Instant::now();
        loop {
            while self.stream.will_block()? {
                if begin.elapsed() > PATIENCE {
                    return Err(io::Error::new(io::ErrorKind::TimedOut, "it gives no frames"));
                }
                std::thread::sleep(NAP);
            }
            let here = Instant::now();
            let bytes = self.stream.dequeue(|view| Ok((!view.is_error()).then(|| view.to_vec())))?;
            // A damaged frame is left out.
            let Some(bytes) = bytes else { continue };
            let pixels = match self.format {
                Format::Mjpeg => Pixels::Jpeg(bytes),
                Format::Yuyv => Pixels::Yuyv(bytes),
            };
            return Ok(Frame { exposed: here.checked_sub(self.latency).unwrap_or(here), pixels });
        }
    }
}

#[cfg(not(target_os = "linux"))]
impl Device {
    /// Only Linux has Video4Linux.
    pub fn open(settings: &DeviceSettings, _: [usize; 2]) -> Result<Device, FrankaError> {
        let why = "cameras are read by Video4Linux, which this system does not have".to_string();
        Err(FrankaError::Camera { name: settings.device.display().to_string(), why })
    }
}

#[cfg(not(target_os = "linux"))]
impl FrameSource for Device {
    fn next(&mut self) -> io::Result<Frame> {
        Err(io::ErrorKind::Unsupported.into())
    }
}
