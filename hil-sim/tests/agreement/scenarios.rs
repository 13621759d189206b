//! Random scenario files: a number fixes every byte.

use cell::names::PlantKind::{self, Ideal, Realistic};
use hil_sim::plant::Rng;

/// A scenario file, and the options of its runs.
pub struct Case {
    pub text: String,
    pub plant: PlantKind,
    pub dead_cycles: usize,
    pub seed: u64,
}

/// What the files are about, in turn.
const KINDS: [fn(&mut Draw) -> Plan; 6] = [calm, calm, jump, far, fast, near_a_limit];

/// Kind of numbers of the generator; those of the plant's noise are other ones.
const STREAM: u64 = 0x0061_6772_6565;

/// Joint ranges \[deg\].
const RANGE_DEG: [f64; 7] = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 170.0];

/// Null-space stiffness \[Nm/rad\] and damping \[Nms/rad\] of the built-in scenarios.
const STIFFNESS: [f64; 7] = [20.0, 20.0, 15.0, 15.0, 3.0, 2.0, 0.2];
const DAMPING: [f64; 7] = [4.0, 4.0, 3.0, 3.0, 0.4, 0.3, 0.03];

/// Posture and reference of the first level.
struct Plan {
    start_deg: [f64; 7],
    orientation: bool,
    reference: String,
}

/// The case with this number.
pub fn case(number: u64) -> Case {
    let mut draw = Draw(Rng::new(number, STREAM));
    let plan = KINDS[number as usize % KINDS.len()](&mut draw);
    let plant = draw.of(&[Ideal, Realistic]);
    let dead_cycles = draw.of(&[0, 0, 0, 1, 2]);
    let cycle_ms = draw.of(&[1.0, 2.0, 2.0, 2.0, 4.0]);
    let duration_s = draw.within(0.6, 1.6);
    let kp = draw.within(80.0, 500.0);
    // Around critical damping.
    let kd = 2.0 * kp.sqrt() * draw.within(0.7, 1.3);
    let softer = draw.within(0.3, 1.0);
    // What the cycle carries shrinks with it.
    let damping = DAMPING.map(|d| d * (2.0 / cycle_ms) * softer.sqrt());
    let mut text = format!(
        "name = 'case-{number}'\nrobot = 'lwr_iv'\nduration_s = {duration_s}\n\
         cycle_ms = {cycle_ms:?}\nstart_deg = {:?}\n\
         [null_space]\nstiffness = {:?}\ndamping = {damping:?}\n\
         [observer]\ngain = {}\n",
        plan.start_deg,
        STIFFNESS.map(|k| k * softer),
        draw.within(10.0, 50.0),
    );
    let task = if plan.orientation {
        "orientation"
    } else {
        "position"
    };
    let axes = draw.of(&["xyz", "xyz", "xy", "z"]);
    text += &level(task, "flange", axes, [kp, kd], &plan.reference);
    if draw.one_in(3) {
        let point = draw.of(&["elbow", "forearm"]);
        let axes = draw.of(&["x", "y", "z"]);
        text += &level("position", point, axes, [kp, kd], "kind = 'hold'");
    }
    for _ in 0..draw.of(&[0, 0, 1, 2]) {
        let from_s = draw.within(0.1, 0.3) * duration_s;
        let to_s = from_s + 0.4 * duration_s;
        text += &format!(
            "[[contact]]\npoint = '{}'\nfrom_s = {from_s}\nto_s = {to_s}\nramp_s = 0.05\n\
             force_n = {:?}\n",
            draw.of(&["upper", "elbow", "forearm", "flange"]),
            [(); 3].map(|()| draw.within(-30.0, 30.0)),
        );
    }
    // A limit that some keep and some do not, in the unit of the level.
    let unit = if plan.orientation { "mrad" } else { "mm" };
    let below = draw.within(0.5, 20.0);
    for measurement in ["direct", "like-fri", "fri"] {
        text += &format!(
            "[[limit]]\nplant = '{}'\ncontacts = true\nmeasurement = '{measurement}'\n\
             dead_cycles = {dead_cycles}\nmetric = 'level1_max_{unit}'\nbelow = {below}\n",
            cell::names::Named::name(plant),
        );
    }
    Case {
        text,
        plant,
        dead_cycles,
        seed: number,
    }
}

fn level(task: &str, point: &str, axes: &str, [kp, kd]: [f64; 2], reference: &str) -> String {
    format!(
        "[[level]]\ntask = '{task}'\npoint = '{point}'\naxes = '{axes}'\nstiffness = {kp}\n\
         damping = {kd}\n[level.reference]\n{reference}\n"
    )
}

