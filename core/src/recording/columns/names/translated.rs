//! Words of other languages in the names of columns, in English.
//!
//! Languages that separate words by blanks have theirs in the lists of quantities. Chinese, Japanese and Korean do not, and Cyrillic has
//! letters of its own: their words are put in English here, `关节1角度` as `joint_1_angle`.

use std::borrow::Cow;

/// Words and what they mean, the longer before those that are a part of them.
const WORDS: [(&str, &str); 61] = [
    ("时间戳", "timestamp"),
    ("タイムスタンプ", "timestamp"),
    ("时间", "time"),
    ("時間", "time"),
    ("時刻", "time"),
    ("시간", "time"),
    ("время", "time"),
    ("关节", "joint"),
    ("關節", "joint"),
    ("関節", "joint"),
    ("관절", "joint"),
    ("сустав", "joint"),
    ("轴", "axis"),
    ("軸", "axis"),
    ("축", "axis"),
    ("ось", "axis"),
    ("电机", "motor"),
    ("モータ", "motor"),
    ("角加速度", "acceleration"),
    ("加速度", "acceleration"),
    ("ускорение", "acceleration"),
    ("角速度", "velocity"),
    ("速度", "velocity"),
    ("转速", "velocity"),
    ("각속도", "velocity"),
    ("속도", "velocity"),
    ("скорость", "velocity"),
    ("角度", "angle"),
    ("位置", "position"),
    ("位移", "position"),
    ("각도", "angle"),
    ("위치", "position"),
    ("угол", "angle"),
    ("положение", "position"),
    ("力矩", "torque"),
    ("扭矩", "torque"),
    ("转矩", "torque"),
    ("トルク", "torque"),
    ("토크", "torque"),
    ("момент", "torque"),
    ("电流", "current"),
    ("電流", "current"),
    ("전류", "current"),
    ("ток", "current"),
    ("实际", "actual"),
    ("实测", "measured"),
    ("測定", "measured"),
    ("实时", "actual"),
    ("当前", "present"),
    ("反馈", "feedback"),
    ("目标", "target"),
    ("目標", "target"),
    ("목표", "target"),
    ("期望", "desired"),
    ("指令", "command"),
    ("设定", "setpoint"),
    ("误差", "error"),
    ("誤差", "error"),
    ("温度", "temperature"),
    ("电压", "voltage"),
    ("外部", "external"),
];

/// Units, which stand in brackets or behind a word as they are.
const UNITS: [(&str, &str); 9] = [
    ("弧度", "rad"),
    ("毫秒", "ms"),
    ("微秒", "us"),
    ("秒", "s"),
    ("度", "deg"),
    ("牛·米", "Nm"),
    ("牛米", "Nm"),
    ("牛顿米", "Nm"),
    ("安", "A"),
];

/// Letters with accents, which keyboards and exports leave out at will.
const LETTERS: [(char, char); 20] = [
    ('é', 'e'),
    ('è', 'e'),
    ('ê', 'e'),
    ('á', 'a'),
    ('à', 'a'),
    ('ã', 'a'),
    ('â', 'a'),
    ('í', 'i'),
    ('ó', 'o'),
    ('ò', 'o'),
    ('õ', 'o'),
    ('ô', 'o'),
    ('ú', 'u'),
    ('ù', 'u'),
    ('ç', 'c'),
    ('É', 'E'),
    ('Á', 'A'),
    ('（', '('),
    ('）', ')'),
    ('：', ' '),
];

/// A name with its words in English; None where all of it is plain letters or nothing is known.
pub(super) fn translated(name: &str) -> Option<String> {
    if name.is_ascii() {
        return None;
    }
    let mut text: Cow<'_, str> = name.to_lowercase().into();
    for (own, english) in WORDS {
        if text.contains(own) {
            text = text.replace(own, &format!("_{english}_")).into();
        }
    }
    for (own, english) in UNITS {
        if text.contains(own) {
            text = text.replace(own, english).into();
        }
    }
    let letter = |own: char| LETTERS.iter().find(|(accented, _)| *accented == own).map_or(own, |(_, plain)| *plain);
    let text: String = text.chars().map(letter).collect();
    // Each word brought its own underscores.
    let mut out = String::new();
    for letter in text.chars() {
        let is_double = letter == '_' && (out.is_empty() || out.ends_with(['_', ' ', '/', '.', '(', '[']));
        if !is_double {
            if ['_', ' ', '/', '.', '(', ')', '[', ']'].contains(&letter) && out.ends_with('_') {
                out.pop();
            }
            out.push(letter);
        }
    }
    let out = out.trim_end_matches('_').to_owned();
    (out != name.to_lowercase()).then_some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_other_languages() {
        for (name, english) in [
            ("时间(秒)", "time(s)"),
            ("时间戳", "timestamp"),
            ("关节1角度（度）", "joint_1_angle(deg)"),
            ("关节1速度(deg/s)", "joint_1_velocity(deg/s)"),
            ("J1 实际力矩 [牛米]", "j1 actual_torque [Nm]"),
            ("関節3トルク", "joint_3_torque"),
            ("관절2 토크", "joint_2 torque"),
            ("сустав_1_момент", "joint_1_torque"),
            ("vélocité_1", "velocite_1"),
        ] {
            assert_eq!(translated(name).as_deref(), Some(english), "{name}");
        }
        assert_eq!((translated("joint1_position"), translated("τ_1"), translated("Ω")), (None, None, None));
    }
}
