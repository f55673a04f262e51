//! The content of `diagnosis.json`.

use super::diagnosis::Diagnosis;
use super::outcome::{Answer, Conclusion};
use super::quantities::{ResidualStructure, Share};
use super::words::{Finding, NamedParameter, finding, findings, joints, law_of_inertias, notices};
use crate::diagnosis::criteria::{Criteria, Judgement, Levels};
use crate::diagnosis::logs::{Consequence, DataFault};
use crate::diagnosis::relevance::Minor;
use crate::diagnosis::search::{Rejected, Verdict};
use crate::diagnosis::variance::{JointMap, Line, Part};
use crate::payload::{self, Payload, Quantity};
use crate::quality::Kind;
use crate::robot::Robot;
use serde::{Serialize, Serializer};

/// Schema of the `diagnosis.json` that `tauscope diagnose` writes.
pub const DIAGNOSIS_SCHEMA: &str = "tauscope.diagnosis/1";

/// File of the scenario with the extended model, and of its bodies and drives.
pub const EXTENDED_SCENARIO: &str = "extended.toml";
/// The URDF that [`EXTENDED_SCENARIO`] refers to.
pub const EXTENDED_URDF: &str = "extended.urdf";
/// The same as a MuJoCo model.
pub const EXTENDED_MJCF: &str = "extended.xml";

/// The content of `diagnosis.json`, without its schema.
#[derive(Debug, Default, Serialize)]
pub(super) struct Document {
    verdict: Option<Verdict>,
    robot: String,
    joints: Vec<String>,
    /// Units of the joints' efforts, noise and residuals.
    effort_units: Vec<&'static str>,
    alpha: f64,
    /// Cut-off at which the positions of each joint were smoothed; empty where nothing was tested.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    position_cutoffs_hz: Vec<f64>,
    /// Cut-off of the low-pass that torque went through before it was logged; absent where there was none.
    #[serde(skip_serializing_if = "Option::is_none")]
    torque_cutoff_hz: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    effective_tests: Option<f64>,
    noise_floor_nm: Vec<f64>,
    sensor_noise_nm: Vec<f64>,
    test_torque_rms_nm: Vec<f64>,
    simulation: Simulation,
    baseline: Baseline,
    /// What was found in the reference logs: there before the change.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    reference: Vec<Finding>,
    findings: Vec<Finding>,
    /// The load added since the reference logs, as `tauscope payload` weighs it.
    #[serde(skip_serializing_if = "Option::is_none")]
    load: Option<Load>,
    /// Effects found that do not matter, not in the extended model.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    smaller_findings: Vec<SmallerFinding>,
    /// The best candidates of rounds of the search that failed a gate, and are not found.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rejected: Vec<RejectedCandidate>,
    /// Thresholds that decide what is a finding.
    #[serde(serialize_with = "as_document")]
    criteria: Criteria,
    /// What the residual of the baseline follows, joint by joint, in means of 80 ms over all logs.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    residual_map: Vec<MapOfJoint>,
    #[serde(skip_serializing_if = "Option::is_none")]
    extended: Option<Extended>,
    not_found: Vec<NotFound>,
    unexplained: Vec<Unexplained>,
    /// What the residual of a joint seemed to follow, and which gate was against it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    rejected_structure: Vec<RejectedFollows>,
    next_experiment: String,
    data_quality: Vec<Quality>,
    /// Whether the search was ended before it was done.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    unfinished: bool,
}

/// An effect found that does not matter.
#[derive(Debug, Serialize)]
struct SmallerFinding {
    effect: &'static str,
    joints: Vec<String>,
    parameters: Vec<NamedParameter>,
    /// Root of the difference of the training logs' mean squares with and without it, per joint.
    size_nm: Vec<f64>,
    /// The gate that it failed.
    failed: Judgement,
}

impl SmallerFinding {
    fn new(robot: &Robot, minor: &Minor, levels: &Levels) -> Self {
        let Finding { effect, joints, parameters, .. } = finding(robot, &minor.found, &[], levels);
        SmallerFinding { effect, joints, parameters, size_nm: minor.size.clone(), failed: minor.failed }
    }
}

