//! Rigid bodies: put together, and whether there can be such a one.

use controller_core::joint::{Matrix3, Vector3};
use controller_core::ranges::MASS_MIN;
use nalgebra::SymmetricEigen;

use super::frame::Frame;
use crate::invalid::Invalid;
use crate::ranges::LINK_MASS_KG;

/// Share of the trace down to which a second moment may be negative: the rounding of printed
/// numbers, as the core allows it.
const ROUNDING: f64 = 1e-9;

/// Share of the trace that the second moments of a nearest body have at least: those with nothing
/// there would be plates and rods without thickness, whose numbers rounding makes impossible again.
const LEAST: f64 = 1e-6;

/// A body in the axes and about the origin of some frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Body {
    /// \[kg\].
    pub mass: f64,
    /// Centre of mass \[m\].
    pub com: Vector3<f64>,
    /// Inertia about the centre of mass \[kg m2\].
    pub inertia: Matrix3<f64>,
}

/// How far a body was moved to become possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Moved {
    /// Change of the mass \[kg\].
    pub mass: f64,
    /// Frobenius norm of the change of the inertia \[kg m2\], and of the inertia it had.
    pub inertia: [f64; 2],
}

impl Body {
    /// Nothing.
    #[must_use]
    pub fn none() -> Self {
        Self {
            mass: 0.0,
            com: Vector3::zeros(),
            inertia: Matrix3::zeros(),
        }
    }

    /// The body seen from the parent of `frame`.
    #[must_use]
    pub fn carried(&self, frame: &Frame) -> Self {
        Self {
            mass: self.mass,
            com: frame.place(&self.com),
            inertia: frame.rotation * self.inertia * frame.rotation.transpose(),
        }
    }

    /// Both as one.
    #[must_use]
    pub fn with(&self, other: &Self) -> Self {
        let mass = self.mass + other.mass;
        if mass == 0.0 {
            return Self::none();
        }
        let com = (self.com * self.mass + other.com * other.mass) / mass;
        let about = |body: &Self| {
            let way = body.com - com;
            body.inertia + (Matrix3::identity() * way.dot(&way) - way * way.transpose()) * body.mass
        };
        Self {
            mass,
            com,
            inertia: about(self) + about(other),
        }
    }

    /// Principal moments \[kg m2\], least first.
    #[must_use]
    pub fn principal_moments(&self) -> [f64; 3] {
        let eigen = SymmetricEigen::new(self.inertia);
        let mut moments: [f64; 3] = eigen.eigenvalues.into();
        moments.sort_by(f64::total_cmp);
        moments
    }

    /// Whether there can be such a body: mass, positive definite inertia, triangle inequality of
    /// the principal moments.
    ///
    /// # Errors
    /// The first of these that is violated, with its numbers.
    pub fn check(&self) -> Result<(), Invalid> {
        LINK_MASS_KG.check("mass [kg]", self.mass)?;
        let [least, middle, greatest] = self.principal_moments();
        let given = format!("principal moments {least:.6e} {middle:.6e} {greatest:.6e} kg m2");
        if least <= 0.0 {
            return Err(Invalid::new(
                "inertia",
                given,
                "all above 0 (positive definite)",
            ));
        }
        // Second moments of mass are half of what the triangle inequality leaves.
        if (least + middle - greatest) / 2.0 < -ROUNDING * (least + middle + greatest) {
            let sum = least + middle;
            let allowed = format!(
                "the greatest at most the sum of the others (triangle inequality): \
                 {greatest:.6e} > {sum:.6e}"
            );
            return Err(Invalid::new("inertia", given, allowed));
        }
        Ok(())
    }

