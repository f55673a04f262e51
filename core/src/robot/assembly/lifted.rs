//! Weights that a simulator carries: `gravcomp` of MuJoCo.

use super::bodies::Assembly;

impl Assembly<'_> {
    /// Links that move and whose weight is carried, with a note on them; none where all links with a mass have all of their weight, or none
    /// of it, which is a torque that is compensated as a whole.
    pub(super) fn lifted(&mut self) -> Vec<String> {
        let moving = self.bodies.iter().flat_map(|&joint| self.welded(self.file.joints[joint].child));
        let links = moving.map(|(link, _)| &self.file.links[link]).filter(|link| link.inertia.mass() != 0.0);
        let (carried, shares): (Vec<_>, Vec<f64>) = links.map(|link| (link.name.clone(), link.gravcomp)).unzip();
        if [0.0, 1.0].iter().any(|of_all| shares.iter().all(|share| share == of_all)) {
            return Vec::new();
        }
        // One share of all weights is a weaker gravity.
        let weaker = shares.first().filter(|first| shares.iter().all(|share| share == *first)).map(|share| {
            let [x, y, z] = (self.file.gravity * (1.0 - share)).into();
            format!("; all links have the share {share}, which --gravity={x},{y},{z} models")
        });
        let each = carried.into_iter().zip(shares).filter(|(_, share)| *share != 0.0);
        let lifted: Vec<String> = each.map(|(name, _)| name).collect();
        self.notes.push(format!(
            "gravcomp carries a part of the arm's weight ({}): torques are not judged by the described bodies. Where the logged torques hold all \
             weights, set gravcomp to 0 in the file; with torques of a simulation, add qfrc_gravcomp to them first{}",
            lifted.join(", "),
            weaker.unwrap_or_default()
        ));
        lifted
    }
}

#[cfg(test)]
mod tests {
    use crate::robot::Robot;

    /// Three links, of which the last has no mass.
    fn robot(shares: [f64; 3]) -> Robot {
        let body = |name: &str, mass: f64, share: f64| {
            format!(
                "<body name='{name}' pos='0 0 .3' gravcomp='{share}'><joint axis='0 1 0'/>\
                 <inertial pos='0 0 .1' mass='{mass}' diaginertia='.01 .01 .01'/>"
            )
        };
        let [one, two, three] = shares;
        let bodies = body("one", 2.0, one) + &body("two", 1.0, two) + &body("three", 0.0, three);
        let text = format!("<mujoco><worldbody>{bodies}</body></body></body></worldbody></mujoco>");
        Robot::from_urdf_str(&text).unwrap()
    }

    #[test]
    fn weights_that_are_carried_in_part_are_named() {
        let lifted = |shares| robot(shares).lifted;
        assert!(lifted([0.0, 0.0, 0.0]).is_empty() && lifted([1.0, 1.0, 1.0]).is_empty());
        assert_eq!(
            (lifted([0.0, 1.0, 0.0]), lifted([1.0, 0.99, 1.0])),
            (vec!["two".into()], vec!["one".into(), "two".into()])
        );
        assert_eq!(lifted([0.5, 0.5, 0.5]).len(), 2);
        let has_cure = |shares| robot(shares).notes.iter().any(|note| note.contains("which --gravity=0,0,-4.905"));
        assert!(has_cure([0.5; 3]) && !has_cure([0.5, 0.4, 0.5]));
        // What weighs nothing does not count.
        assert!(lifted([0.0, 0.0, 1.0]).is_empty() && lifted([1.0, 1.0, 0.0]).is_empty());
        assert!(robot([0.0, 1.0, 0.0]).notes.iter().any(|note| note.contains("set gravcomp to 0 in the file")));
    }
}