/// A candidate that failed a gate of the search.
#[derive(Debug, Serialize)]
struct RejectedCandidate {
    effect: &'static str,
    joints: Vec<String>,
    /// The training log in which it would act, where that is one alone; counted from one.
    #[serde(skip_serializing_if = "Option::is_none")]
    log: Option<usize>,
    /// The gate that it failed.
    failed: Judgement,
}

impl RejectedCandidate {
    fn new(robot: &Robot, Rejected { slot: (family, log), failed }: &Rejected) -> Self {
        let (joints, log) = (joints(robot, *family), log.map(|log| log + 1));
        RejectedCandidate { effect: family.effect, joints, log, failed: *failed }
    }

    /// Those of the search, and wrong inertias as a whole where that was refused.
    fn all(robot: &Robot, diagnosis: &Diagnosis) -> Vec<Self> {
        let inertias = diagnosis.rejected_inertias.map(|failed| RejectedCandidate {
            effect: law_of_inertias(),
            joints: robot.joint_names(),
            log: None,
            failed,
        });
        diagnosis.rejected.iter().map(|one| RejectedCandidate::new(robot, one)).chain(inertias).collect()
    }
}

/// What the residual of one joint follows; root mean squares in the unit of its effort.
#[derive(Debug, Serialize)]
struct MapOfJoint {
    joint: String,
    torque_rms: f64,
    residual_rms: f64,
    noise_rms: f64,
    noise_correlation: f64,
    sensor_noise_rms: f64,
    follows: Vec<Part>,
    lines: Vec<Line>,
}

impl MapOfJoint {
    fn new(robot: &Robot, map: &JointMap) -> Self {
        MapOfJoint {
            joint: robot.joints[map.joint].name.clone(),
            torque_rms: map.torque,
            residual_rms: map.residual,
            noise_rms: map.noise,
            noise_correlation: map.correlation,
            sensor_noise_rms: map.sensor_noise,
            follows: map.parts.clone(),
            lines: map.lines.clone(),
        }
    }
}

#[derive(Debug, Default, Serialize)]
struct Simulation {
    test_rms_nm: Vec<f64>,
    structure: Vec<Structure>,
}

#[derive(Debug, Default, Serialize)]
struct Baseline {
    train_rms_nm: Vec<f64>,
    test_rms_nm: Vec<f64>,
}

#[derive(Debug, Serialize)]
struct Structure {
    joint: String,
    #[serde(flatten)]
    structure: ResidualStructure,
}

#[derive(Debug, Serialize)]
struct Extended {
    test_rms_nm: Vec<f64>,
    test_prediction_std_nm: Vec<f64>,
    gap_closed: f64,
    gap_closed_interval: [f64; 2],
    structure: Vec<Structure>,
    model: &'static str,
    urdf: &'static str,
    mjcf: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    resimulated_test_rms_nm: Option<Vec<f64>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    resimulation: Option<Resimulated>,
}

#[derive(Debug, Serialize)]
struct Resimulated {
    engine: &'static str,
    described_test_rms_nm: Option<Vec<f64>>,
    baseline_test_rms_nm: Vec<f64>,
    gain: Share,
    gap_closed: Share,
}

#[derive(Debug, Serialize)]
struct NotFound {
    effect: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    joint: Option<String>,
    verdict: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    minimum_detectable: Option<f64>,
    unit: &'static str,
}

#[derive(Debug, Serialize)]
struct Unexplained {
    joint: String,
    share: f64,
    structure: &'static str,
    /// Null where none was worked out.
    family_wise_p: Option<f64>,
    /// The law that comes nearest; absent where none was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    nearest: Option<&'static str>,
    /// The gates that it passed.
    passed: Vec<Judgement>,
}

/// What the residual of a joint is not reported to follow.
#[derive(Debug, Serialize)]
struct RejectedFollows {
    joint: String,
    structure: &'static str,
    /// The gate that it failed.
    failed: Judgement,
}

