//! Random states for `hil-sim explain`, the same in every run; docs/explain.md has the
//! format.

use std::f64::consts::FRAC_PI_2;

use rand::seq::IndexedRandom;
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use serde_json::{Value, json};

const COUNT: usize = 200;
const SEED: u64 = 1;

/// All of `hil-sim/src/controllers.rs`.
const CONTROLLERS: [&str; 6] = [
    "hierarchical",
    "no-observer",
    "literal",
    "as-printed",
    "acceleration-level",
    "acceleration-level-estimate",
];

/// Of the core's table of this arm, as the limits.
const POINTS: [&str; 5] = ["upper", "elbow", "forearm", "wrist", "flange"];

/// Largest joint angle \[degrees\], both ways.
const LIMITS_DEG: [f64; 7] = [170.0, 120.0, 170.0, 120.0, 170.0, 120.0, 170.0];

/// Sets of axes by their number.
const AXES: [&[&str]; 3] = [&["x", "y", "z"], &["xy", "xz", "yz"], &["xyz"]];

/// Rows of all levels.
const MAX_ROWS: usize = 7;

/// All of them. Of ten states in a row three have an orientation level, of 1, 2 and 3
/// rows, under another controller each time.
pub fn all() -> Vec<Value> {
    let mut random = Random(ChaCha8Rng::seed_from_u64(SEED));
    (0..COUNT)
        .map(|index| {
            let turned = (index % 10 < 3).then_some(index % 10 + 1);
            let controller = CONTROLLERS[(index + index / 10) % CONTROLLERS.len()];
            random.state(controller, turned)
        })
        .collect()
}

/// The same numbers everywhere.
struct Random(ChaCha8Rng);

impl Random {
    fn below(&mut self, end: usize) -> usize {
        self.0.random_range(..end)
    }

    fn one_in(&mut self, count: usize) -> bool {
        self.below(count) == 0
    }

    fn many(&mut self, count: usize, low: f64, high: f64) -> Vec<f64> {
        (0..count).map(|_| self.0.random_range(low..high)).collect()
    }

    fn joints(&mut self, size: f64) -> Vec<f64> {
        self.many(7, -size, size)
    }

    /// `turned` is the number of rows of an orientation level.
    fn state(&mut self, controller: &str, turned: Option<usize>) -> Value {
        let mut state = json!({
            "robot": "lwr_iv",
            "q": self.posture(),
            "dq": if self.one_in(8) { vec![0.0; 7] } else { self.joints(1.5) },
            "levels": self.levels(turned),
            "null_space": {
                "q_d": self.posture(),
                "stiffness": self.many(7, 0.0, 40.0),
                "damping": self.many(7, 0.0, 5.0),
            },
            "controller": controller,
        });
        if self.one_in(2) {
            state["residual"] = json!(self.joints(5.0));
        }
        if self.one_in(2) {
            state["null_space"]["rate_gain"] = json!(self.many(7, 1.0, 30.0));
        }
        if self.one_in(4) {
            state["observer"] = json!({
                "momentum_prev": self.joints(2.0),
                "input_prev": self.joints(20.0),
                "residual_prev": self.joints(5.0),
                "gain": self.many(7, 0.0, 200.0),
                "h": self.0.random_range(0.0005..0.02),
            });
        }
        state
    }

    /// Angles; in some states joints stand at zero or at a right angle, where rows
    /// cannot be resolved.
    fn posture(&mut self) -> Vec<f64> {
        let special = self.one_in(6);
        let angle = |limit: f64| {
            let angle = self.0.random_range(-limit..limit).to_radians();
            let choice = self.below(if special { 4 } else { 1 });
            [angle, 0.0, 0.0, FRAC_PI_2][choice]
        };
        LIMITS_DEG.map(angle).into()
    }