    /// The nearest body that can be, by the Frobenius norm of the second moments of mass
    /// tr(I)/2 1 - I, which have to be positive: their negative eigenvalues go, the directions
    /// stay.
    #[must_use]
    pub fn nearest(&self) -> (Self, Moved) {
        let mass = self.mass.clamp(MASS_MIN, LINK_MASS_KG.max);
        let identity = Matrix3::identity();
        let second = identity * (self.inertia.trace() / 2.0) - self.inertia;
        let eigen = SymmetricEigen::new(second);
        let clipped = eigen.eigenvalues.map(|value| value.max(0.0));
        // A body without any extent becomes a ball of a micrometre.
        let least = LEAST * clipped.sum().max(1e-6 * mass);
        let clipped = Matrix3::from_diagonal(&clipped.map(|value| value.max(least)));
        let second = eigen.eigenvectors * clipped * eigen.eigenvectors.transpose();
        // Products of three matrices are symmetric but for rounding.
        let second = (second + second.transpose()) / 2.0;
        let inertia = identity * second.trace() - second;
        let moved = Moved {
            mass: mass - self.mass,
            inertia: [(inertia - self.inertia).norm(), self.inertia.norm()],
        };
        let body = Self {
            mass,
            inertia,
            ..*self
        };
        (body, moved)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn body(moments: [f64; 3]) -> Body {
        Body {
            mass: 1.0,
            com: Vector3::zeros(),
            inertia: Matrix3::from_diagonal(&moments.into()),
        }
    }

    #[test]
    fn refusals_name_the_inequality_and_its_numbers() {
        let refusal = |body: Body| body.check().expect_err("impossible").to_string();
        assert_eq!(
            refusal(body([0.1, 0.1, 0.3])),
            "inertia: principal moments 1.000000e-1 1.000000e-1 3.000000e-1 kg m2; allowed: the \
             greatest at most the sum of the others (triangle inequality): 3.000000e-1 > \
             2.000000e-1"
        );
        assert!(refusal(body([-0.1, 0.2, 0.2])).ends_with("(positive definite)"));
        assert!(refusal(body([0.0; 3])).ends_with("(positive definite)"));
        let mut light = body([0.1; 3]);
        light.mass = -2.0;
        assert_eq!(refusal(light), "mass [kg]: -2; allowed: 0.000001 to 1000");
        // A plate is on the border, and its printed numbers may be beyond it by their rounding.
        assert!(body([0.1, 0.2, 0.3]).check().is_ok());
        assert!(body([0.1, 0.2, 0.3 + 1e-10]).check().is_ok());
    }

    /// Closed form: the second moments (0.15, 0.15, -0.05) lose the last one.
    #[test]
    fn the_nearest_body_has_no_negative_second_moment() {
        let (near, moved) = body([0.1, 0.1, 0.3]).nearest();
        assert!(near.check().is_ok());
        let expected = Matrix3::from_diagonal(&Vector3::new(0.15, 0.15, 0.3));
        assert!((near.inertia - expected).amax() < 1e-6);
        assert!((moved.inertia[0] - 0.05 * 2.0_f64.sqrt()).abs() < 1e-6);
        assert_eq!(moved.mass, 0.0);
        // What is possible stays.
        let (same, moved) = body([0.2, 0.25, 0.3]).nearest();
        assert!((same.inertia - body([0.2, 0.25, 0.3]).inertia).amax() < 1e-15);
        assert!(moved.inertia[0] < 1e-15);
        // Any garbage becomes a body.
        for moments in [[-1.0, -1.0, -1.0], [0.0; 3], [-1.0, 0.5, 7.0]] {
            let mut worse = body(moments);
            worse.inertia[(0, 1)] = 0.3;
            worse.inertia[(1, 0)] = 0.3;
            worse.mass = -1.0;
            assert!(worse.nearest().0.check().is_ok(), "{moments:?}");
        }
    }

    /// Two point masses at the ends of a rod.
    #[test]
    fn bodies_are_put_together_about_their_common_centre() {
        let point = |x: f64, mass: f64| Body {
            mass,
            com: Vector3::new(x, 0.0, 0.0),
            inertia: Matrix3::zeros(),
        };
        let both = point(0.0, 1.0).with(&point(1.0, 3.0));
        assert_eq!((both.mass, both.com.x), (4.0, 0.75));
        let expected = Matrix3::from_diagonal(&Vector3::new(0.0, 0.75, 0.75));
        assert!((both.inertia - expected).amax() < 1e-15);
        assert_eq!(Body::none().with(&Body::none()), Body::none());
    }
}
