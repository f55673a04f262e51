//! An orthonormal basis of columns, held joint by joint so that inner products are products of matrices.

use super::column::Column;
use nalgebra::{DMatrix, DMatrixView};

/// Directions of unit length, orthogonal to each other.
#[derive(Debug, Clone, Default)]
pub(super) struct Basis {
    blocks: Vec<Block>,
    /// Values of every direction in rows of no joint.
    beforehand: Vec<Vec<f64>>,
}

/// The directions that act on one joint.
#[derive(Debug, Clone)]
struct Block {
    joint: usize,
    rows: usize,
    /// Which they are.
    places: Vec<usize>,
    /// Their values, one direction after the other.
    values: Vec<f64>,
}

impl Block {
    fn matrix(&self) -> DMatrixView<'_, f64> {
        DMatrixView::from_slice(&self.values, self.rows, self.places.len())
    }
}

impl Basis {
    /// Number of directions.
    pub fn len(&self) -> usize {
        self.beforehand.len()
    }

    /// Inner products, `[direction][column]`.
    pub fn along(&self, columns: &[Column]) -> DMatrix<f64> {
        let mut along = DMatrix::zeros(self.len(), columns.len());
        for block in &self.blocks {
            let (own, values) = on_joint(columns, block.joint);
            if own.is_empty() {
                continue;
            }
            let product = block.matrix().tr_mul(&DMatrixView::from_slice(&values, block.rows, own.len()));
            for (c, &column) in own.iter().enumerate() {
                for (r, &place) in block.places.iter().enumerate() {
                    along[(place, column)] += product[(r, c)];
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
    pub fn subtract(&self, columns: &mut [Column], along: &DMatrix<f64>) {
        for block in &self.blocks {
            let own = along.select_rows(&block.places);
            let product = block.matrix() * &own;
            for (c, column) in columns.iter_mut().enumerate() {
                if own.column(c).iter().any(|&x| x != 0.0) {
                    let part = column.part_mut(block.joint, block.rows);
                    part.iter_mut().zip(&product.column(c)).for_each(|(x, y)| *x -= y);
                }
            }
        }
        for (place, known) in self.beforehand.iter().enumerate().filter(|(_, known)| !known.is_empty()) {
            for (c, column) in columns.iter_mut().enumerate().filter(|(c, _)| along[(place, *c)] != 0.0) {
                column.beforehand.resize(column.beforehand.len().max(known.len()), 0.0);
                column.beforehand.iter_mut().zip(known).for_each(|(x, y)| *x -= along[(place, c)] * y);
            }
        }
    }

    /// Adds a direction of unit length that is orthogonal to all.
    pub fn push(&mut self, direction: Column) {
        let place = self.len();
        for (joint, values) in direction.parts {
            let found = self.blocks.iter().position(|block| block.joint == joint);
            let found = found.unwrap_or_else(|| {
                let rows = values.len();
                self.blocks.push(Block { joint, rows, places: Vec::new(), values: Vec::new() });
                self.blocks.len() - 1
            });
            self.blocks[found].places.push(place);
            self.blocks[found].values.extend(values);
        }
        self.beforehand.push(direction.beforehand);
    }

    /// The directions as columns.
    pub fn columns(&self) -> Vec<Column> {
        let mut columns: Vec<Column> =
            self.beforehand.iter().map(|known| Column { parts: Vec::new(), beforehand: known.clone() }).collect();
        for block in &self.blocks {
            for (&place, values) in block.places.iter().zip(block.values.chunks_exact(block.rows.max(1))) {
                columns[place].parts.push((block.joint, values.to_vec()));
            }
        }
        columns.iter_mut().for_each(|column| column.parts.sort_by_key(|(joint, _)| *joint));
        columns
    }
}

/// Which of `columns` act on a joint, and their values there, one column after the other.
pub(super) fn on_joint(columns: &[Column], joint: usize) -> (Vec<usize>, Vec<f64>) {
    let own = columns.iter().enumerate().filter_map(|(place, column)| Some((place, column.part(joint)?)));
    let (places, parts): (Vec<usize>, Vec<&[f64]>) = own.unzip();
    (places, parts.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_along_the_directions_are_taken() {
        let half = 0.5f64.sqrt();
        let mut basis = Basis::default();
        basis.push(Column::of(vec![(0, vec![half, 0.0]), (2, vec![half, 0.0])]));
        basis.push(Column { parts: vec![(2, vec![0.0, half])], beforehand: vec![half] });
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
