//! `hil-sim serve --robot fci`: what differs from the LWR.

use std::net::SocketAddr;
use std::path::Path;

use crate::cli::files::{Files, announce};
use crate::cli::notes;
use crate::output::Folder;
use crate::robot::{FciFigures, FciOptions, FciRobot, RobotSetup};
use crate::serve::{End, FciService, Operator};
use crate::summary::Summary;
use cell::invalid::Invalid;
use cell::realtime::Realtime;
use cell::terminal::tell;
use record::run::Sample;

/// Where it listens, if nothing is said: the vendor's port.
pub(super) const PORT: u16 = 1337;

/// ADDRESS or ADDRESS:PORT of this PC.
pub(super) fn address(text: &str) -> Result<SocketAddr, String> {
    let with_port = text.parse().map(|ip| SocketAddr::new(ip, PORT));
    with_port.or_else(|_| text.parse()).map_err(|_| {
        format!("ADDRESS of this PC, such as 127.0.0.1, or ADDRESS:PORT [port {PORT}]")
    })
}

/// A service that has ended: what it leaves.
pub(super) struct Served {
    pub files: Files,
    pub robot: FciRobot,
    pub summary: Summary,
    /// Lines for the terminal.
    pub text: String,
}

/// Serves; none where no client came.
pub(super) fn serve(
    service: &FciService,
    setup: RobotSetup<FciOptions>,
    cpu: Option<usize>,
    out: &Path,
) -> Result<Option<Served>, Invalid> {
    let number = setup.options.version.number();
    let scenario = setup.scenario.clone();
    FciOptions::check_cycle(&scenario)?;
    announce(&scenario, f64::INFINITY)?;
    let sockets = service.open()?;
    let mut files = Files::create(Folder::claim(out)?, &scenario, setup.contacts)?;
    let place = sockets.address().unwrap_or(service.address);
    tell(format_args!(
        "robot at the start posture, version {number}, listening on {place}; lines on standard \
         input: push, release, drives off|on, quit"
    ));
    notes::say_what_is_unknown(&scenario, setup.plant);
    let mut operator = Operator::at_the_terminal();
    let mut robot = FciRobot::new(setup);
    let mut sink = |instant: &Sample| files.push(instant);
    let realtime = (!service.lockstep).then(|| Realtime::ask_without_memory(cpu));
    if let Some(realtime) = &realtime {
        tell(realtime.line());
    }
    let end = service
        .run(&mut robot, &mut operator, sockets, &mut sink)
        .map_err(|error| Invalid::line(error).within(place))?;
    if let Some(realtime) = &realtime {
        realtime.release();
    }
    if let End::NoClient(why) = end {
        tell(format_args!("error: {why}"));
        return Ok(None);
    }
    let mut summary = robot.summary();
    if let Some(fci) = &mut summary.fci {
        fci.realtime = realtime;
    }
    let text = summary.fci.as_ref().map_or(String::new(), fci_line);
    Ok(Some(Served {
        files,
        robot,
        summary,
        text,
    }))
}

/// The interface in one line, and in others what has happened.
fn fci_line(fci: &FciFigures) -> String {
    let percent =
        |share: Option<f64>| share.map_or("-".to_string(), |share| format!("{:.1}", share * 100.0));
    let errors = match fci.errors.is_empty() {
        true => String::new(),
        false => format!(" ({})", fci.errors.join(", ")),
    };
    let own = fci.own_lateness.as_ref().map_or(String::new(), |own| {
        format!(
            "robot's own lateness: {} cycles by more than {} ms, p99.9 {:.3} ms, max {:.3} ms\n",
            own.cycles, own.bound_ms, own.p999_ms, own.max_ms,
        )
    });
    let events: String = fci
        .events
        .iter()
        .map(|event| match event.t_s {
            Some(t_s) => format!("{t_s:.3} s: {}\n", event.text),
            None => format!("before time 0: {}\n", event.text),
        })
        .collect();
    format!(
        "FCI version {}: {} % under torque, {} motions, {} reflexes{errors}, {} commands, {} lost, \
         {} late, success rate at least {} %, torque step {:.2} Nm\n{own}{events}",
        fci.version,
        percent(fci.command_share),
        fci.motions,
        fci.reflexes,
        fci.commands,
        fci.lost,
        fci.late,
        percent(fci.success_rate_min),
        fci.largest_torque_step_nm,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_port_is_the_vendors_unless_it_is_said() {
        let at = |text: &str| address(text).map(|address| address.to_string());
        assert_eq!(at("127.0.0.2"), Ok("127.0.0.2:1337".to_string()));
        assert_eq!(at("127.0.0.2:4000"), Ok("127.0.0.2:4000".to_string()));
        assert_eq!(at("::1"), Ok("[::1]:1337".to_string()));
        assert_eq!(at("0.0.0.0"), Ok("0.0.0.0:1337".to_string()));
        for text in ["", "robot", "127.0.0", "127.0.0.1:", "127.0.0.1:65536"] {
            assert!(at(text).is_err(), "{text}");
        }
    }
}
