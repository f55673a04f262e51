//! Time stepping of the plant: classical Runge-Kutta around rapier's forward dynamics, with the instants at which a joint
//! comes to rest found inside the step; and rapier's own step as a named, deliberately imperfect alternative.

use super::plant::{Contact, Controller, Plant, Response, State};

/// How the plant is stepped through time.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Integrator {
    /// Fourth-order Runge-Kutta around rapier's forward dynamics.
    Rk4,
    /// Rapier's native time step, first order in the step.
    RapierNative,
}

/// Velocity below which a joint counts as having come to rest, rad/s.
const REST: f64 = 1e-12;

/// More comings-to-rest than this within one step are not followed up one by one.
const MOST_EVENTS: usize = 32;

/// The plant in motion: a state, the contacts of its joints and the response at the present instant.
pub struct Run<'a> {
    plant: &'a mut Plant,
    controller: &'a dyn Controller,
    t: f64,
    state: State,
    contacts: Vec<Contact>,
}

impl<'a> Run<'a> {
    /// Starts at time zero in `state`.
    pub fn new(plant: &'a mut Plant, controller: &'a dyn Controller, state: State) -> Self {
        let mut contacts = plant.contacts(&state.qd);
        plant.release(0.0, &state, &mut contacts, controller);
        Run { plant, controller, t: 0.0, state, contacts }
    }

    /// The present state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// What happens at the present instant.
    pub fn response(&mut self) -> Response {
        self.plant.respond(self.t, &self.state, &self.contacts, self.controller)
    }

    /// Advances to time `end` in one step of the integrator; `first` is the response at the present instant.
    pub fn advance(&mut self, integrator: Integrator, first: &Response, end: f64) {
        match integrator {
            Integrator::Rk4 => self.runge_kutta_step(first, end),
            Integrator::RapierNative => self.native_step(first, end),
        }
        self.t = end;
    }

    fn runge_kutta_step(&mut self, first: &Response, end: f64) {
        let mut first = first.clone();
        for _ in 0..MOST_EVENTS {
            let step = end - self.t;
            let next = self.runge_kutta(&first, step);
            let Some(joint) = self.first_reversal(&next) else {
                self.state = next;
                return self.settle(end);
            };
            let (passed, resting, at_rest) = self.find_rest(&first, joint, next, step);
            self.state = at_rest;
            self.stop(resting);
            self.settle(self.t + passed);
            first = self.response();
        }
        self.state = self.runge_kutta(&first, end - self.t);
        self.stop_reversed();
        self.settle(end);
    }

    fn stop(&mut self, joint: usize) {
        self.state.qd[joint] = 0.0;
        self.contacts[joint] = Contact::Stuck;
    }

    /// Brings every joint to rest that has turned round.
    fn stop_reversed(&mut self) {
        while let Some(joint) = self.first_reversal(&self.state) {
            self.stop(joint);
        }
    }

    /// Takes over a new time and lets go of what friction cannot hold there.
    fn settle(&mut self, t: f64) {
        self.t = t;
        self.plant.release(t, &self.state, &mut self.contacts, self.controller);
    }

    /// One Runge-Kutta step of length `h` with the contacts held.
    fn runge_kutta(&mut self, first: &Response, h: f64) -> State {
        let start = self.state.clone();
        let shifted = |base: &[f64], rate: &[f64], by: f64| -> Vec<f64> {
            base.iter().zip(rate).map(|(value, slope)| value + by * slope).collect()
        };
        let mut stage = |velocity: &[f64], acceleration: &[f64], by: f64| -> (Vec<f64>, Vec<f64>) {
            let x = State { q: shifted(&start.q, velocity, by), qd: shifted(&start.qd, acceleration, by) };
            let response = self.plant.respond(self.t + by, &x, &self.contacts, self.controller);
            (x.qd, response.qdd)
        };
        let (v1, a1) = (start.qd.clone(), first.qdd.clone());
        let (v2, a2) = stage(&v1, &a1, h / 2.0);
        let (v3, a3) = stage(&v2, &a2, h / 2.0);
        let (v4, a4) = stage(&v3, &a3, h);
        let mean = |k1: &[f64], k2: &[f64], k3: &[f64], k4: &[f64]| -> Vec<f64> {
            (0..k1.len()).map(|j| (k1[j] + 2.0 * (k2[j] + k3[j]) + k4[j]) / 6.0).collect()
        };
        State {
            q: shifted(&start.q, &mean(&v1, &v2, &v3, &v4), h),
            qd: shifted(&start.qd, &mean(&a1, &a2, &a3, &a4), h),
        }
    }

    /// The sliding joint that has turned round farthest by `next`, if any.
    fn first_reversal(&self, next: &State) -> Option<usize> {
        let against = |joint: usize| match self.contacts[joint] {
            Contact::Forward => -next.qd[joint],
            Contact::Backward => next.qd[joint],
            Contact::Stuck | Contact::Free => f64::NEG_INFINITY,
        };
        (0..next.qd.len()).filter(|&joint| against(joint) > REST).max_by(|&a, &b| against(a).total_cmp(&against(b)))
    }

    /// Length of the step, below `h`, after which the first sliding joint comes to rest, with that joint and the state
    /// there. Every trial step that reverses a joint becomes the new upper end, so the earliest reversal is found
    /// (bisection, with regula falsi once a single joint is in question).
    fn find_rest(&mut self, first: &Response, mut joint: usize, mut high_state: State, h: f64) -> (f64, usize, State) {
        let (mut low, mut high) = (0.0, h);
        let mut low_state = self.state.clone();
        for turn in 0..60 {
            let (slow, fast) = (low_state.qd[joint].abs(), high_state.qd[joint].abs());
            let middle = if turn % 3 == 2 { 0.5 * (low + high) } else { low + (high - low) * slow / (slow + fast) };
            let trial = self.runge_kutta(first, middle);
            match self.first_reversal(&trial) {
                Some(other) => (joint, high, high_state) = (other, middle, trial),
                None if trial.qd[joint].abs() <= REST => return (middle, joint, trial),
                None => (low, low_state) = (middle, trial),
            }
            if high - low <= f64::EPSILON * self.t.max(h) {
                break;
            }
        }
        (high, joint, high_state)
    }

    fn native_step(&mut self, first: &Response, end: f64) {
        let net: Vec<f64> = first.tau.iter().zip(&first.friction).map(|(motor, law)| motor - law).collect();
        let h = end - self.t;
        let before = self.state.clone();
        let State { q, qd } = &mut self.state;
        self.plant.arm.native_step(q, qd, &net, h);
        for joint in 0..before.q.len() {
            if self.contacts[joint] == Contact::Stuck {
                self.state.q[joint] = before.q[joint];
                self.state.qd[joint] = 0.0;
            }
        }
        self.stop_reversed();
        self.settle(end);
    }
}
