//! A link as a body in its own DH frame, and the joint that moves it.
//!
//! There the joint's axis and the vector back to the previous frame are constants. With
//! R = Rz(q) Rx(alpha) taking link axes to those of the previous link:
//!
//! - the vector from the previous origin to this one is r = (a, d sin alpha,
//!   d cos alpha);
//! - the joint's axis is s = (0, sin alpha, cos alpha), through the previous
//!   origin, so one rad/s of the joint moves this origin with s x r.

use controller_core::arm::LinkParameters;
use controller_core::joint::{Matrix3, Vector3};
use controller_core::real::Real;

/// One link as a body, and the joint that moves it, in the link's own DH frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Body {
    pub a: f64,
    pub d: f64,
    /// q \[rad\] at which the DH angle is 0.
    zero_angle: f64,
    pub cos_alpha: f64,
    pub sin_alpha: f64,
    /// From the previous origin to this one \[m\].
    pub reach: Vector3<f64>,
    /// Joint axis.
    pub axis: Vector3<f64>,
    /// Velocity of this origin per joint speed \[m/rad\].
    pub lever: Vector3<f64>,
    pub mass: f64,
    pub com: Vector3<f64>,
    /// m c \[kg m\].
    pub first_moment: Vector3<f64>,
    /// About this origin \[kg m2\].
    pub inertia: Matrix3<f64>,
    /// Of the rotor, as the joint feels it \[kg m2\].
    pub rotor_inertia: f64,
}

/// Velocity of a link: of its rotation and of its origin, link axes.
#[derive(Clone, Copy)]
pub(super) struct Twist {
    pub angular: Vector3<f64>,
    pub linear: Vector3<f64>,
}

impl Body {
    pub fn new(link: &LinkParameters) -> Self {
        let (sin_alpha, cos_alpha) = link.alpha.sine_cosine();
        // pi/2 has a cosine of 6e-17 in f64; the tables mean a right angle.
        let exact = |x: f64| if x.abs() < 1e-15 { 0.0 } else { x };
        let (sin_alpha, cos_alpha) = (exact(sin_alpha), exact(cos_alpha));
        let reach = Vector3::new(link.a, link.d * sin_alpha, link.d * cos_alpha);
        let axis = Vector3::new(0.0, sin_alpha, cos_alpha);
        let com = Vector3::from(link.com);
        let [xx, xy, xz, yy, yz, zz] = link.inertia;
        let central = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        // Steiner: m (|c|^2 1 - c c^T).
        let offset = Matrix3::identity() * com.dot(&com) - com * com.transpose();
        Self {
            a: link.a,
            d: link.d,
            zero_angle: -link.angle_offset,
            cos_alpha,
            sin_alpha,
            reach,
            axis,
            lever: axis.cross(&reach),
            mass: link.mass,
            com,
            first_moment: com * link.mass,
            inertia: central + offset * link.mass,
            rotor_inertia: link.rotor_inertia,
        }
    }

    /// DH angle \[rad\].
    #[inline]
    pub fn dh_angle(&self, q: f64) -> f64 {
        q - self.zero_angle
    }

    /// Of the DH angle.
    #[inline]
    pub fn sine_cosine(&self, q: f64) -> (f64, f64) {
        self.dh_angle(q).sine_cosine()
    }

    /// R: takes link axes to those of the previous link.
    #[inline]
    pub fn rotation(&self, q: f64) -> Matrix3<f64> {
        let (s, c) = self.sine_cosine(q);
        let (sa, ca) = (self.sin_alpha, self.cos_alpha);
        Matrix3::new(c, -s * ca, s * sa, s, c * ca, -c * sa, 0.0, sa, ca)
    }

    /// Velocity of this link, given the previous one's and R.
    #[inline]
    pub fn twist(&self, previous: &Twist, rotation: &Matrix3<f64>, dq: f64) -> Twist {
        let carried = rotation.tr_mul(&previous.angular);
        Twist {
            angular: carried + self.axis * dq,
            linear: rotation.tr_mul(&previous.linear)
                + carried.cross(&self.reach)
                + self.lever * dq,
        }
    }

    /// Angular momentum about this origin and linear momentum, link axes.
    #[inline]
    pub fn momentum(&self, twist: &Twist) -> (Vector3<f64>, Vector3<f64>) {
        let angular = self.inertia * twist.angular + self.first_moment.cross(&twist.linear);
        let linear = twist.linear * self.mass - self.first_moment.cross(&twist.angular);
        (angular, linear)
    }
}

impl Twist {
    pub const REST: Self = Self {
        angular: Vector3::new(0.0, 0.0, 0.0),
        linear: Vector3::new(0.0, 0.0, 0.0),
    };
}
