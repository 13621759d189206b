//! The paper's formulas as they are printed, in plain matrices and inverses: the
//! oracle that the core's factorisation and whitened law must agree with.
//!
//! Nothing here comes from the core's `hierarchy` or `law`. M, C, g, J and dJ/dt
//! enter as numbers ([`Terms`]); everything behind them is computed again:
//!
//! ```text
//! Z_i = [-J_m^T J_w^-T, 1] P^T              (20), null space of levels 1..i, P the pivoting
//! Jbar_i = J_i Z^T (Z M Z^T)^-1 Z M         (17), (21), Z = Z_(i-1)
//! Jbar_l = (Z M Z^T)^-1 Z M,  v = Jbar_l dq (21), Z = Z_(l-1)
//! Lambda_i = (Jbar_i M^-1 Jbar_i^T)^-1      Jbar_i^# = M^-1 Jbar_i^T Lambda_i   (18), (19)
//! mu_i = Jbar_i^#T C Jbar_i^# - Lambda_i (dJbar_i/dt) Jbar_i^#                  (28) as a matrix
//! ```
//!
//! Lambda_i of the null space equals Z M Z^T. Rates are analytic, from dM/dt =
//! C + C^T and from differentiating (20) with its columns held. [`Variant`]
//! switches the slips of the printed law (34) on and off.

pub mod closed_loop;
pub mod matrix;
pub mod sample;

pub use matrix::Matrix;

/// One task level, as plain numbers.
#[derive(Clone, Debug)]
pub struct LevelTerms {
    /// J_i.
    pub jacobian: Matrix,
    /// dJ_i/dt.
    pub jacobian_dot: Matrix,
    /// (12) before the bias: ddx_d + K_d dx_err + K_p x_err.
    pub commanded: Matrix,
}

/// Everything the formulas need to know about one instant.
#[derive(Clone, Debug)]
pub struct Terms {
    /// M.
    pub mass: Matrix,
    /// C, Christoffel.
    pub coriolis: Matrix,
    /// g.
    pub gravity: Matrix,
    /// dq.
    pub dq: Matrix,
    /// q~ = q_d - q.
    pub posture_error: Matrix,
    /// K_q.
    pub stiffness: Matrix,
    /// D.
    pub damping: Matrix,
    /// r.
    pub residual: Matrix,
    /// The task levels, highest priority first.
    pub levels: Vec<LevelTerms>,
}

/// A basis of the null space of some levels, with its rate.
#[derive(Clone, Debug)]
pub struct Basis {
    /// Z, r x 7.
    pub z: Matrix,
    /// dZ/dt.
    pub z_dot: Matrix,
    /// Columns of J that J_w of (20) consists of.
    pub columns: Vec<usize>,
}

/// One level of the hierarchy, the null space included.
#[derive(Clone, Debug)]
pub struct Projected {
    /// Jbar_i.
    pub jbar: Matrix,
    /// dJbar_i/dt.
    pub jbar_dot: Matrix,
    /// Jbar_i^#.
    pub jbar_pinv: Matrix,
    /// Lambda_i.
    pub lambda: Matrix,
    /// mu_i as the matrix of (33), (39).
    pub mu: Matrix,
}

/// What of the printed law is corrected.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// Whether a level knows J_i times the accelerations of the levels above,
    /// (8); (26) and (34) do not.
    pub coupled: bool,
    /// Without coupling: whether the bias is (dJbar_i/dt) dq, as (34) needs, or
    /// (dJ_i/dt) dq, as (26) prints.
    pub barred: bool,
    /// Sign of the stiffness term Z K_q q~ in (33).
    pub stiffness_sign: f64,
}

impl Variant {
    /// The exact law.
    pub const EXACT: Self = Self {
        coupled: true,
        barred: true,
        stiffness_sign: 1.0,
    };
    /// (34) without coupling, the sign corrected.
    pub const UNCOUPLED: Self = Self {
        coupled: false,
        ..Self::EXACT
    };
}

/// The hierarchy of one instant.
#[derive(Clone, Debug)]
pub struct Oracle {
    /// What it was computed from.
    pub terms: Terms,
    /// M^-1.
    pub mass_inverse: Matrix,
    /// The task levels, as [`Terms::levels`].
    pub levels: Vec<Projected>,
    /// Z of the null space of all levels.
    pub basis: Basis,
    /// The null space, index l: Jbar_l, Z^T in the place of Jbar_l^#, Z M Z^T.
    pub null: Projected,
}

