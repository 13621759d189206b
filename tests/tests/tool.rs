//! Tasks on a tool, and a tool that is exchanged while the arm moves.

use std::cmp::Ordering;

use arms::{ALL, LWR_IV};
use controller_core::arm::{ArmParameters, Pose, Tool};
use controller_core::joint::{DOF, JointState, JointVector, Matrix3, Vector3};
use controller_core::law::null_space::{NullDamping, NullSpace};
use controller_core::task::orientation::{self, Quaternion};
use controller_core::{
    Axes, Controller, ControllerConfig, LinkFrame, Measurement, Reference, State, Step, Target,
    Task, TaskSet,
};
use hil_sim::plant::PlantModel;
use hil_sim::plant::noise::Rng;
use stratum_tests::config::{REFERENCE_GAINS, two_level, with_tasks};
use stratum_tests::golden::Worst;
use stratum_tests::oracle::closed_loop::{TWO_LEVEL_START, circle, posture};

/// Turned about all axes and set off; 1 kg.
const TOOL: Tool = Tool {
    pose: Pose {
        rotation: [[0.6, 0.0, 0.8], [0.64, 0.6, -0.48], [-0.48, 0.8, 0.36]],
        shift: [0.03, -0.02, 0.12],
    },
    mass: 1.0,
    com: [0.01, 0.0, 0.05],
    inertia: [0.002, 0.0, 0.0, 0.002, 0.0, 0.001],
};

/// An arm without a task of its own: damping c M is allowed on every arm.
fn config(tasks: &[Task]) -> ControllerConfig {
    let config = with_tasks(tasks);
    ControllerConfig {
        null_space: NullSpace {
            damping: NullDamping::Inertia(20.0),
            ..config.null_space
        },
        ..config
    }
}

/// States within the limits of an arm, of continuous joints within half a turn.
fn states(arm: &ArmParameters, count: usize) -> Vec<JointState<f64>> {
    let mut rng = Rng::new(6, 1);
    let mut one = || JointState {
        q: JointVector::from_fn(|i, _| {
            let [min, max] = arm.links[i].position_range.map(|end| end.clamp(-3.1, 3.1));
            min + (max - min) * rng.uniform()
        }),
        dq: JointVector::from_fn(|i, _| arm.links[i].speed_limit * (2.0 * rng.uniform() - 1.0)),
    };
    std::iter::repeat_with(&mut one).take(count).collect()
}

/// Where the plant sees the tool: its origin, and its axes by the ends of unit vectors.
fn seen(arm: &ArmParameters, q: &JointVector<f64>) -> (Vector3<f64>, Matrix3<f64>) {
    let plant = PlantModel::new(arm);
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let at = |point: [f64; 3]| {
        let in_link = arm.flange.place(TOOL.pose.place(point));
        plant.point(&state, DOF, &in_link.into()).0
    };
    let origin = at([0.0; 3]);
    let axes = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    (
        origin,
        Matrix3::from_columns(&axes.map(|end| at(end) - origin)),
    )
}

/// The references that keep a tool are where the plant sees it, of every arm.
#[test]
fn a_tool_is_tracked_where_it_is() {
    let mut worst = [Worst::new("tool point, m"), Worst::new("tool frame")];
    for arm in ALL {
        let controller = Controller::<f64>::new(
            &arm.with_tool(&TOOL),
            &config(&[
                Task::position(arm.tool_point(&TOOL), Axes::XYZ, REFERENCE_GAINS),
                Task::orientation(arm.tool_frame(&TOOL), Axes::XYZ, REFERENCE_GAINS),
            ]),
        );
        let controller = controller.expect(arm.name);
        for JointState { q, .. } in states(arm, 50) {
            let (origin, axes) = seen(arm, &q);
            let reference = controller.rest_reference(&q);
            let [Target::Position { x, .. }, Target::Orientation { q, .. }] = reference.targets()
            else {
                panic!("a position and an orientation");
            };
            worst[0].add((x - origin).amax());
            worst[1].add(orientation::chord(q, &orientation::of_rotation(&axes)).amax());
        }
    }
    // Rounding of sums of lengths of a metre, and of rotations of seven joints.
    for worst in worst {
        worst.within(1e-14);
    }
}

/// The flange turns with link 7, as the table turns it.
#[test]
fn the_flange_is_a_frame_of_its_own() {
    for arm in ALL {
        let bare = Tool {
            pose: Pose::IDENTITY,
            ..TOOL
        };
        assert_eq!(arm.flange_frame(), arm.tool_frame(&bare), "{}", arm.name);
    }
    let turned = ALL
        .iter()
        .filter(|arm| arm.flange.rotation != Pose::IDENTITY.rotation);
    assert!(turned.count() >= 3);
}

