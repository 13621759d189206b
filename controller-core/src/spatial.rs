//! Rigid-body sums in joint axes: what the dynamics carries from joint to joint.
//!
//! The *joint frame* i has its origin at that of DH frame i and its z axis along
//! joint i + 1, and turns with the link behind that joint. There a joint's own
//! axis is (0, 0, 1), so that most products with it are only a choice of entries.
//! From joint frame i + 1 to joint frame i leads the angle of that joint, about z,
//! then the twist of the link between, about x, then the way between the origins,
//! (a, 0, d). Right angles of twist only exchange axes; a sum about one point of
//! the arm never contains the lever to another one.

use core::ops::{Add, Mul, Neg, Sub};

use crate::joint::Lanes;
use crate::model::{Link, Twist};
use crate::real::Real;

/// What turns as a coordinate does: a number, or a column of a matrix.
pub(crate) trait Entry<T>:
    Copy + Add<Output = Self> + Sub<Output = Self> + Neg<Output = Self> + Mul<T, Output = Self>
{
}
impl<T, E> Entry<T> for E where
    E: Copy + Add<Output = E> + Sub<Output = E> + Neg<Output = E> + Mul<T, Output = E>
{
}

/// Rotation about z by the angle whose sine and cosine are given.
#[inline(always)]
fn swing<T: Copy, E: Entry<T>>([x, y, z]: [E; 3], sine: T, cosine: T) -> [E; 3] {
    [x * cosine - y * sine, x * sine + y * cosine, z]
}

/// Rotation about x by the twist of `link`, whose kind is `TWIST`.
#[inline(always)]
fn turn<T: Real, E: Entry<T>, const TWIST: u8>([x, y, z]: [E; 3], link: &Link<T>) -> [E; 3] {
    match TWIST {
        Twist::NONE => [x, y, z],
        Twist::RIGHT => [x, -z, y],
        Twist::LEFT => [x, z, -y],
        _ => {
            let (sine, cosine) = (link.sin_alpha, link.cos_alpha);
            [x, y * cosine - z * sine, y * sine + z * cosine]
        }
    }
}

/// The way from one joint frame to the next one towards the base.
#[derive(Clone, Copy)]
pub(crate) struct Way<'a, T: Real> {
    /// Sine and cosine of the outer joint's angle.
    pub sine: T,
    pub cosine: T,
    /// The link between the joints.
    pub link: &'a Link<T>,
}

/// Calls a function with the kind of twist of a way's link as constant, so that one
/// branch serves all that is carried.
macro_rules! by_twist {
    ($object:expr, $function:ident, $way:expr) => {
        match $way.link.twist.0 {
            Twist::NONE => $object.$function::<{ Twist::NONE }>($way),
            Twist::RIGHT => $object.$function::<{ Twist::RIGHT }>($way),
            Twist::LEFT => $object.$function::<{ Twist::LEFT }>($way),
            _ => $object.$function::<{ Twist::OTHER }>($way),
        }
    };
}

impl<T: Real> Way<'_, T> {
    #[inline(always)]
    fn inward<E: Entry<T>, const TWIST: u8>(&self, v: [E; 3]) -> [E; 3] {
        turn::<T, E, TWIST>(swing(v, self.sine, self.cosine), self.link)
    }

    #[inline(always)]
    fn outward<const TWIST: u8>(&self, [x, y, z]: [T; 3]) -> [T; 3] {
        let (sine, cosine) = (self.link.sin_alpha, self.link.cos_alpha);
        let back = match TWIST {
            Twist::NONE => [x, y, z],
            Twist::RIGHT => [x, z, -y],
            Twist::LEFT => [x, -z, y],
            _ => [x, y * cosine + z * sine, z * cosine - y * sine],
        };
        swing(back, -self.sine, self.cosine)
    }
}

/// Velocities and gravity in joint axes.
#[derive(Clone, Copy)]
pub(crate) struct Motion<T: Real> {
    /// Angular velocity of the link behind the joint \[rad/s\].
    pub spin: [T; 3],
    /// Velocity of the joint frame's origin \[m/s\].
    pub velocity: [T; 3],
    /// Gravitational acceleration \[m/s2\].
    pub gravity: [T; 3],
}

impl<T: Real> Motion<T> {
    /// The same in the next joint frame outwards, whose joint turns at `speed`.
    #[inline(always)]
    pub fn outward(&self, way: &Way<'_, T>, speed: T) -> Self {
        let mut next = by_twist!(self, carried, way);
        next.spin[2] += speed;
        next
    }

    #[inline(always)]
    fn carried<const TWIST: u8>(&self, way: &Way<'_, T>) -> Self {
        let Link { a, d, .. } = *way.link;
        let [wx, wy, wz] = self.spin;
        let [vx, vy, vz] = self.velocity;
        let mut velocity = [vx + wy * d, vy - wx * d, vz];
        if TWIST == Twist::OTHER {
            velocity[1] += wz * a;
            velocity[2] -= wy * a;
        }
        Self {
            spin: way.outward::<TWIST>(self.spin),
            velocity: way.outward::<TWIST>(velocity),
            gravity: way.outward::<TWIST>(self.gravity),
        }
    }
}

