//! The model with all effects found, its columns held, so that any of them can be left out and the rest fitted again at once.

use super::blocks::BlockProducts;
use crate::diagnosis::model::{DataSet, Member, ParameterBlocks, Session};
use crate::diagnosis::noise::Whitener;
use crate::diagnosis::regression::{Column, Described, Solved, combined, is_constant};
use crate::diagnosis::variance::{random_effects, torques};
use crate::error::Result;
use nalgebra::DMatrix;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, FisherSnedecor};
use std::collections::HashMap;
use std::ops::Range;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};

/// Columns of a model along the training and the held-out logs.
#[derive(Debug)]
pub(super) struct HeldFit<'a> {
    session: &'a Session<'a>,
    /// Columns along the training logs: baseline, every member's, and last every member's torque as found.
    train: Vec<Column>,
    /// The same under the noise.
    white: Vec<Column>,
    /// The same along the held-out logs.
    test: Vec<Column>,
    /// Places of the columns of the baseline and of each member.
    blocks: ParameterBlocks,
    /// Places of every member's torque as found.
    torques: Range<usize>,
    /// What the description says of the baseline's parameters.
    described: Vec<Described>,
    products: BlockProducts,
    /// The noise on the training logs.
    whitener: &'a Whitener,
    /// Torque of the arm along the training logs, `[joint][row]`, N m, once it is asked for.
    of_arm: OnceLock<Vec<Vec<f64>>>,
    /// Inner products with the structure of a joint, as far as they were worked out: an elimination on one joint leaves those of the others.
    of_structure: Mutex<HashMap<ModelOfJoint, Arc<Vec<Vec<f64>>>>>,
}

/// A joint and the places of the columns of a model that have torque there.
type ModelOfJoint = (usize, Vec<usize>);

impl<'a> HeldFit<'a> {
    /// The model with `members` under the noise of `whitener`.
    ///
    /// # Errors
    /// If a log is too short to differentiate.
    pub(super) fn new(session: &'a Session<'a>, members: &[Member], whitener: &'a Whitener) -> Result<Self> {
        let blocks = session.blocks(members);
        let with_torques = |data: &DataSet| -> Result<Vec<Column>> {
            let mut columns = session.model.columns(data, members)?;
            for (member, block) in members.iter().zip(&blocks.members) {
                columns.push(combined(&columns[block.amplitudes.clone()], &member.factors));
            }
            Ok(columns)
        };
        let (train, test) = (with_torques(&session.logs.train)?, with_torques(&session.logs.test)?);
        let white = whitener.apply_all(&train);
        let products =
            BlockProducts::new(&session.logs.train.rows, whitener, &white, &whitener.apply(&session.logs.train.torque));
        let torques = blocks.end()..blocks.end() + members.len();
        let described = session.model.described(&session.logs.train);
        Ok(HeldFit {
            session,
            train,
            white,
            test,
            blocks,
            torques,
            described,
            products,
            whitener,
            of_arm: OnceLock::new(),
            of_structure: Mutex::default(),
        })
    }

    /// Places of the baseline's columns and of those of the members at `kept`.
    pub(super) fn places(&self, kept: &[usize]) -> Vec<usize> {
        let members = kept.iter().flat_map(|&member| self.blocks.members[member].all());
        self.blocks.baseline.clone().chain(members).collect()
    }

    /// Places of all columns of a member, with those of its shapes.
    pub(super) fn columns_of(&self, member: usize) -> Range<usize> {
        self.blocks.members[member].all()
    }

    /// Places of the columns of a member's law.
    pub(super) fn law(&self, member: usize) -> Range<usize> {
        self.blocks.members[member].amplitudes.clone()
    }

    /// Torque of a member as found along the training logs.
    pub(super) fn torque(&self, member: usize) -> &Column {
        &self.train[self.torques.start + member]
    }

    /// Whether the law of a member is a constant torque on a joint along the held-out logs.
    pub(super) fn is_offset(&self, member: usize, joint: usize) -> bool {
        self.test[self.law(member)].iter().filter_map(|column| column.part(joint)).all(is_constant)
    }

    /// Residuals along the training and the held-out logs of the model with the members at `kept`, fitted as all models are
    /// ([`Session::solved`]).
    pub(super) fn residuals(&self, kept: &[usize]) -> [Column; 2] {
        let places = self.places(kept);
        let Solved { values, .. } = self.products.solved(&places).with_described(&self.described);
        [(&self.session.logs.train, &self.train), (&self.session.logs.test, &self.test)].map(|(data, columns)| {
            let mut residual = data.torque.clone();
            places.iter().zip(values.iter()).for_each(|(&place, value)| residual.add(-value, &columns[place]));
            residual
        })
    }

