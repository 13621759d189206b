//! What bends a straight arm: against positions of the arm bent so.

use arms::LWR_IV;
use controller_core::arm::ArmParameters;
use controller_core::cycle::{Data, Input};
use controller_core::joint::{JointState, JointVector, Vector3};
use controller_core::real::Real;
use controller_core::{Axes, Controller, ControllerConfig, Measurement, Reference, Target, Task};
use stratum_tests::config::{FLANGE, REFERENCE_GAINS, WRIST, with_tasks};

/// The arm at rest in a posture \[rad\], its flange wanted `off` \[m\], the wrist where it is.
fn cycle<T: Real>(
    arm: &ArmParameters,
    config: &ControllerConfig,
    q: &JointVector<f64>,
    off: &Vector3<f64>,
    posture: &JointVector<f64>,
) -> Data<T> {
    let controller = Controller::<T>::new(arm, config).expect("a configuration");
    let narrow = |x: &JointVector<f64>| x.map(T::from_f64);
    let measurement = Measurement {
        q: narrow(q),
        dq: narrow(&JointVector::zeros()),
        interval_s: T::from_f64(config.cycle_s),
    };
    let mut reference = Reference::hold(config.tasks.tasks().len(), narrow(posture));
    let flange = position(arm, q) + off;
    if let Some(first) = reference.targets_mut().first_mut() {
        *first = Target::position([flange.x, flange.y, flange.z].map(T::from_f64));
    }
    let input = Input {
        measurement: &measurement,
        reference: &reference,
    };
    // A cycle makes one round towards the motion that bends the arm, which gains on all others by
    // a sixth or more. Of all else each is the first cycle, so that r is 0.
    let mut data = Data::new();
    for _ in 0..100 {
        let way_out = data.way_out;
        data = Data::new();
        data.follow_at_once();
        data.way_out = way_out;
        controller.evaluate(&input, &mut data);
    }
    data
}

fn position(arm: &ArmParameters, q: &JointVector<f64>) -> Vector3<f64> {
    let model = hil_sim::plant::PlantModel::new(arm);
    let state = JointState {
        q: *q,
        dq: JointVector::zeros(),
    };
    let (x, _) = model.point(&state, FLANGE.link.number(), &Vector3::from(FLANGE.offset));
    x
}

fn flange() -> ControllerConfig {
    with_tasks(&[Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS)])
}

fn flange_and_wrist() -> ControllerConfig {
    with_tasks(&[
        Task::position(FLANGE, Axes::XYZ, REFERENCE_GAINS),
        Task::position(WRIST, Axes::XY, REFERENCE_GAINS),
    ])
}

/// Straight, to several sides.
fn straight() -> [JointVector<f64>; 3] {
    [
        [0.0; 7],
        [0.3, 0.5, 0.0, 0.0, 0.0, 0.0, 0.0],
        [-1.0, -0.8, 0.7, 0.0, 0.4, 0.0, 1.0],
    ]
    .map(JointVector::from)
}

/// From the flange to the shoulder.
fn back(q: &JointVector<f64>) -> Vector3<f64> {
    (Vector3::new(0.0, 0.0, 0.3105) - position(&LWR_IV, q)).normalize()
}

/// Bent along the acceleration by 0.02 rad the flange is nearer to the shoulder, by the square of
/// it, and beside its place by no more than what comes with the square.
#[test]
fn the_arm_bends_towards_the_target_and_no_level_sees_it() {
    for q in straight() {
        for config in [flange(), flange_and_wrist()] {
            let towards = back(&q);
            let data = cycle::<f64>(&LWR_IV, &config, &q, &(towards * 0.05), &q);
            let bend = data.way_out.acceleration;
            // Fully asked for from 10 mm on, of the joint that bends most: 0.5 rad/s2.
            assert!((bend.amax() - 0.5).abs() < 1e-9, "{bend}");
            let moved = position(&LWR_IV, &(q + bend * (0.02 / 0.5))) - position(&LWR_IV, &q);
            let nearer = moved.dot(&towards);
            let beside = (moved - towards * nearer).norm();
            // c = 0.2 m/rad2 of the elbow: 0.04 mm.
            assert!(nearer > 0.02 * 0.02 * 0.05, "{nearer}");
            assert!(beside < nearer, "{beside} {nearer}");
            let kept = data.spectrum.directions().iter().zip(&data.rows.jacobian);
            for (direction, _) in kept.filter(|(direction, _)| direction.mobility > 0.01) {
                let whitened = data.dynamics.cholesky.upper_times(&bend);
                assert!(direction.along.dot(&whitened).abs() < 1e-9);
            }
            assert!(!data.way_out.stuck.any());
        }
    }
}

