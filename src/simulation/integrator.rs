//! Time stepping of the plant: classical Runge-Kutta around rapier's forward dynamics, with the instants at which a joint
//! comes to rest found inside the step; and rapier's own step as a named, deliberately imperfect alternative.

use super::plant::{Contact, Controller, Memory, Plant, Response, State};

/// How the plant is stepped through time.
///
/// ```
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::{Controller, Plant, State};
/// use tauscope::simulation::integrator::{Integrator, Run};
/// # struct Off;
/// # impl Controller for Off {
/// #     fn torque(&self, _: f64, _: &[f64], _: &[f64], tau: &mut [f64]) { tau.fill(0.0); }
/// # }
/// # let mut robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // A pendulum without friction and motor: its energy stays over 1 s of Runge-Kutta steps of 5 ms.
/// let energy = |state: &State| 0.5 * 0.77 * state.qd[0].powi(2) - 9.81 * state.q[0].cos();
/// let lost = |integrator| {
///     let mut plant = Plant::new(&robot, Vec::new())?;
///     let mut run = Run::new(&mut plant, &Off, State::new(vec![0.5], vec![0.0]));
///     for k in 1..=200 {
///         let now = run.response();
///         run.advance(integrator, &now, 5e-3 * f64::from(k));
///     }
///     Ok::<_, tauscope::error::Error>((energy(run.state()) + 9.81 * 0.5f64.cos()).abs())
/// };
/// assert!(lost(Integrator::Rk4)? < 1e-6 && lost(Integrator::RapierNative)? > 1e-4);
/// # let _ = &mut robot;
/// # Ok::<(), tauscope::error::Error>(())
/// ```
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
///
/// ```
/// use tauscope::robot::{self, InertiaCheck};
/// use tauscope::simulation::plant::{Controller, Plant, State};
/// use tauscope::simulation::integrator::{Integrator, Run};
/// # struct Off;
/// # impl Controller for Off {
/// #     fn torque(&self, _: f64, _: &[f64], _: &[f64], tau: &mut [f64]) { tau.fill(0.0); }
/// # }
/// # let mut robot = robot::load("tests/reference/pendulum.urdf", InertiaCheck::Required)?;
///
/// // Let go at 0.1 rad without friction and motor, it is on the other side after pi sqrt((I + Ia) / m g l).
/// let mut plant = Plant::new(&robot, Vec::new())?;
/// let mut run = Run::new(&mut plant, &Off, State::new(vec![0.1], vec![0.0]));
/// let half = std::f64::consts::PI * ((0.17 + 0.5 + 0.1f64) / 9.81).sqrt();
/// for k in 1..=1000 {
///     let now = run.response();
///     run.advance(Integrator::Rk4, &now, 1e-3 * half * f64::from(k));
/// }
/// assert!((run.state().q[0] + 0.1).abs() < 1e-4);
/// # let _ = &mut robot;
/// # Ok::<(), tauscope::error::Error>(())
/// ```
pub struct Run<'a> {
    plant: &'a mut Plant,
    controller: &'a dyn Controller,
    t: f64,
    state: State,
    contacts: Vec<Contact>,
    memory: Memory,
}

impl<'a> Run<'a> {
    /// Starts at time zero in `state`.
    pub fn new(plant: &'a mut Plant, controller: &'a dyn Controller, state: State) -> Self {
        Self::starting_at(0.0, plant, controller, state)
    }

    /// Starts at time `t` in `state`.
    pub fn starting_at(t: f64, plant: &'a mut Plant, controller: &'a dyn Controller, state: State) -> Self {
        plant.started = t;
        let mut contacts = plant.contacts(&state.qd);
        let memory = plant.fresh_memory();
        plant.release(t, &state, &memory, &mut contacts, controller);
        Run { plant, controller, t, state, contacts, memory }
    }

    /// The present state.
    pub fn state(&self) -> &State {
        &self.state
    }

