//! An orthonormal basis of columns, held joint by joint so that inner products are products of matrices.

use super::column::{Column, joints_of, parts_on};
use super::factors::JointFactors;
use crate::linear::{product_of, subtract_product};
use nalgebra::DMatrix;
use std::collections::BTreeMap;
use std::sync::Arc;

/// Directions of unit length, orthogonal to each other. Those that were there stay as they are when more come, and are shared by all bases
/// that have them.
#[derive(Debug, Clone, Default)]
pub(super) struct Basis {
    /// The first directions, those of a model, over the directions of every joint.
    model: Arc<Vec<Mixed>>,
    blocks: Vec<Arc<Block>>,
    /// Values of every direction in rows of no joint.
    beforehand: Vec<Vec<f64>>,
}

/// Directions of a model on one joint: sums of those of the joint.
#[derive(Debug)]
pub(super) struct Mixed {
    /// The joint.
    pub joint: usize,
    /// Its directions.
    pub factors: Arc<JointFactors>,
    /// Parts of the directions of the model along those of the joint, `[of joint][of model]`.
    pub mix: DMatrix<f64>,
}

/// Directions that came together, on one joint.
#[derive(Debug)]
struct Block {
    joint: usize,
    rows: usize,
    /// Which they are.
    places: Vec<usize>,
    /// Their values, one direction after the other.
    values: Vec<f64>,
}

impl Basis {
    /// The `count` directions of a model.
    pub(super) fn of_model(model: Vec<Mixed>, count: usize) -> Self {
        Basis { model: Arc::new(model), blocks: Vec::new(), beforehand: vec![Vec::new(); count] }
    }

    /// Number of directions.
    pub(super) fn len(&self) -> usize {
        self.beforehand.len()
    }

    /// Inner products, `[direction][column]`.
    pub(super) fn along(&self, columns: &[Column]) -> DMatrix<f64> {
        let mut along = DMatrix::zeros(self.len(), columns.len());
        for (joint, OnJoint { mixed, blocks }) in self.by_joint() {
            let (own, values) = on_joint(columns, joint);
            if own.is_empty() {
                continue;
            }
            if let Some(Mixed { factors, mix, .. }) = mixed {
                let parts = product_of(factors.directions(), &values, factors.rows(), [mix.nrows(), own.len()]);
                let parts = mix.tr_mul(&parts);
                for (c, &column) in own.iter().enumerate() {
                    let mut along = along.view_mut((0, column), (parts.nrows(), 1));
                    along += parts.column(c);
                }
            }
            for block in blocks {
                let product = product_of(&block.values, &values, block.rows, [block.places.len(), own.len()]);
                for (c, &column) in own.iter().enumerate() {
                    for (r, &place) in block.places.iter().enumerate() {
                        along[(place, column)] += product[(r, c)];
                    }
                }
            }
        }
        for (place, known) in self.beforehand.iter().enumerate().filter(|(_, known)| !known.is_empty()) {
            for (c, column) in columns.iter().enumerate() {
                along[(place, c)] += known.iter().zip(&column.beforehand).map(|(a, b)| a * b).sum::<f64>();
            }
        }
        along
    }

    /// Takes from every column its parts `along` the directions.
    pub(super) fn subtract(&self, columns: &mut [Column], along: &DMatrix<f64>) {
        for (joint, OnJoint { mixed, blocks }) in self.by_joint() {
            let of_model = mixed.map_or(0, |mixed| mixed.mix.ncols());
            let acts = |column: usize| {
                let places = blocks.iter().flat_map(|block| block.places.iter().copied()).chain(0..of_model);
                places.into_iter().any(|place| along[(place, column)] != 0.0)
            };
            let touched: Vec<usize> = (0..columns.len()).filter(|&column| acts(column)).collect();
            let rows = mixed.map(|mixed| mixed.factors.rows()).or(blocks.first().map(|block| block.rows));
            let Some(rows) = rows.filter(|_| !touched.is_empty()) else { continue };
            let mut parts: Vec<f64> = Vec::with_capacity(rows * touched.len());
            for &column in &touched {
                parts.extend_from_slice(columns[column].part_mut(joint, rows));
            }
            let along = along.select_columns(&touched);
            if let Some(Mixed { factors, mix, .. }) = mixed {
                subtract_product(&mut parts, factors.directions(), rows, &(mix * along.rows(0, of_model)));
            }
            for block in blocks {
                subtract_product(&mut parts, &block.values, rows, &along.select_rows(&block.places));
            }
            for (&column, left) in touched.iter().zip(parts.chunks_exact(rows.max(1))) {
                columns[column].part_mut(joint, rows).copy_from_slice(left);
            }
        }
        for (place, known) in self.beforehand.iter().enumerate().filter(|(_, known)| !known.is_empty()) {
            for (c, column) in columns.iter_mut().enumerate().filter(|(c, _)| along[(place, *c)] != 0.0) {
                column.beforehand.resize(column.beforehand.len().max(known.len()), 0.0);
                column.beforehand.iter_mut().zip(known).for_each(|(x, y)| *x -= along[(place, c)] * y);
            }
        }
    }