#[test]
fn both_precisions_bend_alike() {
    for q in straight() {
        let off = back(&q) * 0.05;
        let [wide, narrow] = [
            cycle::<f64>(&LWR_IV, &flange(), &q, &off, &q)
                .way_out
                .acceleration,
            cycle::<f32>(&LWR_IV, &flange(), &q, &off, &q)
                .way_out
                .acceleration
                .map(f64::from),
        ];
        // Rows that are lost are rounding; what is left of them is 1e-4 of an arm.
        assert!((wide - narrow).amax() < 1e-3, "{wide} {narrow}");
    }
}

/// The elbow goes to q_d; where q_d is straight to the side with more room; and where an arm is
/// bent already on to that side.
#[test]
fn the_elbow_bends_to_the_side_that_is_wanted() {
    let q = straight()[1];
    let elbow = |arm: &ArmParameters, q: &JointVector<f64>, posture: &JointVector<f64>| {
        let off = back(q) * 0.05;
        cycle::<f64>(arm, &flange(), q, &off, posture)
            .way_out
            .acceleration[3]
    };
    let with = |angle: f64| {
        let mut q = q;
        q[3] = angle;
        q
    };
    assert!(elbow(&LWR_IV, &q, &with(0.3)) > 0.1);
    assert!(elbow(&LWR_IV, &q, &with(-0.3)) < -0.1);
    for side in [1.0, -1.0] {
        let mut arm = LWR_IV;
        let end = arm.links[3].position_range[1];
        arm.links[3].position_range = if side > 0.0 { [-0.5, end] } else { [-end, 0.5] };
        assert!(elbow(&arm, &q, &q) * side > 0.1);
        // Twice as far bent as it takes to stay there, against both.
        let bent = with(-side * 0.018);
        assert!(elbow(&arm, &bent, &bent) * side < -0.1);
        // No room there: bent or not.
        arm.links[3].position_range = if side > 0.0 {
            [-0.05, end]
        } else {
            [-end, 0.05]
        };
        assert!(elbow(&arm, &bent, &with(-side * 0.3)) * side > 0.1);
    }
}

/// It comes without a step, between 5 and 10 mm.
#[test]
fn nothing_is_asked_for_near_the_target_or_where_no_level_is_released() {
    let q = straight()[1];
    let asked = |q: &JointVector<f64>, off: f64| {
        let data = cycle::<f64>(&LWR_IV, &flange(), q, &(back(q) * off), q);
        assert!(!data.way_out.stuck.any());
        data.way_out.acceleration.amax()
    };
    for (off, share) in [
        (0.0, 0.0),
        (0.005, 0.0),
        (0.006, 0.2),
        (0.0075, 0.5),
        (0.02, 1.0),
    ] {
        assert!((asked(&q, off) - 0.5 * share).abs() < 1e-6, "{off}");
    }
    let mut bent = q;
    bent[3] = -0.5;
    assert!(asked(&bent, 0.05) == 0.0);
}

/// A target beyond the arm, and joints without room.
#[test]
fn what_has_no_way_out_is_said() {
    let q = straight()[1];
    let stuck = |arm: &ArmParameters, off: f64| {
        let data = cycle::<f64>(arm, &flange(), &q, &(back(&q) * off), &q);
        assert!(!data.way_out.stuck.any() || data.way_out.acceleration.amax() == 0.0);
        data.way_out.stuck.contains(0)
    };
    assert!(!stuck(&LWR_IV, 0.05));
    assert!(stuck(&LWR_IV, -0.05));
    let mut narrow = LWR_IV;
    for joint in [3, 5] {
        narrow.links[joint].position_range = [-0.1, 0.1];
    }
    assert!(stuck(&narrow, 0.05));
    assert!(!stuck(&narrow, 0.004));
}
