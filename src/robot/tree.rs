//! What makes a robot more than a serial arm: branches, and joints that follow others.

use super::{Coupling, Joint, Robot};

/// A moving joint without a coordinate of its own: it follows a coordinate, q = multiplier x + offset. Its friction and
/// rotor are part of that coordinate's drive.
#[derive(Debug, Clone, PartialEq)]
pub struct Follower {
    /// The joint and the body it carries.
    pub joint: Joint,
    /// Index of the coordinate that it follows.
    pub coordinate: usize,
    /// dq / dx.
    pub multiplier: f64,
    /// Position at x = 0, rad or m.
    pub offset: f64,
}

/// Structure of a robot that is not a serial chain. Bodies are counted: first one per coordinate, then one per follower.
#[derive(Debug, Clone, PartialEq)]
pub struct Tree {
    /// Joints that follow coordinates.
    pub followers: Vec<Follower>,
    /// The body that carries each body, none for the base.
    pub parents: Vec<Option<usize>>,
    /// The body that carries the flange.
    pub tip: usize,
}

impl Robot {
    /// Number of moving bodies: one per coordinate and one per follower.
    pub fn bodies(&self) -> usize {
        self.dof() + self.followers().len()
    }

    /// Joints that follow coordinates; none on a serial arm.
    pub fn followers(&self) -> &[Follower] {
        self.tree.as_ref().map_or(&[], |tree| &tree.followers)
    }

    /// A moving body with the joint it hangs on.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn body(&self, body: usize) -> &Joint {
        match body.checked_sub(self.dof()) {
            None => &self.joints[body],
            Some(follower) => &self.followers()[follower].joint,
        }
    }

    /// [`Robot::body`], to change it.
    ///
    /// # Panics
    /// If there is no such body.
    pub fn body_mut(&mut self, body: usize) -> &mut Joint {
        match (body.checked_sub(self.joints.len()), &mut self.tree) {
            (Some(follower), Some(tree)) => &mut tree.followers[follower].joint,
            _ => &mut self.joints[body],
        }
    }

    /// The body that carries `body`; none if that is the base.
    pub fn parent(&self, body: usize) -> Option<usize> {
        match &self.tree {
            Some(tree) => tree.parents[body],
            None => body.checked_sub(1),
        }
    }

    /// The body that carries the flange.
    pub fn tip(&self) -> usize {
        self.tree.as_ref().map_or(self.dof() - 1, |tree| tree.tip)
    }

    /// How the joint of `body` follows the coordinates: its row of the linear map.
    pub fn coupling(&self, body: usize) -> Coupling {
        match body.checked_sub(self.dof()) {
            None => Coupling::own(body),
            Some(follower) => {
                let Follower { coordinate, multiplier, offset, .. } = self.followers()[follower];
                Coupling { coordinate, multiplier, offset }
            }
        }
    }

    /// All bodies, each behind the one that carries it.
    pub fn outwards(&self) -> Vec<usize> {
        let mut order = Vec::with_capacity(self.bodies());
        let mut placed = vec![false; self.bodies()];
        while order.len() < self.bodies() {
            let before = order.len();
            for body in 0..self.bodies() {
                if !placed[body] && self.parent(body).is_none_or(|parent| placed[parent]) {
                    placed[body] = true;
                    order.push(body);
                }
            }
            assert!(order.len() > before, "a body carries itself");
        }
        order
    }

    /// Whether `coordinate` moves `body`: it, or a joint that follows it, is between the body and the base.
    pub fn moves(&self, coordinate: usize, body: usize) -> bool {
        let mut at = Some(body);
        while let Some(body) = at {
            if self.coupling(body).coordinate == coordinate {
                return true;
            }
            at = self.parent(body);
        }
        false
    }
}