    /// Adds directions of unit length that are orthogonal to all and to each other.
    pub(super) fn extend(&mut self, directions: Vec<Column>) {
        for joint in joints_of(&directions) {
            let (own, values) = on_joint(&directions, joint);
            let (rows, places) = (values.len() / own.len(), own.into_iter().map(|place| self.len() + place).collect());
            self.blocks.push(Arc::new(Block { joint, rows, places, values }));
        }
        self.beforehand.extend(directions.into_iter().map(|direction| direction.beforehand));
    }

    /// The directions as columns.
    pub(super) fn columns(&self) -> Vec<Column> {
        let mut columns: Vec<Column> =
            self.beforehand.iter().map(|known| Column { parts: Vec::new(), beforehand: known.clone() }).collect();
        for Mixed { joint, factors, mix } in self.model.iter() {
            let mut parts = vec![0.0; factors.rows() * mix.ncols()];
            subtract_product(&mut parts, factors.directions(), factors.rows(), &-mix);
            for (column, values) in columns.iter_mut().zip(parts.chunks_exact(factors.rows().max(1))) {
                if values.iter().any(|&x| x != 0.0) {
                    column.parts.push((*joint, values.to_vec()));
                }
            }
        }
        for block in &self.blocks {
            for (&place, values) in block.places.iter().zip(block.values.chunks_exact(block.rows.max(1))) {
                columns[place].parts.push((block.joint, values.to_vec()));
            }
        }
        columns.iter_mut().for_each(|column| column.parts.sort_by_key(|(joint, _)| *joint));
        columns
    }

    /// The directions of each joint.
    fn by_joint(&self) -> BTreeMap<usize, OnJoint<'_>> {
        let mut joints: BTreeMap<usize, OnJoint> = BTreeMap::new();
        for mixed in self.model.iter() {
            joints.entry(mixed.joint).or_default().mixed = Some(mixed);
        }
        for block in &self.blocks {
            joints.entry(block.joint).or_default().blocks.push(block);
        }
        joints
    }
}

/// Directions on one joint.
#[derive(Default)]
struct OnJoint<'a> {
    mixed: Option<&'a Mixed>,
    blocks: Vec<&'a Block>,
}

/// Which of `columns` act on a joint, and their values there, one column after the other.
pub(super) fn on_joint(columns: &[Column], joint: usize) -> (Vec<usize>, Vec<f64>) {
    let (places, parts) = parts_on(columns, joint);
    (places, parts.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_along_the_directions_are_taken() {
        let half = 0.5f64.sqrt();
        let mut basis = Basis::default();
        basis.extend(vec![Column::of(vec![(0, vec![half, 0.0]), (2, vec![half, 0.0])])]);
        basis.extend(vec![Column { parts: vec![(2, vec![0.0, half])], beforehand: vec![half] }]);
        let mut columns = [
            Column::on(0, vec![2.0, 3.0]),
            Column { parts: vec![(2, vec![0.0, 4.0])], beforehand: vec![0.0, 5.0] },
            Column::on(1, vec![7.0, 7.0]),
        ];
        let along = basis.along(&columns);
        let expected = DMatrix::from_row_slice(2, 3, &[2.0 * half, 0.0, 0.0, 0.0, 4.0 * half, 0.0]);
        assert!((&along - expected).norm() < 1e-15);
        basis.subtract(&mut columns, &along);
        assert!(basis.along(&columns).norm() < 1e-15);
        assert_eq!(columns[2], Column::on(1, vec![7.0, 7.0]));
        assert!((columns[0].part(2).unwrap()[0] + 1.0).abs() < 1e-15);
        assert!((columns[1].beforehand[0] + 2.0).abs() < 1e-15 && columns[1].beforehand[1] == 5.0);
        assert_eq!(basis.columns()[0].parts.len(), 2);
    }
}
