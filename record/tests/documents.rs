//! The tables of docs/files.md are the channels.

use bridge::lwr::RobotState;
use record::channel::Channel;
use record::{run, session};

fn table<S>(channels: &[Channel<S>]) -> Vec<String> {
    let in_file = channels.iter().filter(|channel| channel.place.is_in_file());
    in_file.map(Channel::described).collect()
}

#[test]
fn the_tables_of_the_document_are_the_channels() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../docs/files.md");
    let text = std::fs::read_to_string(path).expect("the document");
    let run = [table(run::CHANNELS), table(run::LEVEL_CHANNELS)].concat();
    for table in [run, table(&session::channels::<RobotState>())] {
        let rows = table.join("\n");
        assert!(text.contains(&rows), "docs/files.md has to contain\n{rows}");
    }
}

#[test]
fn the_column_of_modes_names_them_all() {
    let mode = run::CHANNELS
        .iter()
        .find(|channel| channel.columns == "mode");
    let meaning = mode.expect("a channel").meaning;
    for mode in controller_core::fault::Mode::ALL {
        let named = format!("{} {}", mode.number(), mode.name());
        assert!(meaning.contains(&named), "{named}: {meaning}");
    }
}

#[test]
fn names_and_values_are_as_many() {
    let sample = run::Sample {
        t_s: 0.5,
        state: controller_core::joint::JointState {
            q: [1.0; 7].into(),
            dq: [2.0; 7].into(),
        },
        torque: [3.0; 7].into(),
        residual: [4.0; 7].into(),
        mode: Some(controller_core::fault::Mode::Braking),
        saturated: false,
        rank: false,
        tau_ext: [5.0; 7].into(),
        hand_force_n: 6.0,
        conditioning: vec![7.0; 3],
        limits: Some(run::LimitSample {
            status: controller_core::fault::Status::CLEAR,
            null_share: 1.0,
            null_power: 0.0,
        }),
        levels: Vec::new(),
    };
    for channel in run::CHANNELS {
        let mut values = 0;
        (channel.values)(&sample, &mut |_| values += 1);
        assert_eq!(channel.names(0, &[]).len(), values, "{}", channel.columns);
    }
    let axes = ["x", "z"].map(String::from);
    let level = run::LevelSample {
        desired: vec![0.0; 2],
        actual: vec![0.0; 2],
        ..run::LevelSample::default()
    };
    for channel in run::LEVEL_CHANNELS
        .iter()
        .filter(|channel| channel.place.is_in_file())
    {
        let mut values = 0;
        (channel.values)(&level, &mut |_| values += 1);
        assert_eq!(channel.names(2, &axes).len(), values, "{}", channel.columns);
    }
    assert_eq!(
        run::LEVEL_CHANNELS[0].names(2, &axes),
        ["x2_des_x", "x2_des_z"]
    );
}
