//! TOML and JSON as people write them: an error names the line, the way to the value, what
//! stands there and what is allowed.

mod deserializer;
mod tree;

use serde::de::DeserializeOwned;

use crate::invalid::Invalid;
use tree::Node;

/// Reads a TOML text, checks what it says and completes it.
///
/// # Errors
/// The first line and key that cannot be used.
pub fn toml<T: DeserializeOwned>(
    text: &str,
    check: impl FnOnce(&mut T) -> Result<(), Invalid>,
) -> Result<T, Invalid> {
    read(text, &Node::of_toml(text)?, check)
}

/// Reads a JSON text, checks what it says and completes it.
///
/// # Errors
/// The first line and key that cannot be used.
pub fn json<T: DeserializeOwned>(
    text: &str,
    check: impl FnOnce(&mut T) -> Result<(), Invalid>,
) -> Result<T, Invalid> {
    read(text, &Node::of_json(text)?, check)
}

fn read<T: DeserializeOwned>(
    text: &str,
    root: &Node,
    check: impl FnOnce(&mut T) -> Result<(), Invalid>,
) -> Result<T, Invalid> {
    let read = T::deserialize(root).and_then(|mut value| check(&mut value).map(|()| value));
    read.map_err(|error| {
        let line = tree::line(text, root.offset(&error.path()));
        error.within(format_args!("line {line}"))
    })
}

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct File {
        size: f64,
        count: Option<usize>,
        gain: Option<Count>,
        #[serde(default)]
        on: bool,
        #[serde(default)]
        parts: Vec<Part>,
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Part {
        at: [f64; 3],
        shape: Shape,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "lowercase", deny_unknown_fields)]
    #[allow(dead_code)]
    enum Shape {
        Dot {},
        Ball(Ball),
        Box { plane: Plane },
    }

    #[derive(Debug, Deserialize)]
    #[serde(deny_unknown_fields)]
    #[allow(dead_code)]
    struct Ball {
        radius: f64,
    }

    #[derive(Debug, Deserialize)]
    #[serde(rename_all = "lowercase")]
    #[allow(dead_code)]
    enum Plane {
        Xy,
        Yz,
    }

    #[derive(Debug, Deserialize)]
    #[serde(untagged, expecting = "a number or two")]
    #[allow(dead_code)]
    enum Count {
        One(f64),
        Two([f64; 2]),
    }

    fn both(toml_text: &str, json_text: &str) -> [String; 2] {
        [
            toml::<File>(toml_text, |_| Ok(())),
            json::<File>(json_text, |_| Ok(())),
        ]
        .map(|read| read.expect_err(toml_text).to_string())
    }

    #[test]
    fn both_formats_complain_alike() {
        for (toml_text, json_text, error) in [
            (
                "size = '3'",
                r#"{"size": "3"}"#,
                "line 1: size: string \"3\"; allowed: a number",
            ),
            ("on = true", r#"{"on": true}"#, "line 1: missing key 'size'"),
            (
                "size = 1\nsise = 2",
                "{\"size\": 1,\n\"sise\": 2}",
                "line 2: key: unknown 'sise', did you mean 'size'? allowed: size, count, gain, on, parts",
            ),
            (
                "size = 1\ncount = -1",
                "{\"size\": 1,\n\"count\": -1}",
                "line 2: count: integer `-1`; allowed: a whole number from 0",
            ),
            (
                "size = 1\non = 1.5",
                "{\"size\": 1,\n\"on\": 1.5}",
                "line 2: on: floating point `1.5`; allowed: true or false",
            ),
            (
                "size = 1\ngain = [1]",
                "{\"size\": 1,\n\"gain\": [1]}",
                "line 2: gain: a number or two",
            ),
            (
                "size = 1\nparts = {}",
                "{\"size\": 1,\n\"parts\": {}}",
                "line 2: parts: map; allowed: a list",
            ),
            (
                "size = 1\nparts = [{ at = [1, 2] }]",
                "{\"size\": 1,\n\"parts\": [{\"at\": [1, 2]}]}",
                "line 2: parts 1: at: 2 values; allowed: 3",
            ),
            (
                "size = 1\nparts = [{ at = [1, 2, 'x'] }]",
                "{\"size\": 1,\n\"parts\": [{\"at\": [1, 2, \"x\"]}]}",
                "line 2: parts 1: at 3: string \"x\"; allowed: a number",
            ),
        ] {
            assert_eq!(both(toml_text, json_text), [error; 2]);
        }
    }

    #[test]
    fn a_table_says_its_kind() {
        let part = |shape: &str| {
            let text = format!("size = 1\n[[parts]]\nat = [1, 2, 3]\nshape = {shape}\n");
            toml::<File>(&text, |_| Ok(()))
        };
        assert!(part("{ kind = 'dot' }").is_ok());
        assert!(part("{ radius = 1, kind = 'ball' }").is_ok());
        assert!(part("{ kind = 'box', plane = 'yz' }").is_ok());
        for (shape, error) in [
            ("{}", "missing key 'kind'"),
            (
                "{ kind = 'bal' }",
                "kind: unknown 'bal', did you mean 'ball'? allowed: dot, ball, box",
            ),
            ("{ kind = 1 }", "kind: integer `1`; allowed: text in quotes"),
            (
                "{ kind = 'dot', radius = 1 }",
                "key: unknown 'radius'; allowed: none",
            ),
            (
                "{ kind = 'ball', radius = '1' }",
                "radius: string \"1\"; allowed: a number",
            ),
            ("{ kind = 'ball' }", "missing key 'radius'"),
            ("'ball'", "a word; allowed: a table that says its kind"),
            ("1", "integer `1`; allowed: text in quotes"),
            (
                "{ kind = 'box', plane = 'zy' }",
                "plane: unknown 'zy', did you mean 'xy'? allowed: xy, yz",
            ),
            (
                "{ kind = 'box', plane = { kind = 'xy' } }",
                "plane: map; allowed: text in quotes",
            ),
        ] {
            assert_eq!(
                part(shape).expect_err(shape).to_string(),
                format!("line 4: parts 1: shape: {error}")
            );
        }
    }

    #[test]
    fn checks_find_their_line() {
        let checked = toml::<File>(
            "size = 1\n[[parts]]\nat = [1, 2, 3]\nshape.kind = 'dot'",
            |_| Err(Invalid::new("at", "there", "here").in_list("parts", 0)),
        );
        assert_eq!(
            checked.expect_err("checked").to_string(),
            "line 3: parts 1: at: there; allowed: here"
        );
    }

    #[test]
    fn texts_that_are_neither_are_shown() {
        for text in ["size = 1\nsize = 2", "size = [1,", "size = ", "["] {
            let error = toml::<File>(text, |_| Ok(())).expect_err(text).to_string();
            assert!(
                error.starts_with("line ") && error.contains('\''),
                "{error}"
            );
        }
        let deep = format!("{{\"size\": {}", "[".repeat(100_000));
        for text in [
            "",
            "nope",
            "{\"size\": NaN}",
            "{\"size\": 1e999}",
            "{\"size\": 1} 2",
            &deep,
        ] {
            let error = json::<File>(text, |_| Ok(())).expect_err(text).to_string();
            assert!(error.len() < 250 && error.contains("line 1"), "{error}");
        }
        let error = json::<File>("{\"size\": 1,\n\"size\": 2}", |_| Ok(())).expect_err("twice");
        assert_eq!(
            error.to_string(),
            "line 1: key 'size': given twice; allowed: once"
        );
    }
}
