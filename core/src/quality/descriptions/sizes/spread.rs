//! How well the logs determine a direction of gravity: the directions around it under which the torques are explained not clearly worse.
//!
//! A short motion between few poses leaves a flat valley, in which many directions are about as good. The best of them is one draw of the
//! noise; what is known is the set.

use super::super::change::Change;
use super::super::compare::compare;
use super::super::fitting::{Physics, Rows};
use super::super::tried::Tried;
use super::super::verdict::Spread;
use super::tilt;
use nalgebra::Vector3;
use rayon::prelude::*;
use std::f64::consts::TAU;

/// Angles from the best direction at which others are tried, degrees, and sides to which.
const ANGLES: [f64; 7] = [2.0, 4.0, 6.0, 8.0, 12.0, 18.0, FARTHEST];
const FARTHEST: f64 = 25.0;
const SIDES: usize = 12;

/// Directions this near are one, degrees.
const SAME: f64 = 0.01;

/// The directions around that of a description; none where it changes no direction. `described` is that of the robot's file.
pub(crate) fn around(physics: &Physics, rows: &Rows, best: &Tried, described: Vector3<f64>) -> Option<Spread> {
    let description = &best.description;
    let size = description.gravity.norm();
    if size == 0.0 || !description.changes.iter().any(|change| matches!(change, Change::Gravity(_))) {
        return None;
    }
    let center = description.gravity / size;
    let is_as_good = |direction: &Vector3<f64>| {
        let other = Tried::new(physics, rows, description.with_gravity(direction * size));
        let loss = other.and_then(|other| compare(&other.evaluation, &best.evaluation, &rows.log));
        loss.is_some_and(|loss| !loss.is_distinct())
    };
    // A valley is convex about its lowest place: what lies behind a direction that is worse is another valley.
    let reach = |side: usize| {
        let side = TAU * side as f64 / SIDES as f64;
        let as_good = |angle: &&f64| is_as_good(&tilt::turned(&center, angle.to_radians(), side));
        ANGLES.iter().take_while(as_good).count()
    };
    let reached = (0..SIDES).into_par_iter().map(reach).max().unwrap_or(0);
    // The limit is between the last direction that is as good and the next.
    let degrees = ANGLES.get(reached).copied().unwrap_or(f64::INFINITY);
    let nearby = degrees.min(FARTHEST);
    let named = tilt::axes().chain(described.try_normalize(0.0));
    let others = named.filter(|named| !tilt::within(named, &center, SAME) && tilt::within(named, &center, nearby));
    let mut includes: Vec<[f64; 3]> = Vec::new();
    for direction in others.filter(is_as_good) {
        let gravity: [f64; 3] = (direction * size).into();
        if !includes.contains(&gravity) {
            includes.push(gravity);
        }
    }
    let along_an_axis = tilt::axes().any(|axis| tilt::within(&axis, &center, SAME));
    Some(Spread { degrees, includes, along_an_axis })
}
