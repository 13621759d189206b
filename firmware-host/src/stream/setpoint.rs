//! One reference as text: for each level the numbers of its kind.

use std::fmt;

use cell::ranges::{QUATERNION_NORM, Range};
use cell::scenario::{EquippedArm, TOOL_POINT};
use controller_core::joint::Vector3;
use controller_core::ranges::MAX_LEVELS;
use controller_core::task::Tracked;
use controller_core::task::orientation::Quaternion;
use controller_core::{Target, Task, TaskSet};

/// A vector of a level: its name, the range of its entries, its unit.
type Quantity = (&'static str, Range<f64>, &'static str);

/// Of a position. The flange of an LWR IV+ is at most 1.2 m from the base and moves at
/// 3.7 m/s with all joints at their data-sheet speed, other arms of this size hardly more: what is beyond is another unit, not a motion. From
/// rest to full speed in 50 ms is as quick as tasks with a K_p of 400 1/s2 answer.
const POSITION: [Quantity; 3] = [
    ("position", Range::new(-3.0, 3.0), "m"),
    ("velocity", Range::new(-5.0, 5.0), "m/s"),
    ("acceleration", Range::new(-100.0, 100.0), "m/s2"),
];

/// Of an orientation, besides the quaternion. All joints of an LWR IV+ at their data-sheet
/// speed about one axis come to 18.3 rad/s; the acceleration is full speed in 40 ms.
const ROTATION: [Quantity; 2] = [
    ("angular velocity", Range::new(-20.0, 20.0), "rad/s"),
    ("angular acceleration", Range::new(-500.0, 500.0), "rad/s2"),
];

/// Numbers of a position.
const POSITION_NUMBERS: usize = 9;

/// Numbers of an orientation.
const ORIENTATION_NUMBERS: usize = 10;

/// One reference: targets of the first levels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint {
    targets: [Target<f64>; MAX_LEVELS],
    count: usize,
}

impl Setpoint {
    /// Reads a datagram for levels that have these tasks of `arm`, whose names of points
    /// errors use.
    ///
    /// # Errors
    /// What is wrong with it, in one line.
    pub fn parse(text: &str, tasks: &TaskSet, arm: &EquippedArm) -> Result<Self, String> {
        let mut numbers = [0.0; ORIENTATION_NUMBERS * MAX_LEVELS];
        let mut count = 0;
        let words = text.split([' ', ',', '\t', '\n', '\r']);
        for word in words.filter(|word| !word.is_empty()) {
            let Ok(number) = word.parse::<f64>() else {
                return Err(format!("'{word}'; allowed: a number"));
            };
            // Those beyond the array are only counted: they are too many for any tasks.
            if let Some(entry) = numbers.get_mut(count) {
                *entry = number;
            }
            count += 1;
        }
        let given = levels(count, tasks, arm)?;
        let mut setpoint = Self {
            targets: [Target::Hold; MAX_LEVELS],
            count: given,
        };
        let mut rest = numbers.as_slice();
        let places = setpoint.targets.iter_mut().take(given);
        for (target, level) in places.zip(Level::of(tasks, arm)) {
            let (own, others) = rest.split_at_checked(level.length()).unwrap_or_default();
            *target = level.target(own)?;
            rest = others;
        }
        Ok(setpoint)
    }

    /// The targets of the levels that are not left out.
    #[must_use]
    pub fn targets(&self) -> &[Target<f64>] {
        self.targets.get(..self.count).unwrap_or(&[])
    }
}

/// How many levels `count` numbers are for.
fn levels(count: usize, tasks: &TaskSet, arm: &EquippedArm) -> Result<usize, String> {
    // Nine for each level, as if an orientation were a position too: right where there is
    // none among them. Otherwise the first one is what is wrong, not where numbers run out.
    if count.is_multiple_of(POSITION_NUMBERS) && count > 0 {
        let given = count / POSITION_NUMBERS;
        let mut among = Level::of(tasks, arm).take(given);
        if let Some(level) = among.find(|level| level.length() != POSITION_NUMBERS)
            && given <= tasks.tasks().len()
        {
            return Err(level.miscounted(POSITION_NUMBERS));
        }
    }
    let (mut rest, last) = (count, tasks.tasks().len());
    for level in Level::of(tasks, arm) {
        let length = level.length();
        if rest < length || (level.number == last && rest > length) {
            return Err(level.miscounted(rest));
        }
        rest -= length;
        if rest == 0 {
            return Ok(level.number);
        }
    }
    Ok(last)
}

/// A level as the stream has it.
#[derive(Clone, Copy)]
struct Level<'a> {
    /// Counted from 1.
    number: usize,
    task: &'a Task,
    arm: &'a EquippedArm,
}

