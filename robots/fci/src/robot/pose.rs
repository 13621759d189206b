//! Poses and wrenches: homogeneous matrices of 4 by 4, column by column.

use crate::error::Error;
use crate::state::{Pose, position};

/// Where the frame before is.
pub const IDENTITY: Pose = [
    1.0, 0.0, 0.0, 0.0, //
    0.0, 1.0, 0.0, 0.0, //
    0.0, 0.0, 1.0, 0.0, //
    0.0, 0.0, 0.0, 1.0,
];

/// How far columns of a rotation may be from unit length and from right angles: numbers in
/// binary32 pass.
const ROUNDING: f64 = 1e-5;

fn columns(pose: &Pose) -> [[f64; 4]; 4] {
    let [
        a,
        b,
        c,
        d, //
        e,
        f,
        g,
        h, //
        i,
        j,
        k,
        l, //
        m,
        n,
        o,
        p,
    ] = *pose;
    [[a, b, c, d], [e, f, g, h], [i, j, k, l], [m, n, o, p]]
}

/// The three axes of a pose, and its position.
fn axes(pose: &Pose) -> [[f64; 3]; 4] {
    columns(pose).map(|[x, y, z, _]| [x, y, z])
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    ax * bx + ay * by + az * bz
}

pub(super) fn cross(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [ay * bz - az * by, az * bx - ax * bz, ax * by - ay * bx]
}

/// `second` seen from the frame that `first` is seen from.
pub(super) fn product(first: &Pose, second: &Pose) -> Pose {
    let mut product = [0.0; 16];
    let of_second = columns(second);
    for (place, column) in product.as_chunks_mut::<4>().0.iter_mut().zip(of_second) {
        for (of_first, weight) in columns(first).into_iter().zip(column) {
            for (sum, value) in place.iter_mut().zip(of_first) {
                *sum += value * weight;
            }
        }
    }
    product
}

/// From the origin of one pose to that of another, seen from where both are seen.
pub(super) fn between(from: &Pose, to: &Pose) -> [f64; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (position(from), position(to));
    [bx - ax, by - ay, bz - az]
}

fn halves(six: &[f64; 6]) -> [[f64; 3]; 2] {
    let [a, b, c, d, e, f] = *six;
    [[a, b, c], [d, e, f]]
}

fn sum(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    let ([ax, ay, az], [bx, by, bz]) = (a, b);
    [ax + bx, ay + by, az + bz]
}

fn joined([a, b, c]: [f64; 3], [d, e, f]: [f64; 3]) -> [f64; 6] {
    [a, b, c, d, e, f]
}

/// The twist of a point that is `offset` away on the same body, in the same axes.
pub(super) fn twist_at(twist: &[f64; 6], offset: [f64; 3]) -> [f64; 6] {
    let [v, w] = halves(twist);
    joined(sum(v, cross(w, offset)), w)
}

/// The wrench about a point that is `offset` away, in the same axes.
pub(super) fn wrench_about(wrench: &[f64; 6], offset: [f64; 3]) -> [f64; 6] {
    let [force, moment] = halves(wrench);
    joined(force, sum(moment, cross(force, offset)))
}

/// Two vectors in the axes of a pose.
pub(super) fn turned_into(pose: &Pose, vectors: &[f64; 6]) -> [f64; 6] {
    let [x, y, z, _] = axes(pose);
    let seen = |vector| [dot(x, vector), dot(y, vector), dot(z, vector)];
    let [first, second] = halves(vectors);
    joined(seen(first), seen(second))
}

/// Whether a matrix is a pose: a rotation, a position, 0 0 0 1 in the last row.
pub(super) fn check(field: &'static str, pose: &Pose) -> Result<(), Error> {
    let near = |index, found: f64, expected: f64, by: f64| {
        let (min, max) = (expected - by, expected + by);
        // What is no number fails.
        if found >= min && found <= max {
            return Ok(());
        }
        if !found.is_finite() {
            return Err(Error::NotFinite { field, index });
        }
        Err(Error::Range {
            field,
            index,
            found,
            min,
            max,
        })
    };
    for (index, &value) in pose.iter().enumerate() {
        if !value.is_finite() {
            return Err(Error::NotFinite { field, index });
        }
        if index % 4 == 3 {
            near(index, value, if index == 15 { 1.0 } else { 0.0 }, 0.0)?;
        }
    }
    let [x, y, z, _] = axes(pose);
    // Lengths and angles of the columns, told by the first number of the column.
    for (index, found, expected) in [
        (0, dot(x, x), 1.0),
        (4, dot(y, y), 1.0),
        (8, dot(z, z), 1.0),
        (4, dot(x, y), 0.0),
        (8, dot(y, z), 0.0),
        (8, dot(z, x), 0.0),
        (8, dot(cross(x, y), z), 1.0),
    ] {
        near(index, found, expected, ROUNDING)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A quarter turn about z, moved along x.
    const TURNED: Pose = [
        0.0, 1.0, 0.0, 0.0, //
        -1.0, 0.0, 0.0, 0.0, //
        0.0, 0.0, 1.0, 0.0, //
        0.5, 0.0, 0.0, 1.0,
    ];

    #[test]
    fn poses_follow_each_other() {
        assert_eq!(product(&IDENTITY, &TURNED), TURNED);
        assert_eq!(product(&TURNED, &IDENTITY), TURNED);
        // Half a meter along x, a quarter turn, half a meter along what is y then.
        let twice = product(&TURNED, &TURNED);
        assert_eq!(position(&twice), [0.5, 0.5, 0.0]);
        assert_eq!(twice[..3], [-1.0, 0.0, 0.0]);
        assert_eq!(between(&TURNED, &twice), [0.0, 0.5, 0.0]);
    }

    #[test]
    fn twists_and_wrenches_move_with_their_point() {
        // Turning about z, a point along x moves along y.
        let twist = twist_at(&[0.0, 0.0, 0.0, 0.0, 0.0, 2.0], [0.5, 0.0, 0.0]);
        assert_eq!(twist, [0.0, 1.0, 0.0, 0.0, 0.0, 2.0]);
        // A force along y at the origin has a moment about -z around a point along x.
        let wrench = wrench_about(&[0.0, 4.0, 0.0, 0.0, 0.0, 0.0], [0.5, 0.0, 0.0]);
        assert_eq!(wrench, [0.0, 4.0, 0.0, 0.0, 0.0, -2.0]);
        // The y of the base is the x of the turned frame.
        let seen = turned_into(&TURNED, &[0.0, 4.0, 0.0, 1.0, 0.0, 0.0]);
        assert_eq!(seen, [4.0, 0.0, 0.0, 0.0, -1.0, 0.0]);
    }

    #[test]
    fn what_is_no_pose_is_told() {
        assert_eq!(check("NE_T_EE", &TURNED), Ok(()));
        let with = |index: usize, value| {
            let mut pose = TURNED;
            pose[index] = value;
            check("NE_T_EE", &pose)
        };
        assert_eq!(with(12, 1e3), Ok(()));
        for (index, value) in [(0, 0.1), (1, -1.0), (3, 1e-9), (10, -1.0), (15, 0.0)] {
            let error = with(index, value);
            assert!(
                matches!(error, Err(Error::Range { .. })),
                "{index}: {error:?}"
            );
        }
        for value in [f64::NAN, f64::INFINITY] {
            let (field, index) = ("NE_T_EE", 13);
            assert_eq!(with(13, value), Err(Error::NotFinite { field, index }));
        }
    }
}
