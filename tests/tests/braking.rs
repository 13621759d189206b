//! What happens to the arm behind a fault, and the limit on the rate of its torque, against
//! closed forms on the ideal plant.

use arms::LWR_IV;
use cell::names::PlantKind;
use controller_core::fault::{Fault, Mode, Quantity};
use controller_core::joint::{JointState, JointVector, zeros};
use controller_core::ranges::{BLIND_FADE_S, BRAKE_RATE, POSITION_MARGIN, RESTING_SPEED};
use controller_core::{Controller, Measurement, Reference, State, Step, Target};
use hil_sim::plant::Plant;
use stratum_tests::config::two_level;
use stratum_tests::{controller, evaluate, lwr};

const CYCLE_S: f64 = 0.002;
const POSTURE: [f64; 7] = [0.1, 0.6, -0.2, -1.4, 0.3, 1.0, 0.4];

fn measured(q: JointVector<f64>, dq: JointVector<f64>) -> Measurement<f64> {
    Measurement {
        q,
        dq,
        interval_s: CYCLE_S,
    }
}

/// Controller and plant, and a reference that is refused.
struct Braked {
    controller: Controller<f64>,
    state: State<f64>,
    plant: Plant,
    t_s: f64,
}

impl Braked {
    fn new(q: JointVector<f64>) -> Self {
        Self {
            controller: controller(&two_level()),
            state: State::new(),
            plant: Plant::new(PlantKind::Ideal, &LWR_IV, q, CYCLE_S, 1),
            t_s: 0.0,
        }
    }

    fn reference(&self) -> Reference<f64> {
        Reference::new([Target::position([f64::NAN; 3])], self.plant.state().q)
    }

    fn cycle(&mut self) -> Step<f64> {
        let JointState { q, dq } = *self.plant.state();
        let reference = self.reference();
        let step = self
            .controller
            .step(&mut self.state, &measured(q, dq), &reference);
        self.plant
            .advance(self.t_s, &step.torque, |_, _, _| zeros());
        self.t_s += CYCLE_S;
        step
    }

    /// An arm that falls for a tenth of a second, to some rad/s.
    fn falling() -> Self {
        let mut braked = Self::new(POSTURE.into());
        for _ in 0..50 {
            braked
                .plant
                .advance(braked.t_s, &zeros(), |_, _, _| zeros());
            braked.t_s += CYCLE_S;
        }
        braked
    }
}

/// g(q) - c M dq of the measured state, from the first faulty cycle on; dq decays with c, so
/// every joint goes on by about dq / c and rests after ln(|dq| / 0.02) / c.
#[test]
fn an_arm_that_moves_is_braked_until_it_rests() {
    let mut braked = Braked::falling();
    let start = *braked.plant.state();
    let (mut modes, mut rested) = (vec![], None);
    for cycle in 0..300 {
        let seen = *braked.plant.state();
        let dynamics = evaluate(&lwr(), &seen).1;
        let step = braked.cycle();
        let wanted = dynamics.gravity - dynamics.mass_matrix * seen.dq * BRAKE_RATE;
        let wanted = JointVector::from_fn(|i, _| {
            let limit = LWR_IV.links[i].torque_limit;
            wanted[i].clamp(-limit, limit)
        });
        assert!((step.torque - wanted).amax() < 1e-11, "{cycle}");
        assert!((step.gravity - dynamics.gravity).amax() < 1e-12);
        assert_eq!(
            step.status.fault.map(|fault| fault.quantity),
            Some(Quantity::TargetDistance)
        );
        if modes.last() != Some(&step.status.mode) {
            modes.push(step.status.mode);
        }
        if rested.is_none() && seen.dq.amax() < RESTING_SPEED {
            rested = Some(f64::from(cycle) * CYCLE_S);
        }
    }
    let (speed, travel) = (start.dq.amax(), (braked.plant.state().q - start.q).amax());
    let rest_s = rested.expect("at rest");
    println!("{speed:.2} rad/s: at rest after {rest_s} s and {travel:.3} rad");
    assert!(speed > 1.0);
    assert_eq!(modes, [Mode::Braking, Mode::Resting]);
    // Sampled, the decay of a cycle is 1 - h c instead of exp(-h c).
    assert!(rest_s < 1.1 * (speed / RESTING_SPEED).ln() / BRAKE_RATE);
    assert!(travel < 1.1 * speed / BRAKE_RATE);
}

