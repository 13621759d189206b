//! How far the core's model of a table is from a chain, which has none.

use controller_core::arm::dynamics::Dynamics;
use controller_core::arm::kinematics::Kinematics;
use controller_core::arm::{ArmModel, ArmParameters, Link};
use controller_core::joint::{DOF, JointState, JointVector};

use super::chain::Chain;
use super::frame::Frame;

/// One quantity: the largest difference, and the largest entry of the chain.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Apart {
    /// Largest difference of an entry.
    pub most: f64,
    /// Largest entry.
    pub size: f64,
}

/// Largest differences over states.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Agreement {
    /// M \[kg m2\], without rotors.
    pub mass_matrix: Apart,
    /// g \[Nm\].
    pub gravity: Apart,
    /// C dq \[Nm\].
    pub coriolis: Apart,
    /// Position of the flange \[m\].
    pub position: Apart,
    /// Entries of the rotation of the flange.
    pub rotation: Apart,
}

impl Apart {
    fn add<'a>(
        &mut self,
        ours: impl IntoIterator<Item = &'a f64>,
        theirs: impl IntoIterator<Item = &'a f64>,
    ) {
        for (one, other) in ours.into_iter().zip(theirs) {
            let difference = (one - other).abs();
            // A NaN must not hide behind max().
            self.most = if difference <= self.most {
                self.most
            } else {
                difference
            };
            self.size = self.size.max(other.abs());
        }
    }

    /// As a share of the largest entry.
    #[must_use]
    pub fn share(&self) -> f64 {
        self.most / self.size.max(f64::MIN_POSITIVE)
    }
}

impl Agreement {
    /// Of the core's `model` of `arm` and a chain, over `states`: q \[rad\], dq \[rad/s\].
    #[must_use]
    pub fn of(
        arm: &ArmParameters,
        model: &ArmModel<f64>,
        chain: &Chain,
        states: impl IntoIterator<Item = JointState<f64>>,
    ) -> Self {
        let mut agreement = Self::default();
        let (mut kinematics, mut dynamics) = (Kinematics::new(), Dynamics::new());
        let rotor = JointVector::from(arm.links.map(|link| link.rotor_inertia));
        for state in states {
            kinematics.update(model, &state);
            dynamics.update(model, &kinematics, &state);
            let motion = chain.motion(&state.q, &state.dq, &arm.gravity.into());
            let mut mass_matrix = dynamics.mass_matrix;
            for i in 0..DOF {
                for j in 0..DOF {
                    // The core fills one triangle where the other is not read.
                    let (row, column) = (i.max(j), i.min(j));
                    mass_matrix[(i, j)] = dynamics.mass_matrix[(row, column)];
                }
                mass_matrix[(i, i)] -= rotor[i];
            }
            agreement.mass_matrix.add(&mass_matrix, &motion.mass_matrix);
            agreement.gravity.add(&dynamics.gravity, &motion.gravity);
            agreement.coriolis.add(&dynamics.coriolis, &motion.coriolis);
            let flange = flange(&kinematics, arm);
            agreement.position.add(&flange.shift, &motion.tip.shift);
            agreement
                .rotation
                .add(&flange.rotation, &motion.tip.rotation);
        }
        agreement
    }

    /// Every quantity with its name and unit.
    #[must_use]
    pub fn all(&self) -> [(&'static str, Apart); 5] {
        [
            ("M kg m2", self.mass_matrix),
            ("g Nm", self.gravity),
            ("C dq Nm", self.coriolis),
            ("flange m", self.position),
            ("axes rad", self.rotation),
        ]
    }

    /// The largest difference as a share of the largest entry of its quantity.
    #[must_use]
    pub fn worst_share(&self) -> f64 {
        self.all()
            .iter()
            .map(|(_, apart)| apart.share())
            .fold(0.0, f64::max)
    }
}

/// The flange by the core's kinematics.
fn flange(kinematics: &Kinematics<f64>, arm: &ArmParameters) -> Frame {
    let last = Frame {
        rotation: kinematics.link(Link::L7).rotation,
        shift: kinematics.point(Link::L7, &[0.0; 3].into()).x,
    };
    last.carrying(&Frame::from(&arm.flange))
}
