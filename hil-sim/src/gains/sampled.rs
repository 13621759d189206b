//! The sampled loop: an arm near rest, what is read of it, the observer, a law that is linear
//! there, and the way of its torque back to the arm.
//!
//! ```text
//! arm        d/dt x = A x + B tau,  x = (q, dq), with elastic joints also (theta, dtheta)
//!            M ddq = tau - G q - F dq;   elastic:  M ddq = s - G q,  B ddtheta = tau - s - F dtheta,
//!                                                  s = K (theta - q) + D (dtheta - dq)
//!            over a cycle of constant torque  x+ = Phi x + Gamma tau, by the exponential
//! reading    true: q, v = dq
//!            filtered: v_k = a q_k / h + s_k,  s_(k+1) = (1 - a) v_k - a q_k / h
//! observer   r_k = e r_(k-1) + (1 - e) (M v_k / h - c_k),  e = exp(-K_I h)
//!            c_(k+1) = M v_k / h + tau acting - G q_k
//! law        tau_k = T_q q_k + T_v v_k + T_r r_k,  acts d cycles later
//! ```
//!
//! All are deviations from the arm at rest on its targets, where the Coriolis terms are of second
//! order. The order of the state: x, s, r, c, the torques under way.

use super::matrix::Matrix;

/// What moves: `n` joints.
#[derive(Clone, Debug)]
pub struct Arm {
    /// M as the controller believes it \[kg m2\].
    pub mass_matrix: Matrix,
    /// Inverse of the mass matrix that the torque or, with elastic joints, the springs move.
    pub mobility: Matrix,
    /// G = dg/dq \[Nm/rad\].
    pub gravity_slope: Matrix,
    /// F_v, viscous friction \[Nms/rad\]; of the motors where joints are elastic.
    pub friction: Vec<f64>,
    /// Springs between motors and links.
    pub elastic: Option<Springs>,
}

/// Motors on springs, one per joint.
#[derive(Clone, Debug)]
pub struct Springs {
    /// K \[Nm/rad\].
    pub stiffness: Vec<f64>,
    /// D \[Nms/rad\].
    pub damping: Vec<f64>,
    /// B \[kg m2\].
    pub inertia: Vec<f64>,
}

/// What is read of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// Angle and speed of the link.
    Link,
    /// Angle and speed of the motor, which is that of the link unless joints are elastic.
    Motor,
    /// Angle of the link, and its difference through the pole a = 1 - exp(-2 pi f h).
    Filtered {
        /// f \[Hz\].
        corner_hz: f64,
    },
}

/// What passes between arm and law.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timing {
    /// h \[s\].
    pub cycle_s: f64,
    /// d, cycles between a torque and its effect.
    pub dead_cycles: u8,
    /// How positions and speeds come about.
    pub reading: Reading,
}

/// The law near rest: how its torque depends on what it reads.
#[derive(Clone, Debug)]
pub struct Slopes {
    /// T_q \[Nm/rad\].
    pub position: Matrix,
    /// T_v \[Nms/rad\].
    pub speed: Matrix,
    /// T_r.
    pub residual: Matrix,
    /// K_I \[1/s\].
    pub observer_gain: f64,
}

impl Timing {
    /// a of the velocity filter; 1 without one.
    #[must_use]
    pub fn pole(&self) -> f64 {
        match self.reading {
            Reading::Filtered { corner_hz } => {
                1.0 - libm::exp(-std::f64::consts::TAU * corner_hz * self.cycle_s)
            }
            Reading::Link | Reading::Motor => 1.0,
        }
    }
}

impl Arm {
    /// One joint of inertia 1 without weight: what a row of a task, or a mode of the null space,
    /// is in an arm whose model is exact.
    #[must_use]
    pub fn unit() -> Self {
        Self {
            mass_matrix: Matrix::scalar(1, 1.0),
            mobility: Matrix::scalar(1, 1.0),
            gravity_slope: Matrix::zeros(1, 1),
            friction: vec![0.0],
            elastic: None,
        }
    }

    /// The same arm `answer` times as light as believed: masses and motors.
    #[must_use]
    pub fn answering(&self, answer: f64) -> Self {
        let mut arm = self.clone();
        arm.mobility = arm.mobility.scaled(answer);
        if let Some(springs) = &mut arm.elastic {
            springs.inertia.iter_mut().for_each(|b| *b /= answer);
        }
        arm
    }

