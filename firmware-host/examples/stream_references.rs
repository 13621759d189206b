//! References over UDP, for `firmware-host run --references ADDR:PORT`: moves the
//! point of level 1 to and fro along y.
//!
//! ```sh
//! cargo run --release -p firmware-host --example stream_references -- 127.0.0.1:5600 -0.59 0.0 0.40
//! ```
//!
//! The arguments are where to send, and the middle of the motion x y z [m], which
//! should be near where the point is. 10 s at 500 references per second: 5 cm to
//! either side in 4 s, with a smooth start.

use std::f64::consts::TAU;
use std::net::UdpSocket;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const RADIUS_M: f64 = 0.05;
const PERIOD_S: f64 = 4.0;
const START_S: f64 = 2.0;
const LENGTH_S: f64 = 10.0;
const STEP: Duration = Duration::from_millis(2);

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}; allowed: ADDR:PORT X Y Z");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [address, x, y, z] = &arguments[..] else {
        return Err(format!("{} arguments", arguments.len()).into());
    };
    let middle: [f64; 3] = [x.parse()?, y.parse()?, z.parse()?];
    let socket = UdpSocket::bind("0.0.0.0:0")?;
    socket.connect(address)?;
    let begin = Instant::now();
    let mut next = begin;
    while begin.elapsed().as_secs_f64() < LENGTH_S {
        let t = (next - begin).as_secs_f64();
        // 10 s^3 - 15 s^4 + 6 s^5 and its derivatives make the start smooth.
        let s = (t / START_S).min(1.0);
        let b = s * s * s * (10.0 + s * (6.0 * s - 15.0));
        let db = 30.0 * s * s * (1.0 - s) * (1.0 - s) / START_S;
        let ddb = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / (START_S * START_S);
        let omega = TAU / PERIOD_S;
        let (sin, cos) = (omega * t).sin_cos();
        let position = RADIUS_M * b * sin;
        let velocity = RADIUS_M * (db * sin + b * omega * cos);
        let acceleration =
            RADIUS_M * (ddb * sin + 2.0 * db * omega * cos - b * omega * omega * sin);
        let text = format!(
            "{} {} {}, 0 {velocity} 0, 0 {acceleration} 0",
            middle[0],
            middle[1] + position,
            middle[2]
        );
        // Nobody listening yet is no error.
        let _ = socket.send(text.as_bytes());
        next += STEP;
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    Ok(())
}
