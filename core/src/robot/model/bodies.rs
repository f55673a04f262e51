//! The moving bodies of a robot and how they hang together.

use super::arm::Robot;
use super::coupling::Coupling;
use super::joint::Joint;
use super::tree::Follower;

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
    pub(crate) fn body_mut(&mut self, body: usize) -> &mut Joint {
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
