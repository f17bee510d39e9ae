//! The calls of an episode as bytes: every command to its last bit, in little space.
//!
//! A command is a row of numbers. Consecutive rows, one millisecond apart, vary smoothly, so each
//! number is predicted from those before it and only the residual is stored. The bit patterns are
//! treated as integers and extrapolated by differences of order zero to four; the order that
//! predicted best last time is used. The residual takes as few bytes as it needs. A constant number
//! costs one bit; repeated commands cost only their count.

use nalgebra::{Quaternion, Translation3, UnitQuaternion, Vector6};
use ramp_robot::{ArmCommand, Camera, Command, DOF, GripperCommand, ImageWidth, Impedance, Pose};

/// Most periods that one entry may stand for: longer than the longest episode.
const MOST_PERIODS: u64 = 4_000_000;
/// Numbers of the longest command: an impedance and the gripper.
const WIDEST: usize = 7 + 6 + 1 + 6 + DOF + 2;
/// One more than the highest order of differences.
const ORDERS: usize = 5;

// The first byte of an entry. Commands have the numbers 1 to 5.
const REPEAT: u8 = 6;
const READ_PARTS: u8 = 7;
const LOOK_WRIST: u8 = 8;
const LOOK_BIRDS_EYE: u8 = 9;
const STATE: u8 = 10;
const ANSWERED: u8 = 11;
const REFUSED: u8 = 12;
const EXPOSE: u8 = 13;
// Followed by the width of the image.
const LOOK_WRIST_SIZED: u8 = 14;
const LOOK_BIRDS_EYE_SIZED: u8 = 15;

/// One entry of an episode's record.
#[derive(Clone, Debug, PartialEq)]
pub enum Entry {
    /// This command for this number of periods.
    Step(Box<Command>, u64),
    /// The parts were read.
    ReadParts,
    /// An image was taken, of the camera's own width or of another one.
    Look(Camera, Option<ImageWidth>),
    /// The shutters of the cameras were opened.
    Expose,
    /// Not a call: the reading or image above was delivered, and its content has this hash.
    Answered(u64),
    /// Not a call: the reading, image or exposure above was refused.
    Refused,
    /// Not a call: the hash of the physics state at this point.
    State(u64),
}

/// Reasons why bytes cannot be decoded as calls.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum CallsError {
    /// The bytes end inside an entry.
    #[error("the calls end within entry {entry}")]
    Short {
        /// From 1.
        entry: u64,
    },
    /// The entry has an unknown kind.
    #[error("entry {entry} of the calls is of the unknown kind {kind}")]
    Kind {
        /// From 1.
        entry: u64,
        /// Its first byte.
        kind: u8,
    },
    /// It repeats a command before the first one, or more often than an episode has periods.
    #[error("entry {entry} of the calls repeats a command that is not there, or too often")]
    Repeat {
        /// From 1.
        entry: u64,
    },
    /// An image is asked for with a width that no image has.
    #[error("entry {entry} of the calls asks for an image that is {width} pixels wide")]
    Width {
        /// From 1.
        entry: u64,
        /// Pixels.
        width: u64,
    },
    /// A number has more bytes than a number can have.
    #[error("entry {entry} of the calls holds a number that is too long")]
    Number {
        /// From 1.
        entry: u64,
    },
}

/// The numbers of a command as bit patterns, and the kind of the command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Row {
    kind: u8,
    bits: [u64; WIDEST],
}

/// Number of values in a command of this kind, the gripper's included.
fn width(kind: u8) -> Option<usize> {
    match kind {
        1..=3 => Some(DOF + 2),
        4 => Some(7 + 2),
        5 => Some(WIDEST),
        _ => None,
    }
}

fn pose_numbers(x: &Pose) -> [f64; 7] {
    let (p, q) = (x.translation.vector, x.rotation.quaternion());
    [p.x, p.y, p.z, q.w, q.i, q.j, q.k]
}

fn pose_of(numbers: &[f64]) -> Pose {
    let n = |index: usize| numbers.get(index).copied().unwrap_or_default();
    let rotation = UnitQuaternion::new_unchecked(Quaternion::new(n(3), n(4), n(5), n(6)));
    Pose::from_parts(Translation3::new(n(0), n(1), n(2)), rotation)
}

