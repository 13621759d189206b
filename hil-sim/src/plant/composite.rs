//! Equations of motion by composite rigid bodies: accelerations and forces for ddq = 0
//! (Newton and Euler) from base to flange, then composite inertias and the columns of M from
//! flange to base.
//!
//! Everything of a link is in its joint frame ([`super::segment`]).

use controller_core::joint::{DOF, JointVector};
use controller_core::real::Real;

use super::factor::{BIAS, Equations, LANES};
use super::model::PlantModel;
use super::segment::{
    LEFT, LEFT_WITH_LENGTH, Moments, OBLIQUE_WITH_LENGTH, Pair, RIGHT, RIGHT_WITH_LENGTH, STRAIGHT,
    Segment, WITH_LENGTH, by_way, difference, sum, times,
};

/// Motion of a link without joint accelerations.
#[derive(Clone, Copy)]
struct Motion {
    /// Angular velocity \[rad/s\].
    spin: [f64; 3],
    /// Angular acceleration \[rad/s2\].
    turn: [f64; 3],
    /// Acceleration of the joint frame's origin \[m/s2\], gravity taken as a base that
    /// accelerates upwards.
    linear: [f64; 3],
}

/// Acceleration per position, `[turn]x + spin spin^T - |spin|^2`, by rows \[1/s2\].
type Gradient = [[f64; 3]; 3];

/// Two wrenches: moments about the origin of a joint frame and forces, in its axes.
#[derive(Clone, Copy)]
struct Wrenches {
    moment: [Pair; 3],
    force: [Pair; 3],
}

impl Motion {
    /// In the next joint frame, whose joint stands still at an angle with this sine and cosine.
    #[inline(always)]
    fn carried<const WAY: u8>(
        &self,
        from: &Segment,
        gradient: &Gradient,
        (sine, cosine): (f64, f64),
    ) -> Self {
        let (a, d) = (from.a, from.d);
        let mut linear = self.linear;
        for (entry, row) in linear.iter_mut().zip(gradient) {
            *entry += row[2] * d;
            if WAY & WITH_LENGTH != 0 {
                *entry += row[0] * a;
            }
        }
        let turned = |v| {
            let [x, y, z] = from.untwisted::<WAY>(v);
            [x * cosine + y * sine, y * cosine - x * sine, z]
        };
        Self {
            spin: turned(self.spin),
            turn: turned(self.turn),
            linear: turned(linear),
        }
    }

    /// With the joint's own speed \[rad/s\].
    #[inline(always)]
    fn spun(mut self, speed: f64) -> Self {
        let [x, y, _] = self.spin;
        self.turn[0] += y * speed;
        self.turn[1] -= x * speed;
        self.spin[2] += speed;
        self
    }

    /// Moment and force that a link takes to move as told: of the integrals of
    /// p x (linear + gradient p) dm and of (linear + gradient p) dm.
    #[inline(always)]
    fn inertial(&self, gradient: &Gradient, body: &Moments) -> ([f64; 3], [f64; 3]) {
        let [lx, ly, lz] = self.linear;
        let [hx, hy, _] = body.first;
        let [sxx, sxy, sxz, syy, syz, _] = body.second;
        let [gx, gy, gz] = gradient;
        let moment = [
            (hy * lz + gz[1] * syy) + (gz[0] * sxy - gy[0] * sxz) + (gz[2] - gy[1]) * syz,
            (gx[1] * syz - gz[1] * sxy) - (hx * lz + gz[0] * sxx) + (gx[0] - gz[2]) * sxz,
            (hx * ly - hy * lx)
                + (gy[2] * sxz - gx[2] * syz)
                + (gy[0] * sxx - gx[1] * syy)
                + (gy[1] - gx[0]) * sxy,
        ];
        let force = |row: &[f64; 3]| row[0] * hx + row[1] * hy;
        (moment, [force(gx), force(gy), force(gz)])
    }

