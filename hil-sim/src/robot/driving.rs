//! What the motors get besides the robot's own weight, and how one way of driving
//! turns into another without a step.

use controller_core::joint::{JointState, JointVector};

use crate::plant::{DeadTime, Impedance};

/// One way of driving: a torque, and springs and dampers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Driving {
    /// Added torque \[Nm\].
    pub torque: JointVector<f64>,
    /// Springs and dampers.
    pub impedance: Impedance,
}

/// A way of driving that the motors can give.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limited {
    /// What is added, and the springs and dampers.
    pub driving: Driving,
    /// All that the motors give at the start of the cycle \[Nm\].
    pub torque: JointVector<f64>,
    /// Whether a joint was cut.
    pub saturated: bool,
}

impl Driving {
    /// Springs and dampers alone.
    #[must_use]
    pub fn by_springs(impedance: Impedance) -> Self {
        Self {
            torque: JointVector::zeros(),
            impedance,
        }
    }

    /// The same within the torque `limit` \[Nm\] of each joint for `motors` that move so;
    /// what is too much is taken off the added torque.
    #[must_use]
    pub fn limited(&self, motors: &JointState<f64>, limit: &JointVector<f64>) -> Limited {
        let by_springs = self.impedance.torque(motors);
        let mut limited = Limited {
            driving: *self,
            torque: self.torque + by_springs,
            saturated: false,
        };
        for (joint, &limit) in limit.iter().enumerate() {
            let torque = &mut limited.torque[joint];
            if torque.abs() > limit {
                *torque = torque.clamp(-limit, limit);
                limited.driving.torque[joint] = *torque - by_springs[joint];
                limited.saturated = true;
            }
        }
        limited
    }

    /// Where the springs are at the end of a cycle, at rest there.
    #[must_use]
    pub fn at_rest_after(&self, cycle_s: f64) -> Self {
        Self {
            torque: self.torque,
            impedance: Impedance {
                rate: JointVector::zeros(),
                ..self.impedance.after(cycle_s)
            },
        }
    }
}

/// The passage from one way of driving to another. The old one keeps 1 - s of
/// its torque, stiffness and damping, the new springs and dampers have s of
/// theirs, and s grows from 0 to 1 by equal shares per cycle. As all of them are
/// torques that add up, their sum has no step. The new added torque acts at
/// once: its sender decides how it begins.
#[derive(Clone, Debug)]
pub struct Passage {
    old: Driving,
    /// Speed of the targets at the beginning \[rad/s\]; they come to rest with the
    /// passage.
    rate: JointVector<f64>,
    cycle_s: f64,
    done: u64,
    length: u64,
}

impl Passage {
    /// No passage under way; later ones take `length` cycles (above 0) of `cycle_s`
    /// \[s\].
    #[must_use]
    pub fn none(length: u64, cycle_s: f64) -> Self {
        Self {
            old: Driving::by_springs(Impedance::NONE),
            rate: JointVector::zeros(),
            cycle_s,
            done: length,
            length,
        }
    }

    /// Starts from the cycle `old`, whose targets go on with `rate` \[rad/s\].
    pub fn begin(&mut self, old: Driving, rate: JointVector<f64>) {
        self.old = old.at_rest_after(self.cycle_s);
        self.rate = rate;
        self.done = 0;
    }

    /// Ends it early: what is new acts alone.
    pub fn end(&mut self) {
        self.done = self.length;
    }

    /// Whether it is under way.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.done < self.length
    }

    /// One cycle: how fast the targets still move in it \[rad/s\]. The old ones do;
    /// new ones that are to come to rest together with them shall as well.
    pub fn next(&mut self) -> JointVector<f64> {
        if !self.is_running() {
            return JointVector::zeros();
        }
        self.old = self.old.at_rest_after(self.cycle_s);
        self.done += 1;
        let s = self.share();
        // From 1 to 0 with no slope at either end.
        let rate = self.rate * ((1.0 - s) * (1.0 - s) * (1.0 + 2.0 * s));
        self.old.impedance.rate = rate;
        rate
    }

    fn share(&self) -> f64 {
        self.done as f64 / self.length as f64
    }

    /// What acts in this cycle, when `new` is what shall act in the end.
    #[must_use]
    pub fn blend(&self, new: &Driving) -> Driving {
        if !self.is_running() {
            return *new;
        }
        let s = self.share();
        let (from, to) = (&self.old.impedance, &new.impedance);
        let (before, after) = (from.stiffness * (1.0 - s), to.stiffness * s);
        let stiffness = before + after;
        let mean = |from: &JointVector<f64>, to: &JointVector<f64>| {
            JointVector::from_fn(|i, _| {
                if stiffness[i] > 0.0 {
                    (before[i] * from[i] + after[i] * to[i]) / stiffness[i]
                } else {
                    to[i]
                }
            })
        };
        Driving {
            torque: self.old.torque * (1.0 - s) + new.torque,
            impedance: Impedance {
                stiffness,
                damping: from.damping * (1.0 - s) + to.damping * s,
                target: mean(&from.target, &to.target),
                rate: mean(&from.rate, &to.rate),
            },
        }
    }
}

/// The way of added torque to the motors: so many cycles long.
pub struct Pipe {
    cycles: usize,
    way: DeadTime,
}

impl Pipe {
    /// Nothing is under way.
    pub fn new(cycles: usize) -> Self {
        let way = DeadTime::new(cycles, JointVector::zeros());
        Self { cycles, way }
    }

    /// One cycle: takes what is ordered \[Nm\], gives what arrives.
    pub fn pass(&mut self, ordered: &JointVector<f64>) -> JointVector<f64> {
        self.way.pass(ordered)
    }

    /// Forgets what is under way.
    pub fn void(&mut self) {
        *self = Self::new(self.cycles);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sum_of_torques_goes_evenly_from_old_to_new() {
        let spring = |stiffness: f64, damping: f64, target: f64| Impedance {
            stiffness: JointVector::repeat(stiffness),
            damping: JointVector::repeat(damping),
            target: JointVector::repeat(target),
            rate: JointVector::zeros(),
        };
        let old = Driving {
            torque: JointVector::repeat(10.0),
            impedance: spring(200.0, 5.0, 0.1),
        };
        let new = Driving::by_springs(spring(1000.0, 40.0, -0.02));
        let state = JointState {
            q: JointVector::repeat(0.01),
            dq: JointVector::repeat(0.3),
        };
        let total = |driving: &Driving| (driving.torque + driving.impedance.torque(&state))[2];
        let mut passage = Passage::none(50, 0.002);
        assert_eq!(passage.blend(&new), new);
        passage.begin(old, JointVector::zeros());
        for cycle in 1..=50 {
            passage.next();
            let s = f64::from(cycle) / 50.0;
            let expected = (1.0 - s) * total(&old) + s * total(&new);
            assert!((total(&passage.blend(&new)) - expected).abs() < 1e-12);
        }
        assert_eq!(passage.blend(&new), new);
    }

    #[test]
    fn moving_targets_come_to_rest() {
        let mut passage = Passage::none(50, 0.002);
        passage.begin(
            Driving::by_springs(Impedance::NONE),
            JointVector::repeat(0.5),
        );
        let steps: Vec<_> = (0..60).map(|_| passage.next()[0]).collect();
        assert!(steps.windows(2).all(|pair| pair[1] <= pair[0]));
        assert!(steps[0] > 0.499 && steps[49] == 0.0 && steps[59] == 0.0);
        // Half of the way at full speed.
        let way: f64 = steps.iter().sum::<f64>() * 0.002;
        assert!((way - 0.0245).abs() < 1e-4, "{way}");
    }
}
