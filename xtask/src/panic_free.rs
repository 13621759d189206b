//! Constructor and cycle of the core, codec, robot and client of the FCI link without any panic, and the check
//! notices one.

use crate::tools::{Outcome, find, good, host, image_build};

/// The function that a reachable panic needs and that does not exist.
const SYMBOL: &str = "a_panic_is_reachable";

/// Links `panic-free`, and fails to link it with a panic put in.
pub fn run() -> Outcome {
    find(&[])?;
    let output = image_build("panic-free", "").output()?;
    if String::from_utf8_lossy(&output.stderr).contains(SYMBOL) {
        println!(
            "a panic is reachable from the constructor, the cycle or from what there is of the FCI"
        );
        return Ok(false);
    }
    good("build of the image panic-free", &output)?;
    println!(
        "constructor and cycle, 1 to 7 rows, f64 and f32; codec, robot and client of the FCI: linked without a panic"
    );

    let output = image_build("panic-free", "provoke-panic").output()?;
    let noticed = String::from_utf8_lossy(&output.stderr).contains(SYMBOL);
    if output.status.success() || !noticed {
        println!("a panic that was put in is not noticed");
        return Ok(false);
    }
    println!("with a panic put in: not linked, as it should be");
    print!("on the host: {}", host("panic-free", &[])?);
    Ok(true)
}
