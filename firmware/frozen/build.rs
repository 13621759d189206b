//! Freezes the controllers of the firmware's scenarios, in both precisions.

use std::path::Path;
use std::{env, fs};

use freeze::{Precision, Request, freeze};
use scenario::FixedScenario;

#[path = "../src/scenario.rs"]
#[allow(dead_code, reason = "the configuration is all that is needed of it")]
mod scenario;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=../src/scenario.rs");
    let folder = env::var("OUT_DIR").expect("set by cargo");
    for scenario in FixedScenario::ALL {
        for (precision, name) in [(Precision::F64, "f64"), (Precision::F32, "f32")] {
            let config = scenario::config(scenario).expect("valid constants");
            let frozen = freeze(&Request {
                arm: &arms::LWR_IV,
                config: &config,
                limits: true,
                precision,
                job: scenario.name(),
            })
            .unwrap_or_else(|error| panic!("{}: {error}", scenario.name()));
            let file = format!("{}_{name}.rs", scenario.name().replace('-', "_"));
            fs::write(Path::new(&folder).join(file), frozen.rust()).expect("a file");
        }
    }
}
