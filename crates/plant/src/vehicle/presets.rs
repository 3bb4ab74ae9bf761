//! Vehicles by name. Every number has a public source; what no source gives is zero.

use core::f64::consts::SQRT_2;

use stormpetrel_control::math::Vec3;
use stormpetrel_control::options;
use stormpetrel_control::options::{Cells, Options as _, Rows};
use stormpetrel_control::record::{Meta, Path, Record};
use stormpetrel_control::registry::{Settings, SettingsVisitor};

use super::{Arms, Layout, RotorPlaces, Vehicle};

options! {
    /// Layout of the rotors.
    pub struct Options {
        /// Where the rotors stand.
        layout: Arms;
        /// Place and spin of each rotor, for the layout `free`.
        rotors: Rows<RotorPlaces>;
    }
}

/// A vehicle by the name of its preset; each number may be changed.
#[derive(Clone, Copy, Debug)]
pub struct VehicleSettings {
    preset: usize,
    /// The numbers and the layout.
    pub vehicle: Vehicle<f64>,
}

/// A preset: its name, what it is and where its numbers come from, and the numbers.
struct Preset {
    name: &'static str,
    doc: &'static str,
    vehicle: fn() -> Vehicle<f64>,
}

const PRESETS: [Preset; 6] = [
    Preset {
        name: "article",
        doc: "The article's vehicle with its printed constants; its drag coefficient gives c/k = 2.75 m.",
        vehicle: || Vehicle { drag_coefficient: 1.98e-6, ..article() },
    },
    Preset {
        name: "article-corrected",
        doc: "The article's vehicle with the drag coefficient corrected to c/k = 0.0275 m.",
        vehicle: article,
    },
    Preset {
        name: "crazyflie",
        doc: "Bitcraze Crazyflie 2.1, 30 g. Mass, rotors and lag as in RotorPy's crazyflie_params.py \
(University of Pennsylvania), moments of inertia as measured by Foerster, System Identification of the Crazyflie 2.0, \
ETH Zurich 2015 (RotorPy's are those of no rigid body: the third exceeds the sum of the others); \
its rotor drag 1.02506e-6 kg/rad is taken at the hover speed 1788.6 rad/s of four rotors.",
        vehicle: crazyflie,
    },
    Preset {
        name: "hummingbird",
        doc: "AscTec Hummingbird, 0.5 kg. As in RotorPy's hummingbird_params.py, after Svacha, Mohta and \
Kumar, ICUAS 2017; its rotor drag 1.19e-4 kg/rad is taken at the hover speed 469.2 rad/s of four rotors.",
        vehicle: hummingbird,
    },
    Preset {
        name: "racer",
        doc: "A 0.75 kg agile racer with rotors at (+-0.075, +-0.1) m, 8.5 N each. As in the public simulator \
of Learning on the Fly, Robotics and Perception Group, University of Zurich (example_quad.yaml).",
        vehicle: racer,
    },
    Preset {
        name: "x500",
        doc: "Holybro X500 class, 2 kg. As in PX4's Gazebo model x500 (model.sdf, x500_base/model.sdf); its \
rotor drag 8.06428e-5 is taken at the hover speed 757.5 rad/s of four rotors.",
        vehicle: x500,
    },
];

const NAMES: [&str; PRESETS.len()] = {
    let mut names = [""; PRESETS.len()];
    let mut i = 0;
    while i < names.len() {
        names[i] = PRESETS[i].name;
        i += 1;
    }
    names
};

fn article() -> Vehicle<f64> {
    Vehicle { inertia: Vec3::new(2.6e-3, 2.4e-3, 2.6e-3), ..Vehicle::default() }
}

fn crazyflie() -> Vehicle<f64> {
    Vehicle {
        mass: 0.03,
        inertia: Vec3::new(1.657_171e-5, 1.665_560_2e-5, 2.926_165_2e-5),
        gravity: 9.81,
        arm: 0.043,
        thrust_coefficient: 2.3e-8,
        drag_coefficient: 7.8e-10,
        motor_lag: 0.072,
        rotor_speed_min: 0.0,
        rotor_speed_max: 2500.0,
        rotor_radius: 0.023,
        inflow_loss: 7.553e-7,
        rotor_drag: Vec3::new(7.333e-3, 7.333e-3, 0.0),
        layout: Layout { arms: Arms::Px4X, ..Layout::default() },
        ..Vehicle::default()
    }
}

