//! From the wanted motion to the reference of a cycle: followed, held when the
//! link cannot carry it, and joined again without a jump.

use controller_core::joint::{JointVector, Vector3};
use controller_core::ranges::{MAX_LEVELS, QUATERNION_NORMS};
use controller_core::real::Real;
use controller_core::task::orientation::{self, Quaternion};
use controller_core::task::trajectory::quintic;
use controller_core::{Reference, Target, TaskSet};
use heapless::Vec;

/// Where the wanted motion comes from.
pub trait ReferenceSource {
    /// Time 0 is near and the arm rests: `origin` is where the levels are, and the
    /// posture.
    fn start(&mut self, origin: &Reference<f64>);

    /// The reference at `t_s` \[s\] >= 0. None where there is nothing to follow: the
    /// arm holds, and joins again when there is. [`Target::Hold`] says the same of one
    /// level: it comes to rest as the arm does in silence, and stays where its reference
    /// came to rest.
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

/// What the guide, or a part of it, is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum GuideMode {
    /// The reference is the wanted motion.
    Following,
    /// The reference comes to rest, or rests.
    Holding,
    /// The reference leaves its place of rest for the wanted motion.
    Joining,
}

/// The reference of the last cycle and the transitions under way, one per level and one
/// of the posture: a level may hold while the others move.
#[derive(Clone, Debug)]
pub struct Guide {
    times: GuideTimes,
    levels: Vec<Level, MAX_LEVELS>,
    posture: Transition,
    /// Posture where its transition began \[rad\].
    posture_from: JointVector<f64>,
    /// The reference of the last cycle.
    last: Reference<f64>,
}

impl Guide {
    /// Resting, nowhere yet.
    #[must_use]
    pub fn new(times: GuideTimes, tasks: &TaskSet) -> Self {
        let last = Reference::hold(tasks.tasks().len(), [0.0; 7]);
        Self {
            times,
            levels: last.targets().iter().map(Level::at).collect(),
            posture: Transition::BEGIN,
            posture_from: last.posture,
            last,
        }
    }

    /// The reference of the last cycle; where a wanted one was passed on to be refused,
    /// the one before.
    #[must_use]
    pub fn reference(&self) -> &Reference<f64> {
        &self.last
    }

    /// What it is doing; single levels may hold or join.
    #[must_use]
    pub fn mode(&self) -> GuideMode {
        self.posture.mode
    }

    /// Comes to rest from `place`, which may move.
    pub fn brake_from(&mut self, place: &Reference<f64>) {
        self.hold_from(place, 0.0);
    }

    /// Rests at `place`.
    pub fn rest(&mut self, place: &Reference<f64>) {
        // Far enough that nothing is left to brake.
        self.hold_from(place, self.times.brake_s);
    }

    fn hold_from(&mut self, place: &Reference<f64>, elapsed_s: f64) {
        let transition = Transition {
            mode: GuideMode::Holding,
            elapsed_s,
        };
        for (level, target) in self.levels.iter_mut().zip(place.targets()) {
            level.from = *target;
            level.transition = transition;
        }
        self.posture = transition;
        self.posture_from = place.posture;
        self.last.clone_from(place);
    }

    /// The reference of this cycle, `interval_s` \[s\] after the last one. `wanted` is
    /// the motion to follow, or none to hold.
    ///
    /// What the controller will refuse, a wrong number of targets or a target of another
    /// kind than its level, comes out as it is: its fault names it. It is not followed.
    pub fn advance<'a>(
        &'a mut self,
        wanted: Option<&'a Reference<f64>>,
        interval_s: f64,
    ) -> &'a Reference<f64> {
        if let Some(wanted) = wanted
            && !self.fits(wanted)
        {
            return wanted;
        }
        let mut targets = wanted.map(|wanted| wanted.targets().iter());
        for (level, last) in self.levels.iter_mut().zip(self.last.targets_mut()) {
            let wanted = targets.as_mut().and_then(Iterator::next);
            let wanted = wanted.filter(|target| !matches!(target, Target::Hold));
            level.advance(wanted, last, &self.times, interval_s);
        }
        self.advance_posture(wanted.map(|wanted| &wanted.posture), interval_s);
        &self.last
    }

    /// Follows at once, without a transition: for a wanted motion that starts at
    /// rest where the arm rests.
    pub fn follow(&mut self) {
        self.posture.mode = GuideMode::Following;
        for level in &mut self.levels {
            level.transition.mode = GuideMode::Following;
        }
    }

    /// Whether the controller can take it: targets as many and of the kinds of the
    /// levels, orientations that are quaternions. Numbers that are not finite need no
    /// look: a blend with them is not finite either.
    fn fits(&self, wanted: &Reference<f64>) -> bool {
        let targets = wanted.targets();
        let mut pairs = self.last.targets().iter().zip(targets);
        targets.len() == self.levels.len()
            && pairs.all(|pair| match pair {
                (Target::Position { .. }, Target::Orientation { .. })
                | (Target::Orientation { .. }, Target::Position { .. }) => false,
                (_, Target::Orientation { q, .. }) => {
                    let [low, high] = QUATERNION_NORMS.map(|norm| norm * norm);
                    (low..=high).contains(&q.dot(q))
                }
                _ => true,
            })
    }

    /// A posture holds where it is, and is joined like a level.
    fn advance_posture(&mut self, wanted: Option<&JointVector<f64>>, interval_s: f64) {
        if self.posture.advance(wanted.is_some(), interval_s) {
            self.posture_from = self.last.posture;
        }
        self.last.posture = match wanted {
            None => self.posture_from,
            Some(wanted) => match self.posture.join(&self.times) {
                Some([share, ..]) => {
                    let way: JointVector<f64> = wanted - self.posture_from;
                    self.posture_from + way * share
                }
                None => *wanted,
            },
        };
    }
}

