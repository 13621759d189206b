//! Reference motions: of a point straight move and circle, of an orientation a
//! swing, and rest of both. All start and, where they end, end at rest with zero
//! acceleration.

use crate::joint::Vector3;
use crate::real::Real;
use crate::task::Target;
use crate::task::orientation::{self, Quaternion};

/// b(s) = 10 s^3 - 15 s^4 + 6 s^5 and its first two derivatives by s, for s
/// limited to 0..1: 0 before, 1 after, twice continuously differentiable.
#[must_use]
#[inline]
pub fn quintic<T: Real>(s: T) -> [T; 3] {
    let s = s.limited(T::ZERO, T::ONE);
    let c = T::from_f64;
    let rest = T::ONE - s;
    [
        s * s * s * (c(10.0) + s * (c(6.0) * s - c(15.0))),
        c(30.0) * s * s * rest * rest,
        c(60.0) * s * rest * (T::ONE - s - s),
    ]
}

/// Plane of a circle, two base-plate axes: the motion starts along
/// the first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Plane {
    /// First y, then z.
    Yz,
    /// First x, then z.
    Xz,
    /// First x, then y.
    Xy,
}

impl Plane {
    /// a along the first axis of the plane plus b along the second.
    #[inline(always)]
    fn vector<T: Real>(self, a: T, b: T) -> Vector3<T> {
        match self {
            Self::Yz => Vector3::from([T::ZERO, a, b]),
            Self::Xz => Vector3::from([a, T::ZERO, b]),
            Self::Xy => Vector3::from([a, b, T::ZERO]),
        }
    }
}

/// A reference motion as data. Positions in the base-plate frame, relative to
/// an origin that is given when it is sampled.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Trajectory<T: Real> {
    /// Rest at the origin.
    Hold,
    /// Straight line to `by` \[m\] in `duration_s`, then rest.
    Move {
        /// Displacement \[m\].
        by: Vector3<T>,
        /// Time of the move \[s\].
        duration_s: T,
    },
    /// radius b(t / growth_s) (cos, sin)(2 pi t / period_s) about the origin: a
    /// circle that grows from a point.
    Turn {
        /// Plane of the motion.
        plane: Plane,
        /// Radius in the end \[m\].
        radius_m: T,
        /// Time of one turn \[s\].
        period_s: T,
        /// Time in which the radius grows from zero \[s\].
        growth_s: T,
    },
}

impl<T: Real> Trajectory<T> {
    /// Reference at time `t_s` \[s\] since the start, about `origin` \[m\].
    ///
    /// Time before the start counts as the start. A period or duration that is
    /// not positive gives a reference that is not finite, which the controller
    /// refuses as implausible.
    #[must_use]
    pub fn sample(&self, origin: &Vector3<T>, t_s: T) -> Target<T> {
        let t_s = t_s.most(T::ZERO);
        match *self {
            Self::Hold => Target::position(*origin),
            Self::Move { by, duration_s } => {
                let rate = T::ONE / duration_s;
                let [b, db, ddb] = quintic(t_s * rate);
                Target::Position {
                    x: origin + by * b,
                    dx: by * (db * rate),
                    ddx: by * (ddb * rate * rate),
                }
            }
            Self::Turn {
                plane,
                radius_m,
                period_s,
                growth_s,
            } => {
                let [b, db, ddb] = grown(radius_m, growth_s, t_s);
                let (sin, cos, omega) = phase(t_s, period_s);
                let (spin, pull) = (b * omega, b * omega * omega);
                let twist = (db + db) * omega;
                Target::Position {
                    x: origin + plane.vector(b * cos, b * sin),
                    dx: plane.vector(db * cos - spin * sin, db * sin + spin * cos),
                    ddx: plane.vector(
                        ddb * cos - twist * sin - pull * cos,
                        ddb * sin + twist * cos - pull * sin,
                    ),
                }
            }
        }
    }
}

/// A reference motion of an orientation as data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Rotation<T: Real> {
    /// Rest at the origin.
    Hold,
    /// Turning to and fro about a fixed axis: by
    /// amplitude_rad b(t / growth_s) sin(2 pi t / period_s) from the origin.
    Swing {
        /// Unit vector, base-plate axes.
        axis: Vector3<T>,
        /// Largest angle \[rad\], up to 2 pi.
        amplitude_rad: T,
        /// Time of one swing \[s\].
        period_s: T,
        /// Time in which the amplitude grows from zero \[s\].
        growth_s: T,
    },
}

