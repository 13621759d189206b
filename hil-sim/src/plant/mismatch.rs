//! An arm that is not quite the one in the tables: what a controller meets
//! after identification.

use arms::realistic::{Bodies, Body, Realistic};
use controller_core::arm::{ArmParameters, LinkParameters};
use controller_core::joint::{DOF, Matrix3, Vector3};

use super::noise::Rng;

/// Smallest and largest relative error of a link's mass and inertia.
pub const MASS_ERROR: (f64, f64) = (0.05, 0.10);

/// Standard deviation \[m\] of the centre of mass, per axis of the link's frame.
pub const COM_ERROR: f64 = 3e-3;

/// What is known of how the arm with these tables departs from them; of one without data of its
/// own what [`Realistic::of_table`] says.
#[must_use]
pub fn realistic(parameters: &ArmParameters) -> Realistic {
    known(parameters).map_or_else(|| Realistic::of_table(parameters), |own| *own)
}

/// The data of the arm that these tables are of. A name alone is not enough, since a file may give it
/// to any arm; link 7 may carry a tool.
fn known(parameters: &ArmParameters) -> Option<&'static Realistic> {
    let table = arms::by_name(parameters.name)?;
    let same = |(own, of_table): (&LinkParameters, &LinkParameters)| {
        [own.a, own.alpha, own.d, own.mass]
            == [of_table.a, of_table.alpha, of_table.d, of_table.mass]
            && (own.com, own.inertia) == (of_table.com, of_table.inertia)
    };
    let mut bare = parameters.links.iter().zip(&table.links).take(DOF - 1);
    bare.all(same)
        .then(|| arms::realistic_by_name(parameters.name))?
}

/// What a plant of the arm with these tables lacks for want of data, as a sentence; none where the
/// arm has data of its own.
#[must_use]
pub fn want_of_data(parameters: &ArmParameters) -> Option<String> {
    if known(parameters).is_some() {
        return None;
    }
    let friction = match realistic(parameters).is_frictionless() {
        true => "no friction",
        false => "the friction of the table",
    };
    Some(format!(
        "how a true {} departs from its table is not known: the plant draws errors as for lwr_iv \
         and has {friction}",
        parameters.name
    ))
}

/// The arm that is found where the tables are believed, with what it carries: its bodies, known or
/// drawn, and its friction.
#[must_use]
pub fn true_arm(parameters: &ArmParameters, realistic: &Realistic, rng: &mut Rng) -> ArmParameters {
    let mut arm = match realistic.bodies {
        Bodies::Drawn => mismatched(parameters, rng),
        Bodies::Known(bodies) => with_bodies(parameters, bodies),
    };
    for (link, friction) in arm.links.iter_mut().zip(realistic.friction) {
        link.friction = friction;
    }
    arm
}

/// The tables with other bodies; what `parameters` have besides the table of that name, a tool,
/// stays on its link.
fn with_bodies(parameters: &ArmParameters, bodies: &[Body]) -> ArmParameters {
    let table = arms::by_name(parameters.name).unwrap_or(parameters);
    let mut arm = *parameters;
    for ((link, bare), body) in arm.links.iter_mut().zip(&table.links).zip(bodies) {
        let bare = Body {
            mass: bare.mass,
            com: bare.com,
            inertia: bare.inertia,
        };
        Moments::of(link).exchanged(&bare, body).write(link);
    }
    arm
}

/// A body by what adds up: mass \[kg\], first moment \[kg m\] and inertia about the origin of the
/// link's frame \[kg m2\].
struct Moments {
    mass: f64,
    first: Vector3<f64>,
    inertia: Matrix3<f64>,
}

/// Inertia about the origin of a mass of 1 kg at `com`.
fn of_point(com: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * com.dot(com) - com * com.transpose()
}

impl Moments {
    fn new(mass: f64, com: [f64; 3], [xx, xy, xz, yy, yz, zz]: [f64; 6]) -> Self {
        let com = Vector3::from(com);
        let inertia = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
        Self {
            mass,
            first: com * mass,
            inertia: inertia + of_point(&com) * mass,
        }
    }

