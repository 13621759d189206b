//! What a chart is.

/// Height of a row of bars \[px\].
pub const STRIP: f64 = 18.0;

/// A chart of one or more panels.
#[derive(Clone, Debug)]
pub struct Chart {
    /// Short name, unique on a page; also that of the file.
    pub id: String,
    /// What the chart shows, drawn above it.
    pub title: String,
    /// One sentence for those who do not see it.
    pub description: String,
    /// Width \[px\].
    pub width: f64,
    /// Title of the horizontal axis, with its unit.
    pub x_label: String,
    /// Ends of the horizontal axis; none: those of the data.
    pub x_range: Option<[f64; 2]>,
    /// Panels, from the top.
    pub panels: Vec<Panel>,
    /// Shaded intervals of the horizontal axis.
    pub bands: Vec<Band>,
    /// Labelled instants, such as a stop.
    pub marks: Vec<Mark>,
}

/// One pair of axes.
#[derive(Clone, Debug)]
pub struct Panel {
    /// Height of the plot area \[px\].
    pub height: f64,
    /// Title of the vertical axis, with its unit.
    pub y_label: String,
    /// Vertical scale.
    pub scale: Scale,
    /// Lines, the first lowest.
    pub series: Vec<Series>,
    /// Horizontal limits.
    pub limits: Vec<LimitLine>,
    /// Rows of bars, from the top, in the place of lines and of the vertical axis.
    pub strips: Vec<Strip>,
    /// Bars along the upper and along the lower edge: intervals of the horizontal axis.
    pub edges: [Vec<[f64; 2]>; 2],
    /// Whether each line's label also stands at its right end.
    pub end_labels: bool,
}

/// How values are laid out along the vertical axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Scale {
    /// Evenly, over the range of the data.
    Linear,
    /// Evenly, zero included.
    FromZero,
    /// Evenly between these ends.
    Within([f64; 2]),
    /// By powers of ten; smaller values are drawn at `floor` (above 0).
    Log {
        /// Smallest value that is told apart.
        floor: f64,
    },
}

/// A line.
#[derive(Clone, Debug)]
pub struct Series {
    /// Name in the legend. Lines with the same label and style share an entry;
    /// an empty label has none.
    pub label: String,
    /// Values over the horizontal axis; what is not finite is a gap.
    pub points: Vec<[f64; 2]>,
    /// How it is drawn.
    pub style: Style,
}

impl Series {
    /// From times and values.
    #[must_use]
    pub fn new(label: impl Into<String>, t: &[f64], values: &[f64], style: Style) -> Self {
        Self {
            label: label.into(),
            points: t.iter().zip(values).map(|(&t, &v)| [t, v]).collect(),
            style,
        }
    }

    /// Whether it has anything to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        !self
            .points
            .iter()
            .any(|p| p[0].is_finite() && p[1].is_finite())
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Style {
    /// Colour of the palette, counted around.
    pub colour: usize,
    /// Solid or broken.
    pub stroke: Stroke,
}

/// Solid or broken line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Stroke {
    /// Solid.
    #[default]
    Solid,
    /// Solid, half as thick.
    Thin,
    /// Pale and wide: lies under a thinner line that is compared with it.
    Wide,
    /// Dashes.
    Dashed,
    /// Dots.
    Dotted,
}

impl Style {
    /// A solid line.
    #[must_use]
    pub fn solid(colour: usize) -> Self {
        Self::new(colour, Stroke::Solid)
    }

    /// A line of this colour and stroke.
    #[must_use]
    pub fn new(colour: usize, stroke: Stroke) -> Self {
        Self { colour, stroke }
    }

    /// A line among others: every other one is broken.
    #[must_use]
    pub fn alternating(colour: usize) -> Self {
        Self::new(colour, [Stroke::Solid, Stroke::Dashed][colour % 2])
    }

    /// Classes of the line.
    #[must_use]
    pub fn class(self) -> String {
        let stroke = match self.stroke {
            Stroke::Solid => "",
            Stroke::Thin => " thin",
            Stroke::Wide => " wide",
            Stroke::Dashed => " dash",
            Stroke::Dotted => " dot",
        };
        format!(
            "c s{}{stroke}",
            self.colour % super::super::palette::COLOURS
        )
    }
}

/// A horizontal line that the data should stay below.
#[derive(Clone, Debug)]
pub struct LimitLine {
    /// Where.
    pub value: f64,
    /// Text at its right end.
    pub label: String,
}

/// A row of bars: when something was so.
#[derive(Clone, Debug)]
pub struct Strip {
    /// What, to the left of it.
    pub label: String,
    /// Intervals of the horizontal axis.
    pub spans: Vec<[f64; 2]>,
    /// Colour of the palette, counted around.
    pub colour: usize,
}

/// A shaded interval of the horizontal axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Band {
    /// Start.
    pub from: f64,
    /// End.
    pub to: f64,
    /// Letter above it.
    pub label: String,
}

/// A labelled instant.
#[derive(Clone, Debug)]
pub struct Mark {
    /// When.
    pub at: f64,
    /// Text above it.
    pub label: String,
}

impl Chart {
    /// A chart over time without panels, 900 px wide.
    #[must_use]
    pub fn over_time(id: &str, title: impl Into<String>, description: &str) -> Self {
        Self {
            id: id.to_string(),
            title: title.into(),
            description: description.to_string(),
            width: 900.0,
            x_label: "time [s]".to_string(),
            x_range: None,
            panels: Vec::new(),
            bands: Vec::new(),
            marks: Vec::new(),
        }
    }
}

impl Panel {
    /// A panel with these lines, no limits.
    #[must_use]
    pub fn new(y_label: impl Into<String>, height: f64, scale: Scale, series: Vec<Series>) -> Self {
        Self {
            height,
            y_label: y_label.into(),
            scale,
            series,
            limits: Vec::new(),
            strips: Vec::new(),
            edges: [Vec::new(), Vec::new()],
            end_labels: false,
        }
    }

    /// A panel with these rows of bars.
    #[must_use]
    pub fn of_strips(strips: Vec<Strip>) -> Self {
        Self {
            height: STRIP * strips.len() as f64,
            strips,
            ..Self::new("", 0.0, Scale::Linear, Vec::new())
        }
    }

    /// Height of a panel that is one of `count` in a chart.
    #[must_use]
    pub fn height_among(count: usize) -> f64 {
        match count {
            0 | 1 => 250.0,
            2 => 170.0,
            3 => 130.0,
            _ => 86.0,
        }
    }

    /// Whether no line has anything to draw.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.series.iter().all(Series::is_empty) && self.strips.is_empty()
    }

    /// Whether the vertical axis is logarithmic.
    #[must_use]
    pub fn is_log(&self) -> bool {
        matches!(self.scale, Scale::Log { .. })
    }
}