impl Basis {
    /// (20), with the columns of J_w such that |det J_w| is largest: then no
    /// entry of J_w^-1 J_m exceeds 1.
    #[must_use]
    pub fn new(jacobian: &Matrix, jacobian_dot: &Matrix) -> Self {
        let (m, n) = (jacobian.rows(), jacobian.columns());
        let volume = |columns: &Vec<usize>| {
            let (_, determinant) = jacobian.selected(columns).inverse_and_determinant();
            // Elimination of an exactly singular choice divides 0 by 0.
            if determinant.is_nan() {
                0.0
            } else {
                determinant.abs()
            }
        };
        let best = choices(n, m)
            .into_iter()
            .max_by(|a, b| volume(a).total_cmp(&volume(b)))
            .expect("at least one choice of columns");
        Self::with_columns(jacobian, jacobian_dot, &best)
    }

    /// (20) with the given columns of J as J_w.
    #[must_use]
    pub fn with_columns(jacobian: &Matrix, jacobian_dot: &Matrix, chosen: &[usize]) -> Self {
        let n = jacobian.columns();
        let rest: Vec<usize> = (0..n).filter(|j| !chosen.contains(j)).collect();
        let inverse = jacobian.selected(chosen).inverse();
        // X = J_w^-1 J_m, dX/dt = J_w^-1 (dJ_m/dt - dJ_w/dt X).
        let x = &inverse * jacobian.selected(&rest);
        let x_dot = inverse * (jacobian_dot.selected(&rest) - jacobian_dot.selected(chosen) * &x);
        let placed = |block: &Matrix, unit: f64| {
            Matrix::from_fn(rest.len(), n, |i, j| {
                match chosen.iter().position(|&column| column == j) {
                    Some(k) => -block.at(k, i),
                    None => unit * f64::from(u8::from(rest[i] == j)),
                }
            })
        };
        Self {
            z: placed(&x, 1.0),
            z_dot: placed(&x_dot, 0.0),
            columns: chosen.to_vec(),
        }
    }

    /// Another basis of the same space: `by` Z, `by` turning with the rate `rate`.
    #[must_use]
    pub fn transformed(&self, by: &Matrix, rate: &Matrix) -> Self {
        Self {
            z: by * &self.z,
            z_dot: by * &self.z_dot + rate * &self.z,
            columns: self.columns.clone(),
        }
    }
}

/// All choices of `m` out of `n` columns, in order.
fn choices(n: usize, m: usize) -> Vec<Vec<usize>> {
    (0u32..1 << n)
        .filter(|set| set.count_ones() as usize == m)
        .map(|set| (0..n).filter(|&j| set >> j & 1 == 1).collect())
        .collect()
}

impl Oracle {
    /// The whole hierarchy with the pivoted basis.
    #[must_use]
    pub fn new(terms: Terms) -> Self {
        let (jacobian, jacobian_dot) = terms.stacked(terms.levels.len());
        let basis = Basis::new(&jacobian, &jacobian_dot);
        Self::with_basis(terms, basis)
    }

    /// The whole hierarchy with a given basis of the null space of all levels.
    #[must_use]
    pub fn with_basis(terms: Terms, basis: Basis) -> Self {
        let mass_inverse = terms.mass.inverse();
        let levels = (0..terms.levels.len())
            .map(|i| terms.projected(i, &mass_inverse))
            .collect();
        let (jbar, jbar_dot) = terms.null_velocity_map(&basis);
        let jbar_pinv = basis.z.t();
        let lambda = &basis.z * &terms.mass * &jbar_pinv;
        let mu = terms.mu(&jbar_dot, &jbar_pinv, &lambda);
        let null = Projected {
            jbar,
            jbar_dot,
            jbar_pinv,
            lambda,
            mu,
        };
        Self {
            terms,
            mass_inverse,
            levels,
            basis,
            null,
        }
    }

    /// The condition numbers of J M^-1 J^T and of M, added: what the formulas
    /// invert, and so what they may lose. Never below 1e4 for the arm.
    #[must_use]
    pub fn conditioning(&self) -> f64 {
        let (jacobian, _) = self.terms.stacked(self.levels.len());
        let mobility = &jacobian * &self.mass_inverse * &jacobian.t();
        mobility.amax() * mobility.inverse().amax()
            + self.terms.mass.amax() * self.mass_inverse.amax()
    }

    /// v = Jbar_l dq.
    #[must_use]
    pub fn null_velocity(&self) -> Matrix {
        &self.null.jbar * &self.terms.dq
    }

    /// (48): sum of Jbar_i^# Jbar_i dq, the task part of dq.
    #[must_use]
    pub fn task_velocity(&self) -> Matrix {
        self.levels.iter().fold(Matrix::zeros(7, 1), |sum, level| {
            sum + &level.jbar_pinv * &level.jbar * &self.terms.dq
        })
    }

