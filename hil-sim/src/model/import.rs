//! From the text of a URDF to the text of an arm file.

use controller_core::arm::{ArmModel, ArmParameters};
use controller_core::joint::DOF;

use super::search::{damping_postures, states};
use cell::arm::file::OwnArm;
use cell::arm::robot::{self, kept};
use cell::arm::text;
use cell::file::MOST;
use cell::invalid::Invalid;
use cell::model::agreement::Agreement;
use cell::model::chain::{Angles, Chain, Choice};
use cell::model::urdf::Urdf;

/// States in which the table is held against the file.
const STATES: usize = 1000;

/// An imported arm.
#[derive(Clone, Debug)]
pub struct Import {
    /// Its table, as its arm file gives it.
    pub arm: &'static ArmParameters,
    /// Where it comes from and what was made of what the file leaves open, a sentence each.
    pub notes: Vec<String>,
    /// The arm file.
    pub text: String,
}

/// What is imported.
#[derive(Clone, Debug)]
pub struct Request<'a> {
    /// Name of the file, for the notes.
    pub source: &'a str,
    /// Name of the arm; without it that of the robot.
    pub name: Option<&'a str>,
    /// Start and end, and what the file leaves open.
    pub choice: Choice,
    /// The table brings postures of the sampling bound; else they are searched for the very
    /// damping whenever a controller is made.
    pub has_postures: bool,
}

/// Imports an arm from the text of a URDF.
///
/// # Errors
/// What in it makes no arm.
pub fn import(text: &str, request: &Request<'_>) -> Result<Import, Invalid> {
    let urdf = Urdf::parse(text)?;
    let chain = Chain::new(&urdf, &request.choice, Angles::Exact)?;
    let printed = Chain::new(&urdf, &request.choice, Angles::AsPrinted)?;
    let mut notes = vec![format!(
        "from {}, link '{}' to '{}'",
        request.source, chain.base, chain.end
    )];
    notes.extend(chain.notes.iter().cloned());
    notes.push("rotor inertias are not in a URDF: 0 here".to_string());

    let numbers = chain.table();
    let of_table = |error: Invalid| error.within("the table it makes");
    let model_of = |arm| ArmModel::new(arm).map_err(|error| of_table(Invalid::line(error)));
    let mut postures = Vec::new();
    if request.has_postures {
        let (found, excess) = damping_postures(&model_of(&numbers)?);
        notes.push(format!(
            "{} postures of the sampling bound; for other dampings a search found at most \
             {:.1} % more",
            found.len(),
            100.0 * excess.max(0.0)
        ));
        postures = found;
    }
    let name = (request.name).map_or_else(|| simple(&urdf.name), str::to_string);
    let joints: [String; DOF] = std::array::from_fn(|i| chain.joints[i].name.clone());
    let named = kept(OwnArm::new(&numbers, &name, joints, postures));
    // As the file says it: angles of its degrees.
    let arm = robot::parse(&text::text(named, "")).map_err(of_table)?;
    let agreement = Agreement::of(arm, &model_of(arm)?, &printed, states(arm, STATES));
    notes.push(of_right_angles(&chain, &agreement));
    let text = text::text(arm, &notes.join("\n"));
    if text.len() as u64 > MOST {
        let given = format!("{} bytes, with {} notes", text.len(), notes.len());
        return Err(Invalid::new("arm file", given, format!("{MOST} bytes")));
    }
    Ok(Import { arm, notes, text })
}

/// What right angles that are exact change.
fn of_right_angles(chain: &Chain, agreement: &Agreement) -> String {
    let [mass, gravity, _, position, _] = agreement.all().map(|(_, apart)| apart.most);
    let changes = format!(
        "M by at most {mass:.1e} kg m2, g by {gravity:.1e} Nm, the flange by {position:.1e} m"
    );
    let most = chain.snapped.iter().copied().fold(0.0, f64::max);
    match chain.snapped.len() {
        0 => format!("all right angles are exact in the file; the table changes {changes}"),
        count => format!(
            "{count} right angles of the file, up to {most:.1e} rad away, are exact here, which \
             changes {changes}"
        ),
    }
}

/// A name with the letters that the name of an arm may have.
fn simple(name: &str) -> String {
    let letter = |c: char| match c.to_ascii_lowercase() {
        c if c.is_ascii_alphanumeric() || c == '-' || c == '_' => c,
        _ => '_',
    };
    let name: String = name.chars().take(64).map(letter).collect();
    if name.is_empty() {
        "arm".to_string()
    } else {
        name
    }
}