/// A motion that an arm makes every day.
fn calm(draw: &mut Draw) -> Plan {
    let orientation = draw.one_in(4);
    let turn = [draw.within(1.5, 4.0), draw.within(0.5, 2.0)];
    let reference = match draw.below(4) {
        0 => "kind = 'hold'".into(),
        _ if orientation => swing(draw, 20.0, turn),
        1 => straight(draw, 0.08, 1.0),
        2 => circle(draw, "circle", 0.06, turn),
        _ => circle(draw, "spiral", 0.06, turn),
    };
    Plan {
        start_deg: draw.bent(),
        orientation,
        reference,
    }
}

/// A target that is elsewhere at once.
fn jump(draw: &mut Draw) -> Plan {
    let reach_m = draw.of(&[0.05, 0.2, 0.6]);
    let reference = straight(draw, reach_m, 1e-3);
    Plan {
        start_deg: draw.bent(),
        orientation: false,
        reference,
    }
}

/// A target that no arm reaches.
fn far(draw: &mut Draw) -> Plan {
    let duration_s = draw.within(0.3, 1.5);
    let reference = straight(draw, 1.5, duration_s);
    Plan {
        start_deg: draw.bent(),
        orientation: false,
        reference,
    }
}

/// A motion that asks for more speed or torque than there is.
fn fast(draw: &mut Draw) -> Plan {
    let orientation = draw.one_in(3);
    let turn = [draw.within(0.1, 0.6), draw.within(0.05, 0.5)];
    let reference = if orientation {
        swing(draw, 120.0, turn)
    } else {
        circle(draw, "circle", 0.2, turn)
    };
    Plan {
        start_deg: draw.bent(),
        orientation,
        reference,
    }
}

/// A start beside the end of a joint's range, and a motion that may cross it.
fn near_a_limit(draw: &mut Draw) -> Plan {
    let mut start_deg = draw.bent();
    let joint = draw.below(7);
    let side = draw.of(&[-1.0, 1.0]);
    start_deg[joint] = side * (RANGE_DEG[joint] - draw.within(0.0, 6.0));
    let reference = straight(draw, 0.4, 1.0);
    Plan {
        start_deg,
        orientation: false,
        reference,
    }
}

fn straight(draw: &mut Draw, reach_m: f64, duration_s: f64) -> String {
    let way = [(); 3].map(|()| draw.within(-1.0, 1.0));
    let norm = way.iter().map(|x| x * x).sum::<f64>().sqrt().max(0.1);
    let by_m = way.map(|x| x / norm * reach_m);
    format!("kind = 'move'\nby_m = {by_m:?}\nduration_s = {duration_s}")
}

fn circle(draw: &mut Draw, kind: &str, radius_m: f64, [period_s, growth_s]: [f64; 2]) -> String {
    let plane = draw.of(&["xy", "xz", "yz"]);
    format!(
        "kind = '{kind}'\nplane = '{plane}'\nradius_m = {}\nperiod_s = {period_s}\n\
         growth_s = {growth_s}",
        draw.within(0.5, 1.0) * radius_m
    )
}

fn swing(draw: &mut Draw, angle_deg: f64, [period_s, growth_s]: [f64; 2]) -> String {
    let axis = draw.of(&[[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    format!(
        "kind = 'swing'\naxis = {axis:?}\nangle_deg = {}\nperiod_s = {period_s}\n\
         growth_s = {growth_s}",
        draw.within(0.5, 1.0) * angle_deg
    )
}

/// Numbers of one case.
struct Draw(Rng);

impl Draw {
    fn within(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.0.uniform()
    }

    fn below(&mut self, count: usize) -> usize {
        (self.0.uniform() * count as f64) as usize
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    fn of<T: Copy>(&mut self, choices: &[T]) -> T {
        choices[self.below(choices.len())]
    }

    /// A posture with bent elbow and wrist: the tasks have all their directions.
    fn bent(&mut self) -> [f64; 7] {
        let side = self.of(&[-1.0, 1.0]);
        [
            self.within(-60.0, 60.0),
            self.within(15.0, 50.0),
            self.within(-40.0, 40.0),
            -side * self.within(50.0, 100.0),
            self.within(-60.0, 60.0),
            side * self.within(35.0, 80.0),
            self.within(-90.0, 90.0),
        ]
    }
}
