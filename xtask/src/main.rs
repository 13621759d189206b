//! What needs more than one cargo command: images for the Cortex-M7 are built, run
//! in QEMU and judged here, and two builds of `hil-sim` are compared.
//!
//! Exit codes: 0 as it should be, 1 not so, 2 wrong usage or a tool is missing (the
//! line that installs it is printed).

mod arm;
mod bench;
mod board;
mod docs;
mod figures;
mod fri;
mod fri_check;
mod frozen;
mod host;
mod hostile;
mod limits;
mod lines;
mod paced;
mod panic_free;
mod placement;
mod rooms;
mod same_bytes;
mod selftest;
mod stack;
mod table;
mod tools;

use std::process::ExitCode;

use board::Medium;
use tools::{LLVM, QEMU, Trouble};

const USAGE: &str = "usage: cargo xtask COMMAND

selftest-m7 [CYCLES]   torques of host and Cortex-M7, bit for bit; default 10000 cycles
panic-free-m7          constructor and cycle link without a panic, and not with one
bench-m7 [--write | --write-host]
                       instructions, stack and flash against docs/timing.json and limits;
                       --write makes docs/timing.md and docs/timing.json anew, and
                       counts the host's instructions where valgrind is there;
                       --write-host takes the host's committed counts into both, and
                       measures nothing
arm-m7                 the application image; its log needs defmt-print
fri-m7 [--serial]      the controller for a robot that speaks FRI, over UDP or a serial
                       port: run hil-sim serve beside it
fri-m7 --check         the same by itself: trace as without a board, safe outputs after an
                       emergency stop and without a robot; with --serial the first
                       second over the serial port
freeze OPTIONS OUT     the control cycle of one arm and its levels as a straight line, in a file of
                       its own; --check holds a file against what would be written;
                       --help has the options
board-m7               the skeleton for the STM32H743: builds, code in ITCM, data in DTCM
paced [--smoke] [--minutes M | --seconds S] [--load N]
                       hil-sim serve and firmware-host by the wall clock, both with
                       SCHED_FIFO, while N threads are kept busy; 10 minutes, 8 threads.
                       At most 0.1 % of the cycles may be without the client's answer in
                       time, its own p99.9 below 1 ms. --smoke: 15 s, 1 thread, and a PC
                       that cannot is no failure, but said
hostile [COUNT [SEED]] damaged datagrams and streams into the codecs of FRI and FCI, client and
                       robot of the FCI, and the sessions with both: COUNT for each of seven,
                       10000000 unless given; seed 1
lines [REVISION]       lines of code, and of documentation per public item, by package
missing-m7             prints what has to be installed for the first three, exit code 2 if anything

same-bytes BASE [NEW] [--ignore PART]...
                       results of two builds of hil-sim, byte by byte: built-in
                       scenarios, paper, explain of 200 random states. BASE and NEW are
                       executables or git revisions; NEW is the working tree unless
                       given. CSV columns and JSON paths with PART in their name may
                       differ

docs [DOCUMENT]...     commands of README, CONTRIBUTING and docs/*.md: each runs in a copy of the
                       workspace, exits with 0 and prints what the document shows, or
                       docs/commands.txt says why not

rooms                  every crate's files in the layers of docs/rooms.txt, none using one
                       above it, and none in a circle
rooms --graph CRATE    which file uses what of which other file";

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let words: Vec<&str> = arguments.iter().map(String::as_str).collect();
    let outcome = match words[..] {
        ["selftest-m7"] => selftest::run("10000"),
        ["selftest-m7", cycles] => selftest::run(cycles),
        ["panic-free-m7"] => panic_free::run(),
        ["bench-m7"] => bench::run(false),
        ["bench-m7", "--write"] => bench::run(true),
        ["bench-m7", "--write-host"] => bench::write_host(),
        ["arm-m7"] => arm::run(),
        ["fri-m7"] => fri::run(Medium::Ethernet),
        ["fri-m7", "--serial"] => fri::run(Medium::Serial),
        ["fri-m7", "--check"] => fri_check::run(Medium::Ethernet),
        ["fri-m7", "--check", "--serial"] => fri_check::run(Medium::Serial),
        ["freeze", ref words @ ..] => frozen::run(words),
        ["board-m7"] => placement::run(),
        ["paced", ref words @ ..] => paced::run(words),
        ["hostile", ref words @ ..] => hostile::run(words),
        ["lines"] => lines::run(None),
        ["lines", revision] => lines::run(Some(revision)),
        ["missing-m7"] => tools::find(&[QEMU, LLVM]).map(|()| true),
        ["same-bytes", ref words @ ..] => same_bytes::run(words),
        ["docs", ref words @ ..] => docs::run(words),
        ["rooms", ref words @ ..] => rooms::run(words),
        _ => Err(Trouble::usage(USAGE.into())),
    };
    match outcome {
        Ok(fine) => u8::from(!fine).into(),
        Err(trouble) => {
            eprintln!("{}", trouble.text);
            trouble.exit_code.into()
        }
    }
}
