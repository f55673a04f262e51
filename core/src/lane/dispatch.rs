//! Which lanes the machine has, and kernels compiled for each of them.

#[cfg(target_arch = "aarch64")]
use super::neon::Neon;
use super::number::Lane;
use super::portable::Pair;
#[cfg(target_arch = "x86_64")]
use super::x86::{Avx2, Avx512};
use crate::channels::Channels;
use std::ops::Range;

/// Angles up to here, rad, are in reach of [`Lane::sin_cos`] in lanes.
const LARGEST_ANGLE: f64 = 1e6;

/// A computation that is written once for all lanes. Whatever it calls must be inlined into it, or is compiled for the
/// oldest machines.
pub trait Kernel {
    /// What comes out.
    type Output;

    /// Does it in lanes of one kind.
    fn run<L: Lane>(self) -> Self::Output;
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    Scalar,
    Pair,
    #[cfg(target_arch = "aarch64")]
    Neon,
    #[cfg(target_arch = "x86_64")]
    Avx2,
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// Lanes that this machine has: a value of this type says that the processor was asked.
///
/// ```
/// # extern crate tauscope_core as tauscope;
/// use tauscope::channels::Channels;
/// use tauscope::dynamics::{Chain, Lanes, Motion, inverse_dynamics_in};
/// use tauscope::robot::{self, InertiaCheck};
///
/// // What this machine has, the scalar ones first. All give the same torque to rounding.
/// let robot = robot::load("../tests/reference/pendulum.urdf", InertiaCheck::Required)?;
/// let motion = Motion::at_rest(Channels::from_vectors(&[(0..20).map(|k| 0.1 * f64::from(k)).collect()]));
/// let torque = |lanes| inverse_dynamics_in(lanes, &Chain::new(&robot), &robot.inertial_parameters(), &motion);
/// let scalar = torque(Lanes::scalar());
/// for lanes in Lanes::available() {
///     let same = torque(lanes).as_slice().iter().zip(scalar.as_slice()).all(|(a, b)| (a - b).abs() < 1e-9);
///     assert!(same, "{} lanes of {}", lanes.width(), lanes.name());
/// }
/// # Ok::<(), tauscope::error::Error>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Lanes(Kind);

impl Lanes {
    /// The fastest lanes of this machine.
    pub fn best() -> Self {
        #[cfg(target_arch = "aarch64")]
        return Lanes(Kind::Neon);
        #[cfg(target_arch = "x86_64")]
        {
            if has_avx512() {
                return Lanes(Kind::Avx512);
            }
            if has_avx2() {
                return Lanes(Kind::Avx2);
            }
        }
        #[cfg(not(target_arch = "aarch64"))]
        Lanes(Kind::Pair)
    }

    /// One sample at a time.
    pub fn scalar() -> Self {
        Lanes(Kind::Scalar)
    }

    /// All lanes of this machine, the scalar ones first.
    pub fn available() -> Vec<Self> {
        let mut all = vec![Lanes(Kind::Scalar), Lanes(Kind::Pair)];
        #[cfg(target_arch = "aarch64")]
        all.push(Lanes(Kind::Neon));
        #[cfg(target_arch = "x86_64")]
        {
            all.extend(has_avx2().then_some(Lanes(Kind::Avx2)));
            all.extend(has_avx512().then_some(Lanes(Kind::Avx512)));
        }
        all
    }

    /// These lanes, or scalar ones where a position may be too large for the reduction of [`Lane::sin_cos`].
    pub(crate) fn for_positions(self, q: &Channels, samples: Range<usize>) -> Self {
        // Their squares are quicker added than each is compared; not a number counts as too large.
        let within = |signal: &[f64]| self.run(Squares(&signal[samples.clone()])) <= LARGEST_ANGLE * LARGEST_ANGLE;
        if q.iter().all(within) { self } else { Lanes(Kind::Scalar) }
    }

    /// These lanes, or scalar ones for angles up to `largest` where that is too large for the reduction of
    /// [`Lane::sin_cos`].
    pub(crate) fn for_angles_to(self, largest: f64) -> Self {
        if largest > LARGEST_ANGLE { Lanes(Kind::Scalar) } else { self }
    }

    /// Samples side by side.
    pub fn width(self) -> usize {
        match self.0 {
            Kind::Scalar => f64::WIDTH,
            Kind::Pair => Pair::WIDTH,
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => Neon::WIDTH,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => Avx2::WIDTH,
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => Avx512::WIDTH,
        }
    }

    /// Name of the instructions.
    pub fn name(self) -> &'static str {
        match self.0 {
            Kind::Scalar => "scalar",
            Kind::Pair => "portable",
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => "NEON",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => "AVX2",
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => "AVX-512",
        }
    }