    #[inline(always)]
    fn gradient(&self) -> Gradient {
        let ([wx, wy, wz], [ax, ay, az]) = (self.spin, self.turn);
        let (xx, yy, zz) = (wx * wx, wy * wy, wz * wz);
        let (xy, xz, yz) = (wx * wy, wx * wz, wy * wz);
        [
            [-(yy + zz), xy - az, xz + ay],
            [xy + az, -(xx + zz), yz - ax],
            [xz - ay, yz + ax, -(xx + yy)],
        ]
    }
}

impl Wrenches {
    const NONE: Self = Self {
        moment: [[0.0; 2]; 3],
        force: [[0.0; 2]; 3],
    };

    /// In the previous joint frame, that of `to`; sine and cosine of the joint between.
    #[inline(always)]
    fn carried<const WAY: u8>(&self, to: &Segment, (sine, cosine): (f64, f64)) -> Self {
        let turned = |[x, y, z]: [Pair; 3]| {
            to.twisted_pairs::<WAY>([
                difference(times(x, cosine), times(y, sine)),
                sum(times(x, sine), times(y, cosine)),
                z,
            ])
        };
        let force = turned(self.force);
        let mut moment = turned(self.moment);
        // The forces act at (a, 0, d).
        moment[0] = difference(moment[0], times(force[1], to.d));
        moment[1] = sum(moment[1], times(force[0], to.d));
        if WAY & WITH_LENGTH != 0 {
            moment[1] = difference(moment[1], times(force[2], to.a));
            moment[2] = sum(moment[2], times(force[1], to.a));
        }
        Self { moment, force }
    }
}

/// Everything that goes from joint to joint on the way in.
struct Inward {
    group: Moments,
    /// Of unit acceleration of joint k in lane k, of the motion without accelerations in the
    /// last one.
    wrenches: [Wrenches; LANES / 2],
}

impl Inward {
    /// In the joint frame of `to`; `joint` is the one between.
    #[inline(always)]
    fn carry<const WAY: u8>(&mut self, to: &Segment, angle: (f64, f64), joint: usize) {
        self.group = self.group.carried::<WAY>(to, angle).with(&to.body);
        for wrenches in &mut self.wrenches[joint / 2..] {
            *wrenches = wrenches.carried::<WAY>(to, angle);
        }
    }

    /// The same to the first joint, of which only moments about its axis count: those of all
    /// wrenches and its own inertia.
    #[inline(always)]
    fn end<const WAY: u8>(&self, to: &Segment, angle: (f64, f64)) -> ([Pair; LANES / 2], f64) {
        let mut moments = [[0.0; 2]; LANES / 2];
        for (moment, wrenches) in moments.iter_mut().zip(&self.wrenches) {
            *moment = wrenches.carried::<WAY>(to, angle).moment[2];
        }
        let group = self.group.carried::<WAY>(to, angle).with(&to.body);
        (moments, group.second[0] + group.second[3])
    }
}

impl PlantModel {
    /// M, and C dq + g, at posture `q` \[rad\] and speed `dq` \[rad/s\].
    #[must_use]
    pub fn equations(&self, q: &JointVector<f64>, dq: &JointVector<f64>) -> Equations {
        let mut equations = Equations::NONE;
        self.write_equations(q, dq, &mut equations);
        equations
    }

