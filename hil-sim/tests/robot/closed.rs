//! The product's law on the other side of the datagrams: signs, times and origins
//! of both sides fit together.

use cell::names::PlantKind::{self, Ideal, Realistic};
use cell::scenario::Scenario;
use controller_core::cycle::velocity::{CORNER_HZ, VelocityEstimator};
use controller_core::joint::JointVector;
use controller_core::law::null_space::NullDamping;
use controller_core::{Controller, Measurement, State};
use fri::InterfaceState;
use hil_sim::arm_points::origins;
use hil_sim::link::{Expect, LockStep, Peer, finish};
use hil_sim::robot::{LwrBox, LwrRobot, RobotOptions};
use hil_sim::summary::Summary;

use crate::client::{Client, setup};

/// A torque controller: velocity by differences, no gravity in what it sends.
struct Bridge {
    client: Client,
    scenario: Scenario,
    controller: Controller<f64>,
    state: State<f64>,
    velocity: VelocityEstimator<f64>,
    start: Option<JointVector<f64>>,
    cycle: i32,
}

impl Bridge {
    fn new(scenario: &Scenario) -> Self {
        let mut config = scenario.controller_config(0).expect("levels");
        config.null_space.damping = NullDamping::Inertia(10.0);
        Self {
            client: Client::new(),
            scenario: scenario.clone(),
            controller: Controller::new(&scenario.arm().parameters, &config).expect("a controller"),
            state: State::new(),
            velocity: VelocityEstimator::new(CORNER_HZ),
            start: None,
            cycle: -500,
        }
    }

    fn torque(&mut self, q: JointVector<f64>) -> (JointVector<f64>, JointVector<f64>) {
        let state = self.velocity.update(&q, 0.002);
        let posture = *self.start.get_or_insert(q);
        let origins = origins(&self.scenario, &posture);
        let t = f64::from(self.cycle.max(0)) * 0.002;
        let reference = self.scenario.reference(&origins, &posture, t);
        let measurement = Measurement {
            q: state.q,
            dq: state.dq,
            interval_s: 0.002,
        };
        let step = self
            .controller
            .step(&mut self.state, &measurement, &reference);
        assert!(step.status.fault.is_none(), "{:?}", step.status);
        let share = (f64::from(self.cycle + 500) / 500.0).min(1.0);
        self.cycle += 1;
        ((step.torque - step.gravity) * share, step.residual)
    }
}

impl Peer<LwrBox> for Bridge {
    fn exchange(
        &mut self,
        _: &mut LwrRobot,
        measurement: &[u8],
        _: Expect,
        answers: &mut Vec<Vec<u8>>,
    ) -> std::io::Result<bool> {
        let packet = fri::MeasurementPacket::new_checked(measurement).expect("a measurement");
        let msr = fri::Measurement::parse(&packet);
        let mut command = self.client.answer(&msr);
        if msr.state == InterfaceState::Command {
            let (torque, residual) = self.torque(msr.joint_position.map(f64::from).into());
            command.joint_torque = std::array::from_fn(|i| torque[i] as f32);
            for joint in 0..7 {
                command.user.real[joint] = residual[joint] as f32;
            }
        }
        let mut bytes = [0; fri::Command::LEN];
        command.emit(&mut bytes);
        answers.push(bytes.to_vec());
        Ok(true)
    }
}

fn run(plant: PlantKind, contacts: bool, dead_cycles: usize, faults: &[&str]) -> Summary {
    let mut setup = setup(plant, RobotOptions::default());
    setup.contacts = contacts;
    setup.plant_options.dead_cycles = dead_cycles;
    let faults: Vec<_> = faults
        .iter()
        .map(|spec| spec.parse().expect("a spec"))
        .collect();
    let mut bridge = Bridge::new(&setup.scenario);
    let mut robot = LwrRobot::new(setup);
    let mut link = LockStep::new(&faults, 0.002, 1);
    let mut last = -1.0;
    while !robot.is_over() {
        if let Some(instant) = link.step(&mut robot, &mut bridge).expect("no socket") {
            assert!(instant.t_s > last);
            last = instant.t_s;
        }
    }
    finish(&mut robot, &mut bridge).expect("no socket");
    assert!((last - 19.998).abs() < 1e-9);
    robot.summary()
}

#[test]
fn the_law_tracks_over_the_link() {
    // Ideal and free: what binary32 and the velocity by differences leave.
    for (plant, contacts, rms_mm, residual_nm) in [
        (Ideal, false, 0.1, 0.1),
        (Ideal, true, 0.4, 0.5),
        (Realistic, true, 1.0, 1.5),
    ] {
        let summary = run(plant, contacts, 0, &[]);
        let level = &summary.levels[0];
        let rms = level.rms().expect("samples");
        assert!(rms < rms_mm, "{plant:?} {contacts}: {rms}");
        let error = summary.residual.rms_error_nm.expect("samples");
        assert!(error < residual_nm, "{plant:?} {contacts}: {error}");
        assert_eq!(level.leak_max, None);
        let link = summary.link.expect("a link");
        assert_eq!((link.missed, link.fallbacks), (0, 0));
        assert_eq!(link.command_share, Some(1.0));
    }
}

#[test]
fn faults_are_borne_and_deterministic() {
    let faults = [
        "to-robot:drop=0.01@0-20",
        "to-robot:jitter=2.05@0-20",
        "to-robot:burst=0.0005x5@0-20",
    ];
    let [one, two] = [(), ()].map(|()| run(Ideal, true, 0, &faults));
    assert_eq!(one.link, two.link);
    assert_eq!(one.levels[0].rms(), two.levels[0].rms());
    let link = one.link.expect("a link");
    assert!(
        link.missed > 100 && link.late > 50 && link.lost > 50,
        "{link:?}"
    );
    assert_eq!(
        (link.fallbacks, link.command_share),
        (0, Some(1.0)),
        "{link:?}"
    );
    assert!(link.largest_torque_step_nm < 1.0, "{link:?}");
    // A lost answer is a torque that is one cycle old.
    assert!(one.levels[0].rms() < Some(1.0));
}

#[test]
fn a_frozen_link_falls_back_and_recovers_without_a_torque_step() {
    let summary = run(Realistic, false, 0, &["both:freeze@4-4.5"]);
    let link = summary.link.expect("a link");
    assert_eq!(
        (link.fallbacks, link.recoveries),
        (1, 1),
        "{:?}",
        link.events
    );
    // Held for half a second, and as long until the link is good again.
    assert!(link.command_share > Some(0.9) && link.command_share < Some(0.97));
    assert!(link.largest_torque_step_nm < 5.0, "{link:?}");
}
