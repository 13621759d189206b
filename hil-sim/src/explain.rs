//! One control cycle laid open: a state in, every quantity of the law out.

mod input;
mod limits;
mod of_run;
mod output;

use std::path::Path;

use controller_core::cycle::{Data, Input as CycleInput, Inspection};
use controller_core::joint::JointVector;
use controller_core::law::limits::memory::LimitMemory;
use controller_core::ranges::MAX_LEVELS;
use controller_core::{Measurement, Reference};

use crate::controllers::LawGains;
use cell::invalid::Invalid;

pub use input::Input;
pub use limits::WithinLimits;
pub use of_run::state_at;
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
    let null_space = input.compliance();
    let observer = input.observer.as_ref();
    let gain = observer.map_or([0.0; 7], |observer| observer.gain);
    let inspection =
        Inspection::new(&arm.parameters, &tasks, &null_space, gain).map_err(Invalid::line)?;

    let mut data = observed(&input);
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
    let output = Output::new(&data, &tasks, &compensation);
    if !input.is_within_limits() {
        return Ok(output);
    }
    let cycle_s = input.cycle_ms / 1e3;
    let dead_cycles = input.dead_cycles;
    let inspection = Inspection::within_limits(
        &arm.parameters,
        &tasks,
        &null_space,
        gain,
        cycle_s,
        dead_cycles,
    );
    let inspection = inspection.map_err(Invalid::line)?;
    let mut data = observed(&input);
    if let Some(before) = &input.before {
        let mut disturbance = [0.0; MAX_LEVELS];
        for (of_level, &before) in disturbance.iter_mut().zip(&before.disturbance) {
            *of_level = before;
        }
        let memory = LimitMemory {
            disturbance,
            way_out: before.way_out.map(JointVector::from),
        };
        memory.restore(&mut data.projection, &mut data.way_out);
        if let Some(torque) = before.torque {
            data.allocation.start_from(&torque.into());
        }
    }
    inspection.evaluate(&cycle, &mut data);
    if let Some(fault) = data.allocation.fault(&data.demand) {
        return Err(Invalid::line(fault.named(&arm.parameters)).within("the torque of this state"));
    }
    Ok(output.within_limits(&data, &tasks, &arm))
}

/// What is known of the observer, nothing else.
fn observed(input: &Input) -> Data<f64> {
    let mut data = Data::new();
    data.observer.residual = input.residual.into();
    if let Some(previous) = &input.observer {
        data.observer.momentum = previous.momentum_prev.into();
        data.observer.input = previous.input_prev.into();
        data.observer.residual = previous.residual_prev.into();
        data.observer.started = true;
    }
    data
}
