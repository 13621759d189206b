//! The controller as blocks and signals.

use super::svg::{Anchor, Svg};

/// Half the width and the length of an arrow's head \[px\].
const HEAD: [f64; 2] = [4.0, 10.0];

/// References, controller with its priority levels and its null space, limits,
/// robot, person, and the momentum observer that closes the loop: a file.
#[must_use]
pub fn block_diagram() -> String {
    drawing().standalone()
}

/// The same to be put on a page.
#[must_use]
pub fn drawing() -> Svg {
    let mut svg = Svg::new(
        "block-diagram",
        [920.0, 424.0],
        "Block diagram of the controller",
        "Task references and posture enter the hierarchical controller, which gives a torque; \
         limited, it drives the robot, which a person touches. A momentum observer turns torque, \
         position and velocity into the residual r that the controller compensates.",
    );
    references(&mut svg);
    controller(&mut svg);
    loop_outside(&mut svg);
    observer(&mut svg);
    svg
}

fn references(svg: &mut Svg) {
    block(
        svg,
        "box",
        [20.0, 48.0],
        [158.0, 156.0],
        &["Task references"],
        22.0,
    );
    let levels = [("level 1", 84.0), ("level 2", 120.0), ("level l", 168.0)];
    for (name, y) in levels {
        svg.rect("soft", [32.0, y - 1.0], [134.0, 28.0], 4.0);
        svg.text("small b", [42.0, y + 17.0], Anchor::Start, name);
        svg.text("small m", [158.0, y + 17.0], Anchor::End, "x, dx, ddx");
    }
    svg.text("m", [99.0, 162.0], Anchor::Middle, "\u{22ee}");
    block(
        svg,
        "box",
        [20.0, 224.0],
        [158.0, 40.0],
        &["Posture q_d"],
        24.0,
    );
}

fn controller(svg: &mut Svg) {
    svg.rect("box", [232.0, 28.0], [306.0, 258.0], 6.0);
    svg.text(
        "b",
        [385.0, 50.0],
        Anchor::Middle,
        "Hierarchical controller",
    );
    let blocks: [(f64, f64, [&str; 2]); 3] = [
        (
            66.0,
            66.0,
            [
                "Priority levels 1, 2, \u{2026}, l",
                "one factorisation, rows in order",
            ],
        ),
        (146.0, 56.0, ["Compensation of r", "on the tasks only"]),
        (
            216.0,
            56.0,
            ["Null-space compliance", "stiffness K_q, damping D"],
        ),
    ];
    for (y, height, lines) in blocks {
        svg.rect("soft", [262.0, y], [200.0, height], 4.0);
        let middle = y + 0.5 * height;
        svg.text("b small", [362.0, middle - 3.0], Anchor::Middle, lines[0]);
        svg.text("m small", [362.0, middle + 14.0], Anchor::Middle, lines[1]);
        if y < 100.0 {
            arrow(svg, &[[462.0, middle], [500.0, middle], [500.0, 160.0]]);
        } else if y < 200.0 {
            arrow(svg, &[[462.0, middle], [486.0, middle]]);
        } else {
            arrow(svg, &[[462.0, middle], [500.0, middle], [500.0, 188.0]]);
        }
    }
    arrow(svg, &[[178.0, 99.0], [262.0, 99.0]]);
    arrow(svg, &[[178.0, 244.0], [262.0, 244.0]]);
    svg.circle("box", [500.0, 174.0], 13.0);
    svg.text("b", [500.0, 178.5], Anchor::Middle, "\u{3a3}");
}

fn loop_outside(svg: &mut Svg) {
    arrow(svg, &[[513.0, 174.0], [574.0, 174.0]]);
    block(svg, "box", [574.0, 146.0], [84.0, 56.0], &["Limits"], 33.0);
    arrow(svg, &[[658.0, 174.0], [738.0, 174.0]]);
    svg.text("b", [718.0, 165.0], Anchor::Middle, "\u{3c4}");
    block(
        svg,
        "box",
        [738.0, 128.0],
        [158.0, 92.0],
        &["Robot", "7 joints"],
        42.0,
    );
    block(
        svg,
        "box",
        [738.0, 28.0],
        [158.0, 42.0],
        &["Person, environment"],
        25.0,
    );
    arrow(svg, &[[817.0, 70.0], [817.0, 128.0]]);
    svg.text("b", [827.0, 104.0], Anchor::Start, "\u{3c4}_ext");
}

fn observer(svg: &mut Svg) {
    block(
        svg,
        "box",
        [468.0, 312.0],
        [186.0, 60.0],
        &["Momentum observer", "r tends to \u{2212}\u{3c4}_ext"],
        25.0,
    );
    // The torque as limited is what the robot gets: the observer sees no other.
    svg.circle("head", [690.0, 174.0], 2.8);
    arrow(svg, &[[690.0, 174.0], [690.0, 328.0], [654.0, 328.0]]);
    svg.circle("head", [817.0, 356.0], 2.8);
    arrow(svg, &[[817.0, 356.0], [654.0, 356.0]]);
    arrow(
        svg,
        &[
            [817.0, 220.0],
            [817.0, 404.0],
            [290.0, 404.0],
            [290.0, 286.0],
        ],
    );
    svg.text("b", [827.0, 262.0], Anchor::Start, "q, dq");
    svg.text("b", [302.0, 394.0], Anchor::Start, "q, dq");
    arrow(svg, &[[468.0, 342.0], [400.0, 342.0], [400.0, 286.0]]);
    svg.text("b", [434.0, 334.0], Anchor::Middle, "r");
}

/// A box with a bold first line and quiet further lines.
fn block(svg: &mut Svg, class: &str, corner: [f64; 2], size: [f64; 2], lines: &[&str], first: f64) {
    svg.rect(class, corner, size, 6.0);
    let x = corner[0] + 0.5 * size[0];
    for (k, line) in lines.iter().enumerate() {
        let y = corner[1] + first + 17.0 * k as f64;
        svg.text(
            if k == 0 { "b" } else { "m small" },
            [x, y],
            Anchor::Middle,
            line,
        );
    }
}

/// A wire along `corners` with a head at its end.
fn arrow(svg: &mut Svg, corners: &[[f64; 2]]) {
    let [.., from, to] = corners else { return };
    let length = (to[0] - from[0]).hypot(to[1] - from[1]).max(1e-9);
    let along = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
    let [half, back] = HEAD;
    let base = [to[0] - back * along[0], to[1] - back * along[1]];
    let mut wire = corners.to_vec();
    if let Some(last) = wire.last_mut() {
        *last = base;
    }
    svg.curve("wire", &wire, "");
    let side = |sign: f64| {
        [
            base[0] - sign * half * along[1],
            base[1] + sign * half * along[0],
        ]
    };
    svg.polygon("head", &[*to, side(1.0), side(-1.0)]);
}

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;

    #[test]
    fn the_diagram_is_well_formed() {
        well_formed(&super::block_diagram()).unwrap();
    }
}