/// A symmetric 3 x 3 matrix by its six entries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Symmetric<T: Real> {
    pub xx: T,
    pub xy: T,
    pub xz: T,
    pub yy: T,
    pub yz: T,
    pub zz: T,
}

/// Mass, momentum and their moments of a group of links about the origin of a
/// joint frame, in its axes. With p the position of a mass element relative to that
/// origin and dp its absolute velocity, everything that dynamics needs is
///
/// | field | integral over the mass | unit |
/// |---|---|---|
/// | `mass` | dm | kg |
/// | `first` h | p dm | kg m |
/// | `second` S | p p^T dm | kg m2 |
/// | `flow` \[D l\] | dp (p, 1)^T dm, by rows | kg m2/s, kg m/s |
///
/// All add over links. Column l of `flow` is the momentum.
#[derive(Clone, Copy)]
pub(crate) struct Moments<T: Real> {
    pub mass: T,
    pub first: [T; 3],
    pub second: Symmetric<T>,
    pub flow: [Lanes<T>; 3],
}

impl<T: Real> Moments<T> {
    pub fn zero() -> Self {
        let zero = T::ZERO;
        Self {
            mass: zero,
            first: [zero; 3],
            second: Symmetric {
                xx: zero,
                xy: zero,
                xz: zero,
                yy: zero,
                yz: zero,
                zz: zero,
            },
            flow: [Lanes::from([zero; 4]); 3],
        }
    }

    /// Adds one link, whose elements move with dp = v + omega x p.
    #[inline(always)]
    pub fn add_link(&mut self, link: &Link<T>, motion: &Motion<T>) {
        let [x, y, z, one] = &link.moments;
        let [wx, wy, wz] = motion.spin;
        let [vx, vy, vz] = motion.velocity;
        self.flow[0] += one * vx + (z * wy - y * wz);
        self.flow[1] += one * vy + (x * wz - z * wx);
        self.flow[2] += one * vz + (y * wx - x * wy);
        self.mass += one[3];
        self.first[0] += one[0];
        self.first[1] += one[1];
        self.first[2] += one[2];
        let s = &mut self.second;
        s.xx += x[0];
        s.xy += x[1];
        s.xz += x[2];
        s.yy += y[1];
        s.yz += y[2];
        s.zz += z[2];
    }

    /// The same about the next joint frame inwards, in its axes.
    #[inline(always)]
    pub fn inward(&self, way: &Way<'_, T>) -> Self {
        by_twist!(self, carried, way)
    }

    #[inline(always)]
    fn carried<const TWIST: u8>(&self, way: &Way<'_, T>) -> Self {
        // Rows turn with dp, entries within a row with p.
        let turned = way.inward::<Lanes<T>, TWIST>(self.flow);
        let row = |row: Lanes<T>| {
            let [x, y, z] = way.inward::<T, TWIST>([row[0], row[1], row[2]]);
            Lanes::from([x, y, z, row[3]])
        };
        let mut moved = Self {
            mass: self.mass,
            first: way.inward::<T, TWIST>(self.first),
            second: self.second.inward::<TWIST>(way),
            flow: turned.map(row),
        };
        let Link { a, d, .. } = *way.link;
        if d != T::ZERO {
            moved.shift_along_z(d);
        }
        if TWIST == Twist::OTHER {
            moved.shift_along_x(a);
        }
        moved
    }

    /// Every p becomes p + (0, 0, d).
    #[inline(always)]
    fn shift_along_z(&mut self, d: T) {
        let [hx, hy, hz] = self.first;
        let md = self.mass * d;
        self.second.xz += hx * d;
        self.second.yz += hy * d;
        self.second.zz += (hz + hz + md) * d;
        self.first[2] += md;
        for row in &mut self.flow {
            row[2] = row[2] + row[3] * d;
        }
    }

    /// Every p becomes p + (a, 0, 0).
    #[inline(always)]
    fn shift_along_x(&mut self, a: T) {
        let [hx, hy, hz] = self.first;
        let ma = self.mass * a;
        self.second.xx += (hx + hx + ma) * a;
        self.second.xy += hy * a;
        self.second.xz += hz * a;
        self.first[0] += ma;
        for row in &mut self.flow {
            row[0] = row[0] + row[3] * a;
        }
    }
}

impl<T: Real> Symmetric<T> {
    #[inline(always)]
    fn inward<const TWIST: u8>(&self, way: &Way<'_, T>) -> Self {
        let (sine, cosine) = (way.sine, way.cosine);
        let x = self.xx * cosine - self.xy * sine;
        let y = self.xy * cosine - self.yy * sine;
        let xx = x * cosine - y * sine;
        let swung = Self {
            xx,
            xy: x * sine + y * cosine,
            xz: self.xz * cosine - self.yz * sine,
            // A rotation about z keeps xx + yy.
            yy: (self.xx + self.yy) - xx,
            yz: self.xz * sine + self.yz * cosine,
            zz: self.zz,
        };
        swung.turn::<TWIST>(way.link)
    }