impl<T: Real> Rotation<T> {
    /// Reference at time `t_s` \[s\] since the start, from the orientation
    /// `origin`. Time before the start counts as the start.
    #[must_use]
    pub fn sample(&self, origin: &Quaternion<T>, t_s: T) -> Target<T> {
        let t_s = t_s.most(T::ZERO);
        match *self {
            Self::Hold => Target::orientation(*origin),
            Self::Swing {
                axis,
                amplitude_rad,
                period_s,
                growth_s,
            } => {
                let [b, db, ddb] = grown(amplitude_rad, growth_s, t_s);
                let (sin, cos, omega) = phase(t_s, period_s);
                let spin = b * omega;
                let swung = orientation::about_axis(&axis, b * sin);
                Target::Orientation {
                    q: orientation::product(&swung, origin),
                    w: axis * (db * sin + spin * cos),
                    dw: axis * (ddb * sin + (db + db) * omega * cos - spin * omega * sin),
                }
            }
        }
    }
}

/// `amplitude` b(t / growth_s) and its first two derivatives by time.
#[inline(always)]
fn grown<T: Real>(amplitude: T, growth_s: T, t_s: T) -> [T; 3] {
    let rate = T::ONE / growth_s;
    let [b, db, ddb] = quintic(t_s * rate);
    [
        amplitude * b,
        amplitude * db * rate,
        amplitude * ddb * rate * rate,
    ]
}

/// Sine and cosine of 2 pi t / period, and 2 pi / period \[rad/s\]. Whole turns
/// are taken off before the angle is formed.
#[inline(always)]
fn phase<T: Real>(t_s: T, period_s: T) -> (T, T, T) {
    let turns = t_s / period_s;
    let tau = T::from_f64(core::f64::consts::TAU);
    let (sin, cos) = ((turns - turns.floor_small()) * tau).sine_cosine();
    (sin, cos, tau / period_s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_blend_starts_and_ends_at_rest() {
        assert_eq!(quintic(0.0), [0.0, 0.0, 0.0]);
        assert_eq!(quintic(1.0), [1.0, 0.0, 0.0]);
        assert_eq!(quintic(-3.0), [0.0, 0.0, 0.0]);
        assert_eq!(quintic(7.0f32), [1.0, 0.0, 0.0]);
        assert_eq!(quintic(0.5)[0], 0.5);
    }

    /// Velocity and acceleration against central differences of the position,
    /// whose error at a step of 1e-4 s is 1e-8 relative for these motions plus
    /// 1e-16 / 1e-8 of rounding in the second difference.
    #[test]
    fn derivatives_are_those_of_the_position() {
        let origin = Vector3::from([0.4, -0.1, 0.7]);
        let step = 1e-4;
        for motion in [
            Trajectory::Hold,
            Trajectory::Move {
                by: Vector3::from([0.1, 0.2, -0.3]),
                duration_s: 1.7,
            },
            Trajectory::Turn {
                plane: Plane::Yz,
                radius_m: 0.1,
                period_s: 6.0,
                growth_s: 2.0,
            },
            Trajectory::Turn {
                plane: Plane::Xy,
                radius_m: 0.04,
                period_s: 6.0,
                growth_s: 20.0,
            },
            Trajectory::Turn {
                plane: Plane::Xz,
                radius_m: 0.2,
                period_s: 1.5,
                growth_s: 0.5,
            },
        ] {
            for i in 1..900 {
                let t = f64::from(i) * 0.023;
                let [before, now, after] = [t - step, t, t + step].map(|t| {
                    let Target::Position { x, dx, ddx } = motion.sample(&origin, t) else {
                        panic!("a trajectory gives positions");
                    };
                    [x, dx, ddx]
                });
                let velocity = (after[0] - before[0]) / (2.0 * step);
                let acceleration = (after[1] - before[1]) / (2.0 * step);
                assert!((velocity - now[1]).amax() < 2e-6, "{motion:?} {t}");
                assert!((acceleration - now[2]).amax() < 2e-4, "{motion:?} {t}");
            }
        }
    }

    /// The angular velocity against the quaternion's own change: dq/dt = w q / 2.
    #[test]
    fn a_swing_turns_with_its_angular_velocity() {
        let origin = orientation::about_axis(&Vector3::from([0.6, 0.0, 0.8]), 0.7);
        let swing = Rotation::Swing {
            axis: Vector3::from([0.0, 0.6, 0.8]),
            amplitude_rad: 1.2,
            period_s: 4.0,
            growth_s: 2.0,
        };
        let step = 1e-4;
        for i in 1..400 {
            let t = f64::from(i) * 0.023;
            let [before, now, after] = [t - step, t, t + step].map(|t| {
                let Target::Orientation { q, w, dw } = swing.sample(&origin, t) else {
                    panic!("a rotation gives orientations");
                };
                (q, w, dw)
            });
            let turned = orientation::chord(&after.0, &before.0);
            assert!((turned / (2.0 * step) - now.1).amax() < 2e-6, "{t}");
            let acceleration = (after.1 - before.1) / (2.0 * step);
            assert!((acceleration - now.2).amax() < 2e-4, "{t}");
        }
    }
}
