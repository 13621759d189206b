//! Links as bodies in joint frames, and the way from one frame to the next.
//!
//! A link's *joint frame* has its origin on the joint's axis, at the origin of the previous DH
//! frame, and z along the axis; it turns with the link. There the joint's own axis is (0, 0, 1).
//! Outward from one joint frame to the next lead the shift (a, 0, d), the link's twist alpha
//! about x and the next joint's angle about z.

use controller_core::joint::{DOF, Matrix3, Vector3};

use super::body::Body;

/// The way to the next joint frame by what it does to the axes: right angles of twist only
/// exchange them.
pub(super) const STRAIGHT: u8 = 0;
pub(super) const RIGHT: u8 = 1;
pub(super) const LEFT: u8 = 2;
pub(super) const OBLIQUE: u8 = 3;
/// Added where the link has a length a.
pub(super) const WITH_LENGTH: u8 = 4;

/// Calls a method with the way as a constant, so that one branch serves all that is carried.
macro_rules! by_way {
    ($way:expr, $object:ident.$method:ident($($argument:expr),*)) => {
        match $way {
            STRAIGHT => $object.$method::<STRAIGHT>($($argument),*),
            RIGHT => $object.$method::<RIGHT>($($argument),*),
            LEFT => $object.$method::<LEFT>($($argument),*),
            RIGHT_WITH_LENGTH => $object.$method::<RIGHT_WITH_LENGTH>($($argument),*),
            LEFT_WITH_LENGTH => $object.$method::<LEFT_WITH_LENGTH>($($argument),*),
            _ => $object.$method::<OBLIQUE_WITH_LENGTH>($($argument),*),
        }
    };
}
pub(super) use by_way;

pub(super) const RIGHT_WITH_LENGTH: u8 = RIGHT | WITH_LENGTH;
pub(super) const LEFT_WITH_LENGTH: u8 = LEFT | WITH_LENGTH;
/// Any way at all.
pub(super) const OBLIQUE_WITH_LENGTH: u8 = OBLIQUE | WITH_LENGTH;

/// A link as a body in its joint frame, and the way to the next joint frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Segment {
    pub way: u8,
    pub sin_alpha: f64,
    pub cos_alpha: f64,
    /// \[m\].
    pub a: f64,
    /// \[m\].
    pub d: f64,
    pub body: Moments,
    /// Of the rotor, as the joint feels it \[kg m2\].
    pub rotor_inertia: f64,
}

/// Moments of a body about the origin of a joint frame, in its axes.
///
/// What lies on the joint's axis turns with the previous link as well as with this one, so a
/// body here is one without mass, without hz and without Szz: those are with the previous link,
/// and M, C dq and g are the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Moments {
    /// h, integral of p dm \[kg m\].
    pub first: [f64; 3],
    /// S, integral of p p^T dm, by xx, xy, xz, yy, yz, zz \[kg m2\].
    pub second: [f64; 6],
}

/// The same component of two wrenches.
pub(super) type Pair = [f64; 2];

#[inline(always)]
pub(super) fn times([x, y]: Pair, factor: f64) -> Pair {
    [x * factor, y * factor]
}

#[inline(always)]
pub(super) fn sum(a: Pair, b: Pair) -> Pair {
    [a[0] + b[0], a[1] + b[1]]
}

#[inline(always)]
pub(super) fn difference(a: Pair, b: Pair) -> Pair {
    [a[0] - b[0], a[1] - b[1]]
}

impl Segment {
    /// Of all links of an arm.
    pub fn of(links: &[Body; DOF]) -> [Self; DOF] {
        let mut segments = links.each_ref().map(Self::bare);
        // What lies on the axis of the joint behind, and is this link's: mass, h and S along it.
        let mut axial = (0.0, 0.0, 0.0);
        for (segment, link) in segments.iter_mut().zip(links).rev() {
            let (a, d, sin_alpha, cos_alpha) = (link.a, link.d, link.sin_alpha, link.cos_alpha);
            // In the DH frame the link's own; then turned by alpha about x, shifted by
            // (a, 0, d).
            let turned = Matrix3::new(
                1.0, 0.0, 0.0, 0.0, cos_alpha, -sin_alpha, 0.0, sin_alpha, cos_alpha,
            );
            let shift = Vector3::new(a, 0.0, d);
            let central = Matrix3::from_diagonal_element(0.5 * link.inertia.trace());
            let mut second = central - link.inertia;
            let mut first = link.first_moment;
            let mass = link.mass + axial.0;
            first.z += axial.1;
            second[(2, 2)] += axial.2;
            let first = turned * first;
            let mixed = first * shift.transpose();
            let second = turned * second * turned.transpose()
                + mixed
                + mixed.transpose()
                + shift * shift.transpose() * mass;
            let first = first + shift * mass;
            axial = (mass, first.z, second[(2, 2)]);
            let at = |i, j| second[(i, j)];
            segment.body = Moments {
                first: [first.x, first.y, 0.0],
                second: [at(0, 0), at(0, 1), at(0, 2), at(1, 1), at(1, 2), 0.0],
            };
        }
        segments
    }

