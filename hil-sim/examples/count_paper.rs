//! The runs of `hil-sim paper`, each cut to the seconds that are given (0.5 if none), for an
//! instruction counter: all laws, plants and scenarios of the paper in little time. Prints how
//! many there were.

use hil_sim::paper::{plan, results::Results};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let seconds = std::env::args()
        .nth(1)
        .map_or(Ok(0.5), |text| text.parse())?;
    let mut runs = plan::all()?;
    for run in &mut runs {
        run.experiment.scenario.duration_s = seconds;
    }
    let results = Results::of(&runs, 1, |_, _| ())?;
    let made = results.map_or(0, |results| results.outcomes().count());
    println!("{made} runs of {seconds} s");
    Ok(())
}
