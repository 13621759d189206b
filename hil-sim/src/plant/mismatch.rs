//! An arm that is not quite the one in the tables: what a controller meets
//! after identification.

use controller_core::arm::ArmParameters;

use super::noise::Rng;

/// Smallest and largest relative error of a link's mass and inertia.
pub const MASS_ERROR: (f64, f64) = (0.05, 0.10);

/// Standard deviation \[m\] of the centre of mass, per axis of the link's frame.
pub const COM_ERROR: f64 = 3e-3;

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
