//! The widest registers of the machine, chosen at run time.
//!
//! An ordinary build aims at every x86-64 processor; what runs under [`Width::run`] is compiled once
//! more for AVX2 and once more for AVX-512. The bits are the same in all three: no operation is
//! contracted or reordered. Several flights at once ([`Width::fly`]) are eight lanes in these, and pairs in
//! the registers of the smallest width, see [`crate::pair`].
//!
//! Large blocks that a plain flight does not need, such as the whole world, are functions of their own
//! with a boundary of their own ([`wide`]): inlined everywhere they would take minutes to compile.

#[cfg(feature = "std")]
use stormpetrel_control::lanes::Lanes;
use stormpetrel_control::real::Real;

#[cfg(all(feature = "std", target_arch = "x86_64"))]
use crate::pair::Pair;

/// Vehicles side by side in one scalar where registers are wide.
pub const LANES: usize = 8;

/// Work to be compiled for each width.
///
/// `run` must be `#[inline(always)]`, and so must all that it calls: a function of its own would be
/// compiled for the smallest width. Copy what the loop works on into locals first, so that the
/// compiler sees that nothing overlaps.
pub trait Work {
    /// What comes out.
    type Output;
    /// Does the work.
    fn run(self) -> Self::Output;
}

/// Does the work of a block of its own: on the widest registers where `T` has several parts, as it is where it
/// is one number or one register.
#[inline(always)]
pub fn wide<T: Real, W: Work>(work: W) -> W::Output {
    #[cfg(feature = "std")]
    if T::PARTS > 1 {
        return Width::widest().run(work);
    }
    work.run()
}

/// Does rare work out of the way. Inlined, the compiler would do it ahead of its condition at every tick,
/// for every kind of block and from whatever numbers stand in its place.
#[cold]
#[inline(never)]
pub fn rarely<R>(work: impl FnOnce() -> R) -> R {
    work()
}

/// Registers that work can be done in.
#[cfg(feature = "std")]
pub trait Registers: Copy {
    /// Does the work in these registers.
    fn run<W: Work>(self, work: W) -> W::Output;
}

/// The registers that the build aims at.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug)]
pub struct Ordinary;

#[cfg(feature = "std")]
impl Registers for Ordinary {
    // A function of its own, as the other widths are.
    #[inline(never)]
    fn run<W: Work>(self, work: W) -> W::Output {
        work.run()
    }
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl Registers for pulp::x86::V3 {
    #[inline(always)]
    fn run<W: Work>(self, work: W) -> W::Output {
        self.vectorize(Inlined(work))
    }
}

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl Registers for pulp::x86::V4 {
    #[inline(always)]
    fn run<W: Work>(self, work: W) -> W::Output {
        self.vectorize(Inlined(work))
    }
}

/// Several flights, to be flown in whatever scalar fills the registers.
#[cfg(feature = "std")]
pub trait Fleet {
    /// What comes out.
    type Output;
    /// Flies them in `N` groups of `T::LANES` whose ticks take turns: what one group waits for, the next need
    /// not. What each tick does runs on these registers.
    fn fly<T: Real<Scalar = f64>, const N: usize>(self, registers: impl Registers) -> Self::Output;
}

/// How wide the registers are that a loop over lanes may use.
#[cfg(feature = "std")]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Width {
    /// What every machine of the target has: two doubles on x86-64 (SSE2).
    Baseline,
    /// Four doubles.
    Avx2,
    /// Eight doubles.
    Avx512,
}

#[cfg(feature = "std")]
impl Width {
    /// What this machine can do, widest first.
    pub fn available() -> impl Iterator<Item = Self> {
        [Self::Avx512, Self::Avx2, Self::Baseline].into_iter().filter(|width| width.supported())
    }

    /// The widest that this machine can do.
    pub fn widest() -> Self {
        Self::available().next().unwrap_or(Self::Baseline)
    }

    /// As the command line and reports name it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Baseline => "baseline",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
        }
    }

    #[cfg(target_arch = "x86_64")]
    fn supported(self) -> bool {
        match self {
            Self::Baseline => true,
            Self::Avx2 => pulp::x86::V3::try_new().is_some(),
            Self::Avx512 => pulp::x86::V4::try_new().is_some(),
        }
    }

    #[cfg(not(target_arch = "x86_64"))]
    fn supported(self) -> bool {
        self == Self::Baseline
    }

    /// Flies at this width; at the baseline where the machine is narrower.
    #[cfg(target_arch = "x86_64")]
    pub fn fly<F: Fleet>(self, fleet: F) -> F::Output {
        match self {
            Self::Avx512 => {
                if let Some(registers) = pulp::x86::V4::try_new() {
                    return fleet.fly::<Lanes<f64, LANES>, 1>(registers);
                }
            }
            Self::Avx2 => {
                if let Some(registers) = pulp::x86::V3::try_new() {
                    return fleet.fly::<Lanes<f64, LANES>, 1>(registers);
                }
            }
            Self::Baseline => {}
        }
        fleet.fly::<Pair, 2>(Ordinary)
    }

    /// Flies; every width is the baseline on this target.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn fly<F: Fleet>(self, fleet: F) -> F::Output {
        fleet.fly::<Lanes<f64, LANES>, 1>(Ordinary)
    }

    /// Does the work at this width; at the baseline where the machine is narrower.
    #[cfg(target_arch = "x86_64")]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        match self {
            Self::Avx512 => {
                if let Some(wide) = pulp::x86::V4::try_new() {
                    return wide.vectorize(Inlined(work));
                }
            }
            Self::Avx2 => {
                if let Some(wide) = pulp::x86::V3::try_new() {
                    return wide.vectorize(Inlined(work));
                }
            }
            Self::Baseline => {}
        }
        work.run()
    }

    /// Does the work; every width is the baseline on this target.
    #[cfg(not(target_arch = "x86_64"))]
    pub fn run<W: Work>(self, work: W) -> W::Output {
        work.run()
    }
}

/// [`Work`] in the form in which `pulp` inlines it.
#[cfg(all(feature = "std", target_arch = "x86_64"))]
struct Inlined<W>(W);

#[cfg(all(feature = "std", target_arch = "x86_64"))]
impl<W: Work> pulp::NullaryFnOnce for Inlined<W> {
    type Output = W::Output;
    #[inline(always)]
    fn call(self) -> W::Output {
        self.0.run()
    }
}
