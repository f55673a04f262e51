//! Columns that are there by their names, but hold too little to be used.

use super::layout::{ABSENT, Layout};

impl Layout {
    /// Leaves out columns of velocity or acceleration; `why` is what is wrong with them.
    pub(crate) fn leave_out_derivatives(&mut self, columns: &[usize], why: &str) {
        for (name, table) in [("velocity", &mut self.qd), ("acceleration", &mut self.qdd)] {
            let Some(own) = table else { continue };
            for (joint, column) in own.iter_mut().enumerate().filter(|(_, column)| columns.contains(column)) {
                let joint = &self.joints[joint];
                self.understood.push(format!("the {name} of {joint} {why}: it is taken from the position"));
                *column = ABSENT;
            }
            if own.iter().all(|column| *column == ABSENT) {
                *table = None;
            }
        }
    }

    /// Leaves out columns of torque that have gaps.
    pub(crate) fn leave_out_torques(&mut self, columns: &[usize]) {
        for (joint, column) in self.tau.iter_mut().enumerate().filter(|(_, column)| columns.contains(column)) {
            let joint = &self.joints[joint];
            self.understood.push(format!("the torque of {joint} lacks most of its values: it is not used"));
            *column = ABSENT;
        }
    }

    /// Leaves out the velocity, acceleration or torque of a joint whose column holds nothing, or a joint of the file's own
    /// that has no positions. `fixed` joints must have them.
    ///
    /// # Errors
    /// The place in `joints` of one without positions.
    pub(crate) fn leave_out(&mut self, empty: &[usize], fixed: bool) -> std::result::Result<(), usize> {
        self.leave_out_derivatives(empty, "holds no value");
        self.tau.iter_mut().filter(|column| empty.contains(column)).for_each(|column| *column = ABSENT);
        while let Some(joint) = self.q.iter().position(|column| empty.contains(column)) {
            if fixed || self.q.len() == 1 {
                return Err(joint);
            }
            let name = self.joints.remove(joint);
            self.understood.push(format!("{name} has no position and is left out"));
            self.q.remove(joint);
            self.tau.remove(joint);
            let tables = [&mut self.qd, &mut self.qdd].into_iter().flatten().chain(self.truth.iter_mut().flatten());
            for table in tables {
                table.remove(joint);
            }
        }
        Ok(())
    }
}