    pub(super) fn write_equations(
        &self,
        q: &JointVector<f64>,
        dq: &JointVector<f64>,
        equations: &mut Equations,
    ) {
        let segments = &self.segments;
        let angles = self.angles(q);

        let (sine, cosine) = angles[0];
        let [x, y, z] = (-self.base_gravity).into();
        let first = Motion {
            spin: [0.0, 0.0, dq[0]],
            turn: [0.0; 3],
            linear: [x * cosine + y * sine, y * cosine - x * sine, z],
        };
        // Nothing but the joint itself turns the first link.
        let square = dq[0] * dq[0];
        let mut gradient = [[-square, 0.0, 0.0], [0.0, -square, 0.0], [0.0; 3]];
        let mut motion = first;
        // Of the links behind the first one.
        let bias: [_; DOF - 1] = core::array::from_fn(|behind| {
            let (from, i) = (&segments[behind], behind + 1);
            motion = by_way!(from.way, motion.carried(from, &gradient, angles[i])).spun(dq[i]);
            gradient = motion.gradient();
            motion.inertial(&gradient, &segments[i].body)
        });

        let mut inward = Inward {
            group: Moments::NONE,
            wrenches: [Wrenches::NONE; LANES / 2],
        };
        for i in (1..DOF).rev() {
            let segment = &segments[i];
            match i + 1 {
                DOF => inward.group = segment.body,
                joint => by_way!(segment.way, inward.carry(segment, angles[joint], joint)),
            }
            let Inward { group, wrenches } = &mut inward;
            let (moment, force) = &bias[i - 1];
            let [hx, hy, _] = group.first;
            let [sxx, _, sxz, syy, syz, _] = group.second;
            let own = [-sxz, -syz, sxx + syy];
            let pull = [-hy, hx, 0.0];
            for axis in 0..3 {
                wrenches[BIAS / 2].moment[axis][BIAS % 2] += moment[axis];
                wrenches[BIAS / 2].force[axis][BIAS % 2] += force[axis];
                wrenches[i / 2].moment[axis][i % 2] = own[axis];
                wrenches[i / 2].force[axis][i % 2] = pull[axis];
            }
            let column = &mut equations.columns[i];
            for pair in i / 2..LANES / 2 {
                column[2 * pair..2 * pair + 2].copy_from_slice(&wrenches[pair].moment[2]);
            }
            column[i] += segment.rotor_inertia;
        }
        let segment = &segments[0];
        let (moments, own) = by_way!(segment.way, inward.end(segment, angles[1]));
        let column = &mut equations.columns[0];
        for (pair, moments) in moments.iter().enumerate() {
            column[2 * pair..2 * pair + 2].copy_from_slice(moments);
        }
        column[0] = own + segment.rotor_inertia;
        let ([hx, hy, _], [lx, ly, _]) = (segment.body.first, first.linear);
        column[BIAS] += hx * ly - hy * lx;
    }

    /// Sine and cosine of all DH angles.
    #[inline(always)]
    fn angles(&self, q: &JointVector<f64>) -> [(f64, f64); DOF] {
        // By eights side by side, which a compiler takes two by two.
        let mut sine = [0.0; LANES];
        let mut cosine = [0.0; LANES];
        for i in 0..DOF {
            sine[i] = self.links[i].dh_angle(q[i]);
        }
        for (sine, cosine) in sine.iter_mut().zip(&mut cosine) {
            (*sine, *cosine) = sine.sine_cosine();
        }
        core::array::from_fn(|i| (sine[i], cosine[i]))
    }

    /// Joint accelerations \[rad/s2\] at posture `q` \[rad\] and speed `dq`
    /// \[rad/s\]: solves (M + diag(armature)) ddq = torque - C dq - g; rotors are in M.
    ///
    /// `torque` \[Nm\] is everything along +q: motor minus friction plus J^T F of
    /// contact forces. `armature` \[kg m2\] is added to the diagonal of M: zero
    /// or h dF/d(dq) of friction treated implicitly over a
    /// step h.
    #[must_use]
    pub fn forward_dynamics(
        &self,
        q: &JointVector<f64>,
        dq: &JointVector<f64>,
        torque: &JointVector<f64>,
        armature: &JointVector<f64>,
    ) -> JointVector<f64> {
        let mut equations = Equations::NONE;
        self.write_equations(q, dq, &mut equations);
        equations.solve_in_place(torque, armature).0
    }
}

#[cfg(test)]
mod tests {
    use super::super::noise::{Rng, stream};
    use super::*;
    use arms::LWR_IV;
    use controller_core::arm::ArmParameters;
    use controller_core::joint::{JointMatrix, JointState};

    const NONE: JointVector<f64> = controller_core::joint::zeros();

    /// One number in -1 to 1 per joint.
    fn random(rng: &mut Rng) -> JointVector<f64> {
        JointVector::from_fn(|_, _| 2.0 * rng.uniform() - 1.0)
    }

