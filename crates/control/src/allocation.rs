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
use crate::real::{Mask, Real};
use crate::record;
use crate::record::{RecordExt as _, each, from_index};
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

record! {
    /// What the rotors will give.
    pub struct Allocated {
        /// Thrust of each rotor.
        thrusts: [T; 4] [N];
        /// Share of the rotors at a limit.
        saturation: T [1];
        /// What was asked and is not granted; exactly zero where all of it is.
        refused: Wrench<T> [];
    }
}

record! {
    /// Wished thrust of each rotor, by what it is for.
    struct Wish {
        /// To carry.
        lift: [T; 4] [N];
        /// To roll and pitch.
        tilt: [T; 4] [N];
        /// To yaw.
        yaw: [T; 4] [N];
    }
}

impl<T: Real> Wish<T> {
    /// All of it.
    #[inline(always)]
    fn thrusts(&self) -> [T; 4] {
        from_index(|i| (self.lift[i] + self.yaw[i]) + self.tilt[i])
    }
}

impl<T: Real> Allocation<T> {
    /// Rotor thrusts within the limits, N, and the part of the wrench that was refused.
    #[inline(always)]
    pub fn allocate(&self, wrench: &Wrench<T>) -> Allocated<T> {
        let wish = self.wish(wrench);
        // The usual case; the long way ends in the same bits.
        let mut allocated = Allocated {
            thrusts: wish.thrusts(),
            saturation: T::zero(),
            refused: Wrench::default(),
        };
        if self.free(&wish).all() {
            return allocated;
        }
        for i in 0..T::PARTS {
            self.pick(i).limited(&wish.pick(i), &wrench.pick(i)).put(&mut allocated, i);
        }
        allocated
    }

    /// What each rotor should give if there were no limits (1).
    #[inline(always)]
    fn wish(&self, wrench: &Wrench<T>) -> Wish<T> {
        let share = |c: usize, of: T| -> [T; 4] { from_index(|i| self.inverse[i][c] * of) };
        let lift = share(0, wrench.thrust);
        let (roll, pitch) = (share(1, wrench.torque.x), share(2, wrench.torque.y));
        let yaw = share(3, wrench.torque.z);
        Wish { lift, tilt: from_index(|i| roll[i] + pitch[i]), yaw }
    }

    /// Whether every rotor stays inside its limits, so that nothing is refused.
    #[inline(always)]
    fn free(&self, wish: &Wish<T>) -> T::Mask {
        let (least, most) = extremes(wish.thrusts());
        self.lowest.lt(least) & most.lt(self.highest)
    }

    /// The way through (2) to (4).
    #[inline(always)]
    fn limited(&self, wish: &Wish<T>, wrench: &Wrench<T>) -> Allocated<T> {
        let free = self.free(wish);
        let Wish { lift, tilt, yaw } = *wish;
        let (low, high) = extremes(tilt);
        let room = self.highest - self.lowest;
        let scale = room.min(high - low) / (high - low).max(T::lit(1e-30));
        let scale = T::select(room.lt(high - low), scale, T::one()); // (2)
        let base: [T; 4] = from_index(|i| lift[i] + tilt[i] * scale);
        let shift =
            self.raise(base, yaw) - self.raise(each(base, |u| self.mirror(u)), each(yaw, |u| -u));
        let base = each(base, |u| u + shift); // (3)

        let mut grant = T::one();
        for i in 0..4 {
            let headroom =
                T::select(T::zero().lt(yaw[i]), self.highest - base[i], base[i] - self.lowest);
            let share = headroom.max(T::zero()) / yaw[i].abs().max(T::lit(1e-30));
            grant = grant.min(share); // (4)
        }
        let thrusts: [T; 4] =
            from_index(|i| (base[i] + yaw[i] * grant).clamp(self.lowest, self.highest));
        let granted = self.wrench(thrusts);
        // A rotor put at its limit may miss it by a rounding error.
        let margin = room * T::lit(1e-6);
        let mut saturation = T::zero();
        for u in thrusts {
            let inside = (self.lowest + margin).lt(u) & u.lt(self.highest - margin);
            saturation += T::select(inside, T::zero(), T::lit(0.25));
        }
        let refused = |asked: T, granted: T| T::select(free, T::zero(), asked - granted);
        let Wrench { thrust, torque } = *wrench;
        Allocated {
            thrusts: from_index(|i| T::select(free, wish.thrusts()[i], thrusts[i])),
            saturation: T::select(free, T::zero(), saturation),
            refused: Wrench {
                thrust: refused(thrust, granted.thrust),
                torque: Vec3::new(
                    refused(torque.x, granted.torque.x),
                    refused(torque.y, granted.torque.y),
                    refused(torque.z, granted.torque.z),
                ),
            },
        }
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
