//! The client franka-rs against the robot's end of the crate `fci`.
//!
//! ```sh
//! fci-franka-rs ROBOT VERSION ADDRESS
//! ```
//!
//! ROBOT is the example `robot` of the crate, VERSION 5 or 10. As `clients.py` does: fields and
//! errors by name, requests, a torque loop of 2 s, StopMove, a reflex; the accelerometers, the
//! virtual wall, the filters and the text of the model beside them. Exit code 0: all of it.

use std::io::{BufRead as _, BufReader, Lines};
use std::process::{Child, ChildStdout, Command, ExitCode, Stdio};

use franka::{Errors, FciVersion, RealtimeConfig, Robot, RobotState, Torques};

type Outcome<T> = Result<T, Box<dyn std::error::Error>>;

const CYCLES: u32 = 2000;

/// The program, killed at the end.
struct Program {
    child: Child,
    lines: Lines<BufReader<ChildStdout>>,
    fields: Vec<(String, Vec<f64>)>,
}

impl Drop for Program {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

impl Program {
    fn start(path: &str, version: &str, address: &str) -> Outcome<Self> {
        let mut command = Command::new(path);
        // Version 5 is found in a second attempt.
        command.args([&format!("{address}:1337"), version, "3"]);
        let mut child = command.stdout(Stdio::piped()).spawn()?;
        let output = child.stdout.take().ok_or("no output of the robot")?;
        let lines = BufReader::new(output).lines();
        Ok(Self {
            child,
            lines,
            fields: Vec::new(),
        })
    }