    #[inline(always)]
    fn turn<const TWIST: u8>(self, link: &Link<T>) -> Self {
        let Self {
            xx,
            xy,
            xz,
            yy,
            yz,
            zz,
        } = self;
        match TWIST {
            Twist::NONE => self,
            Twist::RIGHT => Self {
                xx,
                xy: -xz,
                xz: xy,
                yy: zz,
                yz: -yz,
                zz: yy,
            },
            Twist::LEFT => Self {
                xx,
                xy: xz,
                xz: -xy,
                yy: zz,
                yz: -yz,
                zz: yy,
            },
            _ => {
                let (sine, cosine) = (link.sin_alpha, link.cos_alpha);
                let y = [yy * cosine - yz * sine, yy * sine + yz * cosine];
                let z = [yz * cosine - zz * sine, yz * sine + zz * cosine];
                Self {
                    xx,
                    xy: xy * cosine - xz * sine,
                    xz: xy * sine + xz * cosine,
                    yy: y[0] * cosine - z[0] * sine,
                    yz: y[0] * sine + z[0] * cosine,
                    zz: y[1] * sine + z[1] * cosine,
                }
            }
        }
    }
}

/// What the links from one joint outwards contribute to its row and column of M and
/// C, as moments and forces about the origin of the joint frame they are carried to.
#[derive(Clone, Copy)]
pub(crate) struct JointWrench<T: Real> {
    /// Rows x, y, z of four vectors, in this order: the moments of I S and of
    /// I dS + B S, the forces of I S and of I dS + B S. I S is the momentum for unit
    /// speed of the joint, I dS + B S the column of C above the diagonal.
    pub rows: [Lanes<T>; 3],
    /// B^T S, a pure moment.
    pub transposed_rate: [T; 3],
}

/// Rate of a joint's twist S = (z, 0), seen from the origin of its frame:
/// dS/dt = (omega x z, v x z), whose third entries are zero.
#[derive(Clone, Copy)]
pub(crate) struct AxisRate<T> {
    pub turn: [T; 2],
    pub slide: [T; 2],
}

impl<T: Real> AxisRate<T> {
    #[inline(always)]
    pub fn new(motion: &Motion<T>) -> Self {
        let ([wx, wy, _], [vx, vy, _]) = (motion.spin, motion.velocity);
        Self {
            turn: [wy, -wx],
            slide: [vy, -vx],
        }
    }
}

impl<T: Real> JointWrench<T> {
    /// With z = (0, 0, 1) a product with S is a choice of entries.
    #[inline(always)]
    pub fn new(group: &Moments<T>, rate: &AxisRate<T>) -> Self {
        let s = &group.second;
        let [hx, hy, hz] = group.first;
        let [dx, dy, dz] = &group.flow;
        let [a, b] = rate.turn;
        let [u, v] = rate.slide;
        let trace = dx[0] + dy[1];
        Self {
            rows: [
                Lanes::from([
                    -s.xz,
                    (s.yy + s.zz) * a - s.xy * b - hz * v - dx[2],
                    -hy,
                    group.mass * u + hz * b - dy[3],
                ]),
                Lanes::from([
                    -s.yz,
                    (s.xx + s.zz) * b - s.xy * a + hz * u - dy[2],
                    hx,
                    group.mass * v - hz * a + dx[3],
                ]),
                Lanes::from([
                    s.xx + s.yy,
                    hx * v - hy * u - s.xz * a - s.yz * b + trace,
                    T::ZERO,
                    hy * a - hx * b,
                ]),
            ],
            transposed_rate: [-dz[0], -dz[1], trace],
        }
    }

    /// The same about the next joint frame inwards, in its axes.
    #[inline(always)]
    pub fn inward(&self, way: &Way<'_, T>) -> Self {
        by_twist!(self, carried, way)
    }

    #[inline(always)]
    fn carried<const TWIST: u8>(&self, way: &Way<'_, T>) -> Self {
        let mut rows = way.inward::<Lanes<T>, TWIST>(self.rows);
        // The forces act at (a, 0, d).
        let Link { a, d, .. } = *way.link;
        if d != T::ZERO {
            for (moment, force) in [(0, 2), (1, 3)] {
                rows[0][moment] = rows[0][moment] - rows[1][force] * d;
                rows[1][moment] = rows[1][moment] + rows[0][force] * d;
            }
        }
        if TWIST == Twist::OTHER {
            for (moment, force) in [(0, 2), (1, 3)] {
                rows[1][moment] = rows[1][moment] - rows[2][force] * a;
                rows[2][moment] = rows[2][moment] + rows[1][force] * a;
            }
        }
        Self {
            rows,
            transposed_rate: way.inward::<T, TWIST>(self.transposed_rate),
        }
    }
}
