//! One step of an arm whose joints have friction, stick, are elastic, or are held by
//! springs of the robot's own.

use controller_core::arm::ArmParameters;
use controller_core::joint::{JointMatrix, JointState, JointVector};

use super::actuators::Actuators;
use super::elastic::{Elastic, Elimination};
use super::factor::{Equations, Factor};
use super::friction::{Friction, FrictionLaw};
use super::impedance::Impedance;
use super::model::PlantModel;
use super::options::PlantOptions;
use super::stiction::{DryFriction, Stiction};

/// What lies between motor torque and links.
#[derive(Clone, Debug)]
pub(super) struct Drive {
    pub friction: DryFriction,
    /// Unless the joints are rigid.
    pub elastic: Option<Elastic>,
}

impl Drive {
    /// Rigid joints without friction.
    pub fn ideal() -> Self {
        Self {
            friction: DryFriction::None,
            elastic: None,
        }
    }

    /// Drive of `model` at rest at `q0` \[rad\], with the friction and size of the arm in
    /// `parameters` and what `options` ask for. The springs of elastic joints carry the
    /// arm's weight.
    pub fn realistic(
        parameters: &ArmParameters,
        model: &PlantModel,
        q0: &JointVector<f64>,
        options: &PlantOptions,
    ) -> Self {
        let law = FrictionLaw::of(parameters);
        let springs = || {
            let load = model.gravity_torque(q0);
            Elastic::new(&Actuators::of(parameters), q0, &load)
        };
        Self {
            friction: if options.stiction {
                DryFriction::Sticking(Stiction::new(law))
            } else {
                DryFriction::Smooth(law)
            },
            elastic: options.elasticity.then(springs),
        }
    }

    /// One step of `h` \[s\] with the torques `torque` of the motors and `pushed`
    /// of contacts \[Nm\]. The springs of `impedance` act on the motors. `equations` are those
    /// of the arm in `state`; they are used up.
    pub fn step(
        &mut self,
        equations: &mut Equations,
        state: &JointState<f64>,
        h: f64,
        torque: &JointVector<f64>,
        impedance: &Impedance,
        pushed: &JointVector<f64>,
    ) -> JointState<f64> {
        let motor = self.elastic.as_ref().map_or(*state, |e| e.motor);
        let before = motor.dq;
        let friction = impedance.resist(self.friction.explicit(&before), &motor, h);
        let motors = match &self.elastic {
            None => rigid(h, torque, &friction),
            Some(elastic) => elastic.eliminate(state, h, torque, &friction),
        };
        let load = motors.torque + pushed;
        let (ddq, inverse_pivots) = equations.solve_in_place(&load, &motors.armature);
        let mut dq = state.dq + ddq * h;
        let mut speed = motors.motor_speed(&dq);
        if let DryFriction::Sticking(stiction) = &mut self.friction {
            // At rest and weightless, accelerations are those that torques cause.
            let links = Factor::reduced(equations, inverse_pivots).inverse() * h;
            let response = JointMatrix::from_fn(|i, j| {
                let own = if i == j { motors.mobility[i] } else { 0.0 };
                own + motors.share[i] * links[(i, j)] * motors.share[j]
            });
            speed = stiction.solve(&response, &before, &speed);
            dq = match self.elastic {
                None => speed,
                Some(_) => dq - links * motors.share.component_mul(&stiction.torque),
            };
        }
        if let Some(elastic) = &mut self.elastic {
            elastic.accept(h, speed);
        }
        JointState {
            q: state.q + (state.dq + dq) * (0.5 * h),
            dq,
        }
    }
}

