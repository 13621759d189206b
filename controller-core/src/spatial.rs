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

use crate::joint::Vector3;
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
        if a != T::ZERO {
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
/// | `momentum` l | dp dm | kg m/s |
/// | `rate` D | dp p^T dm, by columns | kg m2/s |
///
/// All five add over links.
#[derive(Clone, Copy)]
pub(crate) struct Moments<T: Real> {
    pub mass: T,
    pub first: [T; 3],
    pub second: Symmetric<T>,
    pub momentum: [T; 3],
    pub rate: [Vector3<T>; 3],
}

impl<T: Real> Moments<T> {
    /// One link alone: dp = v + omega x p.
    #[inline(always)]
    pub fn of_link(link: &Link<T>, motion: &Motion<T>) -> Self {
        let [hx, hy, hz] = link.first_moment;
        let s = link.second_moment;
        let spin = Vector3::from(motion.spin);
        let velocity = Vector3::from(motion.velocity);
        let column = |h: T, x: T, y: T, z: T| velocity * h + spin.cross(&Vector3::from([x, y, z]));
        let momentum = column(link.mass, hx, hy, hz);
        Self {
            mass: link.mass,
            first: link.first_moment,
            second: s,
            momentum: momentum.into(),
            rate: [
                column(hx, s.xx, s.xy, s.xz),
                column(hy, s.xy, s.yy, s.yz),
                column(hz, s.xz, s.yz, s.zz),
            ],
        }
    }

    #[inline(always)]
    pub fn add(&mut self, other: &Self) {
        let (s, o) = (&mut self.second, &other.second);
        self.mass += other.mass;
        s.xx += o.xx;
        s.xy += o.xy;
        s.xz += o.xz;
        s.yy += o.yy;
        s.yz += o.yz;
        s.zz += o.zz;
        for i in 0..3 {
            self.first[i] += other.first[i];
            self.momentum[i] += other.momentum[i];
            self.rate[i] += other.rate[i];
        }
    }

    /// The same about the next joint frame inwards, in its axes.
    #[inline(always)]
    pub fn inward(&self, way: &Way<'_, T>) -> Self {
        by_twist!(self, carried, way)
    }

    #[inline(always)]
    fn carried<const TWIST: u8>(&self, way: &Way<'_, T>) -> Self {
        let mut moved = Self {
            mass: self.mass,
            first: way.inward::<T, TWIST>(self.first),
            second: self.second.inward::<TWIST>(way),
            momentum: way.inward::<T, TWIST>(self.momentum),
            rate: way
                .inward::<Vector3<T>, TWIST>(self.rate)
                .map(|column| Vector3::from(way.inward::<T, TWIST>(column.into()))),
        };
        let Link { a, d, .. } = *way.link;
        moved.shift_along_z(d);
        if a != T::ZERO {
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
        self.rate[2] += Vector3::from(self.momentum) * d;
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
        self.rate[0] += Vector3::from(self.momentum) * a;
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
/// C, as moment and force about the origin of the joint frame they are carried to.
#[derive(Clone, Copy)]
pub(crate) struct JointWrench<T: Real> {
    /// Momentum for unit speed of the joint: moment and force of I S.
    pub inertia_moment: [T; 3],
    pub inertia_force: [T; 3],
    /// I dS + B S, the column of C above the diagonal.
    pub rate_moment: [T; 3],
    pub rate_force: [T; 3],
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
        let [lx, ly, _] = group.momentum;
        let [dx, dy, dz] = &group.rate;
        let [a, b] = rate.turn;
        let [u, v] = rate.slide;
        let trace = dx[0] + dy[1];
        Self {
            inertia_moment: [-s.xz, -s.yz, s.xx + s.yy],
            inertia_force: [-hy, hx, T::ZERO],
            rate_moment: [
                (s.yy + s.zz) * a - s.xy * b - hz * v - dz[0],
                (s.xx + s.zz) * b - s.xy * a + hz * u - dz[1],
                hx * v - hy * u - s.xz * a - s.yz * b + trace,
            ],
            rate_force: [
                group.mass * u + hz * b - ly,
                group.mass * v - hz * a + lx,
                hy * a - hx * b,
            ],
            transposed_rate: [-dx[2], -dy[2], trace],
        }
    }

    /// The same about the next joint frame inwards, in its axes.
    #[inline(always)]
    pub fn inward(&self, way: &Way<'_, T>) -> Self {
        by_twist!(self, carried, way)
    }

    #[inline(always)]
    fn carried<const TWIST: u8>(&self, way: &Way<'_, T>) -> Self {
        let turned = |v: [T; 3]| way.inward::<T, TWIST>(v);
        let inertia_force = turned(self.inertia_force);
        let rate_force = turned(self.rate_force);
        Self {
            inertia_moment: lever(turned(self.inertia_moment), &inertia_force, way.link),
            inertia_force,
            rate_moment: lever(turned(self.rate_moment), &rate_force, way.link),
            rate_force,
            transposed_rate: turned(self.transposed_rate),
        }
    }
}

/// The moment with that of `force` at (a, 0, d) added.
#[inline(always)]
fn lever<T: Real>(mut moment: [T; 3], force: &[T; 3], link: &Link<T>) -> [T; 3] {
    let [fx, fy, fz] = *force;
    moment[0] -= fy * link.d;
    moment[1] += fx * link.d;
    if link.a != T::ZERO {
        moment[1] -= fz * link.a;
        moment[2] += fy * link.a;
    }
    moment
}