    fn bare(link: &Body) -> Self {
        let (a, d, sin_alpha, cos_alpha) = (link.a, link.d, link.sin_alpha, link.cos_alpha);
        let twist = match (sin_alpha, cos_alpha) {
            (0.0, 1.0) => STRAIGHT,
            (1.0, 0.0) => RIGHT,
            (-1.0, 0.0) => LEFT,
            _ => OBLIQUE,
        };
        Self {
            way: if a == 0.0 { twist } else { twist | WITH_LENGTH },
            sin_alpha,
            cos_alpha,
            a,
            d,
            body: Moments::NONE,
            rotor_inertia: link.rotor_inertia,
        }
    }

    /// A vector turned by alpha about x.
    #[inline(always)]
    pub fn twisted<const WAY: u8>(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match WAY & OBLIQUE {
            STRAIGHT => [x, y, z],
            RIGHT => [x, -z, y],
            LEFT => [x, z, -y],
            _ => [
                x,
                y * self.cos_alpha - z * self.sin_alpha,
                y * self.sin_alpha + z * self.cos_alpha,
            ],
        }
    }

    /// Turned back.
    #[inline(always)]
    pub fn untwisted<const WAY: u8>(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        match WAY & OBLIQUE {
            STRAIGHT => [x, y, z],
            RIGHT => [x, z, -y],
            LEFT => [x, -z, y],
            _ => [
                x,
                y * self.cos_alpha + z * self.sin_alpha,
                z * self.cos_alpha - y * self.sin_alpha,
            ],
        }
    }

    /// The same of two wrenches' components.
    #[inline(always)]
    pub fn twisted_pairs<const WAY: u8>(&self, [x, y, z]: [Pair; 3]) -> [Pair; 3] {
        let negative = |[a, b]: Pair| [-a, -b];
        match WAY & OBLIQUE {
            STRAIGHT => [x, y, z],
            RIGHT => [x, negative(z), y],
            LEFT => [x, z, negative(y)],
            _ => [
                x,
                difference(times(y, self.cos_alpha), times(z, self.sin_alpha)),
                sum(times(y, self.sin_alpha), times(z, self.cos_alpha)),
            ],
        }
    }
}

impl Moments {
    pub const NONE: Self = Self {
        first: [0.0; 3],
        second: [0.0; 6],
    };

    /// Sum with a link.
    #[inline(always)]
    pub fn with(mut self, link: &Self) -> Self {
        for axis in 0..2 {
            self.first[axis] += link.first[axis];
        }
        for entry in 0..5 {
            self.second[entry] += link.second[entry];
        }
        self
    }

    /// In the previous joint frame, that of `to`; sine and cosine of the joint between.
    #[inline(always)]
    pub fn carried<const WAY: u8>(&self, to: &Segment, (sine, cosine): (f64, f64)) -> Self {
        let [hx, hy, hz] = self.first;
        let [sxx, sxy, sxz, syy, syz, szz] = self.second;
        let first = [hx * cosine - hy * sine, hx * sine + hy * cosine, hz];
        let (x, y) = (sxx * cosine - sxy * sine, sxy * cosine - syy * sine);
        let xx = x * cosine - y * sine;
        let xy = x * sine + y * cosine;
        // A turn about z keeps xx + yy.
        let yy = (sxx + syy) - xx;
        let (xz, yz) = (sxz * cosine - syz * sine, sxz * sine + syz * cosine);
        let mut second = match WAY & OBLIQUE {
            STRAIGHT => [xx, xy, xz, yy, yz, szz],
            RIGHT => [xx, -xz, xy, szz, -yz, yy],
            LEFT => [xx, xz, -xy, szz, -yz, yy],
            _ => {
                let (s, c) = (to.sin_alpha, to.cos_alpha);
                let (y, z) = (yy * c - yz * s, yz * c - szz * s);
                let new_yy = y * c - z * s;
                let new_zz = (yy + szz) - new_yy;
                let (new_xy, new_xz) = (xy * c - xz * s, xy * s + xz * c);
                [xx, new_xy, new_xz, new_yy, y * s + z * c, new_zz]
            }
        };
        let first = to.twisted::<WAY>(first);
        let ([hx, hy, hz], d) = (first, to.d);
        second[2] += hx * d;
        second[4] += hy * d;
        second[5] += (hz + hz) * d;
        if WAY & WITH_LENGTH != 0 {
            second[0] += (hx + hx) * to.a;
            second[1] += hy * to.a;
            second[2] += hz * to.a;
        }
        Self { first, second }
    }
}
