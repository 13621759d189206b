//! The inputs of the timing table are what they say, and every part is timed.

use std::cell::Cell;

use firmware::log::Number;
use firmware::scenario::{FixedScenario, controller};
use firmware::stages::{Clock, Rig, Survey, survey};
use firmware::workload::{COUNT, KINDS, Kind, input};

/// Three ticks per reading, an instruction each.
#[derive(Default)]
struct Reading(Cell<u32>);

impl Clock for Reading {
    fn ticks(&self) -> u32 {
        self.0.set(self.0.get().wrapping_add(3));
        self.0.get()
    }

    fn instructions(&self, ticks: u32) -> u32 {
        ticks
    }
}

fn surveyed<T: Number>(scenario: FixedScenario) -> Survey {
    let mut rig = Rig::new(controller::<T>(scenario).expect("a valid scenario"));
    survey(&mut rig, &Reading::default(), Rig::cycle)
}

#[test]
fn every_input_is_believed_and_some_are_hard() {
    const { assert!(COUNT > 2000) };
    for scenario in FixedScenario::ALL {
        for found in [surveyed::<f64>(scenario), surveyed::<f32>(scenario)] {
            assert_eq!(found.faults, 0);
            assert!(found.saturated > 500 && found.saturated < COUNT - 200);
            assert!(found.released > 20);
            // The overhead of two readings is taken off.
            assert!(found.stages.iter().all(|s| (s.min, s.max) == (0, 0)));
        }
    }
    assert_ne!(
        surveyed::<f64>(FixedScenario::TwoLevel).checksum,
        surveyed::<f64>(FixedScenario::Case1).checksum
    );
}

#[test]
fn kinds_follow_each_other() {
    let mut index = 0;
    for (kind, count) in KINDS {
        for number in 0..count {
            assert_eq!(Kind::of(index), (kind, number));
            index += 1;
        }
    }
    assert_eq!(index, COUNT);
}

#[test]
fn corners_are_all_different() {
    let controller = controller::<f64>(FixedScenario::TwoLevel).expect("a valid scenario");
    let corners = (2000..2128).map(|index| {
        let (measurement, _) = input(&controller, index);
        measurement.q.map(|x| u8::from(x > 0.0)).data.0[0]
    });
    let mut corners: Vec<_> = corners.collect();
    corners.sort_unstable();
    corners.dedup();
    assert_eq!(corners.len(), 128);
}
