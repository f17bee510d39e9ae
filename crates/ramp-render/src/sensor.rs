//! A sensor behind a lens: it blurs and scales the light and adds noise.

use ramp_robot::random::Stream;

/// Largest value of a linear channel.
pub(crate) const FULL: u16 = 4095;
/// Sensor noise in grey levels (1 σ) after gamma, which makes shot noise about the same in dark and bright
/// places.
const NOISE: f64 = 1.6;
/// Variation of the exposure from episode to episode, and from image to image (1 σ, share).
const GAIN_EPISODE: f64 = 0.08;
/// See [`GAIN_EPISODE`].
const GAIN_IMAGE: f64 = 0.01;
/// Values that are looked at together, whether they are all of one colour: 16 pixels.
const BLOCK: usize = 3 * 16;
/// Entries in the table of noise: a power of two.
const TABLE: usize = 1 << 17;
/// Steps of the output of the tone curve to a grey level.
const FINE: i16 = 64;

/// A sensor, with its own random numbers.
#[derive(Clone, Debug)]
pub struct Sensor {
    gain: f64,
    stream: Stream,
    noise: Vec<i16>,
    tone: Box<[i16; FULL as usize + 1]>,
    /// Whether `tone` stays as it is from image to image.
    steady: bool,
    row: Vec<i16>,
}

impl Sensor {
    /// The sensor of the camera called `name` in the episode of this seed.
    pub fn new(seed: u64, name: &str) -> Sensor {
        let mut stream = Stream::new(seed, &format!("sensor-{name}"));
        let noise = (0..TABLE).map(|_| (stream.normal(NOISE) * f64::from(FINE)).round() as i16).collect();
        let gain = (1.0 + stream.normal(GAIN_EPISODE)).clamp(0.7, 1.3);
        Sensor { gain, stream, noise, tone: Box::new([0; FULL as usize + 1]), steady: false, row: Vec::new() }
    }

    /// A sensor without noise and with nominal exposure.
    pub fn ideal() -> Sensor {
        Sensor {
            gain: 1.0,
            stream: Stream::new(0, "ideal"),
            noise: vec![0; TABLE],
            tone: Box::new([0; FULL as usize + 1]),
            steady: false,
            row: Vec::new(),
        }
    }

    /// The same, with one exposure for all images.
    pub fn steady() -> Sensor {
        let mut sensor = Sensor::ideal();
        sensor.begin();
        sensor.steady = true;
        sensor
    }

    /// With `gain` times as much light as was meant: 0 is a closed shutter.
    pub fn with_gain(mut self, gain: f64) -> Sensor {
        self.gain = gain;
        self
    }

    /// With `share` times as much light as it would have had.
    pub fn with_light(mut self, share: f64) -> Sensor {
        self.gain *= share;
        self
    }

    /// Prepares the next image.
    pub(crate) fn begin(&mut self) {
        if self.steady {
            return;
        }
        let gain = self.gain * (1.0 + self.stream.normal(GAIN_IMAGE));
        for (value, tone) in self.tone.iter_mut().enumerate() {
            let light = (value as f64 / f64::from(FULL) * gain).min(1.0);
            *tone = (light.powf(1.0 / 2.2) * 255.0 * f64::from(FINE)).round() as i16 + FINE / 2;
        }
    }

    /// Adds a row of pixels to an image from linear light: red, green and blue.
    pub(crate) fn expose(&mut self, light: &[u16], image: &mut Vec<u8>) {
        let room = self.noise.len().saturating_sub(light.len());
        let at = (self.stream.uniform() * room as f64) as usize;
        // First what cannot be done several at once, then what can.
        self.row.clear();
        let tone = |light: &u16| self.tone[usize::from(light & FULL)];
        for block in light.chunks(BLOCK) {
            if block[3..] == block[..block.len() - 3] {
                let colour = [0, 1, 2].map(|channel| tone(&block[channel]));
                self.row.extend([colour; BLOCK / 3].as_flattened().iter().take(block.len()));
            } else {
                self.row.extend(block.iter().map(tone));
            }
        }
        let grey =
            |(tone, noise): (&i16, &i16)| ((tone + noise) >> FINE.trailing_zeros()).clamp(0, 255) as u8;
        image.extend(self.row.iter().zip(&self.noise[at..]).map(grey));
    }
}