/// What is being done, and since when.
#[derive(Clone, Copy, Debug)]
struct Transition {
    mode: GuideMode,
    /// Time since the transition began \[s\].
    elapsed_s: f64,
}

impl Transition {
    const BEGIN: Self = Self {
        mode: GuideMode::Holding,
        elapsed_s: 0.0,
    };

    /// The next cycle, with something to follow or not. Whether a transition begins.
    fn advance(&mut self, follow: bool, interval_s: f64) -> bool {
        self.elapsed_s += interval_s;
        match (follow, self.mode) {
            (false, GuideMode::Holding)
            | (true, GuideMode::Following)
            | (true, GuideMode::Joining) => false,
            (false, _) => {
                // The last reference is an interval old.
                self.elapsed_s = interval_s;
                self.mode = GuideMode::Holding;
                true
            }
            (true, GuideMode::Holding) => {
                self.elapsed_s = 0.0;
                self.mode = GuideMode::Joining;
                true
            }
        }
    }

    /// With something to follow: share of the wanted motion while it is joined, its
    /// rate \[1/s\] and the rate of that \[1/s2\]; none where there is no place of rest any more.
    fn join(&mut self, times: &GuideTimes) -> Option<[f64; 3]> {
        if self.mode == GuideMode::Following {
            return None;
        }
        let join_s = times.join_s;
        let u = self.elapsed_s / join_s;
        if u >= 1.0 {
            self.mode = GuideMode::Following;
            return None;
        }
        let [share, rate, curvature] = quintic(u);
        Some([share, rate / join_s, curvature / (join_s * join_s)])
    }
}

/// One level on its way.
#[derive(Clone, Copy, Debug)]
struct Level {
    transition: Transition,
    /// Target where the transition began.
    from: Target<f64>,
}

impl Level {
    fn at(place: &Target<f64>) -> Self {
        Self {
            transition: Transition::BEGIN,
            from: *place,
        }
    }

    /// From the target of the last cycle to that of this one. `wanted` is what to
    /// follow, of the kind of the level, or none to hold.
    fn advance(
        &mut self,
        wanted: Option<&Target<f64>>,
        last: &mut Target<f64>,
        times: &GuideTimes,
        interval_s: f64,
    ) {
        if self.transition.advance(wanted.is_some(), interval_s) {
            self.from = *last;
        }
        *last = match wanted {
            None => brake(&self.from, self.transition.elapsed_s, times.brake_s),
            Some(wanted) => match self.transition.join(times) {
                Some(blend) => join(&self.from, wanted, blend),
                None => *wanted,
            },
        };
    }
}

/// Velocity v (1 - b(u)), u = elapsed / brake time, from where it began.
fn brake(from: &Target<f64>, elapsed_s: f64, brake_s: f64) -> Target<f64> {
    let u = elapsed_s / brake_s;
    let [share, rate, _] = quintic(u);
    let u = u.limited(0.0, 1.0);
    // Integral of 1 - b: the way, in units of v times the brake time.
    let way = u - u * u * u * u * (2.5 - 3.0 * u + u * u);
    match from {
        Target::Hold => Target::Hold,
        Target::Position { x, dx, .. } => Target::Position {
            x: x + dx * (way * brake_s),
            dx: dx * (1.0 - share),
            ddx: dx * (-rate / brake_s),
        },
        Target::Orientation { q, w, .. } => Target::Orientation {
            q: turned(q, &(w * (way * brake_s))),
            w: w * (1.0 - share),
            dw: w * (-rate / brake_s),
        },
    }
}

/// (1 - b) of the place of rest and b of the wanted motion. Of an orientation it is the
/// share b of the rotation between the two; its rates are right for a wanted orientation
/// that rests, and where the two are close for one that turns.
fn join(from: &Target<f64>, wanted: &Target<f64>, blend: [f64; 3]) -> Target<f64> {
    let [share, rate, curvature] = blend;
    let velocity = |to: &Vector3<f64>, way: Vector3<f64>| to * share + way * rate;
    let acceleration = |dto: &Vector3<f64>, to: &Vector3<f64>, way: Vector3<f64>| {
        dto * share + to * (2.0 * rate) + way * curvature
    };
    match (from, wanted) {
        (Target::Position { x: start, .. }, Target::Position { x, dx, ddx }) => {
            let way = x - start;
            Target::Position {
                x: start + way * share,
                dx: velocity(dx, way),
                ddx: acceleration(ddx, dx, way),
            }
        }
        (Target::Orientation { q: start, .. }, Target::Orientation { q, w, dw }) => {
            let way = orientation::rotation_vector(&orientation::chord(q, start));
            Target::Orientation {
                q: turned(start, &(way * share)),
                w: velocity(w, way),
                dw: acceleration(dw, w, way),
            }
        }
        // There is no place to leave.
        _ => *wanted,
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
