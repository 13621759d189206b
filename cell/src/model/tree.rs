//! How the links of a URDF hang together.

use controller_core::joint::DOF;

use super::urdf::{Kind, Urdf};
use crate::invalid::Invalid;

/// The links as a tree.
pub struct Tree<'a> {
    urdf: &'a Urdf<'a>,
    /// The link that is on no other.
    pub root: usize,
    /// Per link the joint it hangs on; none of the root.
    parent: Vec<Option<usize>>,
    /// Per link the joints that are on it.
    children: Vec<Vec<usize>>,
    /// All joints, none before the one that carries it.
    pub outward: Vec<usize>,
}

impl<'a> Tree<'a> {
    /// Of a URDF.
    ///
    /// # Errors
    /// A link on two others, more than one root or none, links in a circle.
    pub fn new(urdf: &'a Urdf<'a>) -> Result<Self, Invalid> {
        let mut parent = vec![None; urdf.links.len()];
        let mut children = vec![Vec::new(); urdf.links.len()];
        for (number, joint) in urdf.joints.iter().enumerate() {
            if parent[joint.child].replace(number).is_some() {
                let given = format!(
                    "'{}', which hangs on another joint",
                    urdf.links[joint.child].name
                );
                let error = Invalid::new("child", given, "every link on one joint");
                return Err(urdf.at_joint(joint, error));
            }
            children[joint.parent].push(number);
        }
        let mut roots = (0..urdf.links.len()).filter(|&link| parent[link].is_none());
        let Some(root) = roots.next() else {
            let given = format!("none of {} links", urdf.links.len());
            return Err(Invalid::new("root", given, "one link that is on no other"));
        };
        if let Some(other) = roots.next() {
            let given = format!(
                "'{}' and '{}'",
                urdf.links[root].name, urdf.links[other].name
            );
            return Err(Invalid::new("root", given, "one link that is on no other"));
        }
        let (mut outward, mut next): (Vec<usize>, usize) = (children[root].clone(), 0);
        while let Some(&joint) = outward.get(next) {
            outward.extend(&children[urdf.joints[joint].child]);
            next += 1;
        }
        if outward.len() < urdf.joints.len() {
            let lost = (0..urdf.joints.len()).find(|joint| !outward.contains(joint));
            let joint = &urdf.joints[lost.unwrap_or(0)];
            let error = Invalid::new("links", "a circle", "a tree");
            return Err(urdf.at_joint(joint, error));
        }
        Ok(Self {
            urdf,
            root,
            parent,
            children,
            outward,
        })
    }

    /// The joints from `base` to `end`.
    ///
    /// # Errors
    /// `end` is not below `base`.
    pub fn path(&self, base: usize, end: usize) -> Result<Vec<usize>, Invalid> {
        let (mut path, mut link) = (Vec::new(), end);
        while link != base {
            let Some(joint) = self.parent[link] else {
                let names = [base, end].map(|link| &self.urdf.links[link].name);
                let given = format!("'{}', which is not below '{}'", names[1], names[0]);
                return Err(Invalid::new("--tip", given, "a link that the base carries"));
            };
            path.push(joint);
            link = self.urdf.joints[joint].parent;
        }
        path.reverse();
        Ok(path)
    }

    /// The end of the only row of moving joints: the last link fixed behind it.
    ///
    /// # Errors
    /// The row forks, or what is fixed to its end does.
    pub fn only_end(&self, base: usize) -> Result<usize, Invalid> {
        // Which joints move, or carry one that does.
        let mut moves = vec![false; self.urdf.joints.len()];
        for &joint in self.outward.iter().rev() {
            let own = &self.urdf.joints[joint];
            let below = self.children[own.child].iter().any(|&child| moves[child]);
            moves[joint] = own.kind != Kind::Fixed || below;
        }
        let mut link = base;
        loop {
            let all = &self.children[link];
            let moving: Vec<usize> = all.iter().copied().filter(|&joint| moves[joint]).collect();
            let ways = if moving.is_empty() { all } else { &moving };
            match ways.as_slice() {
                [] => return Ok(link),
                [joint] => link = self.urdf.joints[*joint].child,
                several => {
                    let ends = several.iter().map(|&joint| {
                        format!("'{}'", self.urdf.links[self.urdf.joints[joint].child].name)
                    });
                    let ends = ends.collect::<Vec<_>>().join(", ");
                    let from = &self.urdf.links[link].name;
                    let given = format!("none, and '{from}' has several branches: {ends}");
                    return Err(Invalid::new(
                        "--tip",
                        given,
                        "the link at which the arm ends",
                    ));
                }
            }
        }
    }

    /// Per link the number, from 0, of the last of the joints `turning` that moves it; none of
    /// links that stand still.
    #[must_use]
    pub fn carriers(&self, base: usize, turning: &[usize; DOF]) -> Vec<Option<usize>> {
        let mut carriers = vec![None; self.urdf.links.len()];
        for &joint in &self.outward {
            let own = &self.urdf.joints[joint];
            let number = turning.iter().position(|&turning| turning == joint);
            carriers[own.child] = match own.child == base {
                true => None,
                false => number.or(carriers[own.parent]),
            };
        }
        carriers
    }
}
