//! Line charts: panels on top of each other that share the horizontal axis,
//! lettered bands over all of them, limits, and a legend outside the data.

mod bars;
mod chart;
mod decimate;
mod layout;
mod range;

pub use chart::{Band, Chart, LimitLine, Mark, Panel, Scale, Series, Strip, Stroke, Style};
pub use decimate::decimate;

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;
    use super::*;

    fn chart(series: Vec<Series>, scale: Scale) -> Chart {
        let mut chart = Chart::over_time("c", "a <title>", "d");
        let mut panel = Panel::new("error [mm]", 120.0, scale, series);
        panel.limits.push(LimitLine {
            value: 1.8,
            label: "limit 1.8 mm".into(),
        });
        panel.end_labels = true;
        chart.panels = vec![panel.clone(), panel];
        chart.bands = (0..30)
            .map(|k| Band {
                from: f64::from(k),
                to: f64::from(k) + 0.5,
                label: super::super::letter(k as usize),
            })
            .collect();
        chart.marks.push(Mark {
            at: 3.0,
            label: "stopped".into(),
        });
        chart
    }

    #[test]
    fn hard_series_give_finite_well_formed_drawings() {
        let nan = f64::NAN;
        let hard: [Vec<[f64; 2]>; 7] = [
            vec![],
            vec![[nan, nan]],
            vec![[0.0, 5.0], [1.0, 5.0]],
            vec![[2.0, 0.0]],
            vec![[0.0, -1e300], [1.0, 1e300]],
            vec![[0.0, 1.0], [0.5, nan], [1.0, f64::INFINITY], [2.0, 1e-30]],
            vec![[0.0, 0.0], [1.0, -3.0]],
        ];
        for points in hard {
            for scale in [Scale::Linear, Scale::FromZero, Scale::Log { floor: 1e-12 }] {
                let series = Series {
                    label: "x & y".into(),
                    points: points.clone(),
                    style: Style::default(),
                };
                let file = chart(vec![series], scale).draw().standalone();
                well_formed(&file).unwrap_or_else(|error| panic!("{points:?} {scale:?}: {error}"));
                for bad in ["NaN", "inf"] {
                    assert!(!file.contains(bad), "{points:?} {scale:?}");
                }
            }
        }
        well_formed(&chart(vec![], Scale::Linear).draw().inline()).unwrap();
    }

    #[test]
    fn a_long_line_stays_small() {
        let points = (0..100_000).map(|k| {
            let t = f64::from(k) * 2e-4;
            [t, (t * 900.0).sin()]
        });
        let series = Series {
            label: "r".into(),
            points: points.collect(),
            style: Style::solid(0),
        };
        let file = chart(vec![series], Scale::Linear).draw().standalone();
        assert!(file.len() < 80_000, "{}", file.len());
    }

    #[test]
    fn same_label_is_one_legend_entry() {
        let line = |colour| Series {
            label: "estimate".into(),
            points: vec![[0.0, 0.0], [1.0, 1.0]],
            style: Style::solid(colour),
        };
        let mut chart = chart(vec![line(0)], Scale::Linear);
        for panel in &mut chart.panels {
            panel.end_labels = false;
        }
        assert_eq!(chart.draw().inline().matches(">estimate<").count(), 1);
    }
}
