//! Where the rotors stand and which way they turn.

use core::f64::consts::FRAC_1_SQRT_2;

use stormpetrel_control::math::{Body, Vec3};
use stormpetrel_control::options::Rows;
use stormpetrel_control::real::Real;
use stormpetrel_control::{choice, columns, record};

choice! {
    /// How the rotors are numbered, and where the arms point.
    pub enum Arms {
        /// 1 front ccw, 2 right cw, 3 rear ccw, 4 left cw.
        "article-plus" => ArticlePlus,
        /// 1 right ccw, 2 left ccw, 3 front cw, 4 rear cw.
        "px4-plus" => Px4Plus,
        /// 1 front right ccw, 2 rear left ccw, 3 front left cw, 4 rear right cw.
        "px4-x" => Px4X,
        /// Each rotor stands where `rotors` says.
        "free" => Free,
    }
}

columns! {
    /// Four rotors: place from their centre (m) and spin seen from above, 1 counter-clockwise, -1 clockwise.
    pub struct RotorPlaces, 0 => 4 rows {
        x [m] in -10.0 => 10.0;
        y [m] in -10.0 => 10.0;
        z [m] in -10.0 => 10.0;
        spin [1] in -1.0 => 1.0;
    }
}

record! {
    /// One rotor's place and spin.
    pub struct Mount {
        /// Place.
        place: Vec3<T, Body> [m];
        /// Spin seen from above, 1 counter-clockwise.
        spin: T [1];
    }
}

/// Where the rotors stand; equal in all lanes of a batch.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Layout {
    /// Named layout, or free.
    pub arms: Arms,
    /// Places and spins of a free one.
    pub rotors: Rows<RotorPlaces>,
}

/// Direction of each rotor from the centre (forward, left) and spin.
type Directions = [(f64, f64, f64); 4];

const ARTICLE_PLUS: Directions =
    [(1.0, 0.0, 1.0), (0.0, -1.0, -1.0), (-1.0, 0.0, 1.0), (0.0, 1.0, -1.0)];
const PX4_PLUS: Directions =
    [(0.0, -1.0, 1.0), (0.0, 1.0, 1.0), (1.0, 0.0, -1.0), (-1.0, 0.0, -1.0)];
const PX4_X: Directions = [
    (FRAC_1_SQRT_2, -FRAC_1_SQRT_2, 1.0),
    (-FRAC_1_SQRT_2, FRAC_1_SQRT_2, 1.0),
    (FRAC_1_SQRT_2, FRAC_1_SQRT_2, -1.0),
    (-FRAC_1_SQRT_2, -FRAC_1_SQRT_2, -1.0),
];

impl Layout {
    /// Place and spin of rotor `i` on arms of this length (m).
    pub fn mount<T: Real>(&self, i: usize, arm: T) -> Mount<T> {
        let along = |directions: &Directions| {
            let (x, y, spin) = directions[i % 4];
            let place = Vec3::new(arm * T::lit(x), arm * T::lit(y), T::zero());
            Mount { place, spin: T::lit(spin) }
        };
        match self.arms {
            Arms::ArticlePlus => along(&ARTICLE_PLUS),
            Arms::Px4Plus => along(&PX4_PLUS),
            Arms::Px4X => along(&PX4_X),
            Arms::Free => {
                let cell = |column| T::lit(self.rotors.cell(i, column));
                Mount { place: Vec3::new(cell(0), cell(1), cell(2)), spin: cell(3) }
            }
        }
    }
}
