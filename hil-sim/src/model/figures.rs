//! What a table is like: bodies, mass matrix, sampling bound, postures where the arm can do least.

use std::fmt::{self, Write as _};

use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::{DOF, JointMatrix, Matrix3};
use controller_core::law::sampling::{DampingRate, bound, fastest_mode};
use controller_core::task::LevelLimits;
use nalgebra::SymmetricEigen;

use super::at_rest::at_rest;
use super::search::{drawn, highest};
use cell::invalid::Invalid;

/// Random postures of the mass matrix and the mobility.
const POSTURES: usize = 2000;

/// Cycle and dead cycles that the sampling bound is shown for \[s\].
const LOOPS: [(f64, u8); 3] = [(0.001, 0), (0.002, 0), (0.002, 1)];

/// What `hil-sim model check` says of a table.
pub struct Figures<'a> {
    arm: &'a ArmParameters,
    /// Per link the least second moment of mass as a share of their sum; at least 0.
    margin: [f64; DOF],
    /// Least and greatest M_ii \[kg m2\].
    diagonal: [[f64; 2]; DOF],
    /// Median and greatest condition number of M, and where the greatest is \[rad\].
    condition: [f64; 2],
    worst_condition: [f64; DOF],
    /// Per joint, damped alone by 1 Nms/rad.
    rates: [DampingRate; DOF],
    /// Farthest flange from the shoulder \[m\], and where \[rad\].
    stretch: (f64, [f64; DOF]),
    /// Least mobility of the flange's position \[1/kg\], and where \[rad\].
    singular: (f64, [f64; DOF]),
    /// Greatest least mobility of it, and where: farthest from singular.
    mobile: (f64, [f64; DOF]),
    /// Shares of the random postures in which a first level is driven less, and released.
    limited: [f64; 2],
}

/// What is looked at in a posture.
struct Look {
    mass_matrix: JointMatrix<f64>,
    /// Of the flange, rows x, y, z.
    jacobian: nalgebra::SMatrix<f64, 3, DOF>,
    /// Flange from the shoulder \[m\].
    distance: f64,
}

impl<'a> Figures<'a> {
    /// Of an arm.
    ///
    /// # Errors
    /// A mass matrix that is not positive definite somewhere.
    pub fn of(arm: &'a ArmParameters) -> Result<Self, Invalid> {
        let model = ArmModel::<f64>::new(arm).map_err(Invalid::line)?;
        let looks: Vec<_> = drawn(arm, POSTURES)
            .iter()
            .map(|q| look(arm, &model, q))
            .collect();
        let least = |look: &Look| eigenvalues(&look.mass_matrix)[0];
        let weakest = looks.iter().map(least).fold(f64::INFINITY, f64::min);
        if weakest <= 0.0 {
            let given = format!("least eigenvalue {weakest:e} kg m2");
            return Err(Invalid::new(
                "mass matrix",
                given,
                "above 0 in every posture",
            ));
        }
        let mut conditions: Vec<f64> = looks
            .iter()
            .map(|look| condition(&look.mass_matrix))
            .collect();
        conditions.sort_by(f64::total_cmp);
        let at = |q: &[f64; DOF]| look(arm, &model, q);
        let (worst, worst_condition) = highest(arm, |q| condition(&at(q).mass_matrix));
        let (negative, posture) = highest(arm, |q| -at(q).mobility());
        let thresholds = LevelLimits::FIRST;
        let share = |threshold: f64| {
            let below = looks
                .iter()
                .filter(|look| look.mobility() < threshold)
                .count();
            below as f64 / POSTURES as f64
        };
        Ok(Self {
            arm,
            margin: arm.links.map(|link| margin(&link.inertia)),
            diagonal: std::array::from_fn(|i| {
                let entries = looks.iter().map(|look| look.mass_matrix[(i, i)]);
                let least = entries.clone().fold(f64::INFINITY, f64::min);
                [least, entries.fold(0.0, f64::max)]
            }),
            condition: [conditions[POSTURES / 2], worst],
            worst_condition,
            rates: std::array::from_fn(|joint| {
                let mut only = [1e-9; DOF];
                only[joint] = 1.0;
                fastest_mode(&model, &JointMatrix::from_diagonal(&only.into()))
            }),
            stretch: highest(arm, |q| at(q).distance),
            singular: (-negative, posture),
            mobile: highest(arm, |q| at(q).mobility()),
            limited: [thresholds.drive_mobility, thresholds.release_mobility].map(share),
        })
    }

