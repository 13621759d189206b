//! Values that a key takes, and values beside them.

use cell::keys::Key;
use cell::keys::numbers::Span;
use cell::ranges::Range;
use toml::Value;

/// Numbers just inside and just outside of what a span allows, as values of a key that has
/// `given`.
pub fn beside(span: &Span, given: &Value) -> [Vec<Value>; 2] {
    let Range { min, max, .. } = span.range;
    let above = !span.range.contains(min);
    if span.whole {
        let whole = |number: f64| Value::Integer(number as i64);
        return [[min, max], [min - 1.0, max + 1.0]].map(|ends| ends.map(whole).to_vec());
    }
    let (inside, outside) = match above {
        // Degrees that are none in radians are no angle.
        true => ([min.next_up().max(1e-300), max], [min, max.next_up()]),
        false => ([min, max], [min.next_down(), max.next_up()]),
    };
    [inside, outside].map(|ends| ends.map(|number| in_place(number, given)).to_vec())
}

/// A number, as the last one of a list where the key has a list.
fn in_place(number: f64, given: &Value) -> Value {
    let mut value = given.clone();
    match &mut value {
        Value::Array(list) => *list.last_mut().expect("numbers") = Value::Float(number),
        other => *other = Value::Float(number),
    }
    value
}

/// The words that the text of a choice lists.
pub fn listed(key: &Key) -> Vec<Value> {
    let text = (key.allowed)();
    if text == "`true`, `false`" {
        return vec![true.into(), false.into()];
    }
    let quoted = text.split(", ").map(|word| {
        let word = word
            .strip_prefix("`\"")
            .and_then(|rest| rest.strip_suffix("\"`"));
        word.unwrap_or_else(|| panic!("{}: no case for '{text}'", key.name))
    });
    quoted.map(Value::from).collect()
}

/// What a key takes and what it refuses, where that is no range and no choice.
pub fn cases(path: &str, key: &str, given: &Value) -> Option<[Vec<Value>; 2]> {
    let texts = |texts: &[&str]| texts.iter().copied().map(Value::from).collect::<Vec<_>>();
    let value = |toml: &str| {
        let file: toml::Table = format!("value = {toml}").parse().expect("TOML");
        file["value"].clone()
    };
    let values = |tomls: &[&str]| tomls.iter().map(|toml| value(toml)).collect::<Vec<_>>();
    let (long, longer) = ("n".repeat(64), "n".repeat(65));
    let times =
        |count: usize| Value::Array(vec![given.as_array().expect("a list")[0].clone(); count]);
    Some(match (path, key) {
        ("" | "point", "name") => [
            texts(&["a", "Az-_9", &long]),
            texts(&["", &longer, "a b", "ä", "a/b"]),
        ],
        ("joint", "name") => [texts(&["a", "A 1 ä", &long]), texts(&["", &longer, "a\nb"])],
        ("", "robot") => [vec!["lwr_iv".into()], texts(&["lwr", "", "missing.toml"])],
        ("", "mount" | "tool" | "joint_limits" | "null_space" | "observer" | "base" | "flange")
        | ("level", "limits" | "stale")
        | ("joint", "friction" | "end_approach") => [vec![given.clone()], values(&["1", "[]"])],
        ("", "contact" | "hand" | "limit") => {
            [vec![times(0), times(1), times(100)], values(&["1", "{}"])]
        }
        // A level goes once only.
        ("", "event") => [vec![times(0), times(1)], values(&["1", "{}"])],
        ("event", "place") => [values(&["1", "2"]), values(&["0", "3"])],
        ("event", "order") => [values(&["[2]"]), values(&["[]", "[0]", "[1]", "[2, 2]"])],
        // Of the LWR IV+, and beyond its joint 7.
        ("", "start_deg") => [
            values(&[
                "[170, 120, 170, 120, 170, 120, 170]",
                "[-170, -120, -170, -120, -170, -120, -170]",
            ]),
            values(&["[170, 120, 170, 120, 170, 120, 170.0000001]", "[0, 0, 0]"]),
        ],
        ("", "level") => [vec![times(1), times(7)], vec![times(0), times(8)]],
        ("", "joint") => [vec![times(7)], vec![times(0), times(6), times(8)]],
        ("", "point") => {
            let point = |n: usize| {
                value(&format!(
                    "{{ name = 'p{n}', link = 1, offset_m = [0, 0, 0] }}"
                ))
            };
            let points = |count: usize| Value::Array((0..count).map(point).collect());
            [vec![points(0), points(32)], vec![points(33), times(2)]]
        }
        ("", "damping_postures_deg") => {
            let posture = |end: f64| Value::Array(vec![Value::Float(end); 7]);
            [
                vec![
                    times(0),
                    times(64),
                    Value::Array(vec![posture(35_600.0), posture(-35_600.0)]),
                ],
                vec![
                    times(65),
                    Value::Array(vec![posture(35_600.1)]),
                    values(&["[[0, 0]]"]).remove(0),
                ],
            ]
        }
        ("", "gravity_m_s2") => [
            values(&["[0, 0, 0]", "[0, 30, 0]", "[18, 0, -24]"]),
            values(&["[0, 30.000001, 0]", "[18, 0.01, -24]"]),
        ],
        ("level.reference", "axis") => [
            values(&["[0, 0, 0.001]", "[600, 800, 0]"]),
            values(&["[0, 0, 0.000999]", "[600, 800, 1]", "[0, 0, 0]"]),
        ],
        ("level" | "contact" | "hand", "point") => [
            values(&[
                "'elbow'",
                "'wrist'",
                "'flange'",
                "'upper'",
                "'tool'",
                "{ link = 1, offset_m = [0, 0, 2] }",
            ]),
            values(&["'hand'", "''", "{ link = 1 }", "1"]),
        ],
        ("level", "axes") => [
            texts(&["x", "y", "z"]),
            texts(&["", "yx", "xx", "w", "xyzz"]),
        ],
        ("level", "reference") => [
            vec![given.clone()],
            values(&["'hold'", "{}", "{ kind = 'rest' }"]),
        ],
        // The interval of the valid file is 3 s long.
        ("contact", "ramp_s") | ("hand", "approach_s") => {
            [values(&["1e-9", "1.5"]), values(&["0", "1.5000001"])]
        }
        ("level.reference", "ramp_s") => [values(&["1e-9", "1.0"]), values(&["0", "1.0000001"])],
        ("limit", "metric") => [
            texts(&["level1_rms_mrad", "level1_max_mrad", "level1_plateau_mrad"]),
            texts(&["level3_rms_mm", "level1_rms_mm", "rms"]),
        ],
        _ => return None,
    })
}