    /// 1 to 3 levels.
    fn levels(&mut self, turned: Option<usize>) -> Vec<Value> {
        let count = 1 + self.below(3);
        let turned = turned.map(|rows| (self.below(count), rows));
        let mut free = MAX_ROWS - turned.map_or(0, |(_, rows)| rows);
        let mut left = count - usize::from(turned.is_some());
        (0..count)
            .map(|level| match turned {
                Some((at, rows)) if at == level => self.level(rows, true),
                _ => {
                    // Each level that follows needs a row.
                    left -= 1;
                    let rows = 1 + self.below((free - left).min(3));
                    free -= rows;
                    self.level(rows, false)
                }
            })
            .collect()
    }

    fn level(&mut self, rows: usize, turned: bool) -> Value {
        json!({
            "task": if turned { "orientation" } else { "position" },
            "point": self.point(),
            "axes": AXES[rows - 1].choose(&mut self.0),
            "x": if turned { self.quaternion() } else { self.many(rows, -0.9, 0.9) },
            "dx": self.many(rows, -0.5, 0.5),
            "ddx": self.many(rows, -1.0, 1.0),
            "kp": self.many(rows, 50.0, 900.0),
            "kd": self.many(rows, 5.0, 60.0),
        })
    }

    fn point(&mut self) -> Value {
        if self.one_in(6) {
            json!({ "link": 1 + self.below(7), "offset_m": self.many(3, -0.3, 0.3) })
        } else {
            json!(POINTS.choose(&mut self.0))
        }
    }

    /// Of length 0.8 to 1.2: the core has to normalise it.
    fn quaternion(&mut self) -> Vec<f64> {
        loop {
            let values = self.many(4, -1.0, 1.0);
            let norm = values.iter().map(|x| x * x).sum::<f64>().sqrt();
            if norm > 0.1 {
                let length = self.0.random_range(0.8..1.2);
                return values.iter().map(|x| x / norm * length).collect();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn levels(state: &Value) -> &Vec<Value> {
        state["levels"].as_array().expect("levels")
    }

    fn rows(level: &Value) -> usize {
        level["axes"].as_str().expect("axes").len()
    }

    #[test]
    fn states_are_the_same_every_time_and_differ_from_each_other() {
        let states = all();
        assert_eq!(states.len(), COUNT);
        assert_eq!(states, all());
        assert!(states.windows(2).all(|pair| pair[0] != pair[1]));
    }

    #[test]
    fn sixty_states_have_an_orientation_level_twenty_of_each_size() {
        let mut sizes = [0; 4];
        for state in all() {
            let turned = |level: &&Value| level["task"] == "orientation";
            if let Some(level) = levels(&state).iter().find(turned) {
                sizes[rows(level)] += 1;
            }
        }
        assert_eq!(sizes, [0, 20, 20, 20]);
    }

    #[test]
    fn joints_and_rows_are_within_their_limits_and_every_kind_is_there() {
        let states = all();
        let mut most = 0;
        for state in &states {
            let q = state["q"].as_array().expect("q");
            for (q, limit) in q.iter().zip(LIMITS_DEG) {
                assert!(q.as_f64().expect("number").to_degrees().abs() <= limit + 1e-9);
            }
            let rows: usize = levels(state).iter().map(rows).sum();
            assert!(rows <= MAX_ROWS);
            most = most.max(rows);
        }
        assert_eq!(most, MAX_ROWS);
        let has = |test: &dyn Fn(&Value) -> bool| states.iter().any(test);
        for count in 1..=3 {
            assert!(has(&|state| levels(state).len() == count));
        }
        for controller in CONTROLLERS {
            assert!(has(&|state| state["controller"] == controller));
            assert!(has(&|state| state["controller"] == controller
                && levels(state)
                    .iter()
                    .any(|level| level["task"] == "orientation")));
        }
        for point in POINTS {
            assert!(has(&|state| levels(state)
                .iter()
                .any(|level| level["point"] == point)));
        }
        assert!(has(&|state| state["observer"].is_object()));
        assert!(has(&|state| state["residual"].is_array()));
    }
}
