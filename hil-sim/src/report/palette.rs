//! Colours of drawings and pages, for light and dark surroundings and print.
//!
//! The curve colours keep apart under the common colour-vision deficiencies
//! and have a contrast of at least three to one against their background;
//! dashes and labels say the same once more.

use std::fmt::Write;

/// Number of curve colours.
pub const COLOURS: usize = 7;

/// Name, light value, dark value.
const TOKENS: [(&str, &str, &str); 20] = [
    ("bg", "#ffffff", "#15181d"),
    ("page", "#f5f6f8", "#0d0f13"),
    ("ink", "#1b1f24", "#e8eaee"),
    ("muted", "#5b6470", "#a3acb8"),
    ("grid", "#e2e5ea", "#2b3038"),
    ("rule", "#c9ced6", "#3b424d"),
    ("band", "#f8eed3", "#2f2a19"),
    ("edge", "#c9a227", "#9c8130"),
    ("letter", "#7a5a00", "#ecc95c"),
    ("limit", "#b3261e", "#ff8a80"),
    ("pass", "#1a7f37", "#4cc46f"),
    ("fail", "#b3261e", "#ff8a80"),
    ("stopped", "#8a5a00", "#ffbf47"),
    ("s0", "#0072b2", "#4aa3ea"),
    ("s1", "#d55e00", "#ff8b4d"),
    ("s2", "#007f5f", "#2cc295"),
    ("s3", "#a5437f", "#e39ac6"),
    ("s4", "#8f6a00", "#f0c246"),
    ("s5", "#3a96c8", "#a5def8"),
    ("s6", "#5b6470", "#c3c9d2"),
];

/// Style rules that refer to the tokens as `$name`.
const RULES: &str = "\
.plot text{font-family:system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;font-size:12px;fill:$ink}
.plot .t{font-size:13px;font-weight:600}.plot .m{fill:$muted}.plot .b{font-weight:600}
.plot .small{font-size:11px}.plot .l{font-weight:700;fill:$letter}.plot .lim{fill:$limit}
.plot .halo{paint-order:stroke;stroke:$bg;stroke-width:3px;stroke-linejoin:round}
.plot .bg{fill:$bg}.plot .band{fill:$band}.plot .edge{stroke:$edge;stroke-width:.7}
.plot .grid{stroke:$grid;stroke-width:1;fill:none}.plot .minor{stroke-width:.5}
.plot .axis{stroke:$muted;stroke-width:1;fill:none}
.plot .limit{stroke:$limit;stroke-width:1.4;stroke-dasharray:7 4;fill:none}
.plot .mark{stroke:$limit;stroke-width:1.4;fill:none}
.plot .c{fill:none;stroke-width:1.5;stroke-linejoin:round;stroke-linecap:round}
.plot .wide{stroke-width:3.6;opacity:.42}.plot .thin{stroke-width:1}
.plot .dash{stroke-dasharray:7 4}.plot .dot{stroke-dasharray:1.5 4}
.plot .box{fill:$bg;stroke:$ink;stroke-width:1.4}.plot .soft{fill:$page;stroke:$rule;stroke-width:1}
.plot .wire{fill:none;stroke:$ink;stroke-width:1.4}.plot .head{fill:$ink}
";

/// The style sheet of a drawing. It serves a stand-alone file and, once, a page
/// with drawings in it.
#[must_use]
pub fn drawing_css() -> String {
    let curve = |k| format!(".plot .s{k}{{stroke:$s{k}}}.plot .f{k}{{fill:$s{k}}}\n");
    let curves: String = (0..COLOURS).map(curve).collect();
    variables() + &with_fallback(RULES) + &with_fallback(&curves)
}

/// `:root` with the colours: light, dark where asked for, light in print.
fn variables() -> String {
    let light = TOKENS.map(|(name, light, _)| format!("--{name}:{light};"));
    let dark = TOKENS.map(|(name, _, dark)| format!("--{name}:{dark};"));
    let (light, dark) = (light.concat(), dark.concat());
    format!(":root{{{light}}}\n@media screen and (prefers-color-scheme:dark){{:root{{{dark}}}}}\n")
}

/// Writes every declaration with `$name` twice: the light value for viewers
/// that know no variables, then the variable.
fn with_fallback(rules: &str) -> String {
    let mut css = String::new();
    for part in rules.split_inclusive(['{', ';', '}']) {
        let Some(start) = part.find('$') else {
            css += part;
            continue;
        };
        let tail = &part[start + 1..];
        let length = tail
            .find(|c: char| !c.is_ascii_alphanumeric())
            .unwrap_or(tail.len());
        let (name, end) = tail.split_at(length);
        let token = TOKENS.iter().find(|token| token.0 == name);
        let light = token.map_or("", |token| token.1);
        let property = &part[..start];
        let _ = write!(css, "{property}{light};{property}var(--{name}){end}");
    }
    css
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance of `#rrggbb`.
    fn luminance(colour: &str) -> f64 {
        let channel = |at: usize| {
            let value = f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap()) / 255.0;
            if value <= 0.03928 {
                value / 12.92
            } else {
                ((value + 0.055) / 1.055).powf(2.4)
            }
        };
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    #[test]
    fn curves_and_words_stand_out_from_their_background() {
        let contrast = |a: &str, b: &str| {
            let (a, b) = (luminance(a), luminance(b));
            (a.max(b) + 0.05) / (a.min(b) + 0.05)
        };
        let (_, light, dark) = TOKENS[0];
        for (name, on_light, on_dark) in TOKENS {
            let least = match name {
                "ink" | "muted" | "limit" | "pass" | "fail" | "stopped" => 4.5,
                name if name.starts_with('s') => 3.0,
                _ => continue,
            };
            assert!(contrast(on_light, light) >= least, "{name} on light");
            assert!(contrast(on_dark, dark) >= least, "{name} on dark");
        }
    }

    #[test]
    fn every_colour_in_the_rules_exists() {
        let css = drawing_css();
        assert!(!css.contains('$') && !css.contains(":;"), "{css}");
        assert!(css.contains("fill:#1b1f24;fill:var(--ink)"));
    }
}
