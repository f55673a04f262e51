//! Columns of the tests: a torque per joint over the rows, held only for the joints on which it acts.

/// A torque over the rows, `(joint, values)` for every joint on which it is not zero, in the order of the joints.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Column {
    /// Joints with their values.
    pub parts: Vec<(usize, Vec<f64>)>,
}

impl Column {
    /// From one signal per joint; those that are zero throughout are left out.
    pub fn new(signals: impl IntoIterator<Item = Vec<f64>>) -> Self {
        let parts = signals.into_iter().enumerate();
        Column { parts: parts.filter(|(_, signal)| signal.iter().any(|&v| v != 0.0)).collect() }
    }

    /// A torque on one joint.
    pub fn on(joint: usize, signal: Vec<f64>) -> Self {
        Column { parts: vec![(joint, signal)] }
    }

    /// The values on a joint.
    pub fn part(&self, joint: usize) -> Option<&[f64]> {
        self.parts.iter().find(|(own, _)| *own == joint).map(|(_, values)| values.as_slice())
    }

    /// Inner product over all joints and rows.
    pub fn dot(&self, other: &Column) -> f64 {
        self.parts
            .iter()
            .filter_map(|(joint, a)| Some(a.iter().zip(other.part(*joint)?).map(|(x, y)| x * y).sum::<f64>()))
            .sum()
    }

    /// Adds `factor` times `other`.
    pub fn add(&mut self, factor: f64, other: &Column) {
        for (joint, values) in &other.parts {
            match self.parts.binary_search_by_key(joint, |(own, _)| *own) {
                Ok(place) => self.parts[place].1.iter_mut().zip(values).for_each(|(x, y)| *x += factor * y),
                Err(place) => self.parts.insert(place, (*joint, values.iter().map(|y| factor * y).collect())),
            }
        }
    }

    /// All values times `factor`.
    pub fn scale(&mut self, factor: f64) {
        self.parts.iter_mut().flat_map(|(_, values)| values).for_each(|x| *x *= factor);
    }

    /// The same with zeros in the rows that do not count, `[joint][row]`.
    pub fn masked(&self, valid: &[Vec<bool>]) -> Self {
        let parts = self.parts.iter().map(|(joint, values)| {
            let values = values.iter().zip(&valid[*joint]);
            (*joint, values.map(|(&x, &ok)| if ok { x } else { 0.0 }).collect())
        });
        Column { parts: parts.collect() }
    }

    /// The same on some joints only.
    pub fn only(&self, joints: &[usize]) -> Self {
        Column { parts: self.parts.iter().filter(|(joint, _)| joints.contains(joint)).cloned().collect() }
    }

    /// Whether all values are numbers and not all are zero.
    pub fn is_sound(&self) -> bool {
        !self.parts.is_empty() && self.parts.iter().flat_map(|(_, values)| values).all(|v| v.is_finite())
    }
}

/// The sum of `columns` with their `values`.
pub fn combined(columns: &[Column], values: &[f64]) -> Column {
    let mut sum = Column::default();
    for (column, &value) in columns.iter().zip(values) {
        sum.add(value, column);
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_without_torque_are_left_out() {
        let mut a = Column::new([vec![0.0, 0.0], vec![1.0, 2.0]]);
        let b = Column::new([vec![3.0, 1.0], vec![0.0, 4.0]]);
        assert_eq!(a.parts.len(), 1);
        assert_eq!(a.dot(&b), 8.0);
        a.add(2.0, &b);
        assert_eq!(a.parts, [(0, vec![6.0, 2.0]), (1, vec![1.0, 10.0])]);
        assert_eq!(combined(&[b.clone(), b.clone()], &[1.0, -1.0]).dot(&b), 0.0);
        assert!(!Column::default().is_sound());
    }
}
