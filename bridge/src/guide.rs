//! From the wanted motion to the reference of a cycle: followed, held when the
//! link cannot carry it, and joined again without a jump.

use controller_core::joint::{JointVector, Vector3};
use controller_core::measurement::Reference;
use controller_core::orientation::{self, Quaternion};
use controller_core::real::Real;
use controller_core::task::{MAX_LEVELS, Task, TaskKind, TaskReference};
use controller_core::trajectory::quintic;
use heapless::Vec;

/// Where the wanted motion comes from.
pub trait ReferenceSource {
    /// Time 0 is near and the arm rests: `origin` is where the levels are, and the
    /// posture.
    fn start(&mut self, origin: &Reference<f64>);

    /// The reference at `t_s` \[s\] >= 0. None where there is nothing to follow: the
    /// arm holds, and joins again when there is.
    fn sample(&mut self, t_s: f64) -> Option<Reference<f64>>;
}

/// Times of the transitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GuideTimes {
    /// From moving to rest \[s\].
    pub brake_s: f64,
    /// From rest to the wanted motion \[s\].
    pub join_s: f64,
}

impl Default for GuideTimes {
    fn default() -> Self {
        Self {
            brake_s: 0.2,
            join_s: 0.5,
        }
    }
}

/// What the guide is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuideMode {
    /// The reference is the wanted motion.
    Following,
    /// The reference comes to rest, or rests.
    Holding,
    /// The reference leaves its place of rest for the wanted motion.
    Joining,
}

/// The last reference and the transition under way.
#[derive(Clone, Debug)]
pub struct Guide {
    times: GuideTimes,
    kinds: Vec<TaskKind, MAX_LEVELS>,
    mode: GuideMode,
    /// Where the transition began.
    from: Reference<f64>,
    /// Time since then \[s\].
    elapsed_s: f64,
    /// The reference of the last cycle.
    last: Reference<f64>,
}

impl Guide {
    /// Resting, nowhere yet.
    #[must_use]
    pub fn new(times: GuideTimes, tasks: &[Task<f64>]) -> Self {
        Self {
            times,
            kinds: tasks.iter().map(|task| task.kind).collect(),
            mode: GuideMode::Holding,
            from: Reference::new(),
            elapsed_s: 0.0,
            last: Reference::new(),
        }
    }

    /// The reference of the last cycle.
    #[must_use]
    pub fn reference(&self) -> &Reference<f64> {
        &self.last
    }

    /// What it is doing.
    #[must_use]
    pub fn mode(&self) -> GuideMode {
        self.mode
    }

    /// Comes to rest from `place`, which may move.
    pub fn brake_from(&mut self, place: &Reference<f64>) {
        self.mode = GuideMode::Holding;
        self.elapsed_s = 0.0;
        self.from.clone_from(place);
        self.last.clone_from(place);
    }

    /// Rests at `place`.
    pub fn rest(&mut self, place: &Reference<f64>) {
        self.mode = GuideMode::Holding;
        // Far enough that nothing is left to brake.
        self.elapsed_s = self.times.brake_s;
        self.from = place.clone();
        self.last = place.clone();
    }

    /// The reference of this cycle, `interval_s` \[s\] after the last one. `wanted` is
    /// the motion to follow, or none to hold.
    pub fn advance(&mut self, wanted: Option<&Reference<f64>>, interval_s: f64) -> &Reference<f64> {
        self.elapsed_s += interval_s;
        match (wanted, self.mode) {
            (None, GuideMode::Holding) => self.brake(),
            (None, _) => {
                self.mode = GuideMode::Holding;
                self.from.clone_from(&self.last);
                self.elapsed_s = interval_s;
                self.brake();
            }
            (Some(wanted), GuideMode::Following) => self.last.clone_from(wanted),
            (Some(wanted), GuideMode::Joining) => self.join(wanted),
            (Some(wanted), GuideMode::Holding) => {
                self.mode = GuideMode::Joining;
                self.from.clone_from(&self.last);
                self.elapsed_s = 0.0;
                self.join(wanted);
            }
        }
        &self.last
    }

    /// Follows at once, without a transition: for a wanted motion that starts at
    /// rest where the arm rests.
    pub fn follow(&mut self) {
        self.mode = GuideMode::Following;
    }

    /// Velocity v (1 - b(u)), u = elapsed / brake time, from where it began.
    fn brake(&mut self) {
        let brake_s = self.times.brake_s;
        let u = self.elapsed_s / brake_s;
        let [share, rate, _] = quintic(u);
        let u = u.limited(0.0, 1.0);
        // Integral of 1 - b: the way, in units of v times the brake time.
        let way = u - u * u * u * u * (2.5 - 3.0 * u + u * u);
        let pairs = self.last.tasks.iter_mut().zip(&self.from.tasks);
        for (kind, (task, from)) in self.kinds.iter().zip(pairs) {
            let way = from.dx * (way * brake_s);
            match kind {
                TaskKind::Position => task.x = from.x + way,
                TaskKind::Orientation => task.orientation = turned(&from.orientation, &way),
            }
            task.dx = from.dx * (1.0 - share);
            task.ddx = from.dx * (-rate / brake_s);
        }
        self.last.posture = self.from.posture;
    }

    /// (1 - b) of the place of rest and b of the wanted motion. Of an orientation
    /// the rates are those of the rotation vector, exact where the two are close.
    fn join(&mut self, wanted: &Reference<f64>) {
        let join_s = self.times.join_s;
        let u = self.elapsed_s / join_s;
        if u >= 1.0 || self.from.tasks.len() != wanted.tasks.len() {
            self.mode = GuideMode::Following;
            self.last.clone_from(wanted);
            return;
        }
        let [share, rate, curvature] = quintic(u);
        let (rate, curvature) = (rate / join_s, curvature / (join_s * join_s));
        let pairs = self.from.tasks.iter().zip(&wanted.tasks);
        let kinds = self.kinds.iter().zip(self.last.tasks.iter_mut());
        for ((kind, task), (from, to)) in kinds.zip(pairs) {
            let way = match kind {
                TaskKind::Position => to.x - from.x,
                TaskKind::Orientation => orientation::error(&to.orientation, &from.orientation),
            };
            *task = TaskReference {
                x: from.x + way * share,
                orientation: turned(&from.orientation, &(way * share)),
                dx: to.dx * share + way * rate,
                ddx: to.ddx * share + to.dx * (2.0 * rate) + way * curvature,
            };
        }
        let posture: JointVector<f64> = wanted.posture - self.from.posture;
        self.last.posture = self.from.posture + posture * share;
    }
}

/// `orientation` turned by a rotation vector \[rad\].
fn turned(orientation: &Quaternion<f64>, by: &Vector3<f64>) -> Quaternion<f64> {
    let angle = by.dot(by).square_root();
    if angle < 1e-12 {
        return *orientation;
    }
    let angle = angle.limited(0.0, core::f64::consts::TAU);
    let axis = by / by.dot(by).square_root();
    orientation::product(&orientation::about_axis(&axis, angle), orientation)
}