    /// As a table for people.
    #[must_use]
    pub fn text(&self) -> String {
        let mut text = String::new();
        // Into memory: it cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, f: &mut String) -> fmt::Result {
        let (arm, links) = (self.arm, &self.arm.links);
        let mass: f64 = links.iter().map(|link| link.mass).sum();
        writeln!(
            f,
            "{}: {mass:.3} kg move, the flange reaches {:.3} m",
            arm.name, self.stretch.0
        )?;
        writeln!(
            f,
            "\n{:<24} {:>18} {:>9} {:>9} {:>9} {:>9} {:>9}",
            "joint", "range deg", "deg/s", "Nm", "mass kg", "rotor", "margin"
        )?;
        for (link, margin) in links.iter().zip(self.margin) {
            let [min, max] = link.position_range.map(f64::to_degrees);
            writeln!(
                f,
                "{:<24} {:>18} {:>9.1} {:>9.1} {:>9.3} {:>9.4} {:>9.1e}",
                link.name,
                format!("{min:.1} to {max:.1}"),
                link.speed_limit.to_degrees(),
                link.torque_limit,
                link.mass,
                link.rotor_inertia,
                margin
            )?;
        }
        writeln!(
            f,
            "rotor: kg m2, 0 where unknown; margin: least second moment of mass of the \
                     body as a share of all, impossible below 0"
        )?;

        writeln!(
            f,
            "\n{:<24} {:>9} {:>9} {:>12} {:>12} {:>16}",
            "joint", "least", "greatest", "D at 1 ms", "D at 2 ms", "2 ms, dead cycle"
        )?;
        for ((link, rate), [least, greatest]) in links.iter().zip(&self.rates).zip(self.diagonal) {
            let [first, second, third] =
                LOOPS.map(|(cycle_s, dead)| bound(dead) / (cycle_s * rate.rate));
            writeln!(
                f,
                "{:<24} {least:>9.3e} {greatest:>9.3e} {first:>12.4} {second:>12.4} {third:>16.4}",
                link.name
            )?;
        }
        writeln!(
            f,
            "least, greatest: M_ii over {POSTURES} random postures, kg m2; D: damping of \
                     this joint alone that a cycle carries, Nms/rad"
        )?;

        let [median, worst] = self.condition;
        let [driven, released] = self.limited.map(|share| 100.0 * share);
        let LevelLimits {
            drive_mobility,
            release_mobility,
            ..
        } = LevelLimits::FIRST;
        writeln!(
            f,
            "\ncondition of M: {median:.0} (median), {worst:.0} (worst) at {}",
            shown(&self.worst_condition)
        )?;
        writeln!(
            f,
            "stretched: {:.4} m from the shoulder at {}",
            self.stretch.0,
            shown(&self.stretch.1)
        )?;
        writeln!(
            f,
            "singular: least mobility of the flange {:.2e} /kg at {}",
            self.singular.0,
            shown(&self.singular.1)
        )?;
        writeln!(
            f,
            "mobile: {:.2e} /kg at {}",
            self.mobile.0,
            shown(&self.mobile.1)
        )?;
        writeln!(
            f,
            "below {drive_mobility} /kg, where a first level is driven less, in {driven:.1} % \
                     of the postures; below {release_mobility} /kg, where it gives a direction up, \
                     in {released:.1} %"
        )
    }
}

/// A posture \[rad\] in degrees.
#[must_use]
pub fn shown(posture: &[f64; DOF]) -> String {
    let degrees: Vec<_> = posture
        .iter()
        .map(|angle| format!("{:.1}", angle.to_degrees() + 0.0))
        .collect();
    format!("[{}] deg", degrees.join(", "))
}

fn look(arm: &ArmParameters, model: &ArmModel<f64>, q: &[f64; DOF]) -> Look {
    let (kinematics, dynamics) = at_rest(model, q);
    let flange = arm.flange_point();
    let motion = kinematics.point(flange.link, &flange.offset.into());
    let rows = kinematics.point_jacobian(flange.link, &motion);
    let [x, y, z] = rows.jacobian.map(|row| row.transpose());
    Look {
        mass_matrix: dynamics.mass_matrix,
        jacobian: nalgebra::SMatrix::from_rows(&[x, y, z]),
        distance: (motion.x - model.shoulder()).norm(),
    }
}

impl Look {
    /// Least eigenvalue of J M^-1 J^T of the flange's position \[1/kg\].
    fn mobility(&self) -> f64 {
        let Some(factor) = self.mass_matrix.cholesky() else {
            return 0.0;
        };
        let mobility: Matrix3<f64> = self.jacobian * factor.solve(&self.jacobian.transpose());
        let eigen = SymmetricEigen::new(mobility).eigenvalues;
        eigen.min().max(0.0)
    }
}

/// Least first.
fn eigenvalues(mass_matrix: &JointMatrix<f64>) -> [f64; DOF] {
    let mut values: [f64; DOF] = SymmetricEigen::new(*mass_matrix).eigenvalues.into();
    values.sort_by(f64::total_cmp);
    values
}

fn condition(mass_matrix: &JointMatrix<f64>) -> f64 {
    let [least, .., greatest] = eigenvalues(mass_matrix);
    greatest / least
}

/// Least second moment of mass of a body as a share of their sum.
fn margin(inertia: &[f64; 6]) -> f64 {
    let [xx, xy, xz, yy, yz, zz] = *inertia;
    let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let half_trace = inertia.trace() / 2.0;
    let greatest = SymmetricEigen::new(inertia).eigenvalues.max();
    (half_trace - greatest) / half_trace
}
