//! Reads the golden files; `golden/README.md` says what is in them.

#![expect(missing_docs, reason = "fields as in the files, described there")]

use controller_core::arm::{ArmParameters, Friction, LinkParameters, Pose};
use controller_core::joint::{DOF, JointMatrix, JointState};
use serde::Deserialize;
use std::collections::BTreeMap;

/// A 7 x 7 matrix, list of rows.
pub type Rows7 = [[f64; DOF]; DOF];

/// A 3 x 7 matrix, list of rows.
pub type Rows3 = [[f64; DOF]; 3];

#[derive(Deserialize)]
pub struct Golden {
    pub nominal: GoldenArm,
    pub mismatched: GoldenArm,
}

#[derive(Deserialize)]
pub struct GoldenArm {
    pub arm: Tables,
    pub states: Vec<GoldenState>,
}

#[derive(Deserialize)]
pub struct GoldenState {
    pub q: [f64; DOF],
    pub dq: [f64; DOF],
    pub torque: [f64; DOF],
    pub mass_matrix: Rows7,
    /// Nominal arm only.
    pub coriolis_matrix: Option<Rows7>,
    pub coriolis: [f64; DOF],
    pub gravity: [f64; DOF],
    pub ddq: [f64; DOF],
    pub ddq_in: [f64; DOF],
    pub rnea: [f64; DOF],
    pub kinetic_energy: f64,
    pub potential_energy: f64,
    /// Nominal arm only.
    #[serde(default)]
    pub points: BTreeMap<String, GoldenPoint>,
}

#[derive(Deserialize)]
pub struct GoldenPoint {
    pub position: [f64; 3],
    pub jacobian: Rows3,
    pub jacobian_dot: Rows3,
    /// Flange only, as the next.
    pub angular_jacobian: Option<Rows3>,
    pub angular_jacobian_dot: Option<Rows3>,
}

#[derive(Deserialize)]
pub struct Tables {
    base_height: f64,
    flange: f64,
    gravity: [f64; 3],
    links: [LinkTables; DOF],
}

#[derive(Deserialize)]
struct LinkTables {
    a: f64,
    alpha: f64,
    d: f64,
    mass: f64,
    com: [f64; 3],
    inertia: [f64; 6],
    position_limit: f64,
    speed_limit: f64,
    torque_limit: f64,
}

impl Golden {
    /// The whole of `dynamics.json`.
    pub fn read() -> Self {
        serde_json::from_str(&file("dynamics.json")).expect("layout of dynamics.json")
    }
}

impl Tables {
    /// The tables as the product takes them.
    pub fn parameters(&self) -> ArmParameters {
        ArmParameters {
            name: "golden",
            base: Pose::at([0.0, 0.0, self.base_height]),
            flange: Pose::at([0.0, 0.0, self.flange]),
            points: &[],
            limits: None,
            damping_postures: &[],
            gravity: self.gravity,
            links: self.links.each_ref().map(|link| LinkParameters {
                name: "joint",
                angle_offset: 0.0,
                rotor_inertia: 0.0,
                friction: Friction::NONE,
                end_approach: None,
                a: link.a,
                alpha: link.alpha,
                d: link.d,
                mass: link.mass,
                com: link.com,
                inertia: link.inertia,
                position_range: [-link.position_limit, link.position_limit],
                speed_limit: link.speed_limit,
                torque_limit: link.torque_limit,
                torque_rate_limit: 1e4,
                brake_rate_limit: 1e5,
            }),
        }
    }
}

impl GoldenState {
    pub fn state(&self) -> JointState<f64> {
        JointState {
            q: self.q.into(),
            dq: self.dq.into(),
        }
    }

    pub fn mass_matrix(&self) -> JointMatrix<f64> {
        JointMatrix::from_fn(|i, j| self.mass_matrix[i][j])
    }
}

/// Text of a golden file.
pub fn file(name: &str) -> String {
    let path = format!("{}/golden/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// Keeps the largest error seen, and says it beside its tolerance at the end.
pub struct Worst(pub &'static str, f64);

impl Worst {
    pub fn new(what: &'static str) -> Self {
        Self(what, 0.0)
    }

    pub fn add(&mut self, error: f64) {
        // A NaN must not hide behind max().
        self.1 = if error <= self.1 { self.1 } else { error };
    }

    pub fn within(self, tolerance: f64) {
        println!("{}: {:.1e} of {tolerance:.0e}", self.0, self.1);
        assert!(
            self.1 <= tolerance,
            "{}: {:e} > {tolerance:e}",
            self.0,
            self.1
        );
    }
}
