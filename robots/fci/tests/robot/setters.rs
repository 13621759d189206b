//! Setters: what they change, and what is refused.

use fci::reply::CartesianLimit;
use fci::request::{GuidingMode, Load};
use fci::robot::{IDENTITY, Refused};
use fci::status::SetterStatus;
use fci::{Reply, Request, RobotMode, Setter, Version};

use crate::bench::{Bench, set, settings};

/// A quarter turn about z, moved.
const FRAME: [f64; 16] = [
    0.0, 1.0, 0.0, 0.0, //
    -1.0, 0.0, 0.0, 0.0, //
    0.0, 0.0, 1.0, 0.0, //
    0.125, 0.25, 0.375, 1.0,
];

const LOAD: Load = Load {
    m_load: 1.5,
    f_x_cload: [0.25, 0.5, 0.75],
    i_load: [0.5, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.125],
};

/// The same thresholds everywhere.
fn thresholds(lower: f64, upper: f64) -> Request {
    Request::SetCollisionBehavior(fci::request::CollisionBehavior {
        lower_torque_acceleration: [lower; 7],
        upper_torque_acceleration: [upper; 7],
        lower_torque_nominal: [lower; 7],
        upper_torque_nominal: [upper; 7],
        lower_force_acceleration: [lower; 6],
        upper_force_acceleration: [upper; 6],
        lower_force_nominal: [lower; 6],
        upper_force_nominal: [upper; 6],
    })
}

/// One of each that is good.
fn good(version: Version) -> Vec<Request> {
    let mut requests = vec![
        thresholds(10.0, 20.0),
        Request::SetJointImpedance([14_250.0; 7]),
        Request::SetCartesianImpedance([3000.0, 10.0, 100.0, 1.0, 300.0, 10.0]),
        Request::SetGuidingMode(GuidingMode {
            axes: [true; 6],
            null_space: false,
        }),
        Request::SetEeToK(FRAME),
        Request::SetNeToEe(FRAME),
        Request::SetLoad(LOAD),
    ];
    if version == Version::V5 {
        requests.push(Request::SetFilters([100.0; 5]));
    }
    requests
}

#[test]
fn each_is_answered_with_success_and_shows_in_the_state() {
    for version in Version::ALL {
        let mut bench = Bench::new(version);
        for request in good(version) {
            let handled = bench.ask(&request);
            assert_eq!((handled.request, handled.refused), (Some(request), None));
            let setter = Setter::of(request.kind()).expect("a setter");
            let expected = set(setter, SetterStatus::Success);
            assert_eq!(bench.drain(), [(handled.id, expected)]);
        }
        bench.unanswered();
        let state = &bench.state;
        assert_eq!((state.ne_t_ee, state.ee_t_k), (FRAME, FRAME));
        assert_eq!(state.f_t_ee, FRAME);
        assert_eq!((state.m_load, state.f_x_cload), (1.5, LOAD.f_x_cload));
        assert_eq!(state.i_load, LOAD.i_load);
        assert_eq!(bench.robot.load(), LOAD);
        // The flange is at 0.3 0 0.6.
        assert!((state.o_t_ee[12] - 0.425).abs() < 1e-7);
        assert!((state.o_t_ee[13] - 0.25).abs() < 1e-7);
        assert!((state.o_t_ee[14] - 0.975).abs() < 1e-7);
    }
}

#[test]
fn what_is_not_allowed_is_an_invalid_argument_and_changes_nothing() {
    let mut scaled = FRAME;
    scaled[1] = 1.1;
    let heavy = |m_load| Request::SetLoad(Load { m_load, ..LOAD });
    let mut turned = LOAD;
    turned.i_load[4] = -0.1;
    for request in [
        Request::SetJointImpedance([14_251.0; 7]),
        Request::SetJointImpedance([-1.0; 7]),
        Request::SetJointImpedance([f64::NAN; 7]),
        Request::SetCartesianImpedance([9.0, 10.0, 100.0, 1.0, 300.0, 10.0]),
        Request::SetCartesianImpedance([10.0, 10.0, 100.0, 1.0, 301.0, 10.0]),
        Request::SetEeToK(scaled),
        Request::SetNeToEe([0.0; 16]),
        Request::SetNeToEe([f64::INFINITY; 16]),
        heavy(-0.1),
        heavy(f64::NAN),
        Request::SetLoad(turned),
        Request::SetFilters([0.0; 5]),
        thresholds(-1.0, 20.0),
        thresholds(20.1, 20.0),
        thresholds(f64::NAN, 20.0),
    ] {
        let mut bench = Bench::new(Version::V5);
        let before = bench.robot.clone();
        let handled = bench.ask(&request);
        assert!(
            matches!(handled.refused, Some(Refused::Argument(_))),
            "{request:?}: {:?}",
            handled.refused
        );
        let setter = Setter::of(request.kind()).expect("a setter");
        let expected = set(setter, SetterStatus::InvalidArgument);
        assert_eq!(bench.drain(), [(handled.id, expected)]);
        let mut before = before;
        let arm = bench.arm;
        let unchanged = *before.state(&arm, &bench.operator);
        bench.cycle();
        assert_eq!(bench.state, unchanged);
    }
}

#[test]
fn none_is_possible_in_a_motion_or_with_brakes() {
    for version in [Version::V5, Version::V10] {
        let (mut moving, _) = Bench::running(version);
        let mut braked = Bench::new(version);
        braked.operator.ready = false;
        braked.unanswered();
        for (bench, refused) in [
            (&mut moving, Refused::InMotion),
            (&mut braked, Refused::Mode(RobotMode::Other)),
        ] {
            for request in good(version) {
                let handled = bench.ask(&request);
                assert_eq!(handled.refused, Some(refused));
                let setter = Setter::of(request.kind()).expect("a setter");
                let expected = set(setter, SetterStatus::NotPossible);
                assert_eq!(bench.drain(), [(handled.id, expected)]);
            }
            bench.unanswered();
            assert_eq!((bench.state.ne_t_ee, bench.state.m_load), (IDENTITY, 0.0));
        }
    }
}

#[test]
fn walls_are_told_by_their_number() {
    let mut settings = settings(Version::V5);
    let wall = CartesianLimit {
        size: [0.25, 0.5, 0.75],
        frame: FRAME,
        active: true,
    };
    settings.walls[3] = Some(wall);
    let mut bench = Bench::with(settings);
    for (limit, expected) in [(3, Some(wall)), (0, None), (-1, None), (8, None)] {
        let handled = bench.ask(&Request::GetCartesianLimit { limit });
        let status = match expected {
            Some(_) => SetterStatus::Success,
            None => SetterStatus::InvalidArgument,
        };
        let refused = expected.is_none().then_some(Refused::Wall(limit));
        assert_eq!(handled.refused, refused);
        let limit = expected.unwrap_or_default();
        let reply = Reply::CartesianLimit { status, limit };
        assert_eq!(bench.drain(), [(handled.id, format!("{reply:?}"))]);
    }
}
