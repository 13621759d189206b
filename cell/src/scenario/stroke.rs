//! There and back: the share of a way that a motion has made.

use controller_core::real::Real as _;
use controller_core::task::trajectory::quintic;

use crate::invalid::Invalid;
use crate::ranges::{DURATION_S, Range, TIME_S};

/// When a motion goes there and back again, and how evenly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stroke {
    /// When it starts \[s\].
    pub from_s: f64,
    /// Time of one way \[s\].
    pub duration_s: f64,
    /// Time in which the speed goes up, and in which it goes down, along a cosine, with an even
    /// speed between \[s\]; none: one quintic blend.
    pub ramp_s: Option<f64>,
    /// Rest at the far end \[s\].
    pub hold_s: f64,
}

impl Stroke {
    /// Checks the times.
    ///
    /// # Errors
    /// What is out of range.
    pub fn validate(&self) -> Result<(), Invalid> {
        TIME_S.check("from_s", self.from_s)?;
        DURATION_S.check("duration_s", self.duration_s)?;
        TIME_S.check("hold_s", self.hold_s)?;
        match self.ramp_s {
            None => Ok(()),
            Some(ramp_s) => Range::above(0.0, self.duration_s / 2.0)
                .check("ramp_s", ramp_s)
                .map(drop),
        }
    }

    /// One way at `speed` \[m/s\] over `way` \[m\], with ramps of `ramp_s` \[s\].
    #[must_use]
    pub fn at_speed(way: f64, speed: f64, ramp_s: f64) -> Self {
        Self {
            from_s: 0.0,
            duration_s: way / speed + ramp_s,
            ramp_s: Some(ramp_s),
            hold_s: 0.0,
        }
    }

    /// When the motion is over \[s\].
    #[must_use]
    pub fn end_s(&self) -> f64 {
        self.from_s + 2.0 * self.duration_s + self.hold_s
    }

    /// Share of the way made at time `t_s` \[s\], 0 to 1, and its first two derivatives
    /// \[1/s\], \[1/s2\].
    #[must_use]
    pub fn share(&self, t_s: f64) -> [f64; 3] {
        let since_s = t_s - self.from_s;
        if since_s < self.duration_s + self.hold_s {
            return self.there(since_s);
        }
        let [b, db, ddb] = self.there(2.0 * self.duration_s + self.hold_s - since_s);
        [b, -db, ddb]
    }

    /// Of the way there, `t_s` after its start.
    fn there(&self, t_s: f64) -> [f64; 3] {
        let t_s = t_s.clamp(0.0, self.duration_s);
        let Some(ramp_s) = self.ramp_s else {
            let [b, db, ddb] = quintic(t_s / self.duration_s);
            return [
                b,
                db / self.duration_s,
                ddb / (self.duration_s * self.duration_s),
            ];
        };
        let left_s = self.duration_s - t_s;
        let speed = 1.0 / (self.duration_s - ramp_s);
        if t_s < ramp_s {
            ramp(t_s, ramp_s, speed)
        } else if left_s < ramp_s {
            let [b, db, ddb] = ramp(left_s, ramp_s, speed);
            [1.0 - b, db, -ddb]
        } else {
            [speed * (t_s - ramp_s / 2.0), speed, 0.0]
        }
    }
}

/// From rest to `speed` in `ramp_s`: its acceleration is half a sine.
fn ramp(t_s: f64, ramp_s: f64, speed: f64) -> [f64; 3] {
    let rate = core::f64::consts::PI / ramp_s;
    let (sin, cos) = (rate * t_s).sine_cosine();
    [
        speed * (t_s - sin / rate) / 2.0,
        speed * (1.0 - cos) / 2.0,
        speed * rate * sin / 2.0,
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn strokes() -> [Stroke; 2] {
        let quintic = Stroke {
            from_s: 0.5,
            duration_s: 2.0,
            ramp_s: None,
            hold_s: 1.0,
        };
        let even = Stroke {
            ramp_s: Some(0.15),
            ..quintic
        };
        [quintic, even]
    }

    #[test]
    fn it_goes_there_rests_and_comes_back() {
        for stroke in strokes() {
            for (t_s, share) in [(0.0, 0.0), (0.5, 0.0), (1.5, 0.5), (2.5, 1.0), (3.4, 1.0)] {
                assert!((stroke.share(t_s)[0] - share).abs() < 1e-12, "{t_s}");
                // The way back is the way there in a mirror.
                let mirrored = stroke.share(stroke.end_s() + stroke.from_s - t_s);
                assert!((mirrored[0] - share).abs() < 1e-12, "{t_s}");
            }
            assert!(stroke.share(100.0).iter().all(|&number| number == 0.0));
            assert!((stroke.end_s() - 5.5).abs() < 1e-12);
        }
    }

    /// Against central differences; their error is h^2/6 times the third derivative of the
    /// speed, below 1e-5 where no ramp ends.
    #[test]
    fn derivatives_are_those_of_the_share() {
        let step = 1e-4;
        for stroke in strokes() {
            for i in 1..600 {
                let t_s = f64::from(i) * 0.01 + 0.003;
                let [before, now, after] = [t_s - step, t_s, t_s + step].map(|t| stroke.share(t));
                for order in 0..2 {
                    let slope = (after[order] - before[order]) / (2.0 * step);
                    let wrong = (slope - now[order + 1]).abs();
                    assert!(wrong < 1e-5, "{stroke:?} {t_s} {order}: {wrong:e}");
                }
            }
        }
    }

    #[test]
    fn times_that_cannot_be_are_refused() {
        let [stroke, _] = strokes();
        assert_eq!(stroke.validate(), Ok(()));
        for (wrong, text) in [
            (
                Stroke {
                    ramp_s: Some(1.5),
                    ..stroke
                },
                "ramp_s: 1.5; allowed: above 0, at most 1",
            ),
            (
                Stroke {
                    duration_s: 0.0,
                    ..stroke
                },
                "duration_s: 0; allowed: above 0, at most 3600",
            ),
            (
                Stroke {
                    hold_s: -1.0,
                    ..stroke
                },
                "hold_s: -1; allowed: 0 to 3600",
            ),
            (
                Stroke {
                    from_s: f64::NAN,
                    ..stroke
                },
                "from_s: NaN; allowed: 0 to 3600",
            ),
        ] {
            let error = wrong.validate().expect_err(text);
            assert_eq!(error.to_string(), text);
        }
    }

    #[test]
    fn the_speed_between_ramps_is_what_was_asked_for() {
        let stroke = Stroke::at_speed(0.6, 0.3, 0.15);
        assert!(stroke.validate().is_ok());
        assert!((stroke.share(1.0)[1] * 0.6 - 0.3).abs() < 1e-12);
    }
}