impl Row {
    fn of(command: &Command) -> Row {
        let mut numbers = Vec::with_capacity(WIDEST);
        let kind = match &command.arm {
            ArmCommand::JointPositions(values) => {
                numbers.extend_from_slice(values);
                1
            }
            ArmCommand::JointVelocities(values) => {
                numbers.extend_from_slice(values);
                2
            }
            ArmCommand::JointTorques(values) => {
                numbers.extend_from_slice(values);
                3
            }
            ArmCommand::CartesianPose(x_wt) => {
                numbers.extend_from_slice(&pose_numbers(x_wt));
                4
            }
            ArmCommand::CartesianImpedance(it) => {
                numbers.extend_from_slice(&pose_numbers(&it.x_wt));
                numbers.extend_from_slice(it.stiffness.as_slice());
                numbers.push(it.damping_ratio);
                numbers.extend_from_slice(it.feed_forward.as_slice());
                numbers.extend_from_slice(&it.posture);
                5
            }
        };
        numbers.extend_from_slice(&[command.gripper.width, command.gripper.force]);
        let mut bits = [0; WIDEST];
        for (bits, number) in bits.iter_mut().zip(numbers) {
            *bits = number.to_bits();
        }
        Row { kind, bits }
    }

    fn command(&self) -> Command {
        let numbers = self.bits.map(f64::from_bits);
        let joints: [f64; DOF] = std::array::from_fn(|joint| numbers[joint]);
        let (arm, at) = match self.kind {
            1 => (ArmCommand::JointPositions(joints), DOF),
            2 => (ArmCommand::JointVelocities(joints), DOF),
            3 => (ArmCommand::JointTorques(joints), DOF),
            4 => (ArmCommand::CartesianPose(pose_of(&numbers)), 7),
            _ => {
                let impedance = Impedance {
                    x_wt: pose_of(&numbers),
                    stiffness: Vector6::from_column_slice(&numbers[7..13]),
                    damping_ratio: numbers[13],
                    feed_forward: Vector6::from_column_slice(&numbers[14..20]),
                    posture: std::array::from_fn(|joint| numbers[20 + joint]),
                };
                (ArmCommand::CartesianImpedance(impedance), WIDEST - 2)
            }
        };
        Command { arm, gripper: GripperCommand { width: numbers[at], force: numbers[at + 1] } }
    }
}

/// The recent values of one number, from which the next is predicted.
#[derive(Clone, Copy, Debug, Default)]
struct Curve {
    /// The last value and its differences up to the fourth.
    differences: [u64; ORDERS],
    /// The order that predicted the last value best.
    order: usize,
}

impl Curve {
    fn foretell(&self, order: usize) -> u64 {
        self.differences[..=order].iter().fold(0, |sum, it| sum.wrapping_add(*it))
    }

    fn push(&mut self, value: u64) {
        let miss = |order: &usize| (value.wrapping_sub(self.foretell(*order)) as i64).unsigned_abs();
        self.order = (0..ORDERS).min_by_key(miss).unwrap_or(0);
        let mut difference = value;
        for slot in &mut self.differences {
            (*slot, difference) = (difference, difference.wrapping_sub(*slot));
        }
    }
}

/// State shared by writer and reader after each command.
#[derive(Clone, Debug)]
struct Past {
    last: Option<Row>,
    /// For each kind of command and each of its numbers.
    curves: [[Curve; WIDEST]; 5],
}

impl Past {
    fn new() -> Past {
        Past { last: None, curves: [[Curve::default(); WIDEST]; 5] }
    }

    fn curves(&mut self, kind: u8) -> &mut [Curve; WIDEST] {
        &mut self.curves[usize::from(kind - 1)]
    }

    fn push(&mut self, row: Row, width: usize) {
        for (curve, bits) in self.curves(row.kind)[..width].iter_mut().zip(row.bits) {
            curve.push(bits);
        }
        self.last = Some(row);
    }
}

fn put_number(out: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        out.push(number as u8 | 0x80);
        number >>= 7;
    }
    out.push(number as u8);
}

/// Turns calls into bytes.
#[derive(Debug)]
pub struct Encoder {
    past: Past,
    /// Repetitions of the last command that are not written yet.
    repeats: u64,
    bytes: Vec<u8>,
}

impl Default for Encoder {
    fn default() -> Encoder {
        Encoder { past: Past::new(), repeats: 0, bytes: Vec::new() }
    }
}

impl Encoder {
    /// One period under a command.
    pub fn step(&mut self, command: &Command) {
        let row = Row::of(command);
        if self.past.last == Some(row) {
            self.repeats += 1;
            return;
        }
        self.end_repeats();
        let width = width(row.kind).unwrap_or(WIDEST);
        self.bytes.push(row.kind);
        let curves = *self.past.curves(row.kind);
        let changed = |index: usize| row.bits[index] != curves[index].differences[0];
        let mask = (0..width).filter(|index| changed(*index)).fold(0_u64, |mask, index| mask | 1 << index);
        put_number(&mut self.bytes, mask);
        for (curve, bits) in curves[..width].iter().zip(row.bits) {
            if bits != curve.differences[0] {
                let miss = bits.wrapping_sub(curve.foretell(curve.order)) as i64;
                // Small numbers of either sign become small numbers.
                put_number(&mut self.bytes, (miss << 1 ^ miss >> 63) as u64);
            }
        }
        self.past.push(row, width);
    }