    /// Phi and Gamma over a cycle \[s\].
    fn over(&self, cycle_s: f64) -> (Matrix, Matrix) {
        let n = self.mass_matrix.rows();
        let states = self.states();
        let mut rate = Matrix::zeros(states + n, states + n);
        let one = Matrix::scalar(n, 1.0);
        rate.add_block(0, n, &one);
        let falling = self.mobility.times(&self.gravity_slope).scaled(-1.0);
        rate.add_block(n, 0, &falling);
        let friction = Matrix::diagonal(&self.friction).scaled(-1.0);
        match &self.elastic {
            None => {
                rate.add_block(n, n, &self.mobility.times(&friction));
                rate.add_block(n, states, &self.mobility);
            }
            Some(springs) => {
                let stiffness = Matrix::diagonal(&springs.stiffness);
                let damping = Matrix::diagonal(&springs.damping);
                let lightness = springs.inertia.iter().map(|b| 1.0 / b);
                let lightness = Matrix::diagonal(&lightness.collect::<Vec<_>>());
                rate.add_block(3 * n, 3 * n, &lightness.times(&friction));
                rate.add_block(2 * n, 3 * n, &one);
                // Rows of links and motors; columns of q, dq, theta, dtheta.
                for (row, mobility, sign) in [(n, &self.mobility, 1.0), (3 * n, &lightness, -1.0)] {
                    for (place, spring, way) in [
                        (0, &stiffness, -sign),
                        (n, &damping, -sign),
                        (2 * n, &stiffness, sign),
                        (3 * n, &damping, sign),
                    ] {
                        rate.add_block(row, place, &mobility.times(spring).scaled(way));
                    }
                }
                rate.add_block(3 * n, states, &lightness);
            }
        }
        let moved = rate.scaled(cycle_s).exponential();
        let phi = moved.block(0, 0, states, states);
        (phi, moved.block(0, states, states, n))
    }

    fn states(&self) -> usize {
        let n = self.mass_matrix.rows();
        if self.elastic.is_some() { 4 * n } else { 2 * n }
    }
}

/// What one cycle makes of the state of the loop.
#[must_use]
pub fn transition(arm: &Arm, timing: &Timing, law: &Slopes) -> Matrix {
    let n = arm.mass_matrix.rows();
    let (states, h) = (arm.states(), timing.cycle_s);
    let (filter, residual, known) = (states, states + n, states + 2 * n);
    let queue = states + 3 * n;
    let dead = usize::from(timing.dead_cycles);
    let size = queue + dead * n;
    let pick = |place: usize, factor: f64| {
        let mut rows = Matrix::zeros(n, size);
        rows.add_block(0, place, &Matrix::scalar(n, factor));
        rows
    };
    // Every one a map from the state.
    let position = match (timing.reading, &arm.elastic) {
        (Reading::Motor, Some(_)) => pick(2 * n, 1.0),
        _ => pick(0, 1.0),
    };
    let pole = timing.pole();
    let speed = match (timing.reading, &arm.elastic) {
        (Reading::Motor, Some(_)) => pick(3 * n, 1.0),
        (Reading::Filtered { .. }, _) => position.scaled(pole / h).plus(&pick(filter, 1.0)),
        _ => pick(n, 1.0),
    };
    let momentum_rate = arm.mass_matrix.scaled(1.0 / h).times(&speed);
    let kept = libm::exp(-law.observer_gain * h);
    let innovation = momentum_rate.plus(&pick(known, -1.0));
    let estimate = pick(residual, kept).plus(&innovation.scaled(1.0 - kept));
    let of_position = law.position.times(&position);
    let of_motion = of_position.plus(&law.speed.times(&speed));
    let torque = of_motion.plus(&law.residual.times(&estimate));
    let acting = match dead {
        0 => torque.clone(),
        _ => pick(queue + (dead - 1) * n, 1.0),
    };
    let weight = arm.gravity_slope.times(&position);

    let mut next = Matrix::zeros(size, size);
    let (phi, gamma) = arm.over(h);
    next.add_block(0, 0, &phi);
    next.add_block(0, 0, &gamma.times(&acting));
    if let Reading::Filtered { .. } = timing.reading {
        next.add_block(filter, 0, &speed.scaled(1.0 - pole));
        next.add_block(filter, 0, &position.scaled(-pole / h));
    }
    next.add_block(residual, 0, &estimate);
    next.add_block(known, 0, &momentum_rate.plus(&acting));
    next.add_block(known, 0, &weight.scaled(-1.0));
    if dead > 0 {
        next.add_block(queue, 0, &torque);
    }
    for place in 1..dead {
        next.add_block(queue + place * n, 0, &pick(queue + (place - 1) * n, 1.0));
    }
    next
}
