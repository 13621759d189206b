//! Every configuration that cannot be is refused with one line that says what
//! would be allowed.

use controller_core::config::{ConfigError, ControllerConfig, DEAD_CYCLES_MAX, GAIN_MAX};
use controller_core::controller::Controller;
use controller_core::joint::{Matrix3, diagonal};
use controller_core::law::NullDamping;
use controller_core::task::Axes;
use stratum_tests::config::{FLANGE, reference, three_level};
use stratum_tests::lwr;

fn refused(change: impl FnOnce(&mut ControllerConfig<f64>)) -> (ConfigError, String) {
    let mut config = three_level();
    change(&mut config);
    let error = Controller::new(&lwr(), &config).expect_err("a configuration that cannot be");
    (error, error.to_string())
}

fn line(change: impl FnOnce(&mut ControllerConfig<f64>)) -> String {
    refused(change).1
}

#[test]
fn tasks_without_rows_or_with_too_many_are_refused() {
    assert_eq!(
        line(|config| config.tasks.clear()),
        "the tasks have 0 rows together; allowed 1 to 7"
    );
    assert_eq!(
        line(|config| *config = reference(&[(FLANGE, Axes::XYZ); 3])),
        "the tasks have 9 rows together; allowed 1 to 7"
    );
    assert_eq!(
        line(|config| config.tasks[1].axes.xyz = [false; 3]),
        "level 2: the task has no axis; it needs 1 to 3 of x, y, z"
    );
}

#[test]
fn points_that_are_not_on_the_arm_are_refused() {
    for link in [0, 8] {
        assert_eq!(
            line(|config| config.tasks[1].point.link = link),
            format!("level 2: point on link {link}; allowed 1 to 7")
        );
    }
    for value in [f64::NAN, 10.5, f64::NEG_INFINITY] {
        assert_eq!(
            line(|config| config.tasks[0].point.offset.y = value),
            format!("level 1: point offset {value} m; allowed -10 to 10")
        );
    }
}

#[test]
fn gains_that_are_no_gains_are_refused() {
    assert_eq!(
        line(|config| config.tasks[0].stiffness[(1, 1)] = f64::NAN),
        "level 1: task stiffness [1/s2]: entry NaN; allowed -1e9 to 1e9"
    );
    assert_eq!(
        line(|config| config.tasks[1].damping[(0, 0)] = 2.0 * GAIN_MAX),
        "level 2: task damping [1/s]: entry 2000000000; allowed -1e9 to 1e9"
    );
    assert_eq!(
        line(|config| config.null_space.stiffness[(6, 0)] = 0.5),
        "null-space stiffness [Nm/rad]: entry (7, 1) differs from (1, 7) by 0.5; the matrix must \
         be symmetric"
    );
    assert_eq!(
        line(|config| config.tasks[0].damping[(2, 2)] = 0.0),
        "level 1: task damping [1/s]: pivot 0 at row 3; the matrix must be positive definite (a \
         diagonal one: every entry above 0)"
    );
    assert_eq!(
        line(|config| config.null_space.damping =
            NullDamping::Joint(diagonal([1.0, 1.0, 1.0, -2.0, 1.0, 1.0, 1.0]))),
        "null-space damping [Nms/rad]: pivot -2 at row 4; the matrix must be positive definite (a \
         diagonal one: every entry above 0)"
    );
    // Symmetric with positive entries, and yet not definite.
    let indefinite = Matrix3::new(1.0, 2.0, 0.0, 2.0, 1.0, 0.0, 0.0, 0.0, 1.0);
    assert_eq!(
        line(|config| config.tasks[0].stiffness = indefinite),
        "level 1: task stiffness [1/s2]: pivot -3 at row 2; the matrix must be positive definite \
         (a diagonal one: every entry above 0)"
    );
}

/// Rows and columns of axes that the task does not control are not read.
#[test]
fn gains_of_uncontrolled_axes_do_not_matter() {
    let mut config = three_level::<f64>();
    config.tasks[1].stiffness[(2, 2)] = -1.0;
    config.tasks[1].stiffness[(0, 2)] = f64::NAN;
    assert!(Controller::new(&lwr(), &config).is_ok());
}

#[test]
fn observer_gain_cycle_and_dead_time_have_their_ranges() {
    for value in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(
            line(|config| config.observer_gain[2] = value),
            format!("observer gain of joint 3 is {value} 1/s; it must be above 0 and at most 1e9")
        );
    }
    for value in [0.00009, 0.0201, f64::NAN, -0.002] {
        assert_eq!(
            line(|config| config.cycle_s = value),
            format!("cycle {value} s; allowed 0.0001 to 0.02")
        );
    }
    assert_eq!(DEAD_CYCLES_MAX, 8);
    assert_eq!(
        line(|config| config.dead_cycles = 9),
        "dead time of 9 cycles; allowed 0 to 8"
    );
}

#[test]
fn damping_too_strong_for_the_cycle_is_refused_with_joint_value_and_posture() {
    let (error, text) = refused(|config| config.dead_cycles = 1);
    match error {
        ConfigError::Damping {
            joint,
            value,
            bound,
            posture,
        } => {
            // Coaxial with 5 and 7 in the stretched arm, and the most damped of them.
            assert_eq!(joint, 3);
            assert!((1.27..1.33).contains(&value) && (bound - 1.0).abs() < 1e-12);
            assert!(posture.iter().all(|q| q.abs() < 3.0));
        }
        other => panic!("{other}"),
    }
    assert!(
        text.starts_with(
            "null-space damping of joint 3 is too strong for the cycle: h lambda_max = 1."
        ) && text.ends_with(" deg; it must be below 1.000"),
        "{text}"
    );
}

/// D = c M: c must be a rate, and h c stays below one half, dead time or not.
#[test]
fn inertia_shaped_damping_has_its_own_bound() {
    let with = |rate: f64, dead_cycles| {
        let mut config = three_level::<f64>();
        config.null_space.damping = NullDamping::Inertia(rate);
        config.dead_cycles = dead_cycles;
        Controller::new(&lwr(), &config)
    };
    for dead_cycles in [0, 1, 2] {
        assert!(with(249.0, dead_cycles).is_ok(), "h c = 0.498");
        assert!(matches!(
            with(251.0, dead_cycles),
            Err(ConfigError::Damping { value, bound: 0.5, .. }) if (value - 0.502).abs() < 1e-12
        ));
    }
    for value in [0.0, -10.0, f64::NAN] {
        let error = with(value, 0).expect_err("no rate").to_string();
        assert_eq!(
            error,
            format!(
                "inertia-shaped null-space damping {value} 1/s; it must be above 0 and at most 1e9"
            )
        );
    }
}