impl<'a> Level<'a> {
    fn of(tasks: &'a TaskSet, arm: &'a EquippedArm) -> impl Iterator<Item = Self> {
        let tasks = (1..).zip(tasks.tasks());
        tasks.map(move |(number, task)| Self { number, task, arm })
    }

    /// Numbers in a datagram.
    fn length(&self) -> usize {
        match self.task.tracked {
            Tracked::Position(_) => POSITION_NUMBERS,
            Tracked::Orientation(_) => ORIENTATION_NUMBERS,
        }
    }

    fn miscounted(&self, given: usize) -> String {
        let what = match self.task.tracked {
            Tracked::Position(_) => "x y z, velocity, acceleration",
            Tracked::Orientation(_) => "w x y z, angular velocity, angular acceleration",
        };
        let numbers = if given == 1 { "number" } else { "numbers" };
        format!(
            "{self}: {given} {numbers}; allowed: {}, {what}",
            self.length()
        )
    }

    /// The target that `numbers` of the level's length say.
    fn target(&self, numbers: &[f64]) -> Result<Target<f64>, String> {
        match self.task.tracked {
            Tracked::Position(_) => {
                let [x, dx, ddx] = self.vectors(numbers, POSITION)?;
                Ok(Target::Position { x, dx, ddx })
            }
            Tracked::Orientation(_) => {
                let (quaternion, rates) = numbers.split_at_checked(4).unwrap_or_default();
                let [w, dw] = self.vectors(rates, ROTATION)?;
                let q = self.quaternion(quaternion)?;
                Ok(Target::Orientation { q, w, dw })
            }
        }
    }

    fn vectors<const N: usize>(
        &self,
        numbers: &[f64],
        quantities: [Quantity; N],
    ) -> Result<[Vector3<f64>; N], String> {
        let mut vectors = [Vector3::zeros(); N];
        let triples = numbers.chunks_exact(3).zip(quantities);
        for (vector, (triple, (name, range, unit))) in vectors.iter_mut().zip(triples) {
            for ((axis, entry), number) in ["x", "y", "z"].iter().zip(vector).zip(triple) {
                let thing = format_args!("{self}: {name} {axis} [{unit}]");
                *entry = range.check(thing, *number).map_err(|e| e.to_string())?;
            }
        }
        Ok(vectors)
    }

    /// The unit quaternion of four numbers.
    fn quaternion(&self, numbers: &[f64]) -> Result<Quaternion<f64>, String> {
        let q = Quaternion::from_iterator(numbers.iter().copied());
        let thing = format_args!("{self}: quaternion norm");
        let norm = QUATERNION_NORM
            .check(thing, q.norm())
            .map_err(|e| e.to_string())?;
        // Transitions begin at it, and take it for one.
        Ok(q / norm)
    }
}

