//! The thresholds as `diagnosis.json` holds them.

use super::thresholds::Criteria;
use crate::effects::{Effect, LIBRARY};
use serde_json::{Map, Value, json};

impl Criteria {
    /// The thresholds as `diagnosis.json` holds them: each that several questions share stands also where every question had its own, since
    /// fields of a schema are not renamed. With them are the limits that laws have of their own.
    pub(crate) fn to_document(self) -> Value {
        document(&self)
    }
}

fn document(criteria: &Criteria) -> Value {
    let Criteria { share_of_torque, levels, search, structure, .. } = criteria;
    let [even, leans, usual, strict] =
        [levels.even_p, levels.leaning_p, levels.usual_p, levels.strict_p].map(|p| json!(p));
    let [open, sure] = [levels.open_p, levels.sure_p].map(|p| json!(p));
    let [most, far, certain] = [levels.most, levels.far, levels.certain].map(|number| json!(number));
    let [once, in_part, misfit] =
        [search.unconfirmable, search.in_part, search.share_of_misfit].map(|number| json!(number));
    let of_bound = json!(criteria.worse_p());
    let worse = criteria.worse();
    let shared: [(&str, &[(&str, &Value)]); 8] = [
        (
            "",
            &[
                ("strength_p", &strict),
                ("share_of_excess", &json!(levels.minor)),
                ("floor_of_torque", &json!(levels.minor * share_of_torque)),
                ("worse", &json!(worse)),
                ("worse_p", &of_bound),
                ("contradicted_p", &usual),
                ("beyond_structure", &json!(levels.log_odds)),
                ("replication", &json!({})),
                ("impacts", &json!({})),
            ],
        ),
        (
            "/replication",
            &[
                ("asked_p", &even),
                ("again_p", &usual),
                ("leans_p", &leans),
                ("alone_p", &strict),
                ("second_attempt", &json!(search.second_attempt)),
            ],
        ),
        (
            "/search",
            &[
                ("event", &once),
                ("gear", &once),
                ("saturation", &once),
                ("beyond_chance", &once),
                ("after_reversals", &in_part),
                ("second_form", &in_part),
                ("hidden", &in_part),
                ("later", &certain),
                ("confirmable_p", &leans),
                ("share_with_constants", &misfit),
                ("flat", &most),
                ("at_bound", &json!(criteria.at_bound())),
                ("influence_p", &json!([levels.strict_p, levels.usual_p])),
                ("again_p", &usual),
                ("confirms_p", &leans),
                ("hopeless_p", &even),
                ("attempts", &json!(search.attempts())),
            ],
        ),
        (
            "/comparison",
            &[
                ("surely_worse_p", &sure),
                ("encompassed_p", &sure),
                ("superfluous_p", &usual),
                ("dropped_p", &sure),
                ("criterion_gap", &json!(criteria.criterion_gap())),
            ],
        ),
        (
            "/estimate",
            &[
                ("beyond_bound", &far),
                ("share_of_drive", &json!(levels.minor)),
                ("significant", &json!(levels.significant_std())),
            ],
        ),
        ("/impacts", &[("each_p", &usual), ("own_p", &strict), ("open_p", &open), ("unconfirmed", &once)]),
        (
            "/structure",
            &[
                ("suggested_p", &open),
                ("beyond_finding", &json!(levels.minor)),
                ("certain", &certain),
                ("share_of_residual", &json!(structure.share_of_residual())),
                ("below_cutoff", &most),
                ("carried_on", &most),
                ("resolved", &most),
                ("foreign", &far),
                ("not_separated", &far),
                ("not_all_p", &strict),
                ("foreign_noise", &json!(structure.above_noise)),
                ("again_p", &usual),
                ("confirmed_p", &strict),
                ("looked_for_p", &even),
                ("leans_p", &leans),
                ("adds_nothing_p", &sure),
            ],
        ),
        (
            "/verdict",
            &[
                ("worse", &json!(worse.powi(2))),
                ("explained_above_noise", &json!(1.0 - levels.minor)),
                ("wrong_bodies", &json!(levels.few)),
                ("doubtful_joints", &json!(levels.few.saturating_sub(1))),
                ("inertias_gain", &misfit),
                ("sampling_size", &json!(levels.bound_std)),
                ("misdescribed", &far),
            ],
        ),
    ];
    let mut document = json!(criteria);
    document["effects"] = limits_of_effects();
    for (place, fields) in shared {
        let own = fields.iter().map(|(name, value)| ((*name).to_owned(), (*value).clone()));
        if let Some(Value::Object(object)) = document.pointer_mut(place) {
            object.extend(own.collect::<Map<_, _>>());
        }
    }
    document
}

/// What a machine can have of those laws that hold it themselves, beyond the bounds of their parameters.
fn limits_of_effects() -> Value {
    let of_effect = |effect: &&dyn Effect| {
        let (share, limits) = (effect.largest_share(), effect.limits());
        let has_any = share.is_some() || !limits.is_empty();
        has_any.then(|| json!({"effect": effect.about().name, "largest_share": share, "limits": limits}))
    };
    LIBRARY.iter().filter_map(of_effect).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_shared_stands_where_each_question_had_it() {
        let document = document(&Criteria::default());
        let at = |place: &str| document.pointer(place).unwrap_or_else(|| panic!("{place}")).clone();
        assert_eq!(at("/structure/again_p"), at("/replication/again_p"));
        assert_eq!(at("/search/attempts"), json!([1.25, 5.0]));
        assert_eq!(at("/search/influence_p"), json!([0.01, 0.05]));
        assert_eq!(at("/comparison/criterion_gap"), json!(6.0));
        assert_eq!([at("/strength_p"), at("/levels/strict_p")], [json!(0.01), json!(0.01)]);
        let laws = at("/effects");
        let law = |name: &str| laws.as_array().unwrap().iter().find(|law| law["effect"] == name).cloned();
        let gap = json!([{"quantity": "half_gap, rad or m", "least": 5e-6}]);
        assert_eq!(law("backlash"), Some(json!({"effect": "backlash", "largest_share": null, "limits": gap})));
        assert_eq!(law("joint_spring").unwrap()["largest_share"], json!(0.5));
        assert_eq!(law("viscous_friction"), None);
        // Chi-square of one degree of freedom at 1 %, and the tail beyond one standard deviation, from tables.
        assert!((at("/search/at_bound").as_f64().unwrap() - 6.634_896_601).abs() < 1e-6);
        assert!((at("/worse_p").as_f64().unwrap() - 0.158_655_254).abs() < 1e-8);
    }
}
