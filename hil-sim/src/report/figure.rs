//! One figure of a run.

use super::plot::{Band, Chart};
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
/// to D, changes 1 to 4.", or nothing.
pub fn figure(run: &Run<'_>, file: &'static str, caption: &str, chart: &Chart) -> Figure {
    let named = |what: &str, bands: &[Band]| match bands {
        [] => None,
        [one] => Some(format!("{what} {}", one.label)),
        [first, .., last] => Some(format!("{what}s {} to {}", first.label, last.label)),
    };
    let shaded = [
        named("contact", &run.bands()),
        named("change", &run.changes()),
    ];
    let shaded = match shaded.into_iter().flatten().collect::<Vec<_>>() {
        none if none.is_empty() => String::new(),
        some => format!(" Shaded: {}.", some.join(", ")),
    };
    Figure {
        file,
        caption: format!("{caption}{shaded}"),
        drawing: chart.draw(),
    }
}
