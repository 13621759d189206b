//! One control cycle laid open: a state in, every quantity of the law out.

mod input;
mod output;

use std::path::Path;

use controller_core::cycle::{Data, Input as CycleInput, Inspection};
use controller_core::gain::diagonal;
use controller_core::law::null_space::{NullDamping, NullSpace, Posture};
use controller_core::{Measurement, Reference};

use crate::controllers::LawGains;
use cell::invalid::Invalid;

pub use input::Input;
pub use output::Output;

/// Explains the cycle described by a JSON text; an arm file is looked for in the working
/// directory.
///
/// # Errors
/// Anything in the text that cannot be used.
pub fn explain(text: &str) -> Result<Output, Invalid> {
    explain_in(text, Path::new(""))
}

/// The same of a text from `folder`, in which an arm file is looked for.
///
/// # Errors
/// Anything in the text that cannot be used.
pub fn explain_in(text: &str, folder: &Path) -> Result<Output, Invalid> {
    let input = Input::parse(text, folder)?;
    let arm = input.arm()?;
    let (tasks, targets) = input.tasks(&arm);
    let null_space = NullSpace {
        stiffness: diagonal(input.null_space.stiffness),
        damping: NullDamping::Joint(diagonal(input.null_space.damping)),
        posture: Posture::Constant,
    };
    let observer = input.observer.as_ref();
    let gain = observer.map_or([0.0; 7], |observer| observer.gain);
    let inspection =
        Inspection::new(&arm.parameters, &tasks, &null_space, gain).map_err(Invalid::line)?;

    let mut data = Data::new();
    data.observer.residual = input.residual.into();
    if let Some(previous) = observer {
        data.observer.momentum = previous.momentum_prev.into();
        data.observer.input = previous.input_prev.into();
        data.observer.residual = previous.residual_prev.into();
        data.observer.started = true;
    }
    let measurement = Measurement {
        q: input.q.into(),
        dq: input.dq.into(),
        interval_s: observer.map_or(1.0, |observer| observer.h),
    };
    let reference = Reference::from_targets(&targets, input.null_space.q_d)
        .ok_or_else(|| Invalid::new("levels", targets.len(), "1 to 7 levels"))?;
    let gains = LawGains {
        rate: input.null_space.rate_gain.into(),
        stiffness: controller_core::joint::JointMatrix::from_diagonal(
            &input.null_space.stiffness.into(),
        ),
    };
    let controller = input.controller();
    let cycle = CycleInput {
        measurement: &measurement,
        reference: &reference,
    };
    inspection.evaluate_with(&cycle, &mut data, |_, _, data| {
        data.demand = controller.decide(data, &gains).demand(&data.dynamics);
    });
    if let Some(fault) = data.allocation.fault(&data.demand) {
        return Err(Invalid::line(fault.named(&arm.parameters)).within("the torque of this state"));
    }
    let compensation = controller.residual_compensation(&data);
    Ok(Output::new(&data, &tasks, &compensation))
}
