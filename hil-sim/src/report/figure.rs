//! One figure of a run.

use super::plot::Chart;
use super::run::Run;
use super::svg::Svg;

/// A figure with the words under it.
#[derive(Clone, Debug)]
pub struct Figure {
    /// File name, with its ending.
    pub file: &'static str,
    /// How to read it.
    pub caption: String,
    /// The drawing.
    pub drawing: Svg,
}

/// A chart of this run.
pub fn chart(run: &Run<'_>, id: &str, what: &str, description: &str) -> Chart {
    let title = format!("{what} \u{2013} {}", run.label());
    run.chart(id, title, description)
}

/// A chart as a figure; the caption goes on with what is shaded: " Shaded: contacts A
/// to D.", or nothing.
pub fn figure(run: &Run<'_>, file: &'static str, caption: &str, chart: &Chart) -> Figure {
    let shaded = match run.bands().as_slice() {
        [] => String::new(),
        [one] => format!(" Shaded: contact {}.", one.label),
        [first, .., last] => format!(" Shaded: contacts {} to {}.", first.label, last.label),
    };
    Figure {
        file,
        caption: format!("{caption}{shaded}"),
        drawing: chart.draw(),
    }
}
