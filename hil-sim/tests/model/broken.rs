//! Random and damaged files: an arm or one line, never a panic.

use std::fs;

use cell::model::chain::{Choice, Impossible};
use hil_sim::model::import::{Request, import};
use proptest::prelude::*;

use super::urdf;

fn try_import(text: &str, impossible: Impossible) -> Result<(), TestCaseError> {
    let request = Request {
        source: "a.urdf",
        name: None,
        choice: Choice {
            base: None,
            tip: None,
            continuous: std::f64::consts::TAU,
            impossible,
        },
        has_postures: false,
    };
    match import(text, &request) {
        Ok(import) => prop_assert!(import.text.len() < 1 << 20),
        Err(error) => {
            let line = error.to_string();
            prop_assert!(
                !line.contains('\n') && line.chars().count() < 1300,
                "{line}"
            );
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn random_texts(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        try_import(&String::from_utf8_lossy(&bytes), Impossible::Refused)?;
    }

    /// A good file with a piece cut out, doubled or replaced.
    #[test]
    fn damaged_files(
        at in 0.0..1.0f64,
        length in 0usize..60,
        piece in "[ -~\n]{0,12}",
        doubled in any::<bool>(),
    ) {
        let good = fs::read_to_string(urdf("skew")).expect("a file");
        let start = (at * good.len() as f64) as usize;
        let end = (start + length).min(good.len());
        let middle = if doubled { good[start..end].repeat(2) } else { piece };
        try_import(&format!("{}{middle}{}", &good[..start], &good[end..]), Impossible::Refused)?;
    }

    /// Any number in any place, also where bodies are made possible.
    #[test]
    fn wild_numbers(
        which in 0usize..1000,
        number in prop_oneof![
            any::<f64>(), -3.0..3.0f64, -1e-3..1e-3f64,
            Just(0.0), Just(1e-320), Just(1e300), Just(f64::NAN), Just(f64::INFINITY),
        ],
        nearest in any::<bool>(),
    ) {
        let good = fs::read_to_string(urdf("skew")).expect("a file");
        let is_part = |c: char| c.is_ascii_digit() || c == '.' || c == '-';
        let starts: Vec<_> = good
            .char_indices()
            .filter(|&(i, c)| (c.is_ascii_digit() || c == '-') && good[..i].ends_with(['"', ' ']))
            .map(|(i, _)| i)
            .collect();
        let start = starts[which % starts.len()];
        let end = start + good[start..].find(|c| !is_part(c)).unwrap_or(0);
        let text = format!("{}{}{}", &good[..start], number, &good[end..]);
        let impossible = if nearest { Impossible::Nearest } else { Impossible::Refused };
        try_import(&text, impossible)?;
    }
}