/// R_t = R_7 R_c tracks R_t,d exactly where R_7 tracks R_t,d R_c^-1: the error of both is
/// that of one rotation in base-plate axes, about any axes. So is their torque.
#[test]
fn a_turned_frame_costs_the_torque_of_its_link() {
    let mut worst = Worst::new("torque of the tool's frame, of the link's");
    for (arm, axes) in ALL
        .iter()
        .zip([Axes::XYZ, Axes::XY, Axes::Z].iter().cycle())
    {
        let frame = arm.tool_frame(&TOOL);
        let controllers = [frame, frame.link.frame()].map(|frame| {
            let task = Task::orientation(frame, *axes, REFERENCE_GAINS);
            Controller::<f64>::new(arm, &config(&[task])).expect(arm.name)
        });
        let turn = orientation::of_rotation(&Matrix3::from(frame.rotation).transpose());
        let back = Quaternion::from([turn[0], -turn[1], -turn[2], -turn[3]]);
        for state in states(arm, 20) {
            let off = Vector3::new(0.2, -0.1, 0.3);
            let torques = [&controllers[0], &controllers[1]].map(|controller| {
                let mut reference = controllers[0].rest_reference(&state.q);
                for target in reference.targets_mut() {
                    let Target::Orientation { q, w, dw } = target else {
                        panic!("an orientation");
                    };
                    *q = orientation::turned(q, &off);
                    (*w, *dw) = (off, -off);
                    if std::ptr::eq(controller, &controllers[1]) {
                        *q = orientation::product(q, &back);
                    }
                }
                let measurement = Measurement {
                    q: state.q,
                    dq: state.dq,
                    interval_s: 0.002,
                };
                let mut fresh = State::new();
                fresh.follow_at_once();
                let step = controller.step(&mut fresh, &measurement, &reference);
                assert!(step.status.fault.is_none(), "{}", arm.name);
                fresh.data().demand.0
            });
            let [one, other] = torques;
            worst.add((one - other).amax() / other.amax().max(1.0));
        }
    }
    // Rounding of an error of 0.4 times K_p, through task inertias that reach 1e3 times the
    // mean near singular postures.
    worst.within(1e-11);
}

#[test]
fn a_frame_that_is_none_is_refused() {
    let line = |change: fn(&mut LinkFrame)| {
        let mut frame = LWR_IV.tool_frame(&TOOL);
        change(&mut frame);
        let task = Task::orientation(frame, Axes::XYZ, REFERENCE_GAINS);
        let error = TaskSet::new(&[task]).expect_err("no frame");
        error.to_string()
    };
    // An axis with five digits.
    let cut = line(|frame| frame.rotation[0][2] += 1e-6);
    assert!(cut.ends_with("e-6; allowed 0 to 1e-9"), "{cut}");
    assert_eq!(
        line(|frame| frame.rotation[1] = frame.rotation[1].map(|entry| -entry)),
        "level 1: rotation of the frame is distorted by 2e0; allowed 0 to 1e-9"
    );
    for value in [f64::NAN, f64::INFINITY] {
        let mut frame = LWR_IV.flange_frame();
        frame.rotation[2][1] = value;
        let task = Task::orientation(frame, Axes::XYZ, REFERENCE_GAINS);
        let error = TaskSet::new(&[task]).expect_err("no frame");
        assert!(
            error.to_string().ends_with("; allowed 0 to 1e-9"),
            "{error}"
        );
    }
}

/// A load that is gripped on the way: it has the speed of the tool already, so that nothing
/// pushes the arm.
const LOAD: Tool = Tool {
    pose: Pose::at([0.0, 0.0, 0.1]),
    ..TOOL
};
const CYCLE_S: f64 = 0.002;

/// One cycle of the plant by Runge-Kutta steps of 0.5 ms.
fn advance(plant: &PlantModel, state: &mut JointState<f64>, torque: &JointVector<f64>) {
    let none = JointVector::zeros();
    let h = CYCLE_S / 4.0;
    let rate = |s: &JointState<f64>| JointState {
        q: s.dq,
        dq: plant.articulated_bodies(&s.q, &s.dq, torque, &none),
    };
    let moved = |from: &JointState<f64>, rate: &JointState<f64>, h: f64| JointState {
        q: from.q + rate.q * h,
        dq: from.dq + rate.dq * h,
    };
    for _ in 0..4 {
        let k1 = rate(state);
        let k2 = rate(&moved(state, &k1, 0.5 * h));
        let k3 = rate(&moved(state, &k2, 0.5 * h));
        let k4 = rate(&moved(state, &k3, h));
        for (k, weight) in [(k1, 1.0), (k2, 2.0), (k3, 2.0), (k4, 1.0)] {
            *state = moved(state, &k, weight * h / 6.0);
        }
    }
}

/// Acceleration of the flange \[m/s2\] under `torque`, by differences of its velocity.
fn flange_acceleration(
    plant: &PlantModel,
    state: &JointState<f64>,
    torque: &JointVector<f64>,
) -> Vector3<f64> {
    let ddq = plant.articulated_bodies(&state.q, &state.dq, torque, &JointVector::zeros());
    // Rounding of a velocity of 0.2 m/s over 0.2 ms: 1e-12 m/s2; truncation less than 1e-6.
    let h = 1e-4;
    let velocity = |h: f64| {
        let state = JointState {
            q: state.q + state.dq * h,
            dq: state.dq + ddq * h,
        };
        plant.point(&state, DOF, &LWR_IV.flange.shift.into()).1
    };
    (velocity(h) - velocity(-h)) / (2.0 * h)
}