    /// What happens at the present instant.
    pub fn response(&mut self) -> Response {
        self.plant.respond(self.t, &self.state, &self.memory, &self.contacts, self.controller)
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
                return self.arrive(next, step, end, |_| {});
            };
            let (passed, resting, at_rest) = self.find_rest(&first, joint, next, step);
            self.arrive(at_rest, passed, self.t + passed, |run| run.stop(resting));
            first = self.response();
        }
        let step = end - self.t;
        let next = self.runge_kutta(&first, step);
        self.arrive(next, step, end, Self::stop_reversed);
    }

    /// Takes over the state after `passed` seconds, brings to rest what must rest, and lets go of what friction cannot hold.
    fn arrive(&mut self, next: State, passed: f64, t: f64, stop: impl FnOnce(&mut Self)) {
        self.memory = self.plant.remember(&self.memory, self.t, &self.state, &next, passed);
        self.state = next;
        stop(self);
        self.t = t;
        self.plant.release(t, &self.state, &self.memory, &mut self.contacts, self.controller);
    }

    fn stop(&mut self, joint: usize) {
        self.state.qd[joint] = 0.0;
        if self.plant.is_rigid(joint) {
            self.state.link_qd[joint] = 0.0;
        }
        self.contacts[joint] = Contact::Stuck;
    }

    /// Brings every joint to rest that has reversed.
    fn stop_reversed(&mut self) {
        while let Some(joint) = self.first_reversal(&self.state) {
            self.stop(joint);
        }
    }

    /// One Runge-Kutta step of length `h` with the contacts held.
    fn runge_kutta(&mut self, first: &Response, h: f64) -> State {
        let start = self.state.clone();
        let mut stage = |rate: &Rate, by: f64| -> Rate {
            let x = rate.applied(&start, by);
            let memory = self.plant.remember(&self.memory, self.t, &start, &x, by);
            let response = self.plant.respond(self.t + by, &x, &memory, &self.contacts, self.controller);
            Rate::new(&x, response)
        };
        let one = Rate::new(&start, first.clone());
        let two = stage(&one, h / 2.0);
        let three = stage(&two, h / 2.0);
        let four = stage(&three, h);
        Rate::mean([&one, &two, &three, &four]).applied(&start, h)
    }

    /// The sliding joint that has reversed farthest by `next`, if any.
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

    /// Rapier's own step, where rapier is the engine. It knows no elastic gears: such scenarios are refused before they run.
    fn native_step(&mut self, first: &Response, end: f64) {
        let net: Vec<f64> = first.tau.iter().zip(&first.friction).map(|(motor, law)| motor - law).collect();
        let step = end - self.t;
        let (mut q, mut qd) = (self.state.q.clone(), self.state.qd.clone());
        let Some(arm) = self.plant.arm.rapier() else { return self.runge_kutta_step(first, end) };
        arm.native_step(&mut q, &mut qd, &net, step);
        for joint in (0..q.len()).filter(|&joint| self.contacts[joint] == Contact::Stuck) {
            q[joint] = self.state.q[joint];
            qd[joint] = 0.0;
        }
        self.arrive(State::new(q, qd), step, end, Self::stop_reversed);
    }
}

/// Time derivative of a [`State`].
struct Rate {
    qd: Vec<f64>,
    qdd: Vec<f64>,
    link_qd: Vec<f64>,
    link_qdd: Vec<f64>,
}

impl Rate {
    fn new(x: &State, response: Response) -> Self {
        Rate { qd: x.qd.clone(), qdd: response.qdd, link_qd: x.link_qd.clone(), link_qdd: response.link_qdd }
    }

    /// The state `by` seconds after `start` at this rate.
    fn applied(&self, start: &State, by: f64) -> State {
        let moved = |base: &[f64], rate: &[f64]| -> Vec<f64> {
            base.iter().zip(rate).map(|(value, slope)| value + by * slope).collect()
        };
        State {
            q: moved(&start.q, &self.qd),
            qd: moved(&start.qd, &self.qdd),
            link_q: moved(&start.link_q, &self.link_qd),
            link_qd: moved(&start.link_qd, &self.link_qdd),
        }
    }

    /// The Runge-Kutta mean of the four stages.
    fn mean(stages: [&Rate; 4]) -> Rate {
        let mean = |pick: fn(&Rate) -> &Vec<f64>| -> Vec<f64> {
            let [one, two, three, four] = stages.map(pick);
            (0..one.len()).map(|j| (one[j] + 2.0 * (two[j] + three[j]) + four[j]) / 6.0).collect()
        };
        Rate {
            qd: mean(|r| &r.qd),
            qdd: mean(|r| &r.qdd),
            link_qd: mean(|r| &r.link_qd),
            link_qdd: mean(|r| &r.link_qdd),
        }
    }
}