    /// Every arm there is, and ones whose links have any length and twist.
    fn all_arms(rng: &mut Rng) -> Vec<ArmParameters> {
        let mut all: Vec<_> = arms::ALL.into_iter().copied().collect();
        for straight in [false, true] {
            for _ in 0..5 {
                let mut arm = LWR_IV;
                let (lengths, twists, angles) = (random(rng), random(rng), random(rng));
                for (i, link) in arm.links.iter_mut().enumerate() {
                    link.a = 0.3 * lengths[i];
                    link.alpha = if straight { 0.0 } else { 3.0 * twists[i] };
                    link.angle_offset = angles[i];
                }
                arm.gravity = [3.0, -2.0, -8.0];
                all.push(arm);
            }
        }
        all
    }

    /// Two ways that share neither axes nor method, in random postures, at random speeds, with
    /// and without armature.
    #[test]
    fn accelerations_are_those_of_the_articulated_bodies() {
        let mut rng = Rng::new(11, stream::TORQUE);
        for arm in all_arms(&mut rng) {
            let model = PlantModel::new(&arm);
            for n in 0..100 {
                let (q, dq) = (random(&mut rng) * 3.0, random(&mut rng) * 2.0);
                let torque = random(&mut rng) * 50.0;
                let share = f64::from(n % 2) * 0.1;
                let armature = random(&mut rng).map(|x| x.abs() * share);
                let found = model.forward_dynamics(&q, &dq, &torque, &armature);
                let expected = model.articulated_bodies(&q, &dq, &torque, &armature);
                let equations = model.equations(&q, &dq);
                // Sums of a hundred terms of the size of the torques, 1e-16 each; accelerations
                // are those through M^-1, so what is left of them is weighed as a torque.
                let bias = equations.bias();
                let inertia = equations.mass_matrix() + JointMatrix::from_diagonal(&armature);
                let scale = 1.0 + torque.amax() + bias.amax() + (inertia * expected).amax();
                let left = (inertia * (found - expected)).amax() / scale;
                assert!(left < 1e-13, "{left:e}");
                // M's condition number: up to 1e5.
                let error = (found - expected).amax() / (1.0 + expected.amax());
                assert!(error < 1e-10, "{error:e}");
            }
        }
    }

    #[test]
    fn equations_are_those_of_energies_and_weights() {
        let mut rng = Rng::new(12, stream::TORQUE);
        for arm in all_arms(&mut rng) {
            let model = PlantModel::new(&arm);
            for _ in 0..20 {
                let (q, dq) = (random(&mut rng) * 3.0, random(&mut rng) * 2.0);
                let equations = model.equations(&q, &dq);
                let mass_matrix = equations.mass_matrix();
                let energy = 0.5 * dq.dot(&(mass_matrix * dq));
                let expected = model.kinetic_energy(&JointState { q, dq });
                // Rounding of some hundred terms.
                assert!((energy - expected).abs() < 1e-13 * (1.0 + expected));
                let weight = model.equations(&q, &NONE).bias();
                assert!((weight - model.gravity_torque(&q)).amax() < 1e-12);
            }
        }
    }

    #[test]
    fn the_factor_solves_and_inverts() {
        let mut rng = Rng::new(13, stream::TORQUE);
        let model = PlantModel::new(&LWR_IV);
        for _ in 0..100 {
            let (q, dq) = (random(&mut rng) * 3.0, random(&mut rng));
            let armature = random(&mut rng).map(f64::abs);
            let equations = model.equations(&q, &dq);
            let inertia = equations.mass_matrix() + JointMatrix::from_diagonal(&armature);
            let factor = equations.factor(&armature);
            let torque = random(&mut rng) * 10.0;
            // Backward stable: what is left is rounding of the torques.
            assert!((inertia * factor.solve(&torque) - torque).amax() < 1e-12);
            let identity = inertia * factor.inverse();
            assert!((identity - JointMatrix::identity()).amax() < 1e-10);
            let found = equations.accelerations(&torque, &armature);
            assert!((inertia * found + equations.bias() - torque).amax() < 1e-11);
        }
    }
}
