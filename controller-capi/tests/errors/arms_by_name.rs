//! The arms of the crate, by name.

use std::ffi::{CStr, CString, c_char};

use arms::{LWR_IV_DAMPING, LWR_IV_STIFFNESS};
use controller_core::arm::{ArmParameters, Pose, Tool};
use controller_core::joint::JointVector;
use controller_core::law::null_space::NullDamping;
use controller_core::real::Real;
use controller_core::{
    Axes, Controller, ControllerConfig, LinkPoint, Measurement, NullSpace, State, Task, TaskGains,
    TaskSet,
};
use stratum::*;

use super::{Bench, ZERO};

/// Settings of a built-in arm.
fn settings_of(name: &str) -> Box<StratumSettings> {
    let name = CString::new(name).unwrap();
    let mut settings: Box<StratumSettings> = Box::default();
    // SAFETY: see `Bench::new`.
    let answer =
        unsafe { stratum_settings_of_arm(STRATUM_ABI_VERSION, name.as_ptr(), &mut *settings) };
    assert_eq!(answer, STRATUM_OK);
    settings
}

/// A controller of settings, and the torques of some cycles from a state at rest in the middle
/// of all ranges; in every cycle `settings(k)` are those of the controller.
fn torques(variants: &[&StratumSettings], exchanged: usize) -> Vec<[f64; 7]> {
    let bench = &mut Bench::new();
    let q = variants[0].arm.links.map(|link| {
        let [least, greatest] = link.position_range;
        0.4 * least + 0.6 * greatest
    });
    let mut torques = Vec::new();
    // SAFETY: see `Bench::new`.
    unsafe {
        let (c, s): (*mut StratumController, *mut StratumState) =
            (&mut *bench.controller, &mut *bench.state);
        assert_eq!(stratum_controller_init(c, variants[0]), STRATUM_OK);
        assert_eq!(stratum_state_init(s, c, q.as_ptr()), STRATUM_OK);
        for cycle in 0..20 {
            if cycle == exchanged {
                assert_eq!(stratum_controller_init(c, variants[1]), STRATUM_OK);
                assert_eq!(stratum_skip(s), STRATUM_OK);
            }
            let mut torque = ZERO;
            let t = torque.as_mut_ptr();
            let q = q.map(|q| q + 1e-4 * cycle as f64);
            let dq = [0.05; 7];
            assert_eq!(
                stratum_step(c, s, q.as_ptr(), dq.as_ptr(), 0.002, t),
                STRATUM_OK
            );
            torques.push(torque);
        }
    }
    torques
}

/// The same cycles through the core itself, from the tables of the crate.
fn core_torques(variants: &[(ArmParameters, LinkPoint)], exchanged: usize) -> Vec<[f64; 7]> {
    let controllers: Vec<_> = variants
        .iter()
        .map(|(arm, point)| {
            let gains = TaskGains::uniform(400.0, 40.0);
            let config = ControllerConfig {
                tasks: TaskSet::new(&[Task::position(*point, Axes::XYZ, gains)]).unwrap(),
                null_space: NullSpace {
                    damping: NullDamping::Inertia(20.0),
                    ..NullSpace::diagonal(LWR_IV_STIFFNESS, LWR_IV_DAMPING)
                },
                observer_gain: [50.0; 7],
                cycle_s: 0.002,
                dead_cycles: 0,
            };
            Controller::<Scalar>::new(arm, &config).unwrap()
        })
        .collect();
    let vector = |values: [f64; 7]| JointVector::from(values.map(Scalar::from_f64));
    let q = variants[0].0.links.map(|link| {
        let [least, greatest] = link.position_range;
        0.4 * least + 0.6 * greatest
    });
    let reference = controllers[0].rest_reference(&vector(q));
    let mut state = State::new();
    let cycle = |cycle: usize| {
        if cycle == exchanged {
            state.resume_after_gap();
        }
        let measurement = Measurement {
            q: vector(q.map(|q| q + 1e-4 * cycle as f64)),
            dq: vector([0.05; 7]),
            interval_s: Scalar::from_f64(0.002),
        };
        let controller = &controllers[usize::from(cycle >= exchanged)];
        let step = controller.step(&mut state, &measurement, &reference);
        step.torque.map(Real::to_f64).into()
    };
    (0..20).map(cycle).collect()
}

/// Every table of the crate, its names and its bits: by its settings, by its preset, and
/// mounted elsewhere with a tool that is exchanged for another.
#[test]
fn every_arm_has_the_torques_of_the_core() {
    // SAFETY: a constant.
    let refusal = unsafe { CStr::from_ptr(stratum_error_text(STRATUM_ERROR_PRESET)) };
    let names = refusal
        .to_str()
        .unwrap()
        .split("there are ")
        .nth(1)
        .unwrap();
    let known = arms::ALL.map(|arm| arm.name);
    assert_eq!(names.split(", ").collect::<Vec<_>>(), known);

    for arm in arms::ALL {
        let mut settings = settings_of(arm.name);
        settings.damping = STRATUM_DAMPING_INERTIA;
        let label = |name: &[c_char; STRATUM_NAME_SIZE]| {
            assert_eq!(name[STRATUM_NAME_SIZE - 1], 0);
            // SAFETY: it ends within the array.
            let name = unsafe { CStr::from_ptr(name.as_ptr()) };
            name.to_str().unwrap().to_owned()
        };
        assert_eq!(label(&settings.arm.name), arm.name);
        for (link, table) in settings.arm.links.iter().zip(&arm.links) {
            assert_eq!(label(&link.name), table.name);
            let approach = table
                .end_approach
                .map_or(0.0, |approach| approach.deceleration);
            assert_eq!(link.end_approach.deceleration, approach);
            assert_eq!(link.friction.coulomb, table.friction.coulomb);
        }
        let bare = (*arm, arm.flange_point());
        assert_eq!(
            torques(&[&settings], 20),
            core_torques(&[bare], 20),
            "{}",
            arm.name
        );

        // On the ceiling, with one tool and then another.
        let tools = [0.5, 1.5].map(|mass| Tool {
            pose: Pose {
                rotation: [[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]],
                shift: [0.0, 0.02, 0.1 * mass],
            },
            mass,
            com: [0.0, 0.0, 0.05],
            inertia: [0.002, 0.0, 0.0, 0.002, 0.0, 0.001],
        });
        let ceiling = Pose {
            rotation: [[1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]],
            shift: [0.0, 0.0, 2.0],
        };
        let hanging = ArmParameters {
            base: ceiling,
            ..*arm
        };
        let core = tools.map(|tool| (hanging.with_tool(&tool), hanging.tool_point(&tool)));
        let pose = |pose: &Pose| StratumPose {
            rotation: pose.rotation,
            shift: pose.shift,
        };
        settings.arm.base = pose(&ceiling);
        let settings = tools.map(|tool| {
            let mut settings = settings.clone();
            settings.tool = StratumTool {
                pose: pose(&tool.pose),
                mass: tool.mass,
                com: tool.com,
                inertia: tool.inertia,
            };
            settings
        });
        let c = torques(&[&settings[0], &settings[1]], 10);
        assert_eq!(c, core_torques(&core, 10), "{}", arm.name);
    }
}
