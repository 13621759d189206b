//! `explain` against the paper's explicit formulas, evaluated by
//! `golden/laws.py` on Pinocchio's terms: every matrix and the torque, two and
//! more levels, every controller.

use hil_sim::explain::explain;
use serde_json::Value;
use stratum_tests::golden::file;

/// The explicit formulas of the golden file lose up to four digits to the
/// conditioning of M (1.6e4) and three to that of Lambda (its cases stay below
/// 1e3): 1e-16 times 1e7.
const TOLERANCE: f64 = 1e-9;

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(entries) => entries.iter().flat_map(numbers).collect(),
        Value::Number(number) => vec![number.as_f64().expect("a float")],
        other => panic!("not a number: {other}"),
    }
}

/// Relative to the largest entry; absolute below 1e-3, where entries are
/// differences of larger ones.
fn compare(path: &str, given: &Value, expected: &Value, worst: &mut f64) {
    match expected {
        Value::Object(fields) => {
            for (key, value) in fields {
                compare(&format!("{path}.{key}"), &given[key], value, worst);
            }
        }
        Value::Array(entries) if entries.iter().any(Value::is_object) => {
            assert_eq!(
                given.as_array().map(Vec::len),
                Some(entries.len()),
                "{path}"
            );
            for (index, value) in entries.iter().enumerate() {
                compare(&format!("{path}[{index}]"), &given[index], value, worst);
            }
        }
        _ => {
            let (mut given, expected) = (numbers(given), numbers(expected));
            // A quaternion and its opposite are the same orientation.
            if path.ends_with(".x") && given.len() == 4 && dot(&given, &expected) < 0.0 {
                given.iter_mut().for_each(|x| *x = -*x);
            }
            assert_eq!(given.len(), expected.len(), "{path}");
            let error = stratum_tests::relative(&given, &expected, 1e-3);
            assert!(
                error < TOLERANCE,
                "{path}: {error:e}\n{given:?}\n{expected:?}"
            );
            *worst = worst.max(error);
        }
    }
}

/// Covers eq (7), eq (8), eq (9), eq (12), eq (13), eq (14) by the acceleration-level
/// controllers, eq (30) by the observer step, eq (17), eq (18), eq (32), eq (33), eq (34)
/// by the others, the printed law among them.
#[test]
fn every_quantity_agrees_with_the_explicit_formulas() {
    let golden: Value = serde_json::from_str(&file("laws.json")).expect("laws.json");
    let cases = golden["cases"].as_array().expect("cases");
    assert_eq!(cases.len(), 120);
    let mut worst = 0.0;
    for case in cases {
        let mut input = case["input"].clone();
        input["law"] = "exact".into();
        let input = &input;
        let output = explain(&input.to_string()).expect("a valid state");
        let output = serde_json::to_value(&output).expect("plain data");
        compare(
            case["name"].as_str().unwrap_or(""),
            &output,
            &case["expected"],
            &mut worst,
        );
        check_null_space(&output, input);
    }
    println!("worst relative error {worst:e}");
}

/// The basis is one of many: it must span the null space of every level,
/// be orthonormal in M, and give the projector and the velocity.
fn check_null_space(output: &Value, input: &Value) {
    let mass_matrix = rows(&output["mass_matrix"]);
    let projector = rows(&output["null_space"]["projector"]);
    let basis = rows(&output["null_space"]["basis"]);
    let velocity = numbers(&output["null_space"]["velocity"]);
    let weighted: Rows = basis.iter().map(|row| times(&mass_matrix, row)).collect();
    for (i, row) in basis.iter().enumerate() {
        for (j, other) in weighted.iter().enumerate() {
            let unit = f64::from(u8::from(i == j));
            assert!((dot(row, other) - unit).abs() < TOLERANCE);
        }
        for level in output["levels"].as_array().expect("levels") {
            let seen = times(&rows(&level["jacobian"]), row);
            assert!(seen.iter().all(|x| x.abs() < TOLERANCE * largest(row)));
        }
    }
    let combined = |weights: &dyn Fn(usize) -> f64| -> Vec<f64> {
        (0..7)
            .map(|i| {
                basis
                    .iter()
                    .enumerate()
                    .map(|(k, row)| row[i] * weights(k))
                    .sum()
            })
            .collect()
    };
    for j in 0..7 {
        let column = combined(&|k| weighted[k][j]);
        for i in 0..7 {
            let error = (column[i] - projector[i][j]).abs();
            assert!(error < TOLERANCE * largest(&column).max(1.0));
        }
    }
    let null_velocity = times(&projector, &numbers(&input["dq"]));
    for (a, b) in combined(&|k| velocity[k]).iter().zip(&null_velocity) {
        assert!((a - b).abs() < TOLERANCE * largest(&null_velocity).max(1.0));
    }
}

type Rows = Vec<Vec<f64>>;

fn rows(value: &Value) -> Rows {
    value
        .as_array()
        .expect("rows")
        .iter()
        .map(numbers)
        .collect()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn times(matrix: &Rows, vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| dot(row, vector)).collect()
}

fn largest(values: &[f64]) -> f64 {
    values
        .iter()
        .fold(0.0, |largest, value| value.abs().max(largest))
}