    /// The next line that begins so, without that; fields on the way are kept.
    fn expect(&mut self, start: &str) -> Outcome<String> {
        loop {
            let line = self
                .lines
                .next()
                .ok_or(format!("robot: ended; expected: {start}"))??;
            if let Some(rest) = line.strip_prefix("field ") {
                let mut words = rest.split(' ');
                let name = words.next().unwrap_or_default().to_string();
                self.fields
                    .push((name, words.map(str::parse).collect::<Result<_, _>>()?));
            }
            if let Some(rest) = line.strip_prefix(start) {
                return Ok(rest.trim().to_string());
            }
        }
    }
}

fn check<T: PartialEq + std::fmt::Debug>(what: &str, found: T, expected: T) -> Outcome<()> {
    if found == expected {
        return Ok(());
    }
    Err(format!("{what}: {found:?}; expected: {expected:?}").into())
}

/// A field of the client's state by the vendor's name.
fn field(state: &RobotState, name: &str) -> Option<Vec<f64>> {
    macro_rules! find {
        ($($field:ident)*) => {
            match name {
                $(stringify!($field) => state.$field.to_vec(),)*
                "m_ee" => vec![state.m_ee],
                "m_load" => vec![state.m_load],
                "control_command_success_rate" => vec![state.control_command_success_rate],
                "accelerometer_top" => state.accelerometer_top.as_flattened().to_vec(),
                "accelerometer_bottom" => state.accelerometer_bottom.as_flattened().to_vec(),
                _ => return None,
            }
        };
    }
    Some(find!(
        O_T_EE O_T_EE_d F_T_EE EE_T_K F_T_NE NE_T_EE I_ee F_x_Cee I_load F_x_Cload elbow elbow_d
        tau_J tau_J_d dtau_J q q_d dq dq_d ddq_d joint_contact cartesian_contact joint_collision
        cartesian_collision tau_ext_hat_filtered O_F_ext_hat_K K_F_ext_hat_K O_dP_EE_d O_ddP_O
        elbow_c delbow_c ddelbow_c O_T_EE_c O_dP_EE_c O_ddP_EE_c theta dtheta
    ))
}

fn check_state(robot: &Robot, program: &Program, errors: &[String], shown: u64) -> Outcome<()> {
    let state = robot.read_once()?;
    for (name, expected) in &program.fields {
        let found = field(&state, name).ok_or(format!("no field {name}"))?;
        check(name, &found, expected)?;
    }
    let mut seen = vec![(false, false); errors.len()];
    for _ in 0..20 * shown * errors.len() as u64 {
        let state = robot.read_once()?;
        let i = (state.time.as_millis() / shown) as usize % errors.len();
        let opposite = errors.len() - 1 - i;
        let names = |errors: &Errors| errors.names().join(" ");
        check("errors", names(&state.current_errors), errors[i].clone())?;
        check(
            "reasons",
            names(&state.last_motion_errors),
            errors[opposite].clone(),
        )?;
        seen[i].0 = true;
        seen[opposite].1 = true;
        if seen.iter().all(|&(current, last)| current && last) {
            break;
        }
    }
    let count = seen
        .iter()
        .filter(|&&(current, last)| current && last)
        .count();
    check("errors seen", count, errors.len())?;
    let fields = program.fields.len();
    println!(
        "  fields of the state: {fields} of {fields} equal; errors by name: {count} of {count}"
    );
    Ok(())
}

/// Zero at first, as answers may be late until the robot waits for them; then smooth.
fn torques(cycle: u32) -> [f64; 7] {
    let cycle = cycle.saturating_sub(50);
    std::array::from_fn(|i| {
        0.5 * (0.01 * f64::from(cycle) + i as f64).sin() - 0.5 * (i as f64).sin()
    })
}

fn check_motion(robot: &Robot, program: &mut Program) -> Outcome<()> {
    let mut control = robot.start_torque_control()?;
    let mut wrong = 0f64;
    for cycle in 0..CYCLES {
        let (state, _) = control.read_once()?;
        if cycle > 0 {
            let pairs = state.tau_J_d.into_iter().zip(torques(cycle - 1));
            wrong = pairs.fold(wrong, |wrong, (a, b)| wrong.max((a - b).abs()));
        }
        let mut command = Torques::new(torques(cycle));
        command.motion_finished = cycle + 1 == CYCLES;
        control.write_once(&command)?;
    }
    drop(control);
    let last = program.expect("last ")?;
    let expected = format!("tau_j_d: {:?}", torques(CYCLES - 1));
    if !last.contains(&expected) {
        return Err(format!("last command: {last}; expected: {expected}").into());
    }
    let line = program.expect("motion")?;
    println!("  torque loop: robot: {line}; largest difference of tau_J_d {wrong:.1e} Nm");
    check("end of the motion", line.ends_with(": success"), true)?;
    // Half a step of binary32 below 2 Nm.
    check("tau_J_d within 6e-8 Nm", wrong <= 6e-8, true)
}

/// A motion that the client stops, and one that the robot aborts.
fn check_ends(robot: &Robot, program: &mut Program) -> Outcome<()> {
    let mut control = robot.start_torque_control()?;
    control.read_once()?;
    control.write_once(&Torques::new([0.0; 7]))?;
    robot.stop()?;
    let stopped = control
        .read_once()
        .map(|_| ())
        .err()
        .map(|error| error.to_string());
    drop(control);
    println!(
        "  StopMove: robot: {}; client: {}",
        program.expect("motion")?,
        stopped.unwrap_or_default()
    );

    let mut control = robot.start_torque_control()?;
    let mut aborted = None;
    for cycle in 0..CYCLES {
        let jump = if cycle < 100 { 0.0 } else { 5.0 };
        let outcome = control.read_once();
        let outcome = outcome.and_then(|_| control.write_once(&Torques::new([jump; 7])));
        if let Err(error) = outcome {
            aborted = Some(error.to_string());
            break;
        }
    }
    drop(control);
    let aborted = aborted.ok_or("torque that jumps: accepted; expected: a reflex")?;
    println!(
        "  torque that jumps: {aborted}; robot: {}",
        program.expect("motion")?
    );
    check(
        "reason",
        aborted.contains("controller_torque_discontinuity"),
        true,
    )?;
    robot.automatic_error_recovery()?;
    Ok(())
}

/// Numbers in a line that the robot has printed.
fn numbers(line: &str) -> Vec<f64> {
    let words = line.split(|c: char| !(c.is_ascii_alphanumeric() || "_.-".contains(c)));
    words.filter_map(|word| word.parse().ok()).collect()
}

fn check_requests(robot: &Robot, program: &mut Program, version: FciVersion) -> Outcome<()> {
    let series = |first: f64| move |i: usize| first + 0.5 * i as f64;
    let torques: [[f64; 7]; 4] =
        std::array::from_fn(|i| std::array::from_fn(series(20.0 + 10.0 * i as f64)));
    let forces: [[f64; 6]; 4] =
        std::array::from_fn(|i| std::array::from_fn(series(60.0 + 10.0 * i as f64)));
    let mut count = 0;
    let frame = program.fields[0].1.clone();
    let mut understood = |kind: &str, expected: &[f64]| {
        count += 1;
        let line = program.expect(&format!("request {kind}"))?;
        check(kind, numbers(&line), expected.to_vec())
    };
    let ([a, b, c, d], [e, f, g, h]) = (torques, forces);
    robot.set_collision_behavior(a, b, c, d, e, f, g, h)?;
    understood(
        "SetCollisionBehavior",
        &[torques.as_flattened(), forces.as_flattened()].concat(),
    )?;
    robot.set_joint_impedance(a)?;
    understood("SetJointImpedance", &a)?;
    robot.set_cartesian_impedance(e)?;
    understood("SetCartesianImpedance", &e)?;
    let pose = [
        1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.125, 0.25, 0.375, 1.0,
    ];
    robot.set_k(pose)?;
    understood("SetEeToK", &pose)?;
    robot.set_ee(pose)?;
    understood("SetNeToEe", &pose)?;
    let inertia = [0.5, 0.0, 0.0, 0.0, 0.25, 0.0, 0.0, 0.0, 0.125];
    robot.set_load(1.5, [0.25, 0.5, 0.75], inertia)?;
    understood("SetLoad", &[&[1.5, 0.25, 0.5, 0.75][..], &inertia].concat())?;
    if version == FciVersion::V5 {
        robot.set_filters(100.0, 200.0, 300.0, 400.0, 500.0)?;
        understood("SetFilters", &[100.0, 200.0, 300.0, 400.0, 500.0])?;
        let wall = robot.virtual_wall(3)?;
        understood("GetCartesianLimit", &[3.0])?;
        check(
            "size of the wall",
            wall.object_world_size,
            [0.25, 0.5, 0.75],
        )?;
        check("frame of the wall", wall.p_frame.to_vec(), frame)?;
        check("the wall holds", wall.active, true)?;
    } else {
        let model = robot.robot_model()?;
        check(
            "model",
            model.starts_with("<?xml") && model.trim_end().ends_with("</robot>"),
            true,
        )?;
        understood("GetRobotModel", &[])?;
        println!("  model: {} bytes", model.len());
    }
    robot.set_guiding_mode([true, false, true, false, true, false], true)?;
    let line = program.expect("request SetGuidingMode")?;
    check(
        "SetGuidingMode",
        line.contains("[true, false, true, false, true, false], null_space: true"),
        true,
    )?;
    println!(
        "  requests: {} understood as they were meant, answered with success",
        count + 1
    );
    match robot.set_joint_impedance([20_000.0; 7]) {
        Ok(()) => Err("stiffness out of range: accepted; expected: refused".into()),
        Err(error) => {
            println!("  stiffness out of range: {error}");
            Ok(())
        }
    }
}

fn run() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [path, version, address] = &arguments[..] else {
        return Err(format!("arguments: {arguments:?}; allowed: ROBOT VERSION ADDRESS").into());
    };
    let mut program = Program::start(path, version, address)?;
    let errors = program.expect("errors")?;
    let errors: Vec<String> = errors.split(' ').map(str::to_string).collect();
    let shown = program.expect("shown")?.parse()?;
    let robot = Robot::new(address, RealtimeConfig::Ignore)?;
    check(
        "version",
        robot.server_version().to_string(),
        version.clone(),
    )?;
    println!("franka-rs, version {version} found by itself");
    check_state(&robot, &program, &errors, shown)?;
    check_requests(&robot, &mut program, robot.fci_version())?;
    check_motion(&robot, &mut program)?;
    check_ends(&robot, &mut program)
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            println!("{error}");
            ExitCode::FAILURE
        }
    }
}