#[derive(Debug, Serialize)]
struct Quality {
    kind: QualityKind,
    log: String,
    r#where: String,
    text: String,
    consequence: Consequence,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum QualityKind {
    Fault(Kind),
    Notice(&'static str),
}

/// What is known of a load added since the reference logs; what the logs do not determine is none.
#[derive(Debug, Serialize)]
struct Load {
    verdict: payload::Verdict,
    frame: String,
    mass_kg: Option<Quantity>,
    center_m: [Option<Quantity>; 3],
    first_moment_kg_m: [Option<Quantity>; 3],
    inertia_kg_m2: [Option<Quantity>; 6],
    scaled_by: &'static str,
    notes: Vec<String>,
}

impl Load {
    fn of(load: &Payload) -> Self {
        Load {
            verdict: load.verdict,
            frame: load.frame.clone(),
            mass_kg: load.mass_kg,
            center_m: load.center_m,
            first_moment_kg_m: load.first_moment_kg_m,
            inertia_kg_m2: load.inertia_kg_m2,
            scaled_by: load.scaled_by,
            notes: load.not_determined.iter().chain(&load.notes).cloned().collect(),
        }
    }
}

impl Document {
    /// The answer as `diagnosis.json` holds it.
    pub(super) fn new(robot: &Robot, conclusion: &Conclusion, faults: &[DataFault]) -> Document {
        let Conclusion { diagnosis, resimulation, .. } = conclusion;
        let resimulation = resimulation.as_ref();
        // Not a number, which JSON writes as null, where there is no equation.
        let known = |values: &[f64]| -> Vec<f64> {
            let each = values.iter().zip(&diagnosis.logs.equations);
            each.map(|(&value, &has)| if has { value } else { f64::NAN }).collect()
        };
        let [train, test] = diagnosis.errors.baseline_rms.each_ref().map(|rms| known(rms));
        let not_found = diagnosis.not_found.iter().map(|missed| NotFound {
            effect: missed.family.effect,
            joint: joints(robot, missed.family).into_iter().next(),
            verdict: if missed.minimum_detectable.is_some() { "not_found" } else { "not_testable" },
            minimum_detectable: missed.minimum_detectable,
            unit: missed.unit,
        });
        let unexplained = diagnosis.unexplained.iter().map(|left| Unexplained {
            joint: robot.joints[left.joint].name.clone(),
            share: left.share,
            structure: left.structure,
            family_wise_p: left.family_wise_p,
            nearest: diagnosis.nearest(left.joint).map(|minor| minor.found.member.candidate.family().effect),
            passed: left.passed.clone(),
        });
        let rejected_structure = diagnosis.rejected_structure.iter().map(|one| RejectedFollows {
            joint: robot.joints[one.joint].name.clone(),
            structure: one.structure,
            failed: one.failed,
        });
        let mut data_quality = qualities(robot, faults);
        let held_out = "no test log was given: 30 % of every training log was held out";
        let notices = [
            (
                "held_out_from_training",
                "training logs",
                diagnosis.logs.held_out_from_training.then(|| held_out.to_owned()),
            ),
            ("unfinished", "search", notices::unfinished(diagnosis)),
            ("most_findings", "search", notices::most_findings(diagnosis)),
            ("equal_states", "reference logs", notices::equal_states(diagnosis)),
            ("mixed_rates", "t", notices::mixed_rates(diagnosis)),
            ("sampling_delay", "tau", notices::sampling(robot, diagnosis)),
            ("smooth_friction", "tau", notices::smooth_friction(robot, diagnosis)),
            ("extrapolation", "training logs", notices::extrapolation(robot, diagnosis)),
        ];
        data_quality.extend(notices.into_iter().filter_map(|(kind, place, text)| {
            Some(Quality {
                kind: QualityKind::Notice(kind),
                log: String::new(),
                r#where: place.into(),
                text: text?,
                consequence: Consequence::Noted,
            })
        }));
        let structure = |of: &[ResidualStructure]| {
            let named = robot.joint_names().into_iter().zip(of.iter().cloned());
            named.map(|(joint, structure)| Structure { joint, structure }).collect()
        };
        Document {
            verdict: Some(diagnosis.verdict),
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            effort_units: robot.effort_units(),
            alpha: diagnosis.scope.alpha,
            position_cutoffs_hz: diagnosis.logs.cutoffs_hz.clone(),
            torque_cutoff_hz: diagnosis.logs.passband.map(|low_pass| low_pass.hz),
            effective_tests: Some(diagnosis.scope.effective_tests),
            noise_floor_nm: known(&diagnosis.errors.noise_floor),
            sensor_noise_nm: known(&diagnosis.errors.sensor_noise),
            test_torque_rms_nm: known(&diagnosis.errors.test_torque_rms),
            simulation: Simulation {
                test_rms_nm: known(&diagnosis.errors.simulation_test_rms),
                structure: structure(&diagnosis.errors.structure[0]),
            },
            baseline: Baseline { train_rms_nm: train, test_rms_nm: test },
            reference: diagnosis
                .before
                .iter()
                .map(|found| finding(robot, found, &[], &diagnosis.scope.criteria.levels))
                .collect(),
            findings: findings(robot, diagnosis),
            load: diagnosis.load.as_ref().map(Load::of),
            smaller_findings: diagnosis
                .minor
                .iter()
                .map(|minor| SmallerFinding::new(robot, minor, &diagnosis.scope.criteria.levels))
                .collect(),
            rejected: RejectedCandidate::all(robot, diagnosis),
            criteria: diagnosis.scope.criteria,
            residual_map: diagnosis.map.joints.iter().map(|map| MapOfJoint::new(robot, map)).collect(),
            extended: Some(Extended {
                test_rms_nm: known(&diagnosis.errors.extended_test_rms),
                test_prediction_std_nm: known(&diagnosis.errors.prediction_std),
                gap_closed: diagnosis.errors.gap_closed.value,
                gap_closed_interval: diagnosis.errors.gap_closed.interval,
                structure: structure(&diagnosis.errors.structure[1]),
                model: EXTENDED_SCENARIO,
                urdf: EXTENDED_URDF,
                mjcf: EXTENDED_MJCF,
                resimulated_test_rms_nm: resimulation.map(|run| known(&run.extended_rms)),
                resimulation: resimulation.map(|run| Resimulated {
                    engine: run.engine.key,
                    described_test_rms_nm: run.described_rms.clone(),
                    baseline_test_rms_nm: run.baseline_rms.clone(),
                    gain: run.gain,
                    gap_closed: run.gap_closed,
                }),
            }),
            not_found: not_found.collect(),
            unexplained: unexplained.collect(),
            rejected_structure: rejected_structure.collect(),
            unfinished: diagnosis.unfinished,
            next_experiment: diagnosis.next_experiment.clone(),
            data_quality,
        }
    }

    /// The answer where faults of the data forbid one.
    pub(super) fn stopped(robot: &Robot, alpha: f64, faults: &[DataFault]) -> Document {
        Document {
            verdict: Some(Verdict::NotTestable),
            robot: robot.name.clone(),
            joints: robot.joint_names(),
            effort_units: robot.effort_units(),
            alpha,
            next_experiment: notices::remedy(faults),
            data_quality: qualities(robot, faults),
            ..Document::default()
        }
    }
}

fn as_document<S: Serializer>(criteria: &Criteria, serializer: S) -> std::result::Result<S::Ok, S::Error> {
    criteria.to_document().serialize(serializer)
}

impl Serialize for Answer {
    fn serialize<S: Serializer>(&self, serializer: S) -> std::result::Result<S::Ok, S::Error> {
        match self.conclusion() {
            Some(conclusion) => Document::new(&self.robot, conclusion, &self.faults).serialize(serializer),
            None => Document::stopped(&self.robot, self.alpha, &self.faults).serialize(serializer),
        }
    }
}

impl Answer {
    /// The content of `diagnosis.json`, with its schema.
    pub fn to_json(&self) -> String {
        let mut bytes = Vec::new();
        crate::output::json(&mut bytes, DIAGNOSIS_SCHEMA, self).expect("an answer is a JSON object");
        String::from_utf8(bytes).expect("JSON is UTF-8")
    }
}

/// What is noted of the robot's file, and the faults of the logs.
fn qualities(robot: &Robot, faults: &[DataFault]) -> Vec<Quality> {
    let notes = robot.notes.iter().map(|note| Quality {
        kind: QualityKind::Notice("robot_description"),
        log: String::new(),
        r#where: robot.name.clone(),
        text: note.clone(),
        consequence: Consequence::Noted,
    });
    let quality = |fault: &DataFault| Quality {
        kind: QualityKind::Fault(fault.kind),
        log: fault.log.clone(),
        r#where: fault.place.clone(),
        text: fault.text.clone(),
        consequence: fault.consequence,
    };
    notes.chain(faults.iter().map(quality)).collect()
}
