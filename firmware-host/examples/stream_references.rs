//! References over UDP, for `firmware-host run --references ADDR:PORT`: moves the
//! point of level 1 to and fro along y, and turns the link of level 2 about z with it, where
//! that is an orientation.
//!
//! ```sh
//! cargo run --release -p firmware-host --example stream_references -- 127.0.0.1:5600 -0.59 0.0 0.40
//! ```
//!
//! The arguments are where to send, the middle of the motion x y z [m], and for a scenario
//! with an orientation as level 2 the quaternion w x y z in the middle of its motion. Both
//! should be near where the arm is. 10 s at 500 references per second: 5 cm and 0.1 rad to
//! either side in 4 s, with a smooth start.

use std::f64::consts::TAU;
use std::net::UdpSocket;
use std::process::ExitCode;
use std::time::{Duration, Instant};

const RADIUS_M: f64 = 0.05;
const ANGLE_RAD: f64 = 0.1;
const PERIOD_S: f64 = 4.0;
const START_S: f64 = 2.0;
const LENGTH_S: f64 = 10.0;
const STEP: Duration = Duration::from_millis(2);

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}; allowed: ADDR:PORT X Y Z [W X Y Z]");
            ExitCode::from(2)
        }
    }
}

fn run() -> Result<(), Box<dyn std::error::Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let Some((address, numbers)) = arguments.split_first() else {
        return Err("no arguments".into());
    };
    let numbers = numbers.iter().map(|number| number.parse());
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let (point, frame) = match numbers[..] {
        [x, y, z] => ([x, y, z], None),
        [x, y, z, qw, qx, qy, qz] => ([x, y, z], Some([qw, qx, qy, qz])),
        _ => return Err(format!("{} numbers", numbers.len()).into()),
    };
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
        let way = b * sin;
        let rate = db * sin + b * omega * cos;
        let curvature = ddb * sin + 2.0 * db * omega * cos - b * omega * omega * sin;
        let motion = [way, rate, curvature];
        let mut text = position(point, motion);
        if let Some(frame) = frame {
            // The next level.
            text = text + ", " + &orientation(frame, motion);
        }
        // Nobody listening yet is no error.
        let _ = socket.send(text.as_bytes());
        next += STEP;
        std::thread::sleep(next.saturating_duration_since(Instant::now()));
    }
    Ok(())
}

/// Nine numbers: x y z, velocity, acceleration.
fn position([x, y, z]: [f64; 3], [way, rate, curvature]: [f64; 3]) -> String {
    let [y, dy, ddy] = [y + RADIUS_M * way, RADIUS_M * rate, RADIUS_M * curvature];
    format!("{x} {y} {z}, 0 {dy} 0, 0 {ddy} 0")
}

/// Ten numbers: w x y z, angular velocity, angular acceleration.
fn orientation([w, x, y, z]: [f64; 4], [way, rate, curvature]: [f64; 3]) -> String {
    let [angle, speed, acceleration] = [way, rate, curvature].map(|part| ANGLE_RAD * part);
    // (cos, 0, 0, sin) of half the angle times the quaternion in the middle.
    let (sin, cos) = (0.5 * angle).sin_cos();
    let [w, z] = [cos * w - sin * z, cos * z + sin * w];
    let [x, y] = [cos * x - sin * y, cos * y + sin * x];
    format!("{w} {x} {y} {z}, 0 0 {speed}, 0 0 {acceleration}")
}
