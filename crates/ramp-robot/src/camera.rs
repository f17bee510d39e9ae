//! Cameras: images, and the lens models given to an agent.
//!
//! An optical frame C: origin in the centre of the lens, z along the viewing direction, x to the
//! right and y downwards in the image. Pixel coordinates start at the outer corner of the first
//! pixel: its middle is at (0.5, 0.5).

use nalgebra::{Matrix3, Point3, Translation3, UnitQuaternion, Vector3};

use crate::pose::Pose;

/// Width and height of a full image, pixels.
const NOMINAL_SIZE: [usize; 2] = [1280, 800];

/// A camera of the robot's cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Camera {
    /// On the hand; moves with the tip.
    Wrist,
    /// High over the table, looking down.
    BirdsEye,
}

impl Camera {
    /// Both cameras.
    pub const ALL: [Camera; 2] = [Camera::Wrist, Camera::BirdsEye];

    /// The name on the command line, in files and in messages.
    pub fn name(self) -> &'static str {
        match self {
            Camera::Wrist => "wrist",
            Camera::BirdsEye => "birds-eye",
        }
    }

    /// Distance between the two lenses of its depth sensor, m: those of common sensors for its distances, the
    /// RealSense D405 on the hand and the D435 above (datasheet of the D400 series).
    pub fn baseline(self) -> f64 {
        match self {
            Camera::Wrist => 0.018,
            Camera::BirdsEye => 0.050,
        }
    }
}

/// The distance for which 1 stands in [`Image::depth`], m.
pub const DEPTH_UNIT: f64 = 1.0e-4;

/// Pixels in a row of an image that is smaller than the camera's own.
///
/// ```
/// use ramp_robot::camera::ImageWidth;
/// assert_eq!(ImageWidth::new(224).map(ImageWidth::pixels), Some(224));
/// assert_eq!(ImageWidth::new(8), None);
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct ImageWidth(u16);

impl ImageWidth {
    /// The smallest.
    pub const LEAST: u64 = 16;
    /// The largest: the camera's own.
    pub const MOST: u64 = NOMINAL_SIZE[0] as u64;

    /// A width from [`ImageWidth::LEAST`] to [`ImageWidth::MOST`], or `None`.
    pub fn new(pixels: u64) -> Option<ImageWidth> {
        let fits = (ImageWidth::LEAST..=ImageWidth::MOST).contains(&pixels);
        u16::try_from(pixels).ok().filter(|_| fits).map(ImageWidth)
    }

    /// The camera's own.
    pub fn full() -> ImageWidth {
        ImageWidth(ImageWidth::MOST as u16)
    }

    /// Pixels in a row.
    pub fn pixels(self) -> usize {
        usize::from(self.0)
    }
}

/// An image, as it came out of a camera.
#[derive(Clone, Debug, PartialEq)]
pub struct Image {
    /// Which camera took it.
    pub camera: Camera,
    /// Robot time in the middle of the exposure, s.
    pub time: f64,
    /// Measured pose of the tip in the world at that moment.
    pub x_wt: Pose,
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Red, green and blue of each pixel, row by row from the top left, gamma 2.2.
    pub pixels: Vec<u8>,
    /// On the track `depth`: the measured distance along the optical axis in each pixel, in [`DEPTH_UNIT`], 0
    /// where there is none.
    pub depth: Option<Vec<u16>>,
}

impl Image {
    /// Its depths as bytes: two of each pixel, the lower one first. Empty without depth.
    pub fn depth_bytes(&self) -> Vec<u8> {
        let depth = self.depth.as_deref().unwrap_or_default();
        let mut bytes = vec![0; 2 * depth.len()];
        bytes.as_chunks_mut().0.iter_mut().zip(depth).for_each(|(pair, depth)| *pair = depth.to_le_bytes());
        bytes
    }
}

/// The body to which a camera is fixed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Mount {
    /// To the hand: pose of C in the tip frame T.
    Tip(Pose),
    /// To the room: pose of C in the world W.
    World(Pose),
}

/// A pinhole camera with lens distortion by Brown's model.
#[derive(Clone, Debug, PartialEq)]
pub struct CameraModel {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// Focal lengths along x and y, pixels.
    pub focal: [f64; 2],
    /// Principal point, pixels.
    pub centre: [f64; 2],
    /// Radial and tangential coefficients in the usual order: k1, k2, p1, p2, k3.
    pub distortion: [f64; 5],
    /// Mounting and pose.
    pub mount: Mount,
}

/// An optical frame that looks along `forward` with `up` upwards in the image, both unit vectors at
/// right angles.
fn looking(position: Vector3<f64>, forward: Vector3<f64>, up: Vector3<f64>) -> Pose {
    let right = forward.cross(&up);
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[right, -up, forward]));
    Pose::from_parts(Translation3::from(position), UnitQuaternion::from_rotation_matrix(&rotation))
}