    /// Sixteen blocks of the key stream of ChaCha with eight rounds, from the first one's starting words, whose counter is a
    /// multiple of sixteen; false where these lanes are too narrow to be any faster than one block after the other.
    pub(crate) fn chacha8(self, start: &[u32; 16], words: &mut [u64; 128]) -> bool {
        debug_assert!(start[12].is_multiple_of(16));
        match self.0 {
            // SAFETY: this kind is only made after the processor was asked for it.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => {
                unsafe { super::chacha::blocks(start, words) };
                true
            }
            _ => false,
        }
    }

    /// Runs a kernel in these lanes.
    #[doc(hidden)]
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        match self.0 {
            Kind::Scalar => kernel.run::<f64>(),
            Kind::Pair => kernel.run::<Pair>(),
            #[cfg(target_arch = "aarch64")]
            Kind::Neon => kernel.run::<Neon>(),
            // SAFETY: this kind is only made after the processor was asked for it.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx2 => unsafe { in_avx2(kernel) },
            // SAFETY: this kind is only made after the processor was asked for it.
            #[cfg(target_arch = "x86_64")]
            Kind::Avx512 => unsafe { in_avx512(kernel) },
        }
    }
}

/// The sum of the squares of a signal.
struct Squares<'a>(&'a [f64]);

impl Kernel for Squares<'_> {
    type Output = f64;

    #[inline(always)]
    fn run<L: Lane>(self) -> f64 {
        let mut sum = L::splat(0.0);
        for start in (0..self.0.len()).step_by(L::WIDTH) {
            let values = L::load_part(&self.0[start..]);
            sum = values.mul_add(values, sum);
        }
        sum.sum()
    }
}

#[cfg(target_arch = "x86_64")]
fn has_avx2() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

#[cfg(target_arch = "x86_64")]
fn has_avx512() -> bool {
    has_avx2() && is_x86_feature_detected!("avx512f")
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma")]
fn in_avx2<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx2>()
}

#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2,fma,avx512f")]
fn in_avx512<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<Avx512>()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random;
    use rand::RngExt;

    struct SinCos<'a> {
        angle: &'a [f64],
        sine: &'a mut [f64],
        cosine: &'a mut [f64],
    }

    impl Kernel for SinCos<'_> {
        type Output = ();

        #[inline(always)]
        fn run<L: Lane>(self) {
            let values = self.angle.chunks(L::WIDTH);
            let out = self.sine.chunks_mut(L::WIDTH).zip(self.cosine.chunks_mut(L::WIDTH));
            for (angle, (sine, cosine)) in values.zip(out) {
                let (s, c) = L::load_part(angle).sin_cos();
                s.store_part(sine);
                c.store_part(cosine);
            }
        }
    }

    #[test]
    fn sines_and_cosines_are_right_to_rounding() {
        let mut source = random::stream(1, "angles", 0);
        for lanes in Lanes::available() {
            for range in [1e-300, 1e-8, 1.0, 10.0, 1e3, 1e6] {
                let mut angle: Vec<f64> = (0..10_001).map(|_| source.random_range(-range..range)).collect();
                angle.extend((-9..10).map(|k| f64::from(k) * std::f64::consts::FRAC_PI_2));
                let (mut sine, mut cosine) = (vec![9.0; angle.len()], vec![9.0; angle.len()]);
                lanes.run(SinCos { angle: &angle, sine: &mut sine, cosine: &mut cosine });
                for ((a, s), c) in angle.iter().zip(&sine).zip(&cosine) {
                    let (s0, c0) = a.sin_cos();
                    assert!((s - s0).abs() <= 1e-15 && (c - c0).abs() <= 1e-15, "{lanes:?}: {a}: {s} {s0}, {c} {c0}");
                }
            }
        }
    }

    #[test]
    fn angles_out_of_reach_take_scalar_lanes() {
        let mut q = Channels::zeros(2, 11);
        q.as_mut_slice().fill(3e5);
        for (value, scalar) in [(1.0, false), (2e6, true), (-1e300, true), (f64::NAN, true)] {
            q.channel_mut(1)[10] = value;
            for lanes in Lanes::available() {
                let chosen = lanes.for_positions(&q, 0..11);
                assert_eq!(chosen, if scalar { Lanes::scalar() } else { lanes }, "{value}");
                assert_eq!(lanes.for_positions(&q, 0..10), lanes);
            }
        }
    }

    #[test]
    fn what_is_not_a_number_stays_so() {
        for lanes in Lanes::available() {
            let (mut sine, mut cosine) = ([0.0; 3], [0.0; 3]);
            lanes.run(SinCos { angle: &[f64::NAN, 1.0, f64::INFINITY], sine: &mut sine, cosine: &mut cosine });
            assert!(sine[0].is_nan() && cosine[2].is_nan() && (sine[1] - 1f64.sin()).abs() < 1e-15);
        }
    }
}
