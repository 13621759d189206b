//! A small SVG writer: shapes and text with classes, numbers rounded to
//! hundredths, text escaped. What is not finite is never written.

use std::fmt::{Display, Write};

use super::palette;

/// A drawing under construction, in its own pixels.
#[derive(Clone, Debug)]
pub struct Svg {
    id: String,
    width: f64,
    height: f64,
    title: String,
    description: String,
    body: String,
}

/// Where a text stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// Text begins there.
    Start,
    /// Text is centred there.
    Middle,
    /// Text ends there.
    End,
}

impl Anchor {
    fn name(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Middle => "middle",
            Self::End => "end",
        }
    }
}

impl Svg {
    /// An empty drawing. `id` must be unique on a page; `title` and
    /// `description` are for those who do not see it.
    #[must_use]
    pub fn new(id: &str, [width, height]: [f64; 2], title: &str, description: &str) -> Self {
        Self {
            id: id.to_string(),
            width,
            height,
            title: title.to_string(),
            description: description.to_string(),
            body: String::new(),
        }
    }

    /// The same drawing, this high.
    #[must_use]
    pub fn with_height(self, height: f64) -> Self {
        Self { height, ..self }
    }

    /// A straight line.
    pub fn line(&mut self, class: &str, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
        let [x1, y1, x2, y2] = [x1, y1, x2, y2].map(number);
        self.element(format_args!(
            r#"<line class="{class}" x1="{x1}" y1="{y1}" x2="{x2}" y2="{y2}"/>"#
        ));
    }

    /// A rectangle.
    pub fn rect(&mut self, class: &str, [x, y]: [f64; 2], [w, h]: [f64; 2]) {
        let [x, y, w, h] = [x, y, w.max(0.0), h.max(0.0)].map(number);
        self.element(format_args!(
            r#"<rect class="{class}" x="{x}" y="{y}" width="{w}" height="{h}"/>"#
        ));
    }

    /// A disc.
    pub fn circle(&mut self, class: &str, [x, y]: [f64; 2], radius: f64) {
        let [x, y, r] = [x, y, radius].map(number);
        self.element(format_args!(
            r#"<circle class="{class}" cx="{x}" cy="{y}" r="{r}"/>"#
        ));
    }

    /// A line of text; `y` is the baseline.
    pub fn text(&mut self, class: &str, [x, y]: [f64; 2], anchor: Anchor, text: &str) {
        let ([x, y], anchor, text) = ([x, y].map(number), anchor.name(), escape(text));
        self.element(format_args!(
            r#"<text class="{class}" x="{x}" y="{y}" text-anchor="{anchor}">{text}</text>"#
        ));
    }

    /// Text that reads upwards, centred at the point.
    pub fn text_upwards(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        let ([x, y], text) = ([x, y].map(number), escape(text));
        self.element(format_args!(
            r#"<text class="{class}" transform="translate({x} {y}) rotate(-90)" text-anchor="middle">{text}</text>"#
        ));
    }