/// Beyond what is believed a position may still be true: an arm that got there is braked.
/// One that jumped is not followed.
#[test]
fn a_fault_that_is_true_is_followed_and_a_jump_is_not() {
    let controller = controller::<f64>(&two_level());
    let beyond = |by: f64| {
        let mut q = JointVector::from(POSTURE);
        q[6] = LWR_IV.links[6].position_range[1] + POSITION_MARGIN + by;
        q
    };
    let hold = Reference::hold(1, POSTURE);
    let dq = JointVector::from([0.1, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0]);
    let fault = |state: &mut State<f64>, q| controller.step(state, &measured(q, dq), &hold);

    let mut state = State::new();
    assert!(fault(&mut state, beyond(-1e-3)).status.fault.is_none());
    let step = fault(&mut state, beyond(3e-3));
    let found = step.status.fault.map(
        |Fault {
             quantity, index, ..
         }| (quantity, index),
    );
    assert_eq!(
        (step.status.mode, found),
        (Mode::Braking, Some((Quantity::Position, 7)))
    );

    let mut state = State::new();
    let mut near = beyond(-0.5);
    near[0] = 0.0;
    assert!(fault(&mut state, near).status.fault.is_none());
    let step = fault(&mut state, beyond(0.5));
    assert_eq!(step.status.mode, Mode::Blind);
    // Back where the arm can be: seen again.
    near[6] += dq[6] * CYCLE_S;
    assert_eq!(fault(&mut state, near).status.mode, Mode::Braking);
}

/// The last believed gravity torque fades evenly; at its end nothing but a reset leads out.
#[test]
fn a_blind_arm_is_let_go_over_a_stated_time() {
    let controller = controller::<f64>(&two_level());
    let q = JointVector::from(POSTURE);
    let hold = Reference::hold(1, q);
    let (good, bad) = (measured(q, zeros()), measured(q * f64::NAN, zeros()));
    let mut state = State::new();
    let gravity = controller.step(&mut state, &good, &hold).gravity;
    let cycles = (BLIND_FADE_S / CYCLE_S).round() as i32;
    for cycle in 1..=cycles + 50 {
        let step = controller.step(&mut state, &bad, &hold);
        let left = (1.0 - f64::from(cycle) * CYCLE_S / BLIND_FADE_S).max(0.0);
        // Rounding of a sum of 250 intervals.
        assert!((step.torque - gravity * left).amax() < 1e-11, "{cycle}");
        // A robot that adds gravity itself goes on doing so.
        assert_eq!(step.gravity, step.torque);
        let ended = if cycle < cycles {
            Mode::Blind
        } else {
            Mode::Stopped
        };
        // The last cycle of the sum may round to either side.
        assert!(cycle == cycles || step.status.mode == ended, "{cycle}");
    }
    let step = controller.step(&mut state, &good, &hold);
    assert_eq!((step.status.mode, step.torque), (Mode::Stopped, zeros()));
    state.reset();
    let step = controller.step(&mut state, &good, &hold);
    // The torque starts from none, 1e4 Nm/s at most.
    assert_eq!(
        (step.status.mode, step.torque[1]),
        (Mode::Limited, gravity[1].signum() * 20.0)
    );

    // Nothing was ever seen: nothing is known to hold by.
    let step = controller.step(&mut State::new(), &bad, &hold);
    assert_eq!((step.status.mode, step.torque), (Mode::Blind, zeros()));
}

/// A demand that flips by some hundred Nm, on an arm with this rate limit
/// \[Nm/s\]: cycles limited, largest residual \[Nm\].
fn flipping(rate_limit: f64, cycles: i32) -> (u32, f64) {
    let mut arm = LWR_IV;
    for link in &mut arm.links {
        link.torque_rate_limit = rate_limit;
    }
    let controller = Controller::<f64>::exact(&arm, &two_level()).expect("valid");
    let mut plant = Plant::new(PlantKind::Ideal, &LWR_IV, POSTURE.into(), CYCLE_S, 1);
    let mut state = State::new();
    let rest = controller.rest_reference(&POSTURE.into());
    let (mut last, mut residual) = (None, 0.0f64);
    for cycle in 0..cycles {
        let JointState { q, dq } = *plant.state();
        let mut reference = rest.clone();
        if let Target::Position { ddx, .. } = &mut reference.targets_mut()[0]
            && cycle > 0
        {
            ddx[0] = if cycle / 10 % 2 == 0 { 40.0 } else { -40.0 };
        }
        let step = controller.step(&mut state, &measured(q, dq), &reference);
        assert!(step.status.fault.is_none());
        if let Some(last) = last {
            let change: JointVector<f64> = step.torque - last;
            assert!(change.amax() <= rate_limit * CYCLE_S + 1e-12);
            residual = residual.max(step.residual.amax());
        }
        last = Some(step.torque);
        plant.advance(f64::from(cycle) * CYCLE_S, &step.torque, |_, _, _| zeros());
    }
    (state.rate_limited_cycles(), residual)
}

/// The observer gets the torque that leaves the limiter: on an exact model what is left of
/// the residual is that gravity changes within a cycle. That is nothing where the limit
/// is so tight that the arm hardly moves, and some mNm where it is shaken; the torque that
/// was cut off would be some hundred Nm.
#[test]
fn a_limited_rate_is_known_to_the_observer() {
    let (limited, residual) = flipping(1e-4, 20);
    println!("tight: {limited} limited cycles, residual {residual:.1e} Nm");
    assert!(limited == 19 && residual < 1e-9, "{residual:e}");
    let (limited, residual) = flipping(1e4, 200);
    println!("shaken: {limited} limited cycles, residual {residual:.1e} Nm");
    assert!(limited > 20 && residual < 0.01, "{residual:e}");
}
