//! A session with a robot: one row per answered cycle.

use bridge::protocol::Report;
use bridge::session::CycleReport;
use controller_core::Step;
use controller_core::joint::{DOF, JointVector};

use crate::channel::{Channel, Place, Sink, Value, numbers};

/// How many channels a session has.
const COUNT: usize = 15;

/// Channels of a session with a robot that says `R` of itself.
#[must_use]
#[rustfmt::skip]
pub const fn channels<R: Report>() -> [Channel<CycleReport<R>>; COUNT] { [
    Channel { columns: "counter", unit: "", meaning: "of the measurement", place: Place::File, values: |c, sink| sink(Value::Count(c.counter as i64)) },
    Channel { columns: "lost", unit: "", meaning: "how many before it never came", place: Place::File, values: |c, sink| sink(Value::Count(c.lost.into())) },
    Channel { columns: "phase", unit: "", meaning: "of the session", place: Place::File, values: |c, sink| sink(Value::Word(c.phase.name().into())) },
    Channel { columns: "state", unit: "", meaning: "as the robot reports it", place: Place::File, values: |c, sink| sink(Value::Word(format!("{:?}", c.robot.state()))) },
    Channel { columns: "quality", unit: "", meaning: "of the link, as the robot reports it", place: Place::File, values: |c, sink| sink(Value::Word(format!("{:?}", c.robot.quality()))) },
    Channel { columns: "t", unit: "s", meaning: "scenario time; 0 before command state, from -1 on after it", place: Place::File, values: |c, sink| sink(Value::Number(c.t_s)) },
    Channel { columns: "q{joint}", unit: "rad", meaning: "measured", place: Place::File, values: |c, sink| numbers(c.joints.q.as_slice(), sink) },
    Channel { columns: "dq{joint}", unit: "rad/s", meaning: "estimated", place: Place::File, values: |c, sink| numbers(c.joints.dq.as_slice(), sink) },
    Channel { columns: "tau{joint}", unit: "Nm", meaning: "torque of the controller, gravity included; empty where it did not run", place: Place::File, values: |c, sink| of_step(c, |step| &step.torque, sink) },
    Channel { columns: "sent{joint}", unit: "Nm", meaning: "added torque as sent", place: Place::File, values: |c, sink| numbers(c.sent.as_slice(), sink) },
    Channel { columns: "r{joint}", unit: "Nm", meaning: "residual; empty as `tau`", place: Place::File, values: |c, sink| of_step(c, |step| &step.residual, sink) },
    Channel { columns: "mode", unit: "", meaning: "number of the controller's mode as in trace.csv; empty as `tau`", place: Place::File, values: |c, sink| sink(c.step.map_or(Value::Empty, |step| Value::Count(step.status.mode.number().into()))) },
    Channel { columns: "fault", unit: "", meaning: "number of the fault, or 0", place: Place::File, values: |c, sink| sink(Value::Count(fault(c))) },
    Channel { columns: "saturated", unit: "", meaning: "bits of joints", place: Place::File, values: |c, sink| sink(Value::Count(c.step.map_or(0, |step| step.status.saturated.0.into()))) },
    Channel { columns: "rank", unit: "", meaning: "bits of rows", place: Place::File, values: |c, sink| sink(Value::Count(c.step.map_or(0, |step| step.status.rank.0.into()))) },
] }

fn of_step<R>(cycle: &CycleReport<R>, pick: fn(&Step<f64>) -> &JointVector<f64>, sink: Sink<'_>) {
    match &cycle.step {
        Some(step) => numbers(pick(step).as_slice(), sink),
        None => (0..DOF).for_each(|_| sink(Value::Empty)),
    }
}

fn fault<R>(cycle: &CycleReport<R>) -> i64 {
    let fault = cycle.step.and_then(|step| step.status.fault);
    fault.map_or(0, |fault| fault.kind.number().into())
}