    /// A curve through `points`; what is not finite is a gap. `extra` is more
    /// attributes, each with a space before it.
    pub fn curve(&mut self, class: &str, points: &[[f64; 2]], extra: &str) {
        let d = path_data(points);
        if !d.is_empty() {
            self.element(format_args!(r#"<path class="{class}"{extra} d="{d}"/>"#));
        }
    }

    /// An element as it is.
    pub fn element(&mut self, element: impl Display) {
        let _ = writeln!(self.body, "{element}");
    }

    /// A rectangle that clips what refers to it; gives the attribute to refer.
    pub fn clip(&mut self, [x, y]: [f64; 2], [w, h]: [f64; 2], number_of: usize) -> String {
        let id = format!("{}-clip{number_of}", self.id);
        let [x, y, w, h] = [x, y, w, h].map(number);
        self.element(format_args!(
            r#"<clipPath id="{id}"><rect x="{x}" y="{y}" width="{w}" height="{h}"/></clipPath>"#
        ));
        format!(r#" clip-path="url(#{id})""#)
    }

    /// The drawing as a file of its own, style included.
    #[must_use]
    pub fn standalone(&self) -> String {
        let style = format!("<style>\n{}</style>\n", palette::drawing_css());
        self.document(r#" xmlns="http://www.w3.org/2000/svg""#, &style)
    }

    /// The drawing as part of a page that has [`palette::drawing_css`].
    #[must_use]
    pub fn inline(&self) -> String {
        self.document("", "")
    }

    fn document(&self, namespace: &str, style: &str) -> String {
        let Self { id, body, .. } = self;
        let (w, h) = (number(self.width), number(self.height));
        let size = if namespace.is_empty() {
            String::new()
        } else {
            format!(r#" width="{w}" height="{h}""#)
        };
        let (title, description) = (escape(&self.title), escape(&self.description));
        format!(
            r#"<svg{namespace} class="plot" viewBox="0 0 {w} {h}"{size} role="img" aria-labelledby="{id}-title {id}-desc">
<title id="{id}-title">{title}</title>
<desc id="{id}-desc">{description}</desc>
{style}<rect class="bg" width="{w}" height="{h}"/>
{body}</svg>
"#
        )
    }
}

/// A number of pixels: hundredths, without trailing zeros; 0 if not finite.
#[must_use]
pub fn number(value: f64) -> String {
    let mut text = String::new();
    let finite = if value.is_finite() { value } else { 0.0 };
    push_hundredths(&mut text, rounded(finite.clamp(-1e6, 1e6) * 100.0));
    text
}

/// The nearest whole number of one below 2^52, halves away from zero.
#[inline]
fn rounded(value: f64) -> i64 {
    let whole = value as i64;
    let rest = value - whole as f64;
    whole + i64::from(rest >= 0.5) - i64::from(rest <= -0.5)
}

/// Appends hundredths as a decimal without trailing zeros. A drawing is mostly numbers, and the
/// way through `fmt` takes ten times as long.
fn push_hundredths(text: &mut String, value: i64) {
    if value < 0 {
        text.push('-');
    }
    let size = value.unsigned_abs();
    let (whole, rest) = (size / 100, (size % 100) as u8);
    push_whole(text, whole);
    let digit = |digit: u8| char::from(b'0' + digit);
    if rest != 0 {
        text.push('.');
        text.push(digit(rest / 10));
        if !rest.is_multiple_of(10) {
            text.push(digit(rest % 10));
        }
    }
}

fn push_whole(text: &mut String, value: u64) {
    if value >= 10 {
        push_whole(text, value / 10);
    }
    text.push(char::from(b'0' + (value % 10) as u8));
}

/// Path data of a line with gaps: steps between positions that are rounded
/// first, so that rounding does not add up.
fn path_data(points: &[[f64; 2]]) -> String {
    let snap = |v: f64| rounded(v.clamp(-1e6, 1e6) * 10.0) * 10;
    let mut data = String::with_capacity(8 * points.len());
    let mut last: Option<[i64; 2]> = None;
    for (k, point) in points.iter().enumerate() {
        if !(point[0].is_finite() && point[1].is_finite()) {
            last = None;
            continue;
        }
        let [x, y] = point.map(snap);
        let Some([x0, y0]) = last else {
            data.push('M');
            push_hundredths(&mut data, x);
            data.push(' ');
            push_hundredths(&mut data, y);
            last = Some([x, y]);
            if points.get(k + 1).is_none_or(|next| !next[1].is_finite()) {
                // A point on its own is a dot.
                data += "h0";
            }
            continue;
        };
        // On a level stretch only its end matters.
        let level = points.get(k + 1).is_some_and(|next| {
            next[0] >= point[0] && next[1].is_finite() && y == y0 && snap(next[1]) == y
        });
        if level && x >= x0 {
            continue;
        }
        let (dx, dy) = (x - x0, y - y0);
        if dy == 0 {
            data.push('h');
            push_hundredths(&mut data, dx);
        } else {
            data.push('l');
            push_hundredths(&mut data, dx);
            if dy > 0 {
                data.push(' ');
            }
            push_hundredths(&mut data, dy);
        }
        last = Some([x, y]);
    }
    data
}

/// Text for XML and HTML content and attributes; without characters that XML
/// does not allow.
#[must_use]
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            '\'' => escaped += "&#39;",
            c if c.is_control() && !matches!(c, '\n' | '\t') => escaped.push(' '),
            '\u{fffe}' | '\u{ffff}' => escaped.push(' '),
            c => escaped.push(c),
        }
    }
    escaped
}

/// About how wide a text is \[px\] at a font size, rather too wide than too narrow.
#[must_use]
pub fn text_width(text: &str, size: f64) -> f64 {
    let units = text.chars().map(|c| match c {
        'i' | 'j' | 'l' | '.' | ',' | ':' | ';' | '|' | '\'' | ' ' | '(' | ')' => 0.36,
        'm' | 'w' | 'M' | 'W' => 0.95,
        c if c.is_ascii_uppercase() => 0.72,
        _ => 0.6,
    });
    units.sum::<f64>() * size
}

/// Whether tags open and close in order, and nothing in them is not a number.
#[cfg(test)]
pub(crate) fn well_formed(xml: &str) -> Result<(), String> {
    const VOID: [&str; 4] = ["meta", "br", "!doctype", "hr"];
    let mut open: Vec<&str> = Vec::new();
    let mut rest = xml;
    while let Some(start) = rest.find('<') {
        let text = &rest[..start];
        for part in text.split('&').skip(1) {
            let entity = part.split(';').next().unwrap_or("");
            if !part.contains(';') || entity.len() > 6 || entity.contains(' ') {
                return Err(format!("bare & in {text:?}"));
            }
        }
        let end = rest[start..].find('>').ok_or("tag without end")? + start;
        let tag = &rest[start + 1..end];
        rest = &rest[end + 1..];
        if !tag.matches('"').count().is_multiple_of(2) {
            return Err(format!("odd quotes in <{tag}>"));
        }
        for bad in ["NaN", "nan\"", "inf"] {
            if tag.contains(bad) {
                return Err(format!("{bad} in <{tag}>"));
            }
        }
        let name = tag.split([' ', '\n', '/']).next().unwrap_or("");
        if let Some(closed) = tag.strip_prefix('/') {
            let expected = open.pop();
            if expected != Some(closed) {
                return Err(format!("</{closed}> closes {expected:?}"));
            }
        } else if !tag.ends_with('/') && !VOID.contains(&name.to_lowercase().as_str()) {
            open.push(name);
            if name == "style" {
                let end = rest.find("</style>").ok_or("style without end")?;
                rest = &rest[end..];
            }
        }
    }
    if open.is_empty() {
        Ok(())
    } else {
        Err(format!("never closed: {open:?}"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_finite() {
        for (value, text) in [
            (1.0, "1"),
            (-0.001, "0"),
            (2.345_6, "2.35"),
            (-10.1, "-10.1"),
            (0.05, "0.05"),
            (-0.3, "-0.3"),
            (0.125, "0.13"),
            (-0.125, "-0.13"),
            (1234.5, "1234.5"),
            (-2e6, "-1000000"),
            (f64::NAN, "0"),
            (f64::INFINITY, "0"),
        ] {
            assert_eq!(number(value), text);
        }
    }

    #[test]
    fn curves_have_gaps_and_merge_level_stretches() {
        let nan = f64::NAN;
        assert_eq!(
            path_data(&[[0.0, 1.0], [1.0, 1.0], [2.0, 1.0], [3.0, 4.0]]),
            "M0 1h2l1 3"
        );
        assert_eq!(
            path_data(&[[0.0, 1.0], [1.0, nan], [2.0, 0.0], [3.0, -1.5]]),
            "M0 1h0M2 0l1-1.5"
        );
        assert_eq!(path_data(&[[nan, nan]]), "");
    }

    #[test]
    fn text_is_escaped() {
        let mut svg = Svg::new("x", [10.0, 10.0], "a < b & \"c\"", "d");
        svg.text("", [f64::NAN, 1.0], Anchor::Start, "</text><script>\u{1}");
        let file = svg.standalone();
        well_formed(&file).unwrap();
        assert!(!file.contains("<script>") && !file.contains('\u{1}'));
        assert!(well_formed("<a><b></a>").is_err() && well_formed("<a x=\"NaN\"/>").is_err());
    }
}
