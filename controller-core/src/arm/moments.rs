//! Rigid-body sums in joint axes: what the dynamics carries from joint to joint.
//!
//! All quantities are in the axes of a joint frame ([`super::transform`]). Right
//! angles of twist only exchange axes; a sum about one point of the arm never
//! contains the lever to another one.

use crate::arm::exchange::AxisExchange;
use crate::arm::model::LinkModel;
use crate::arm::transform::{JointTransform, by_exchange};
use crate::joint::Lanes;
use crate::real::Real;

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
    /// The same in the child's joint frame, whose joint turns at `speed` \[rad/s\].
    #[inline(always)]
    pub fn in_child(&self, transform: &JointTransform<'_, T>, speed: T) -> Self {
        let mut next = by_exchange!(self, carried, transform);
        next.spin[2] += speed;
        next
    }

    #[inline(always)]
    fn carried<const EXCHANGE: u8>(&self, transform: &JointTransform<'_, T>) -> Self {
        let LinkModel { a, d, .. } = *transform.link;
        let [wx, wy, wz] = self.spin;
        let [vx, vy, vz] = self.velocity;
        let mut velocity = [vx + wy * d, vy - wx * d, vz];
        if AxisExchange::has_length(EXCHANGE) {
            velocity[1] += wz * a;
            velocity[2] -= wy * a;
        }
        Self {
            spin: transform.in_child::<EXCHANGE>(self.spin),
            velocity: transform.in_child::<EXCHANGE>(velocity),
            gravity: transform.in_child::<EXCHANGE>(self.gravity),
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
/// | `velocity_moment` \[D l\] | dp (p, 1)^T dm, by rows | kg m2/s, kg m/s |
///
/// All add over links. Column l of `velocity_moment` is the momentum.
#[derive(Clone, Copy)]
pub(crate) struct Moments<T: Real> {
    pub mass: T,
    pub first: [T; 3],
    pub second: Symmetric<T>,
    pub velocity_moment: [Lanes<T>; 3],
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
            velocity_moment: [Lanes::from([zero; 4]); 3],
        }
    }

    /// Adds one link, whose elements move with dp = v + omega x p.
    #[inline(always)]
    pub fn add_link(&mut self, link: &LinkModel<T>, motion: &Motion<T>) {
        let [x, y, z, one] = &link.moments;
        let [wx, wy, wz] = motion.spin;
        let [vx, vy, vz] = motion.velocity;
        self.velocity_moment[0] += one * vx + (z * wy - y * wz);
        self.velocity_moment[1] += one * vy + (x * wz - z * wx);
        self.velocity_moment[2] += one * vz + (y * wx - x * wy);
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

    /// The same about the origin of the parent's joint frame, in its axes.
    #[inline(always)]
    pub fn in_parent(&self, transform: &JointTransform<'_, T>) -> Self {
        by_exchange!(self, carried, transform)
    }

    #[inline(always)]
    fn carried<const EXCHANGE: u8>(&self, transform: &JointTransform<'_, T>) -> Self {
        // Rows turn with dp, entries within a row with p.
        let turned = transform.in_parent::<Lanes<T>, EXCHANGE>(self.velocity_moment);
        let row = |row: Lanes<T>| {
            let [x, y, z] = transform.in_parent::<T, EXCHANGE>([row[0], row[1], row[2]]);
            Lanes::from([x, y, z, row[3]])
        };
        let mut moved = Self {
            mass: self.mass,
            first: transform.in_parent::<T, EXCHANGE>(self.first),
            second: self.second.in_parent::<EXCHANGE>(transform),
            velocity_moment: turned.map(row),
        };
        let LinkModel { a, d, .. } = *transform.link;
        if d != T::ZERO {
            moved.shift_along_z(d);
        }
        if AxisExchange::has_length(EXCHANGE) {
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
        for row in &mut self.velocity_moment {
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
        for row in &mut self.velocity_moment {
            row[0] = row[0] + row[3] * a;
        }
    }
}

impl<T: Real> Symmetric<T> {
    #[inline(always)]
    fn in_parent<const EXCHANGE: u8>(&self, transform: &JointTransform<'_, T>) -> Self {
        let (sine, cosine) = (transform.sine, transform.cosine);
        let x = self.xx * cosine - self.xy * sine;
        let y = self.xy * cosine - self.yy * sine;
        let xx = x * cosine - y * sine;
        let rotated = Self {
            xx,
            xy: x * sine + y * cosine,
            xz: self.xz * cosine - self.yz * sine,
            // A rotation about z keeps xx + yy.
            yy: (self.xx + self.yy) - xx,
            yz: self.xz * sine + self.yz * cosine,
            zz: self.zz,
        };
        rotated.exchanged::<EXCHANGE>(transform.link)
    }

    #[inline(always)]
    fn exchanged<const EXCHANGE: u8>(self, link: &LinkModel<T>) -> Self {
        let Self {
            xx,
            xy,
            xz,
            yy,
            yz,
            zz,
        } = self;
        match AxisExchange::turn(EXCHANGE) {
            AxisExchange::NONE => self,
            AxisExchange::RIGHT => Self {
                xx,
                xy: -xz,
                xz: xy,
                yy: zz,
                yz: -yz,
                zz: yy,
            },
            AxisExchange::LEFT => Self {
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
        let [dx, dy, dz] = &group.velocity_moment;
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

    /// The same about the origin of the parent's joint frame, in its axes.
    #[inline(always)]
    pub fn in_parent(&self, transform: &JointTransform<'_, T>) -> Self {
        by_exchange!(self, carried, transform)
    }

    #[inline(always)]
    fn carried<const EXCHANGE: u8>(&self, transform: &JointTransform<'_, T>) -> Self {
        let mut rows = transform.in_parent::<Lanes<T>, EXCHANGE>(self.rows);
        // The forces act at (a, 0, d).
        let LinkModel { a, d, .. } = *transform.link;
        if d != T::ZERO {
            for (moment, force) in [(0, 2), (1, 3)] {
                rows[0][moment] = rows[0][moment] - rows[1][force] * d;
                rows[1][moment] = rows[1][moment] + rows[0][force] * d;
            }
        }
        if AxisExchange::has_length(EXCHANGE) {
            for (moment, force) in [(0, 2), (1, 3)] {
                rows[1][moment] = rows[1][moment] - rows[2][force] * a;
                rows[2][moment] = rows[2][moment] + rows[1][force] * a;
            }
        }
        Self {
            rows,
            transposed_rate: transform.in_parent::<T, EXCHANGE>(self.transposed_rate),
        }
    }
}
