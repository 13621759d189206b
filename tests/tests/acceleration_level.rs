//! The acceleration-level controllers, as `explain` shows them, against (8), (9), (12)-(14)
//! in explicit projectors and inverses, the derivative of the projector among them.

use hil_sim::explain::explain;
use serde_json::{Value, json};
use stratum_tests::oracle::Matrix;
use stratum_tests::random::States;

const STATES: usize = 100;

/// The explicit inverses square the conditioning of J, up to 3e3 in these states:
/// 1e-16 times 1e7.
const TOLERANCE: f64 = 1e-9;

/// Point and axes of the levels: two priorities and three, the null space the last.
const LEVELS: [&[(&str, &str)]; 2] = [&[("flange", "xyz")], &[("flange", "xyz"), ("wrist", "xy")]];

fn state(random: &mut States, levels: &[(&str, &str)], controller: &str) -> Value {
    let joints = random.state();
    let mut list = |length: usize, scale: f64| -> Vec<f64> {
        (0..length).map(|_| scale * random.signed()).collect()
    };
    let levels: Vec<_> = levels
        .iter()
        .map(|(point, axes)| {
            let rows = axes.len();
            let gain = |values: Vec<f64>| values.into_iter().map(f64::abs).collect::<Vec<_>>();
            json!({
                "point": point, "axes": axes,
                "x": list(rows, 0.5), "dx": list(rows, 0.5), "ddx": list(rows, 2.0),
                "kp": gain(list(rows, 400.0)), "kd": gain(list(rows, 40.0)),
            })
        })
        .collect();
    json!({
        "robot": "lwr_iv", "q": joints.q.as_slice(), "dq": joints.dq.as_slice(),
        "residual": list(7, 10.0), "controller": controller, "levels": levels,
        "null_space": {
            "q_d": list(7, 1.0), "stiffness": vec![1.0; 7], "damping": vec![1.0; 7],
            "rate_gain": list(7, 20.0),
        },
    })
}

fn matrix(value: &Value) -> Matrix {
    let rows: Vec<Vec<f64>> = serde_json::from_value(value.clone()).expect("rows");
    Matrix::from_fn(rows.len(), rows[0].len(), |i, j| rows[i][j])
}

fn column(value: &Value) -> Matrix {
    Matrix::column(&serde_json::from_value::<Vec<f64>>(value.clone()).expect("numbers"))
}

/// A^# = A^T (A A^T)^-1.
fn right_inverse(a: &Matrix) -> Matrix {
    a.t() * (a * a.t()).inverse()
}

/// The torque, and the part of it that P (dP/dt) dq makes.
fn printed(input: &Value, terms: &Value) -> [Matrix; 2] {
    let dq = column(&input["dq"]);
    let levels = || terms["levels"].as_array().expect("levels").iter();
    let (mut ddq, mut free) = (Matrix::zeros(7, 1), Matrix::identity(7));
    for level in levels() {
        let jacobian = matrix(&level["jacobian"]);
        let inverse = right_inverse(&(&jacobian * &free));
        let command = column(&level["command"]) - column(&level["jacobian_dot_dq"]);
        ddq = &ddq + &inverse * (command - &jacobian * &ddq);
        free = &free - &inverse * (&jacobian * &free);
    }
    let stacked = |key: &str| {
        let blocks: Vec<_> = levels().map(|level| matrix(&level[key])).collect();
        Matrix::stack(7, &blocks)
    };
    let (j, j_dot) = (stacked("jacobian"), stacked("jacobian_dot"));
    // P = 1 - J^# J differentiated, with the derivative of J^T (J J^T)^-1.
    let (square, pinv) = ((&j * j.t()).inverse(), right_inverse(&j));
    let square_dot = &square * (&j_dot * j.t() + &j * j_dot.t()) * &square;
    let pinv_dot = j_dot.t() * &square - j.t() * square_dot;
    let p_dot = (pinv_dot * &j + &pinv * &j_dot).scaled(-1.0);
    let turning = &free * (&p_dot * &dq);
    let rate: Vec<f64> =
        serde_json::from_value(input["null_space"]["rate_gain"].clone()).expect("numbers");
    let braking = Matrix::from_fn(7, 1, |i, _| rate[i] * dq.at(i, 0));
    let mass = matrix(&terms["mass_matrix"]);
    let estimated = input["controller"] == "acceleration-level-estimate";
    let external = column(&input["residual"]).scaled(if estimated { -1.0 } else { 0.0 });
    let torque = &mass * (ddq - &free * braking - &turning)
        + column(&terms["coriolis"])
        + column(&terms["gravity"])
        + external;
    [torque, mass * turning]
}

/// eq (8), eq (9), eq (12), eq (13), eq (14), with dq_d = 0.
#[test]
fn the_torque_is_the_printed_one_with_the_rate_of_the_projector() {
    let mut random = States::new(13);
    let (mut worst, mut shares) = (0.0f64, Vec::new());
    for controller in ["acceleration-level", "acceleration-level-estimate"] {
        for n in 0..STATES {
            let input = state(&mut random, LEVELS[n % 2], controller);
            let output = explain(&input.to_string()).expect("a state");
            let output = serde_json::to_value(&output).expect("plain data");
            let [torque, turning] = printed(&input, &output);
            let given = column(&output["torque_demand"]);
            let scale = torque.amax();
            let error = (given - torque).amax() / scale;
            assert!(error < TOLERANCE, "{error:e} in {input}");
            worst = worst.max(error);
            shares.push(turning.amax() / scale);
        }
    }
    shares.sort_by(f64::total_cmp);
    let (few, typical) = (shares[shares.len() / 20], shares[shares.len() / 2]);
    let most = shares[shares.len() - 1];
    println!(
        "worst {worst:.1e}; the rate of P: typically {typical:.1e} of the torque, to {most:.1e}"
    );
    // A law without the term fails in at least 95 of 100 states.
    assert!(few > 10.0 * TOLERANCE, "{few:e}");
}
