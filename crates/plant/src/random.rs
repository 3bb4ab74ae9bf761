//! Random numbers from counters: what a block draws depends on its key and the tick, and on nothing
//! that was drawn before, by it or by another block.
//!
//!   mix: the finaliser of SplitMix64, variant 13                         (1)
//!   key(a, b) = mix(mix(a + g) ^ b),   g = 2^64/golden ratio             (2)
//!   u = (k >> 11) 2^-53 + 2^-54, in the open interval 0 to 1             (3)
//!   n1 = sqrt(-2 ln u1) cos(2 pi u2),  n2 = sqrt(-2 ln u1) sin(2 pi u2)  (4)
//!
//! Source: Steele, Lea and Flood, OOPSLA 2014; D. Stafford, "Better bit mixing" (2011); Box and Muller,
//! Annals of Mathematical Statistics 29 (1958).

use stormpetrel_control::real::Real;
use stormpetrel_control::record;

/// Mixes the bits of a word (1).
#[inline(always)]
const fn mix(mut z: u64) -> u64 {
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}

/// A key from a key and a number (2).
#[inline(always)]
pub const fn key(a: u64, b: u64) -> u64 {
    mix(mix(a.wrapping_add(0x9E37_79B9_7F4A_7C15)) ^ b)
}

/// A key from a key and a name.
pub fn named(a: u64, name: &str) -> u64 {
    name.bytes().fold(key(a, name.len() as u64), |state, byte| key(state, byte.into()))
}

/// A number between 0 and 1, never either (3).
#[inline(always)]
pub fn unit(key: u64) -> f64 {
    ((key >> 11) as f64 + 0.5) * (1.0 / 9_007_199_254_740_992.0)
}

record! {
    /// The random stream of one channel of one block of one flight.
    pub struct Stream {
        /// The key: a whole number below 2^52, so that a double holds it exactly.
        key: T [count];
    }
}

impl Stream<f64> {
    /// The stream of this name under a key.
    pub fn new(parent: u64, name: &str) -> Self {
        Self { key: (named(parent, name) >> 12) as f64 }
    }
}

impl<T: Real> Stream<T> {
    /// The `draw`-th number between 0 and 1 at `tick`; `draw` below 4096, `tick` a whole number below 2^40.
    #[inline(always)]
    pub fn unit(&self, tick: T, draw: u64) -> T {
        T::from_lanes(|i| {
            let (stream, tick) = (self.key.lane(i).to_f64(), tick.lane(i).to_f64());
            // The bits of a whole number below 2^40 end in zeros: there is room for the draw.
            T::Scalar::lit(unit(key(stream.to_bits(), tick.to_bits() | draw)))
        })
    }

    /// Two independent standard normal numbers (4); draws `2 pair` and `2 pair + 1`.
    #[inline(always)]
    pub fn normals(&self, tick: T, pair: u64) -> [T; 2] {
        let radius = (self.unit(tick, 2 * pair).ln() * T::lit(-2.0)).sqrt();
        let angle = self.unit(tick, 2 * pair + 1) * T::lit(core::f64::consts::TAU);
        let (sin, cos) = angle.sin_cos();
        [radius * cos, radius * sin]
    }
}
