//! A client as a stranger would write it: flags 0x35, positions mirrored, counter
//! starting anywhere, every measurement answered once.

use cell::names::PlantKind;
use cell::scenario::Scenario;
use controller_core::joint::JointVector;
use fri::{Command, Flags, InterfaceState, Measurement, MeasurementPacket};
use hil_sim::plant::PlantOptions;
use hil_sim::robot::{Answer, LwrRobot, MEASUREMENT_BYTES, RobotOptions, RobotSetup};

pub fn setup(plant: PlantKind, options: RobotOptions) -> RobotSetup<RobotOptions> {
    RobotSetup {
        scenario: Scenario::find("two-level").expect("built in"),
        plant,
        contacts: false,
        seed: 1,
        plant_options: PlantOptions::default(),
        options,
    }
}

pub fn robot(plant: PlantKind) -> LwrRobot {
    LwrRobot::new(setup(plant, RobotOptions::default()))
}

pub struct Client {
    pub counter: u16,
    pub flags: u32,
}

impl Client {
    pub fn new() -> Self {
        Self {
            counter: 65_500,
            flags: Flags::JOINT_IMPEDANCE.0,
        }
    }

    /// The polite answer: mirrors, no stiffness, no torque.
    pub fn answer(&mut self, msr: &Measurement) -> Command {
        self.counter = self.counter.wrapping_add(1);
        let mut command = Command::default();
        command.header.counter = self.counter;
        command.header.reflected = msr.header.counter;
        command.flags = Flags(self.flags);
        command.joint_position = if msr.state == InterfaceState::Command {
            msr.joint_position
        } else {
            msr.total_commanded_position()
        };
        command
    }
}

pub fn measurement(robot: &mut LwrRobot) -> Measurement {
    let mut bytes = [0; MEASUREMENT_BYTES];
    robot.measurement(&mut bytes);
    let packet = MeasurementPacket::new_checked(&bytes[..]).expect("a measurement");
    Measurement::parse(&packet)
}

pub fn send(robot: &mut LwrRobot, command: &Command) -> Answer {
    let mut bytes = [0; Command::LEN];
    command.emit(&mut bytes);
    robot.command(&bytes, 0.0)
}

/// Robot and client in lock-step, with the largest torque step ever seen.
pub struct Loop {
    pub robot: LwrRobot,
    pub client: Client,
    pub last: Option<JointVector<f64>>,
    pub step: f64,
}

impl Loop {
    pub fn new(robot: LwrRobot) -> Self {
        Self {
            robot,
            client: Client::new(),
            last: None,
            step: 0.0,
        }
    }

    /// `cycles` cycles, each answered as `edit` makes it, or not at all.
    pub fn run(&mut self, cycles: usize, mut edit: impl FnMut(&Measurement, &mut Command) -> bool) {
        for _ in 0..cycles {
            let msr = measurement(&mut self.robot);
            let mut command = self.client.answer(&msr);
            if edit(&msr, &mut command) {
                send(&mut self.robot, &command);
            }
            self.robot.advance();
            let torque = self.robot.applied_torque().copied();
            if let (Some(last), Some(now)) = (self.last, torque) {
                self.step = self.step.max((now - last).amax());
            }
            self.last = torque;
        }
    }

    pub fn polite(&mut self, cycles: usize) {
        self.run(cycles, |_, _| true);
    }

    /// Until command state, at most 300 cycles.
    pub fn enter(&mut self) {
        self.polite(300);
        assert_eq!(
            self.robot.control_box().state(),
            hil_sim::robot::State::Command,
            "{:?}",
            self.robot.events()
        );
    }

    pub fn said(&self, text: &str) -> bool {
        self.robot
            .events()
            .iter()
            .any(|event| event.text.contains(text))
    }
}
