//! One control cycle laid open: a state in, every quantity of the law out.

mod input;
mod output;

use controller_core::dynamics::Dynamics;
use controller_core::hierarchy::Hierarchy;
use controller_core::joint::{JointMatrix, JointVector};
use controller_core::kinematics::Kinematics;
use controller_core::law::{Command, Cycle, NullDamping, NullSpace, Posture, TaskMotion};
use controller_core::limits::TorqueCommand;
use controller_core::model::ArmModel;
use controller_core::observer::Observer;
use controller_core::task::TaskRows;

use crate::controllers::LawGains;
use crate::invalid::Invalid;

pub use input::Input;
pub use output::Output;

/// Explains the cycle described by a JSON text.
///
/// # Errors
/// Anything in the text that cannot be used.
pub fn explain(text: &str) -> Result<Output, Invalid> {
    let input = Input::parse(text)?;
    let model = ArmModel::new(input.arm()).map_err(Invalid::line)?;
    let state = input.state();
    let (tasks, references) = input.tasks();

    let kinematics = Kinematics::new(&model, &state);
    let dynamics = Dynamics::new(&model, &kinematics, &state);
    let residual = match &input.observer {
        None => JointVector::from(input.residual),
        Some(previous) => {
            let mut observer = Observer {
                momentum: previous.momentum_prev.into(),
                input: previous.input_prev.into(),
                residual: previous.residual_prev.into(),
                started: true,
                ..Observer::new()
            };
            observer.update(&previous.gain.into(), previous.h, &dynamics.momentum)
        }
    };
    let rows = TaskRows::new(&tasks, &references, &kinematics, &state);
    let hierarchy = Hierarchy::new(&rows, &dynamics.cholesky);
    let motion = TaskMotion::new(&dynamics, &hierarchy, &state);
    let null_space = NullSpace {
        stiffness: JointMatrix::from_diagonal(&input.null_space.stiffness.into()),
        damping: NullDamping::Joint(JointMatrix::from_diagonal(&input.null_space.damping.into())),
        posture: Posture::Constant,
    };
    let posture = input.null_space.q_d.into();
    let command = Command::new(
        &null_space,
        &dynamics,
        &rows,
        &hierarchy,
        &motion,
        &state,
        &posture,
    );
    let cycle = Cycle {
        state: &state,
        kinematics: &kinematics,
        dynamics: &dynamics,
        rows: &rows,
        hierarchy: &hierarchy,
        motion: &motion,
        posture: &posture,
        command: &command,
        residual: &residual,
    };
    let controller = input.controller();
    let gains = LawGains {
        rate: input.null_space.rate_gain.into(),
        stiffness: null_space.stiffness,
    };
    let demand = controller.decide(&cycle, &gains).demand(&dynamics);
    let limited = TorqueCommand::new(&demand, model.torque_limit())
        .map_err(|fault| Invalid::line(fault).within("the torque of this state"))?;
    Ok(Output::new(
        &cycle,
        &tasks,
        controller.residual_compensation(&cycle),
        &demand,
        &limited,
    ))
}