/// Motors that are one with their links and have no inertia of their own.
fn rigid(h: f64, torque: &JointVector<f64>, friction: &Friction) -> Elimination {
    Elimination {
        torque: torque - friction.torque,
        armature: friction.slope * h,
        share: JointVector::repeat(1.0),
        mobility: JointVector::zeros(),
        offset: JointVector::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::super::noise::{Rng, stream};
    use super::super::stiction::BREAK_AWAY;
    use super::*;
    use arms::LWR_IV;
    use controller_core::joint::DOF;

    const H: f64 = 0.25e-3;
    const POSTURE: [f64; DOF] = [0.2, 0.6, -0.3, -1.4, 0.4, 0.9, 0.1];
    const NONE: JointVector<f64> = controller_core::joint::zeros();

    fn drive(model: &PlantModel, q0: [f64; DOF], stiction: bool, elasticity: bool) -> Drive {
        let options = PlantOptions {
            stiction,
            elasticity,
            ..PlantOptions::default()
        };
        Drive::realistic(&LWR_IV, model, &q0.into(), &options)
    }

    fn law() -> FrictionLaw {
        FrictionLaw::of(&LWR_IV)
    }

    fn at_rest(q: [f64; DOF]) -> JointState<f64> {
        JointState {
            q: q.into(),
            dq: NONE,
        }
    }

    /// One step without contacts and springs of the robot.
    fn step(
        drive: &mut Drive,
        model: &PlantModel,
        state: &JointState<f64>,
        h: f64,
        torque: &JointVector<f64>,
    ) -> JointState<f64> {
        let mut equations = model.equations(&state.q, &state.dq);
        drive.step(&mut equations, state, h, torque, &Impedance::NONE, &NONE)
    }

    /// One number in -1 to 1 per joint.
    fn random(rng: &mut Rng) -> JointVector<f64> {
        JointVector::from_fn(|_, _| 2.0 * rng.uniform() - 1.0)
    }

    #[test]
    fn a_joint_at_rest_stays_exactly_at_rest_below_break_away() {
        let model = PlantModel::new(&LWR_IV);
        let mut rng = Rng::new(1, stream::TORQUE);
        for elastic in [false, true] {
            let mut drive = drive(&model, POSTURE, true, elastic);
            let start = at_rest(POSTURE);
            let motors = drive.elastic.as_ref().map(|elastic| elastic.motor);
            let weight = model.gravity_torque(&start.q);
            let mut state = start;
            for _ in 0..2000 {
                // Another torque every step, up to 1 % from the level.
                let push = random(&mut rng).component_mul(&law().coulomb) * (0.99 * BREAK_AWAY);
                state = step(&mut drive, &model, &state, H, &(weight + push));
                match (&drive.elastic, motors) {
                    (Some(elastic), Some(motors)) => assert_eq!(elastic.motor, motors),
                    _ => assert_eq!(state, start),
                }
            }
            // The springs of held motors carry the weight: rounding only.
            assert!((state.q - start.q).amax() < 1e-12);
        }
    }

    #[test]
    fn a_joint_breaks_away_above_its_level_and_slides_below_it() {
        let model = PlantModel::new(&LWR_IV);
        for joint in 0..DOF {
            let run = |first: f64, then: f64| {
                let mut drive = drive(&model, POSTURE, true, false);
                let mut state = at_rest(POSTURE);
                for n in 0..40 {
                    let mut torque = model.gravity_torque(&state.q);
                    torque[joint] += law().coulomb[joint] * if n == 0 { first } else { then };
                    state = step(&mut drive, &model, &state, H, &torque);
                }
                state.dq[joint]
            };
            assert_eq!(run(0.99 * BREAK_AWAY, 0.99 * BREAK_AWAY), 0.0);
            assert!(run(1.01 * BREAK_AWAY, 1.01 * BREAK_AWAY) > 0.0);
            // Between the levels, what slides goes on and what sticks stays.
            assert!(run(1.5 * BREAK_AWAY, 1.1) > 0.0);
            assert_eq!(run(1.1, 1.1), 0.0);
        }
    }

    #[test]
    fn one_joint_slides_to_its_stop_as_in_closed_form() {
        // Joint 7 turns about an axis of symmetry of its link and the others
        // stick: I dv/dt = -F_c - F_v v, which ends at a known time.
        let model = PlantModel::new(&LWR_IV).weightless();
        let mut state = at_rest(POSTURE);
        state.dq[6] = 2.0;
        let inertia = 2.0 * model.kinetic_energy(&state) / 4.0;
        let (dry, viscous) = (law().coulomb[6], law().viscous[6]);
        let expected = inertia / viscous * libm::log(1.0 + viscous * 2.0 / dry);
        let time = |h: f64| {
            let (mut drive, mut state) = (drive(&model, POSTURE, true, false), state);
            let mut steps = 0;
            while state.dq[6] != 0.0 {
                state = step(&mut drive, &model, &state, h, &NONE);
                steps += 1;
                assert_eq!(state.dq.rows(0, 6).amax(), 0.0);
            }
            f64::from(steps) * h
        };
        // Counted in whole steps, and of first order in the viscous part.
        for h in [H, 1e-5, 1e-6] {
            let error = time(h) - expected;
            assert!(error.abs() < 1.5 * h, "{h}: {error:e} of {expected:e}");
        }
    }

    #[test]
    fn the_sweeps_find_the_friction() {
        let model = PlantModel::new(&LWR_IV);
        // The second posture is stretched, with aligned axes.
        for posture in [POSTURE, [0.0; DOF]] {
            for elastic in [false, true] {
                let mut drive = drive(&model, posture, true, elastic);
                let mut state = at_rest(posture);
                let (mut worst, mut stuck, mut slid) = (0.0f64, 0, 0);
                for n in 0..40_000 {
                    let t = f64::from(n / 8) * 8.0 * H;
                    let sway = JointVector::from_fn(|i, _| {
                        1.6 * law().coulomb[i] * libm::sin((3.0 + 0.7 * i as f64) * t)
                    });
                    let back = (state.q - JointVector::from(posture)) * 0.5;
                    let torque = model.gravity_torque(&state.q) + sway - back;
                    state = step(&mut drive, &model, &state, H, &torque);
                    let DryFriction::Sticking(stiction) = &drive.friction else {
                        panic!("on");
                    };
                    worst = worst.max(stiction.residual);
                    let moving = drive.elastic.as_ref().map_or(state.dq, |e| e.motor.dq);
                    let still = moving.iter().filter(|&&speed| speed == 0.0).count();
                    (stuck, slid) = (stuck + still, slid + DOF - still);
                }
                assert!(stuck > 50_000 && slid > 50_000);
                // 1/500 of the weakest joint's friction.
                assert!(worst < 1e-4, "{worst:e}");
            }
        }
    }

    /// Kinetic energy of links and motors, energy of springs and of height.
    fn energy(model: &PlantModel, drive: &Drive, state: &JointState<f64>) -> f64 {
        let motors = drive.elastic.as_ref().map_or(0.0, |elastic| {
            let drawn = elastic.motor.q - state.q;
            let speed = elastic.motor.dq;
            drawn.component_mul(&drawn).dot(&elastic.stiffness)
                + speed.component_mul(&speed).dot(&elastic.inertia)
        });
        model.kinetic_energy(state) + model.potential_energy(&state.q) + 0.5 * motors
    }

    #[test]
    fn energy_only_falls() {
        let model = PlantModel::new(&LWR_IV).weightless();
        let mut rng = Rng::new(2, stream::TORQUE);
        for (stiction, elastic) in [(true, false), (false, true), (true, true)] {
            for _ in 0..20 {
                let mut drive = drive(&model, POSTURE, stiction, elastic);
                let mut state = at_rest(POSTURE);
                state.dq = random(&mut rng);
                if let Some(elastic) = &mut drive.elastic {
                    elastic.motor.dq = random(&mut rng);
                    elastic.motor.q += random(&mut rng) * 1e-2;
                }
                let start = energy(&model, &drive, &state);
                let (mut last, mut rise) = (start, 0.0f64);
                for _ in 0..8000 {
                    state = step(&mut drive, &model, &state, H, &NONE);
                    let now = energy(&model, &drive, &state);
                    rise = rise.max((now - last) / start);
                    last = now;
                }
                // Springs between motors that stick may keep a little.
                assert!(rise < 1e-15 && last < 1e-4 * start, "{rise:e} {last:e}");
            }
        }
    }

    #[test]
    fn a_joint_whose_neighbours_are_locked_has_the_resonance_of_two_masses() {
        let model = PlantModel::new(&LWR_IV).weightless();
        for joint in 0..DOF {
            let mut drive = drive(&model, POSTURE, false, true);
            let elastic = drive.elastic.as_mut().expect("on");
            // Immovable motors and springs of steel hold the others.
            for other in (0..DOF).filter(|&other| other != joint) {
                (elastic.stiffness[other], elastic.inertia[other]) = (1e12, 1e12);
            }
            elastic.damping.fill(0.0);
            // A large swing, beside which friction is small.
            elastic.motor.q[joint] += 0.2;
            let (stiffness, motor) = (elastic.stiffness[joint], elastic.inertia[joint]);
            let mut state = at_rest(POSTURE);
            state.dq[joint] = 1.0;
            let link = 2.0 * model.kinetic_energy(&state);
            state.dq[joint] = 0.0;
            let expected = (stiffness * (1.0 / link + 1.0 / motor)).sqrt();

            let h = 1e-5;
            let drawn = |drive: &Drive, state: &JointState<f64>| {
                drive.elastic.as_ref().expect("on").motor.q[joint] - state.q[joint]
            };
            // Half periods between changes of sign, placed by interpolation.
            let (mut crossings, mut last) = (Vec::new(), drawn(&drive, &state));
            let mut n = 0;
            while crossings.len() < 11 {
                state = step(&mut drive, &model, &state, h, &NONE);
                let now = drawn(&drive, &state);
                if now * last <= 0.0 {
                    crossings.push((f64::from(n) + last / (last - now)) * h);
                }
                (last, n) = (now, n + 1);
            }
            let found = 10.0 * core::f64::consts::PI / (crossings[10] - crossings[0]);
            // Friction, and neighbours that yield a little.
            assert!((found / expected - 1.0).abs() < 1e-3, "{found} {expected}");
        }
    }

    #[test]
    fn a_stiff_spring_is_a_rigid_joint() {
        let model = PlantModel::new(&LWR_IV);
        // From equilibrium on, without a jump that would make the springs ring.
        let weight = model.gravity_torque(&POSTURE.into());
        let sway = JointVector::from([4.0, 3.0, 1.5, 3.0, 0.8, 0.5, 0.1]);
        let torque = |t: f64| weight + sway * libm::sin(9.0 * t);
        // One body of link and motor, by the same kind of step.
        let mut rigid = at_rest(POSTURE);
        for n in 0..2000 {
            let friction = law().at(&rigid.dq);
            let armature = friction.slope * H + Actuators::of(&LWR_IV).motor_inertia;
            let load = torque(f64::from(n) * H) - friction.torque;
            let dq = rigid.dq + model.forward_dynamics(&rigid.q, &rigid.dq, &load, &armature) * H;
            rigid.q += (rigid.dq + dq) * (0.5 * H);
            rigid.dq = dq;
        }
        let difference = |stiffer: f64| {
            let mut drive = drive(&model, POSTURE, false, true);
            let elastic = drive.elastic.as_mut().expect("on");
            let load =
                (elastic.motor.q - JointVector::from(POSTURE)).component_mul(&elastic.stiffness);
            elastic.stiffness *= stiffer;
            elastic.damping *= stiffer.sqrt();
            elastic.motor.q = JointVector::from(POSTURE) + load.component_div(&elastic.stiffness);
            let mut state = at_rest(POSTURE);
            for n in 0..2000 {
                state = step(&mut drive, &model, &state, H, &torque(f64::from(n) * H));
            }
            (state.q - rigid.q).amax()
        };
        let moved = (rigid.q - JointVector::from(POSTURE)).amax();
        assert!(moved > 0.3, "{moved}");
        // The deflection, and with it the difference, goes with 1 / K.
        let found = [1.0, 10.0, 100.0, 1e3, 1e4].map(difference);
        for pair in found.windows(2) {
            assert!((9.0..11.0).contains(&(pair[0] / pair[1])), "{found:?}");
        }
        assert!(found[4] < 1e-6 * moved, "{found:?}");
    }
}
