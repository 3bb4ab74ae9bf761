//! From the wrench to the rotors, within their limits, roll and pitch first.
//!
//!   u = B^-1 w,   u_i = k Omega_i^2                                      (1)
//!   u_rp scaled by s = min(1, (u_max - u_min)/spread(u_rp))              (2)
//!   thrust shifted by the least t for which u_min <= u_T + t + s u_rp + y u_yaw <= u_max
//!   has a solution 0 <= y <= 1                                           (3)
//!   yaw scaled by the largest such y                                     (4)
//!
//! Roll and pitch keep the vehicle in the air, so they are granted first, then thrust, then yaw. In (3)
//! the bound that rotor i sets falls with y where its yaw is positive, and rises for the others; the
//! least y-dependent maximum is at y = 0, at y = 1, or where two such bounds cross. So a wrench that the
//! rotors can make is granted as it is.
//!
//! Source: priority desaturation as in common multirotor practice (Smeur, Hoeppener and de Wagter, IMAV
//! 2017, treat the same problem as weighted least squares). Valid for four rotors with equal thrust
//! limits whose equal thrusts give no torque.

use crate::math::Vec3;
use crate::real::Real;
use crate::record;
use crate::signals::Wrench;

record! {
    /// A rotor layout, inverted.
    pub struct Allocation {
        /// Rotor thrusts per wrench: rows rotors, columns thrust, torque x, y, z.
        inverse: [[T; 4]; 4] [];
        /// Wrench per rotor thrust: rows thrust, torque x, y, z; columns rotors.
        effect: [[T; 4]; 4] [];
        /// Thrust of one rotor at its lowest speed.
        lowest: T [N];
        /// Thrust of one rotor at its highest speed.
        highest: T [N];
    }
}

impl<T: Real> Allocation<T> {
    /// Rotor thrusts within the limits, N, and the wrench that they make.
    #[inline(always)]
    pub fn allocate(&self, wrench: &Wrench<T>) -> ([T; 4], Wrench<T>) {
        let share =
            |c: usize, of: T| -> [T; 4] { crate::record::from_index(|i| self.inverse[i][c] * of) };
        let lift = share(0, wrench.thrust); // (1)
        let (roll, pitch) = (share(1, wrench.torque.x), share(2, wrench.torque.y));
        let yaw = share(3, wrench.torque.z);
        let tilt: [T; 4] = crate::record::from_index(|i| roll[i] + pitch[i]);

        let (low, high) = extremes(tilt);
        let room = self.highest - self.lowest;
        let scale = room.min(high - low) / (high - low).max(T::lit(1e-30));
        let scale = T::select(room.lt(high - low), scale, T::one()); // (2)
        let tilt = crate::record::each(tilt, |u| u * scale);
        let base: [T; 4] = crate::record::from_index(|i| lift[i] + tilt[i]);
        let shift = self.raise(base, yaw)
            - self.raise(
                crate::record::each(base, |u| self.mirror(u)),
                crate::record::each(yaw, |u| -u),
            );
        let base = crate::record::each(base, |u| u + shift); // (3)

        // The least of one and all headroom/wish, as a fraction: one division instead of four.
        let (mut part, mut whole) = (T::one(), T::one());
        for i in 0..4 {
            let headroom =
                T::select(T::zero().lt(yaw[i]), self.highest - base[i], base[i] - self.lowest);
            let (headroom, wish) = (headroom.max(T::zero()), yaw[i].abs());
            let less = (headroom * whole).lt(part * wish);
            (part, whole) = (T::select(less, headroom, part), T::select(less, wish, whole));
        }
        let grant = part / whole; // (4)
        let thrusts: [T; 4] = crate::record::from_index(|i| {
            (base[i] + yaw[i] * grant).clamp(self.lowest, self.highest)
        });
        (thrusts, self.wrench(thrusts))
    }

    /// The least common rise that brings every rotor to its lowest thrust, some share of yaw granted.
    #[inline(always)]
    fn raise(&self, base: [T; 4], yaw: [T; 4]) -> T {
        let far = T::lit(1e30);
        let (mut whole, mut with, mut against) = (far, far, far);
        for i in 0..4 {
            let up = T::zero().lt(yaw[i]);
            whole = whole.min(base[i] + yaw[i].max(T::zero()));
            with = with.min(T::select(up, base[i], far));
            against = against.min(T::select(up, far, base[i]));
        }
        (self.lowest - whole.min((with + against).half())).max(T::zero())
    }

    /// Thrusts upside down: the highest becomes the lowest.
    #[inline(always)]
    fn mirror(&self, u: T) -> T {
        self.lowest + (self.highest - u)
    }

    /// The wrench that these rotor thrusts (N) make.
    #[inline(always)]
    pub fn wrench(&self, thrusts: [T; 4]) -> Wrench<T> {
        let row = |r: usize| {
            let b = &self.effect[r];
            b[0] * thrusts[0] + b[1] * thrusts[1] + (b[2] * thrusts[2] + b[3] * thrusts[3])
        };
        // The first row of B is ones.
        let thrust = thrusts[0] + thrusts[1] + (thrusts[2] + thrusts[3]);
        Wrench { thrust, torque: Vec3::new(row(1), row(2), row(3)) }
    }
}

#[inline(always)]
fn extremes<T: Real>(u: [T; 4]) -> (T, T) {
    (u[0].min(u[1]).min(u[2].min(u[3])), u[0].max(u[1]).max(u[2].max(u[3])))
}
