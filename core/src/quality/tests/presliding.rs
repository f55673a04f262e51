//! Friction that builds up after reversals and torques that come late: of point-to-point motions both look alike.

use super::*;

/// A log of moves from point to point, of joints whose friction, half of the torque, builds up over some mrad, with torques that come
/// `late` samples behind the motion.
fn point_to_point(late: usize) -> Sieved {
    let (robot, rate_hz, seconds) = (irb(), 200.0, 25.0);
    let samples = (rate_hz * seconds) as usize;
    let mut random = random::stream(3, "presliding", 0);
    let mut motion = Motion::zeros(robot.dof(), samples);
    let middle: Vec<f64> = robot.joints.iter().map(|joint| 0.5 * (joint.limits.lower + joint.limits.upper)).collect();
    let mut at = middle.clone();
    let mut sample = 0;
    while sample < samples {
        let to: Vec<f64> = middle.iter().map(|middle| middle + random.random_range(-1.1..1.1)).collect();
        let far = at.iter().zip(&to).map(|(from, to)| (to - from).abs()).fold(0.0, f64::max);
        // Peak speed 1.9 times the mean one.
        let (moves, rests) = ((1.9 * far / 1.2).max(0.3), random.random_range(0.1..0.6));
        for step in 0..((moves + rests) * rate_hz) as usize {
            if sample == samples {
                break;
            }
            let s = (step as f64 / rate_hz / moves).min(1.0);
            let path = s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s);
            let speed = 30.0 * s * s * (1.0 - s).powi(2) / moves;
            let acceleration = 60.0 * s * (1.0 - s) * (1.0 - 2.0 * s) / moves.powi(2);
            for j in 0..robot.dof() {
                motion.q.channel_mut(j)[sample] = at[j] + path * (to[j] - at[j]);
                motion.qd.channel_mut(j)[sample] = speed * (to[j] - at[j]);
                motion.qdd.channel_mut(j)[sample] = acceleration * (to[j] - at[j]);
            }
            sample += 1;
        }
        at = to;
    }
    let bodies = inverse_dynamics(&Chain::new(&robot), &robot.inertial_parameters(), &motion);
    let mut normal = || -> f64 { StandardNormal.sample(&mut random) };
    let (mut tau, mut q) = (bodies.clone(), motion.q.clone());
    for j in 0..robot.dof() {
        let size = root_mean_square(bodies.channel(j));
        let mut bent: f64 = 0.0;
        let torque: Vec<f64> = (0..samples)
            .map(|i| {
                let v = motion.qd.channel(j)[i];
                bent = (bent + v / rate_hz / 2e-3).clamp(-1.0, 1.0);
                bodies.channel(j)[i] + 0.5 * size * (bent + 0.5 * v) + 0.02 * size * normal()
            })
            .collect();
        for i in 0..samples {
            tau.channel_mut(j)[i] = torque[i.saturating_sub(late)];
            q.channel_mut(j)[i] += 2e-5 * normal();
        }
    }
    let time = (0..samples).map(|i| i as f64 / rate_hz).collect();
    let recording = Recording { joints: robot.joint_names(), time, q, qd: None, tau, ..Recording::default() };
    Sieved { lines: (2..samples + 2).collect(), recording, ..Sieved::default() }
}

#[test]
fn friction_that_builds_up_is_no_late_torque() {
    let told = |late: usize| {
        let report = examine(&point_to_point(late), Some(&irb())).unwrap();
        let findings = report.findings.into_iter().filter(|finding| finding.kind == Kind::DeadTime);
        findings.map(|finding| finding.severity).collect::<Vec<_>>()
    };
    assert!(!told(1).contains(&Severity::Warning));
    assert_eq!(told(10), [Severity::Warning]);
}
