//! Prints the part of `include/stratum.h` that is names for numbers: `check.sh header`
//! puts it in the place of a marker.

use stratum::constants::{Constant, Names};
use stratum::header::HEADER;

/// A comment of the header, in lines of at most `WIDTH` characters.
fn comment(indent: &str, text: &str) {
    const WIDTH: usize = 90;
    let mut line = format!("{indent}//");
    for word in text.split_whitespace() {
        if line.len() + 1 + word.len() > WIDTH {
            println!("{line}");
            line = format!("{indent}//");
        }
        line.push(' ');
        line.push_str(word);
    }
    println!("{line}");
}

/// A text as a sentence.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map(|letter| letter.to_ascii_uppercase());
    first.into_iter().chain(letters).chain(['.']).collect()
}

fn main() -> Result<(), std::str::Utf8Error> {
    for (i, names) in HEADER.into_iter().flatten().enumerate() {
        let Names {
            kind,
            integer,
            about,
            constants,
        } = names;
        if i > 0 {
            println!();
        }
        comment("", about);
        println!("typedef {integer} {kind};\nenum {{");
        for Constant { number, name, text } in constants.iter().copied().flatten() {
            comment("  ", &sentence(text.to_str()?));
            println!("  {} = {number},", name.to_str()?);
        }
        println!("}};");
    }
    Ok(())
}