/// What happens in the cycle in which the load is there, before and behind it.
struct Exchange {
    /// Largest change of r from cycle to cycle \[Nm\]: before, in that cycle, behind.
    residual: [f64; 3],
    /// Step of the torque in that cycle \[Nm\].
    torque: JointVector<f64>,
    /// What the load weighs then \[Nm\], by the plant.
    weight: JointVector<f64>,
    /// Step of the flange's acceleration in that cycle, and the largest from cycle to cycle
    /// before \[m/s2\], by the plant.
    acceleration: [f64; 2],
    /// Largest |dq| then \[rad/s\].
    speed: f64,
}

/// The circle of the experiments at twice their speed, 0.1 m in 3 s; the load is there from 4 s on. `anew`: with
/// [`State::resume_after_gap`].
fn exchange(anew: bool) -> Exchange {
    const EXCHANGED: u32 = 2_000;
    let arms = [LWR_IV, LWR_IV.with_tool(&LOAD)];
    let controllers = arms.each_ref().map(|arm| {
        Controller::<f64>::new(arm, &two_level()).expect("a load slows the modes of the damping")
    });
    let plants = arms.each_ref().map(PlantModel::new);
    let q0 = posture(TWO_LEVEL_START);
    let mut truth = JointState {
        q: q0,
        dq: JointVector::zeros(),
    };
    let [Target::Position { x: origin, .. }] = *controllers[0].rest_reference(&q0).targets() else {
        panic!("a position");
    };
    let mut state = State::new();
    let mut last: Option<(Step<f64>, Vector3<f64>)> = None;
    let mut seen = Exchange {
        residual: [0.0; 3],
        torque: JointVector::zeros(),
        weight: JointVector::zeros(),
        acceleration: [0.0; 2],
        speed: 0.0,
    };
    for cycle in 0..EXCHANGED + 500 {
        let loaded = usize::from(cycle >= EXCHANGED);
        if cycle == EXCHANGED && anew {
            state.resume_after_gap();
        }
        let measurement = Measurement {
            q: truth.q,
            dq: truth.dq,
            interval_s: CYCLE_S,
        };
        let target = circle(0.1, 3.0).sample(&origin, f64::from(cycle) * CYCLE_S);
        let reference = Reference::new([target], q0);
        let step = controllers[loaded].step(&mut state, &measurement, &reference);
        assert!(step.status.is_clear(), "{:?}", step.status);
        let acceleration = flange_acceleration(&plants[loaded], &truth, &step.torque);
        if let Some((last, acceleration_before)) = last {
            let torque = step.torque - last.torque;
            let step_of_acceleration = (acceleration - acceleration_before).amax();
            let phase = match cycle.cmp(&EXCHANGED) {
                Ordering::Less => 0,
                Ordering::Equal => 1,
                Ordering::Greater => 2,
            };
            let jump = (step.residual - last.residual).amax();
            seen.residual[phase] = jump.max(seen.residual[phase]);
            match phase {
                0 => seen.acceleration[1] = step_of_acceleration.max(seen.acceleration[1]),
                1 => {
                    let [bare, loaded] = plants.each_ref().map(|arm| arm.gravity_torque(&truth.q));
                    (seen.torque, seen.weight) = (torque, loaded - bare);
                    seen.acceleration[0] = step_of_acceleration;
                    seen.speed = truth.dq.amax();
                }
                _ => {}
            }
        }
        last = Some((step, acceleration));
        advance(&plants[loaded], &mut truth, &step.torque);
    }
    seen
}

/// The plant takes the load in the cycle in which the controller is exchanged.
#[test]
fn a_load_taken_on_the_way_is_no_external_torque() {
    let Exchange {
        residual: [before, then, behind],
        torque,
        weight,
        acceleration: [acceleration, usual],
        speed,
    } = exchange(true);
    let rest = (torque - weight).amax();
    println!(
        "1 kg at up to {speed:.2} rad/s: r changes by {before:.1e} Nm before, {then:.1e} then, \
         {behind:.1e} behind; torque by {:.2} Nm, weight {:.2}, rest {rest:.3}; acceleration of \
         the flange by {acceleration:.1e} m/s2, {usual:.1e} in other cycles",
        torque.amax(),
        weight.amax()
    );
    assert!(before.max(then).max(behind) < 0.1);
    assert!(speed > 0.1 && weight.amax() > 3.0);
    // The flange notices nothing: its acceleration changes no more than from any cycle to the
    // next, whatever the torque does.
    assert!(acceleration < 2.0 * usual);
    // Beside the weight: springs of the null space pull through other masses.
    assert!(rest < 0.5 * weight.amax());

    // The other way: the momentum that the load brings is taken for a push.
    let [_, jump, _] = exchange(false).residual;
    println!("without the momentum taken anew: {jump:.1} Nm");
    assert!(jump > 10.0 * 0.1);
}