fn hummingbird() -> Vehicle<f64> {
    Vehicle {
        mass: 0.5,
        inertia: Vec3::new(3.65e-3, 3.68e-3, 7.03e-3),
        gravity: 9.81,
        arm: 0.17,
        thrust_coefficient: 5.57e-6,
        drag_coefficient: 1.36e-7,
        motor_lag: 0.005,
        rotor_speed_min: 0.0,
        rotor_speed_max: 1500.0,
        rotor_radius: 0.1,
        inflow_loss: 2.32e-4,
        rotor_drag: Vec3::new(0.2233, 0.2233, 0.0),
        body_drag: 5e-3,
        layout: Layout { arms: Arms::Px4X, ..Layout::default() },
        ..Vehicle::default()
    }
}

/// Places and spins of the racer's rotors, in the order of `px4-x`.
const RACER: [f64; 16] = [
    0.075, -0.1, 0.0, 1.0, //
    -0.075, 0.1, 0.0, 1.0, //
    0.075, 0.1, 0.0, -1.0, //
    -0.075, -0.1, 0.0, -1.0,
];

fn racer() -> Vehicle<f64> {
    Vehicle {
        mass: 0.75,
        inertia: Vec3::new(2.410e-3, 1.800e-3, 3.759e-3),
        gravity: 9.81,
        arm: 0.125,
        thrust_coefficient: 1.562_522e-6,
        drag_coefficient: 0.022 * 1.562_522e-6,
        motor_lag: 0.033,
        rotor_speed_min: 150.0,
        rotor_speed_max: 2332.0,
        rotor_inertia: 5.64e-6,
        layout: Layout { arms: Arms::Free, rotors: Cells { cells: &RACER, file: "" }.into() },
        ..Vehicle::default()
    }
}

fn x500() -> Vehicle<f64> {
    Vehicle {
        mass: 2.0,
        inertia: Vec3::new(0.021_666_666_666_666_67, 0.021_666_666_666_666_67, 0.04),
        gravity: 9.81,
        arm: 0.174 * SQRT_2,
        thrust_coefficient: 8.548_58e-6,
        drag_coefficient: 0.016 * 8.548_58e-6,
        motor_lag: 0.0125,
        motor_lag_fall: 0.025,
        rotor_speed_min: 0.0,
        rotor_speed_max: 1000.0,
        rotor_inertia: 2.611_585_169_170_08e-5,
        rotor_radius: 0.127,
        rotor_drag: Vec3::new(0.2443, 0.2443, 0.0),
        layout: Layout { arms: Arms::Px4X, ..Layout::default() },
        ..Vehicle::default()
    }
}

impl VehicleSettings {
    /// What each preset is, and where its numbers come from.
    pub const DOCS: [&'static str; PRESETS.len()] = {
        let mut docs = [""; PRESETS.len()];
        let mut i = 0;
        while i < docs.len() {
            docs[i] = PRESETS[i].doc;
            i += 1;
        }
        docs
    };
}

impl Settings for VehicleSettings {
    const KEY: &'static str = "model";
    const NAMES: &'static [&'static str] = &NAMES;
    const SOURCES: &'static [&'static str] = &[include_str!("presets.rs"); PRESETS.len()];

    fn named(name: &str) -> Option<Self> {
        let preset = NAMES.iter().position(|known| *known == name)?;
        PRESETS.get(preset).map(|found| Self { preset, vehicle: (found.vehicle)() })
    }

    fn name(&self) -> &'static str {
        NAMES[self.preset % NAMES.len()]
    }

    fn settings(&mut self, v: &mut impl SettingsVisitor) {
        let Layout { arms, rotors } = self.vehicle.layout;
        let mut options = Options { layout: arms, rotors };
        options.visit(v);
        self.vehicle.layout = Layout { arms: options.layout, rotors: options.rotors };
        self.vehicle.visit_mut(&Path::ROOT, &Meta::signal("", ""), v);
    }
}