    /// Standard deviations by the scatter between blocks of the factors of each member at `kept`, in the order of its columns; None where
    /// there are too few blocks.
    pub(super) fn scatters(&self, kept: &[usize]) -> Option<Vec<Vec<f64>>> {
        let estimates = self.products.estimates(&self.places(kept));
        let mut place = self.blocks.baseline.end;
        kept.iter()
            .map(|&member| {
                let own = place..place + self.blocks.members[member].all().len();
                place = own.end;
                own.map(|place| Some(estimates.scatter(place)?.0)).collect()
            })
            .collect()
    }

    /// Inner products of all columns with the structure of the residual of the model with the members at `kept`: generic functions of each
    /// joint as random effects, in columns.
    pub(super) fn structure(&self, kept: &[usize]) -> DMatrix<f64> {
        let rows = &self.session.logs.train.rows;
        let places = self.places(kept);
        let joints = (0..rows.dof()).into_par_iter().filter(|&joint| rows.valid[joint].contains(&true));
        let each: Vec<Arc<Vec<Vec<f64>>>> = joints.map(|joint| self.structure_on(joint, &places)).collect();
        let products: Vec<&Vec<f64>> = each.iter().flat_map(|products| products.iter()).collect();
        DMatrix::from_fn(self.white.len(), products.len(), |column, effect| products[effect][column])
    }

    /// The same on one joint, `[effect][column]`, of the model with the columns at `places`.
    fn structure_on(&self, joint: usize, places: &[usize]) -> Arc<Vec<Vec<f64>>> {
        let has_torque = |place: &usize| self.train[*place].part(joint).is_some();
        let model: ModelOfJoint = (joint, places.iter().copied().filter(has_torque).collect());
        if let Some(known) = self.known_structure().get(&model) {
            return known.clone();
        }
        let train = &self.session.logs.train;
        let of_arm = self.of_arm.get_or_init(|| torques(&self.session.model.arm, &train.rows));
        let fixed: Vec<Column> = model.1.iter().map(|&place| self.train[place].clone()).collect();
        let effects = self.whitener.apply_all(&random_effects(&train.rows, &train.torque, &fixed, of_arm, joint));
        let products = |effect: &Column| self.white.iter().map(|column| column.dot(effect)).collect();
        let products: Arc<Vec<Vec<f64>>> = Arc::new(effects.iter().map(products).collect());
        self.known_structure().insert(model, products.clone());
        products
    }

    fn known_structure(&self) -> MutexGuard<'_, HashMap<ModelOfJoint, Arc<Vec<Vec<f64>>>>> {
        self.of_structure.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Variances that `structure` adds to the factors of each member at `kept`, in the order of its columns.
    pub(super) fn variances_by_structure(&self, kept: &[usize], structure: &DMatrix<f64>) -> Option<Vec<Vec<f64>>> {
        let places = self.places(kept);
        let covariance = self.products.covariance(&places, structure.select_rows(&places), 0.0)?;
        let mut place = self.blocks.baseline.end;
        let each = kept.iter().map(|&member| {
            let own = place..place + self.blocks.members[member].all().len();
            place = own.end;
            own.map(|place| covariance[(place, place)]).collect()
        });
        Some(each.collect())
    }

    /// p-value of the factors of the law of the member at `kept[index]` under noise and `structure`, with its shapes held, by a Wald test; None
    /// where there are too few blocks for the degrees of freedom.
    pub(super) fn structure_p(&self, kept: &[usize], index: usize, structure: &DMatrix<f64>) -> Option<f64> {
        let others: Vec<usize> = kept.iter().copied().filter(|&member| member != kept[index]).collect();
        let (mut places, law) = (self.places(&others), self.law(kept[index]));
        let own = places.len()..places.len() + law.len();
        places.extend(law);
        let covariance = self.products.covariance(&places, structure.select_rows(&places), 1.0)?;
        let covariance = covariance.view((own.start, own.start), (own.len(), own.len())).into_owned();
        let factors = self.products.estimates(&places).values.rows(own.start, own.len()).into_owned();
        let count = own.len() as f64;
        let statistic = factors.dot(&covariance.cholesky()?.solve(&factors)) / count;
        let law = FisherSnedecor::new(count, self.products.freedom()?).ok()?;
        Some(law.sf(statistic))
    }

    /// Strength of the member at `kept[index]` in units of what was found, with its standard deviation by the scatter between blocks and
    /// the degrees of freedom of that: its shapes are held, all else in the model is free. None where there are too few blocks.
    pub(super) fn strength(&self, kept: &[usize], index: usize) -> Option<[f64; 3]> {
        let others: Vec<usize> = kept.iter().copied().filter(|&member| member != kept[index]).collect();
        let mut places = self.places(&others);
        places.push(self.torques.start + kept[index]);
        let estimates = self.products.estimates(&places);
        let (std, freedom) = estimates.scatter(places.len() - 1)?;
        Some([estimates.values[places.len() - 1], std, freedom])
    }
}