    fn of(link: &LinkParameters) -> Self {
        Self::new(link.mass, link.com, link.inertia)
    }

    /// Without the body `off`, with the body `on`.
    fn exchanged(self, off: &Body, on: &Body) -> Self {
        let [off, on] = [off, on].map(|body| Self::new(body.mass, body.com, body.inertia));
        Self {
            mass: self.mass - off.mass + on.mass,
            first: self.first - off.first + on.first,
            inertia: self.inertia - off.inertia + on.inertia,
        }
    }

    /// Makes it the body of a link.
    fn write(&self, link: &mut LinkParameters) {
        let com = self.first / self.mass;
        let inertia = self.inertia - of_point(&com) * self.mass;
        link.mass = self.mass;
        link.com = com.into();
        link.inertia = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)].map(|at| inertia[at]);
    }
}

/// The tables with wrong masses. Each link's mass and inertia are scaled by one
/// factor 1 +- U(0.05, 0.10) of random sign, and its centre of mass is moved
/// by a Gaussian offset of 3 mm per axis. Geometry and limits stay. One common
/// factor, and inertia about the moved centre of mass, keep every link a
/// possible body.
#[must_use]
pub fn mismatched(parameters: &ArmParameters, rng: &mut Rng) -> ArmParameters {
    let (least, most) = MASS_ERROR;
    let mut arm = *parameters;
    for link in &mut arm.links {
        let error = least + (most - least) * rng.uniform();
        let factor = 1.0 + rng.sign() * error;
        link.mass *= factor;
        link.inertia = link.inertia.map(|moment| moment * factor);
        link.com = link.com.map(|offset| offset + COM_ERROR * rng.gaussian());
    }
    arm
}

#[cfg(test)]
mod tests {
    use super::super::noise::stream;
    use super::*;
    use arms::LWR_IV;
    use controller_core::arm::ArmModel;

    /// A file may call any arm `fr3`.
    #[test]
    fn data_are_of_the_arm_and_not_of_its_name() {
        let mut other = arms::FR3;
        assert_eq!(realistic(&other), arms::FR3_REALISTIC);
        assert_eq!(want_of_data(&other), None);
        other.links[3].mass *= 1.01;
        assert_eq!(realistic(&other), Realistic::of_table(&other));
        assert!(want_of_data(&other).is_some_and(|note| note.ends_with("no friction")));
    }

    #[test]
    fn errors_lie_within_their_bounds_and_the_arm_stays_possible() {
        let (mut up, mut down, mut sum, mut square) = (0, 0, 0.0, 0.0);
        const SEEDS: u64 = 500;
        for seed in 0..SEEDS {
            let arm = mismatched(&LWR_IV, &mut Rng::new(seed, stream::MISMATCH));
            assert!(ArmModel::<f64>::new(&arm).is_ok());
            for (link, nominal) in arm.links.iter().zip(&LWR_IV.links) {
                let factor = link.mass / nominal.mass;
                let error = (factor - 1.0).abs();
                assert!((0.05 - 1e-12..0.10 + 1e-12).contains(&error), "{error}");
                if factor > 1.0 {
                    up += 1
                } else {
                    down += 1
                }
                for (moment, nominal) in link.inertia.iter().zip(&nominal.inertia) {
                    assert!((moment - nominal * factor).abs() <= 1e-15 * nominal.abs().max(1e-3));
                }
                for (com, nominal) in link.com.iter().zip(&nominal.com) {
                    let offset = (com - nominal) / COM_ERROR;
                    assert!(offset.abs() < 5.0);
                    sum += offset;
                    square += offset * offset;
                }
                assert_eq!(
                    (link.a, link.alpha, link.d),
                    (nominal.a, nominal.alpha, nominal.d)
                );
            }
        }
        // Four standard errors.
        let links = f64::from(up + down);
        assert!((f64::from(up) / links - 0.5).abs() < 0.034);
        let axes = 3.0 * links;
        assert!((sum / axes).abs() < 0.04 && (square / axes - 1.0).abs() < 0.056);
    }
}