impl fmt::Display for Level<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "level {} ", self.number)?;
        match &self.task.tracked {
            Tracked::Position(point) => match self.arm.name_of(point) {
                Some(name) => write!(f, "(position of {name})"),
                None => write!(f, "(position of a point of link {})", point.link.number()),
            },
            Tracked::Orientation(frame) => match self.arm.tool_frame() {
                Some(tool) if tool == *frame => write!(f, "(orientation of {TOOL_POINT})"),
                _ => write!(f, "(orientation of link {})", frame.link.number()),
            },
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use arms::{LWR_IV, LWR_IV_FLANGE};
    use controller_core::{Axes, Link, LinkPoint, TaskGains};

    const GAINS: TaskGains = TaskGains::uniform(400.0, 40.0);
    const FLANGE: Task = Task::position(LWR_IV_FLANGE, Axes::XYZ, GAINS);
    const LINK_7: Task = Task::orientation(Link::L7.frame(), Axes::XYZ, GAINS);
    const HEIGHT: Task = Task::position(
        LinkPoint {
            link: Link::L3,
            offset: [0.0, 0.1, 0.0],
        },
        Axes::Z,
        GAINS,
    );

    fn set(tasks: &[Task]) -> TaskSet {
        TaskSet::new(tasks).expect("tasks that can be")
    }

    /// Flange, orientation of link 7, and a point of link 3.
    pub fn three() -> TaskSet {
        set(&[FLANGE, LINK_7, HEIGHT])
    }

    fn setpoint(text: &str, tasks: &TaskSet) -> Result<Setpoint, String> {
        Setpoint::parse(text, tasks, &EquippedArm::of(&LWR_IV))
    }

    fn zeros(count: usize) -> String {
        "0 ".repeat(count)
    }

    /// Nothing but zeros, with an orientation of its own where the tasks have one.
    fn rest(tasks: &TaskSet) -> Vec<String> {
        let levels = tasks.tasks().iter();
        levels
            .map(|task| match task.tracked {
                Tracked::Position(_) => zeros(9),
                Tracked::Orientation(_) => format!("1 {}", zeros(9)),
            })
            .collect()
    }

    fn refusal(text: &str, tasks: &TaskSet) -> String {
        setpoint(text, tasks).expect_err(text)
    }

    #[test]
    fn each_level_gets_the_numbers_of_its_kind() {
        let text = "0.5 0 0.4, 0.1 0 0, 0 0 -1\n\
                    0 0 -0.6 0.8, 1 2 3, 4 5 6\n\
                    0 0 1\t0 0 2\r\n0 0 3";
        let setpoint = setpoint(text, &three()).expect("all levels");
        let expected = [
            Target::Position {
                x: [0.5, 0.0, 0.4].into(),
                dx: [0.1, 0.0, 0.0].into(),
                ddx: [0.0, 0.0, -1.0].into(),
            },
            Target::Orientation {
                q: [0.0, 0.0, -0.6, 0.8].into(),
                w: [1.0, 2.0, 3.0].into(),
                dw: [4.0, 5.0, 6.0].into(),
            },
            Target::Position {
                x: [0.0, 0.0, 1.0].into(),
                dx: [0.0, 0.0, 2.0].into(),
                ddx: [0.0, 0.0, 3.0].into(),
            },
        ];
        assert_eq!(setpoint.targets(), expected);
    }

    /// Every count of numbers, whatever the kinds of the levels: read where it is that of
    /// the first levels, refused otherwise.
    #[test]
    fn levels_may_be_left_out_at_the_end_and_nowhere_else() {
        let kinds = [FLANGE, LINK_7].map(|task| Task {
            axes: Axes::Z,
            ..task
        });
        for mask in 0..1 << MAX_LEVELS {
            let tasks: Vec<_> = (0..MAX_LEVELS)
                .map(|level| kinds[mask >> level & 1])
                .collect();
            let tasks = set(&tasks);
            let levels = rest(&tasks);
            let mut counts = Vec::new();
            for given in 1..=MAX_LEVELS {
                let text = levels[..given].concat();
                let setpoint = setpoint(&text, &tasks).expect("the first levels");
                assert_eq!(setpoint.targets().len(), given);
                counts.push(text.split_whitespace().count());
            }
            for count in (0..=80).filter(|count| !counts.contains(count)) {
                let error = refusal(&zeros(count), &tasks);
                assert!(error.starts_with("level "), "{mask:b} {count}: {error}");
                assert!(
                    error.contains("; allowed: 9, x") || error.contains("; allowed: 10, w"),
                    "{mask:b} {count}: {error}"
                );
            }
            // Nine for every level are no stream where one of the levels is an orientation.
            for given in (1..=MAX_LEVELS).filter(|given| mask & ((1 << given) - 1) != 0) {
                let first = mask.trailing_zeros() + 1;
                assert_eq!(
                    refusal(&zeros(9 * given), &tasks),
                    format!(
                        "level {first} (orientation of link 7): 9 numbers; allowed: 10, w x y z, \
                         angular velocity, angular acceleration"
                    )
                );
            }
        }
    }

    #[test]
    fn a_wrong_count_names_the_level() {
        let position = "allowed: 9, x y z, velocity, acceleration";
        let orientation = "allowed: 10, w x y z, angular velocity, angular acceleration";
        for (count, start, allowed) in [
            (0, "level 1 (position of flange): 0 numbers; ", position),
            (1, "level 1 (position of flange): 1 number; ", position),
            (8, "level 1 (position of flange): 8 numbers; ", position),
            (
                10,
                "level 2 (orientation of link 7): 1 number; ",
                orientation,
            ),
            (
                18,
                "level 2 (orientation of link 7): 9 numbers; ",
                orientation,
            ),
            (
                27,
                "level 2 (orientation of link 7): 9 numbers; ",
                orientation,
            ),
            (
                20,
                "level 3 (position of a point of link 3): 1 number; ",
                position,
            ),
            (
                29,
                "level 3 (position of a point of link 3): 10 numbers; ",
                position,
            ),
            // More than any tasks have.
            (
                1000,
                "level 3 (position of a point of link 3): 981 numbers; ",
                position,
            ),
        ] {
            let error = refusal(&zeros(count), &three());
            assert_eq!(error, format!("{start}{allowed}"), "{count}");
        }
    }

    #[test]
    fn what_is_no_number_is_named() {
        for (text, part) in [
            ("a 0 0 0 0 0 0 0 0", "'a'"),
            (
                "NaN 0 0 0 0 0 0 0 0",
                "level 1 (position of flange): position x [m]: NaN; allowed: -3 to 3",
            ),
            (
                "0 0 0 0 0 inf 0 0 0",
                "level 1 (position of flange): velocity z [m/s]: inf; allowed: -5 to 5",
            ),
            (
                "0 0 0 0 0 0 0 0 1e400",
                "level 1 (position of flange): acceleration z [m/s2]: inf; allowed: -100 to 100",
            ),
        ] {
            assert!(refusal(text, &three()).contains(part), "{text}");
        }
        let link = set(&[LINK_7]);
        for quaternion in ["NaN 0 0 0", "1 inf 0 0", "1e200 0 0 0", "0 0 0 0"] {
            let error = refusal(&format!("{quaternion} {}", zeros(6)), &link);
            let start = "level 1 (orientation of link 7): quaternion norm: ";
            assert!(error.starts_with(start), "{error}");
            assert!(error.ends_with("; allowed: 0.5 to 2"), "{error}");
        }
    }

    /// Every number of a datagram at its limits and just beyond.
    #[test]
    fn ranges_include_their_limits() {
        let tasks = set(&[FLANGE, LINK_7]);
        let mut numbers = [0.0; 19];
        numbers[9] = 1.0;
        let limits = [(0, 3.0), (3, 5.0), (6, 100.0), (13, 20.0), (16, 500.0)];
        let parse = |numbers: &[f64; 19]| {
            let words = numbers.map(|number| number.to_string());
            setpoint(&words.join(" "), &tasks)
        };
        for (place, limit) in limits.into_iter().flat_map(|(from, limit)| {
            let signs = [limit, -limit].into_iter();
            signs.flat_map(move |limit| (from..from + 3).map(move |place| (place, limit)))
        }) {
            let mut changed = numbers;
            changed[place] = limit;
            assert!(parse(&changed).is_ok(), "number {place}: {limit}");
            // The next one farther from zero.
            changed[place] = f64::from_bits(f64::to_bits(limit) + 1);
            let error = parse(&changed).expect_err("beyond the limit");
            let (level, size) = (if place < 9 { 1 } else { 2 }, limit.abs());
            assert!(error.starts_with(&format!("level {level} (")), "{error}");
            let allowed = format!("; allowed: -{size} to {size}");
            assert!(error.ends_with(&allowed), "{error}");
        }
    }

    #[test]
    fn quaternions_have_norms_of_one_half_to_two() {
        let tasks = set(&[LINK_7]);
        let parse = |q: [f64; 4]| {
            let words = q.map(|number| number.to_string()).join(" ");
            setpoint(&format!("{words} {}", zeros(6)), &tasks)
        };
        for norm in [0.5, 1.0, 1.7, 2.0] {
            for unit in [[1.0, 0.0, 0.0, 0.0], [0.5, -0.5, 0.5, -0.5]] {
                let setpoint = parse(unit.map(|part| part * norm)).expect("a quaternion");
                let [Target::Orientation { q, .. }] = setpoint.targets() else {
                    panic!("an orientation");
                };
                // The norm is rounded, and the division.
                assert!((q - Quaternion::from(unit)).amax() < 1e-15, "{norm}: {q}");
            }
        }
        // One part in 1e15 of the norm is more than it is rounded by.
        for norm in [0.0, 0.5 * (1.0 - 1e-15), 2.0 * (1.0 + 1e-15), 10.0] {
            let error = parse([0.0, 0.0, norm, 0.0]).expect_err("no quaternion");
            assert!(error.contains("quaternion norm"), "{error}");
        }
    }

    /// The reason of the range: no link turns faster than all joints together.
    #[test]
    fn no_link_turns_beyond_the_range() {
        let fastest: f64 = LWR_IV.links.iter().map(|link| link.speed_limit).sum();
        let [(_, range, _), _] = ROTATION;
        assert!(range.contains(fastest), "{fastest}");
    }

    #[test]
    fn the_document_says_the_ranges() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/fri.md");
        let text = std::fs::read_to_string(path).expect("the document");
        let rows = POSITION.iter().chain(&ROTATION);
        let rows = rows.map(|(name, range, unit)| format!("| {name} | {range} {unit} |"));
        let norm = format!("| norm of the quaternion | {QUATERNION_NORM} |");
        for row in rows.chain([norm]) {
            assert!(text.contains(&row), "docs/fri.md has to contain {row}");
        }
    }
}