    /// N = Z^T Jbar_l.
    #[must_use]
    pub fn null_projector(&self) -> Matrix {
        &self.null.jbar_pinv * &self.null.jbar
    }

    /// d(Jbar_i dq)/dt - (dJbar_i/dt) dq per level: what the task torques ask of
    /// Jbar_i ddq.
    #[must_use]
    pub fn task_accelerations(&self, variant: Variant) -> Vec<Matrix> {
        let dq = &self.terms.dq;
        let mut above = Matrix::zeros(7, 1);
        let mut accelerations = Vec::new();
        for (level, terms) in self.levels.iter().zip(&self.terms.levels) {
            let bias = if variant.coupled || !variant.barred {
                &terms.jacobian_dot * dq
            } else {
                &level.jbar_dot * dq
            };
            let mut acceleration = &terms.commanded - bias;
            if variant.coupled {
                acceleration = acceleration - &terms.jacobian * &above;
            }
            above = above + &level.jbar_pinv * &acceleration;
            accelerations.push(acceleration);
        }
        accelerations
    }

    /// (33): Lambda_l dv/dt = Z K_q q~ - Z D Z^T v - mu_l v, without tau_ext.
    #[must_use]
    pub fn null_momentum_rate(&self, stiffness_sign: f64) -> Matrix {
        let (terms, z) = (&self.terms, &self.basis.z);
        let v = self.null_velocity();
        (z * &terms.stiffness * &terms.posture_error).scaled(stiffness_sign)
            - z * &terms.damping * &z.t() * &v
            - &self.null.mu * &v
    }

    /// (34): task torques, null-space torque, compensation of the residual on the
    /// tasks, C dq and g.
    #[must_use]
    pub fn torque(&self, variant: Variant) -> Matrix {
        let terms = &self.terms;
        let mut torque = &terms.coriolis * &terms.dq + &terms.gravity;
        let accelerations = self.task_accelerations(variant);
        for (level, acceleration) in self.levels.iter().zip(accelerations) {
            let disturbance = &level.jbar * &self.mass_inverse * &terms.residual;
            torque = torque + level.jbar.t() * &level.lambda * (acceleration - disturbance);
        }
        let null_force = self.null_momentum_rate(variant.stiffness_sign)
            - &self.null.lambda * &self.null.jbar_dot * &terms.dq;
        torque + self.null.jbar.t() * null_force
    }
}

impl Terms {
    /// J and dJ/dt of the first `count` levels.
    #[must_use]
    pub fn stacked(&self, count: usize) -> (Matrix, Matrix) {
        let levels = &self.levels[..count];
        (
            Matrix::stack(7, levels.iter().map(|level| &level.jacobian)),
            Matrix::stack(7, levels.iter().map(|level| &level.jacobian_dot)),
        )
    }

    /// (Z M Z^T)^-1 Z M and its rate.
    fn null_velocity_map(&self, basis: &Basis) -> (Matrix, Matrix) {
        let Basis { z, z_dot, .. } = basis;
        let mass_rate = &self.coriolis + self.coriolis.t();
        let inverse = (z * &self.mass * &z.t()).inverse();
        let half = z_dot * &self.mass * &z.t();
        let inertia_rate = &half + half.t() + z * &mass_rate * &z.t();
        let jbar = &inverse * (z * &self.mass);
        let jbar_dot = inverse * (z_dot * &self.mass + z * &mass_rate - inertia_rate * &jbar);
        (jbar, jbar_dot)
    }

    fn mu(&self, jbar_dot: &Matrix, jbar_pinv: &Matrix, lambda: &Matrix) -> Matrix {
        jbar_pinv.t() * &self.coriolis * jbar_pinv - lambda * jbar_dot * jbar_pinv
    }

    /// Level i below the levels 0 .. i.
    fn projected(&self, i: usize, mass_inverse: &Matrix) -> Projected {
        let (above, above_dot) = self.stacked(i);
        let basis = Basis::new(&above, &above_dot);
        let (map, map_dot) = self.null_velocity_map(&basis);
        let LevelTerms {
            jacobian,
            jacobian_dot,
            ..
        } = &self.levels[i];
        let seen = jacobian * &basis.z.t();
        let seen_dot = jacobian_dot * &basis.z.t() + jacobian * &basis.z_dot.t();
        let jbar = &seen * &map;
        let jbar_dot = seen_dot * &map + seen * map_dot;
        let lambda = (&jbar * mass_inverse * &jbar.t()).inverse();
        let jbar_pinv = mass_inverse * &jbar.t() * &lambda;
        let mu = self.mu(&jbar_dot, &jbar_pinv, &lambda);
        Projected {
            jbar,
            jbar_dot,
            jbar_pinv,
            lambda,
            mu,
        }
    }
}
