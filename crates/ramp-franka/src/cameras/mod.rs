//! Cameras on this computer, for a station without a cell.
//!
//! Data passes one way: a [`FrameSource`] takes one frame after another in a thread of its own (`stream`). A
//! frame that the agent asks for is picked there by the time of its exposure; its `pixels` become red, green
//! and blue in the size that was asked for. Time and pose are those that the arm reported at that moment.

mod device;
mod pixels;
mod stream;

use ramp_robot::{Camera, CameraModel, Image, ImageWidth};

use crate::error::FrankaError;
use crate::periods::Periods;
use device::Device;
pub use device::{DeviceSettings, Format};
pub use pixels::Pixels;
use stream::Stream;
pub use stream::{Frame, FrameSource};

/// The cameras of a station.
pub struct LocalCameras {
    streams: [Stream; 2],
    models: [CameraModel; 2],
}

/// Number of a camera in arrays.
fn index(camera: Camera) -> usize {
    Camera::ALL.iter().position(|other| *other == camera).unwrap_or_default()
}

impl LocalCameras {
    /// Opens two devices, in the order of [`Camera::ALL`], with the calibrated models of their lenses and
    /// places.
    ///
    /// # Errors
    /// When one cannot be opened, or does not give images of the model's size in its format.
    pub fn open(
        devices: &[DeviceSettings; 2],
        models: [CameraModel; 2],
    ) -> Result<LocalCameras, FrankaError> {
        let open = |at: usize| -> Result<(String, Box<dyn FrameSource>), FrankaError> {
            let size = [models[at].width, models[at].height];
            let device = Device::open(&devices[at], size)?;
            Ok((devices[at].device.display().to_string(), Box::new(device)))
        };
        let sources = [open(0)?, open(1)?];
        Ok(LocalCameras::new(sources, models))
    }

    /// Takes frames from two sources with these names, in the order of [`Camera::ALL`].
    pub fn new(sources: [(String, Box<dyn FrameSource>); 2], models: [CameraModel; 2]) -> LocalCameras {
        LocalCameras { streams: sources.map(|(name, source)| Stream::new(name, source)), models }
    }

    /// The model of a camera.
    pub(crate) fn model(&self, camera: Camera) -> &CameraModel {
        &self.models[index(camera)]
    }

    /// Asks both cameras for an image of what they see next.
    pub(crate) fn expose(&mut self) {
        self.streams.iter_mut().for_each(Stream::request);
    }

    /// The oldest image of a camera that was asked for, or one that is exposed from now on.
    pub(crate) fn image(
        &mut self,
        camera: Camera,
        width: Option<ImageWidth>,
        periods: &Periods,
    ) -> Result<Image, FrankaError> {
        let stream = &mut self.streams[index(camera)];
        let frame = stream.frame()?;
        let own = &self.models[index(camera)];
        let size = width.map_or([own.width, own.height], |width| {
            let small = own.with_width(width);
            [small.width, small.height]
        });
        let pixels = frame.pixels.to_rgb([own.width, own.height], size);
        let pixels = pixels.map_err(|why| stream.wrong(&why))?;
        let [width, height] = size;
        let (time, x_wt) = periods
            .at(frame.exposed)
            .ok_or_else(|| stream.wrong("an image from before the arm's first state"))?;
        Ok(Image { camera, time, x_wt, width, height, pixels, depth: None })
    }
}