    /// The parts were read.
    pub fn read_parts(&mut self) {
        self.end_repeats();
        self.bytes.push(READ_PARTS);
    }

    /// An image was taken.
    pub fn look(&mut self, camera: Camera, width: Option<ImageWidth>) {
        self.end_repeats();
        self.bytes.push(match (camera, width) {
            (Camera::Wrist, None) => LOOK_WRIST,
            (Camera::BirdsEye, None) => LOOK_BIRDS_EYE,
            (Camera::Wrist, Some(_)) => LOOK_WRIST_SIZED,
            (Camera::BirdsEye, Some(_)) => LOOK_BIRDS_EYE_SIZED,
        });
        if let Some(width) = width {
            put_number(&mut self.bytes, width.pixels() as u64);
        }
    }

    /// The shutters of the cameras were opened.
    pub fn expose(&mut self) {
        self.end_repeats();
        self.bytes.push(EXPOSE);
    }

    /// The last reading or image was delivered; `hash` is the hash of its content.
    pub fn answered(&mut self, hash: u64) {
        self.end_repeats();
        self.bytes.push(ANSWERED);
        self.bytes.extend_from_slice(&hash.to_le_bytes());
    }

    /// The last reading or image was refused.
    pub fn refused(&mut self) {
        self.end_repeats();
        self.bytes.push(REFUSED);
    }

    /// The physics state has this hash now.
    pub fn state(&mut self, hash: u64) {
        self.end_repeats();
        self.bytes.push(STATE);
        self.bytes.extend_from_slice(&hash.to_le_bytes());
    }

    fn end_repeats(&mut self) {
        if self.repeats > 0 {
            self.bytes.push(REPEAT);
            put_number(&mut self.bytes, std::mem::take(&mut self.repeats));
        }
    }

    /// Number of bytes that wait to be taken.
    pub fn waiting(&self) -> usize {
        self.bytes.len()
    }

    /// Takes the bytes since the last call. Those of an episode, concatenated, are its record.
    pub fn take(&mut self) -> Vec<u8> {
        self.end_repeats();
        std::mem::take(&mut self.bytes)
    }
}

/// Turns bytes back into calls. For any input it needs no more memory than the input.
#[derive(Clone, Debug)]
pub struct Decoder<'b> {
    bytes: &'b [u8],
    past: Past,
    entry: u64,
}

impl<'b> Decoder<'b> {
    /// From the bytes of a whole episode.
    pub fn new(bytes: &'b [u8]) -> Decoder<'b> {
        Decoder { bytes, past: Past::new(), entry: 0 }
    }

    fn byte(&mut self) -> Result<u8, CallsError> {
        let (first, rest) = self.bytes.split_first().ok_or(CallsError::Short { entry: self.entry })?;
        self.bytes = rest;
        Ok(*first)
    }

    fn hash(&mut self) -> Result<u64, CallsError> {
        let (hash, rest) =
            self.bytes.split_first_chunk::<8>().ok_or(CallsError::Short { entry: self.entry })?;
        self.bytes = rest;
        Ok(u64::from_le_bytes(*hash))
    }

    fn number(&mut self) -> Result<u64, CallsError> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            let part = u64::from(byte & 0x7f);
            if shift == 63 && part > 1 {
                break;
            }
            number |= part << shift;
            if byte < 0x80 {
                return Ok(number);
            }
        }
        Err(CallsError::Number { entry: self.entry })
    }

    fn width(&mut self) -> Result<ImageWidth, CallsError> {
        let width = self.number()?;
        ImageWidth::new(width).ok_or(CallsError::Width { entry: self.entry, width })
    }

    fn entry(&mut self) -> Result<Entry, CallsError> {
        let entry = self.entry;
        let kind = self.byte()?;
        match kind {
            READ_PARTS => Ok(Entry::ReadParts),
            LOOK_WRIST => Ok(Entry::Look(Camera::Wrist, None)),
            LOOK_BIRDS_EYE => Ok(Entry::Look(Camera::BirdsEye, None)),
            LOOK_WRIST_SIZED => Ok(Entry::Look(Camera::Wrist, Some(self.width()?))),
            LOOK_BIRDS_EYE_SIZED => Ok(Entry::Look(Camera::BirdsEye, Some(self.width()?))),
            EXPOSE => Ok(Entry::Expose),
            STATE => Ok(Entry::State(self.hash()?)),
            ANSWERED => Ok(Entry::Answered(self.hash()?)),
            REFUSED => Ok(Entry::Refused),
            REPEAT => {
                let count = self.number()?;
                match self.past.last {
                    Some(row) if (1..=MOST_PERIODS).contains(&count) => {
                        Ok(Entry::Step(Box::new(row.command()), count))
                    }
                    _ => Err(CallsError::Repeat { entry }),
                }
            }
            kind => {
                let width = width(kind).ok_or(CallsError::Kind { entry, kind })?;
                let mask = self.number()?;
                let curves = *self.past.curves(kind);
                let mut row = Row { kind, bits: [0; WIDEST] };
                for (index, curve) in curves[..width].iter().enumerate() {
                    row.bits[index] = if mask >> index & 1 == 1 {
                        let miss = self.number()?;
                        let miss = (miss >> 1) as i64 ^ -((miss & 1) as i64);
                        curve.foretell(curve.order).wrapping_add(miss as u64)
                    } else {
                        curve.differences[0]
                    };
                }
                self.past.push(row, width);
                Ok(Entry::Step(Box::new(row.command()), 1))
            }
        }
    }
}