impl CameraModel {
    /// The nominal camera model of the benchmark, as given to an agent; `tip` is the distance from
    /// the hand's frame to the tip's along z, m. Poses and fields of view are those of the
    /// published simulation; the distortion is typical of a lens with this field of view.
    pub fn nominal(camera: Camera, tip: f64) -> CameraModel {
        let [width, height] = NOMINAL_SIZE;
        // Half of the horizontal field of view, the coefficients, and the mounting.
        let (half, distortion, mount) = match camera {
            // (50, 0, 50) mm in the hand's frame, looking along the hand's z, up towards the hand's
            // x.
            Camera::Wrist => (
                43.65_f64,
                [-0.055, 0.018, 3.0e-4, -2.0e-4, -0.002],
                Mount::Tip(looking(Vector3::new(0.05, 0.0, 0.05 - tip), Vector3::z(), Vector3::x())),
            ),
            Camera::BirdsEye => (
                23.6,
                [-0.08, 0.05, -2.0e-4, 3.0e-4, 0.0],
                Mount::World(looking(Vector3::new(0.6, 0.0, 2.5), -Vector3::z(), Vector3::y())),
            ),
        };
        let focal = width as f64 / 2.0 / half.to_radians().tan();
        CameraModel {
            width,
            height,
            focal: [focal; 2],
            centre: [width as f64 / 2.0, height as f64 / 2.0],
            distortion,
            mount,
        }
    }

    /// The same lens with another number of pixels: the same field of view, `width` pixels in a row, and as
    /// many rows as the ratio of the sides gives, rounded.
    ///
    /// ```
    /// use ramp_robot::camera::{Camera, CameraModel, ImageWidth};
    /// let small = CameraModel::nominal(Camera::Wrist, 0.1134).with_width(ImageWidth::new(224).unwrap());
    /// assert_eq!((small.width, small.height), (224, 140));
    /// ```
    #[must_use]
    pub fn with_width(&self, width: ImageWidth) -> CameraModel {
        let width = width.pixels();
        let scale = width as f64 / self.width as f64;
        let rows = self.height as f64 * scale;
        let height = (rows.round() as usize).max(1);
        CameraModel {
            width,
            height,
            focal: self.focal.map(|focal| focal * scale),
            // Rows that rounding adds or drops are shared by both sides.
            centre: [self.centre[0] * scale, self.centre[1] * scale + 0.5 * (height as f64 - rows)],
            ..self.clone()
        }
    }

    /// Pose of the optical frame in the world while the tip is at `x_wt`.
    pub fn x_wc(&self, x_wt: &Pose) -> Pose {
        match self.mount {
            Mount::Tip(x_tc) => x_wt * x_tc,
            Mount::World(x_wc) => x_wc,
        }
    }

    /// The distorted direction of a direction (x/z, y/z) of the optical frame.
    pub fn distort(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let [k1, k2, p1, p2, k3] = self.distortion;
        let r2 = x * x + y * y;
        let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
        [
            x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
            y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
        ]
    }

    /// The pixel in which a point of the optical frame (m) appears; `None` behind the camera. It
    /// may lie outside the image.
    pub fn project(&self, p_c: &Point3<f64>) -> Option<[f64; 2]> {
        if p_c.z <= 1e-6 {
            return None;
        }
        let [x, y] = self.distort([p_c.x / p_c.z, p_c.y / p_c.z]);
        Some([self.focal[0] * x + self.centre[0], self.focal[1] * y + self.centre[1]])
    }

    /// The direction (x/z, y/z) of the optical frame that appears at a pixel: the inverse of
    /// [`CameraModel::project`], by Newton's method, to better than a millionth of a pixel within
    /// the image.
    ///
    /// ```
    /// use ramp_robot::camera::{Camera, CameraModel};
    /// let camera = CameraModel::nominal(Camera::Wrist, 0.1134);
    /// let [x, y] = camera.direction([3.0, 790.0]);
    /// let pixel = camera.project(&nalgebra::Point3::new(0.2 * x, 0.2 * y, 0.2)).unwrap();
    /// assert!((pixel[0] - 3.0).abs() < 1e-6 && (pixel[1] - 790.0).abs() < 1e-6);
    /// ```
    pub fn direction(&self, pixel: [f64; 2]) -> [f64; 2] {
        let wanted: [f64; 2] =
            std::array::from_fn(|axis| (pixel[axis] - self.centre[axis]) / self.focal[axis]);
        let [k1, k2, p1, p2, k3] = self.distortion;
        let [mut x, mut y] = wanted;
        for _ in 0..20 {
            let at = self.distort([x, y]);
            let (ex, ey) = (at[0] - wanted[0], at[1] - wanted[1]);
            if ex.abs().max(ey.abs()) < 1e-12 {
                break;
            }
            let r2 = x * x + y * y;
            let radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
            // Derivative of `radial` by r², times two.
            let slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * 3.0 * k3));
            let xx = radial + slope * x * x + 2.0 * p1 * y + 6.0 * p2 * x;
            let xy = slope * x * y + 2.0 * p1 * x + 2.0 * p2 * y;
            let yy = radial + slope * y * y + 6.0 * p1 * y + 2.0 * p2 * x;
            let determinant = xx * yy - xy * xy;
            if determinant.abs() < 1e-9 {
                break;
            }
            x -= (yy * ex - xy * ey) / determinant;
            y -= (xx * ey - xy * ex) / determinant;
        }
        [x, y]
    }
}
