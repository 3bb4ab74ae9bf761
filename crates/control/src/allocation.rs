//! From the wrench to the rotors, within their limits, roll and pitch first.
//!
//!   u = B^-1 w,   u_i = k Omega_i^2                                      (1)
//!   u_rp scaled by s = min(1, (u_max - u_min)/spread(u_rp))              (2)
//!   thrust shifted so that u_min <= u_T + s u_rp <= u_max                (3)
//!   yaw scaled by the largest y <= 1 that keeps every rotor inside       (4)
//!
//! Roll and pitch keep the vehicle in the air, so they are granted first, then thrust, then yaw.
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
            |c: usize, of: T| -> [T; 4] { core::array::from_fn(|i| self.inverse[i][c] * of) };
        let lift = share(0, wrench.thrust); // (1)
        let (roll, pitch) = (share(1, wrench.torque.x), share(2, wrench.torque.y));
        let yaw = share(3, wrench.torque.z);
        let tilt: [T; 4] = core::array::from_fn(|i| roll[i] + pitch[i]);

        let (low, high) = extremes(tilt);
        let room = self.highest - self.lowest;
        let scale = room.min(high - low) / (high - low).max(T::lit(1e-30));
        let scale = T::select(room.lt(high - low), scale, T::one()); // (2)
        let tilt = tilt.map(|u| u * scale);
        let base: [T; 4] = core::array::from_fn(|i| lift[i] + tilt[i]);
        let (low, high) = extremes(base);
        let shift = (self.lowest - low).max(T::zero()) - (high - self.highest).max(T::zero());
        let base = base.map(|u| u + shift); // (3)

        let mut grant = T::one();
        for i in 0..4 {
            let headroom =
                T::select(T::zero().lt(yaw[i]), self.highest - base[i], base[i] - self.lowest);
            let wish = yaw[i].abs();
            let part = headroom.max(T::zero()) / wish.max(T::lit(1e-30));
            grant = T::select(headroom.lt(wish), grant.min(part), grant); // (4)
        }
        let thrusts: [T; 4] =
            core::array::from_fn(|i| (base[i] + yaw[i] * grant).clamp(self.lowest, self.highest));
        (thrusts, self.wrench(thrusts))
    }

    /// The wrench that these rotor thrusts (N) make.
    #[inline(always)]
    pub fn wrench(&self, thrusts: [T; 4]) -> Wrench<T> {
        let row = |r: usize| {
            let b = &self.effect[r];
            b[0] * thrusts[0] + b[1] * thrusts[1] + (b[2] * thrusts[2] + b[3] * thrusts[3])
        };
        Wrench { thrust: row(0), torque: Vec3::new(row(1), row(2), row(3)) }
    }
}

#[inline(always)]
fn extremes<T: Real>(u: [T; 4]) -> (T, T) {
    (u[0].min(u[1]).min(u[2].min(u[3])), u[0].max(u[1]).max(u[2].max(u[3])))
}