impl Iterator for Decoder<'_> {
    type Item = Result<Entry, CallsError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.bytes.is_empty() {
            return None;
        }
        self.entry += 1;
        let entry = self.entry();
        if entry.is_err() {
            self.bytes = &[];
        }
        Some(entry)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn commands() -> Vec<Command> {
        let mut commands = Vec::new();
        for period in 0..3000 {
            let t = f64::from(period) * 1e-3;
            let gripper = GripperCommand { width: 0.04, force: 20.0 };
            let arm = match period {
                0..1000 => ArmCommand::JointPositions(std::array::from_fn(|joint| {
                    0.3 + (1.0 + joint as f64) * 0.1 * t * t * t * (10.0 - t * (15.0 - 6.0 * t))
                })),
                1000..2000 => ArmCommand::CartesianImpedance(Impedance {
                    x_wt: Pose::from_parts(
                        Translation3::new(0.3, -0.1, 0.2 - 0.02 * t),
                        UnitQuaternion::from_euler_angles(3.1, 0.0, 0.2 * t),
                    ),
                    stiffness: Vector6::repeat(800.0),
                    damping_ratio: 1.0,
                    feed_forward: Vector6::zeros(),
                    posture: [0.1; DOF],
                }),
                2000..2500 => ArmCommand::JointTorques([0.5; DOF]),
                _ => ArmCommand::JointVelocities([f64::NAN, -0.0, 1e300, 5e-324, t, f64::INFINITY, 1.0]),
            };
            commands.push(Command { arm, gripper });
        }
        commands
    }

    fn bits(command: &Command) -> Row {
        Row::of(command)
    }

    #[test]
    fn every_bit_of_every_command_comes_back_in_order() {
        let mut encoder = Encoder::default();
        let mut bytes = Vec::new();
        for (index, command) in commands().iter().enumerate() {
            encoder.step(command);
            if index % 700 == 0 {
                encoder.read_parts();
                encoder.refused();
                encoder.look(Camera::BirdsEye, ImageWidth::new(16 + index as u64 / 10));
                encoder.answered(index as u64);
                encoder.state(index as u64);
                bytes.extend(encoder.take());
            }
        }
        bytes.extend(encoder.take());
        let mut back = Vec::new();
        let mut others = 0;
        for entry in Decoder::new(&bytes) {
            match entry.unwrap() {
                Entry::Step(command, count) => back.extend((0..count).map(|_| bits(&command))),
                _ => others += 1,
            }
        }
        assert_eq!(others, 25);
        assert_eq!(back, commands().iter().map(bits).collect::<Vec<_>>());
        // 3000 commands of 72 or 232 bytes.
        assert!(bytes.len() < 60_000, "{} bytes", bytes.len());
    }

    #[test]
    fn bytes_that_are_no_calls_say_where() {
        let all = |bytes: &[u8]| Decoder::new(bytes).collect::<Result<Vec<_>, _>>();
        assert_eq!(all(&[7, 99]), Err(CallsError::Kind { entry: 2, kind: 99 }));
        assert_eq!(all(&[6, 1]), Err(CallsError::Repeat { entry: 1 }));
        assert_eq!(all(&[10, 1, 2]), Err(CallsError::Short { entry: 1 }));
        assert_eq!(
            all(&[6, 255, 255, 255, 255, 255, 255, 255, 255, 255, 2]),
            Err(CallsError::Number { entry: 1 })
        );
        assert_eq!(all(&[14, 224, 1]), Ok(vec![Entry::Look(Camera::Wrist, ImageWidth::new(224))]));
        assert_eq!(all(&[15, 8]), Err(CallsError::Width { entry: 1, width: 8 }));
        assert_eq!(all(&[15]), Err(CallsError::Short { entry: 1 }));
        let mut encoder = Encoder::default();
        encoder.step(&commands()[0]);
        let mut bytes = encoder.take();
        bytes.extend([6, 255, 255, 255, 127]);
        assert_eq!(all(&bytes), Err(CallsError::Repeat { entry: 2 }));
    }
}
