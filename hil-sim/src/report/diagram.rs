//! The controller as blocks and signals.

use super::svg::Svg;

/// References, controller with its priority levels and its null space, limits,
/// robot, person, and the momentum observer that closes the loop: a drawing that no
/// run changes, its elements as they stand in the file.
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
    svg.element(include_str!("diagram.svg").trim_end());
    svg
}

#[cfg(test)]
mod tests {
    use super::super::svg::well_formed;

    #[test]
    fn the_diagram_is_well_formed() {
        well_formed(&super::drawing().standalone()).unwrap();
    }
}
