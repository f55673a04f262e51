//! The map of the residual: what it follows, joint by joint, as a picture and as a table.

use crate::diagnosis::{Diagnosis, JointMap, Kind};
use crate::report::console::significant;
use crate::report::html::{Block, Section};
use crate::robot::Robot;
use std::fmt::Write;

/// Sizes of the picture, pixels.
const NAME: usize = 120;
const CELL: [usize; 2] = [72, 30];
const HEAD: usize = 64;

/// Size over the noise at which a cell is darkest.
const DARKEST: f64 = 3.0;

/// The map, and a table of sizes, noise and lines.
pub(super) fn section(robot: &Robot, diagnosis: &Diagnosis) -> Section {
    let text = "Residual of the re-identified baseline in all logs, joint by joint: the root mean square that follows each kind \
                of generic function, whether or not a law of the library explains it. A cell is the darker the larger the part \
                is over the noise of its joint; parts that are not significant are left white.";
    let rows = diagnosis.map.joints.iter().map(|map| {
        let lines = map.reported_lines().map(|line| format!("{} Hz: {}", significant(line.hz), significant(line.rms)));
        let unit = robot.joints[map.joint].effort_unit();
        let mut row = vec![format!("{}, {unit}", robot.joints[map.joint].name)];
        row.extend([map.torque, map.residual, map.noise, map.sensor_noise].map(significant));
        row.push(lines.collect::<Vec<String>>().join(", "));
        row
    });
    let header = ["joint", "torque", "residual", "without all parts", "white noise of the signal", "spectral lines"];
    let blocks = vec![
        Block::text(text),
        Block::Figure(picture(robot, &diagnosis.map.joints)),
        Block::table(header, rows.collect()),
    ];
    Section::new("What the residual follows", blocks)
}

/// A cell for every joint and kind.
fn picture(robot: &Robot, joints: &[JointMap]) -> String {
    let [width, height] = CELL;
    let (all_width, all_height) = (NAME + width * Kind::ALL.len(), HEAD + height * joints.len());
    let mut svg = format!(
        "<svg class=\"ts-figure\" xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {all_width} {all_height}\" \
         width=\"{all_width}\" role=\"img\" aria-label=\"what the residual follows\">"
    );
    for (column, kind) in Kind::ALL.into_iter().enumerate() {
        let x = NAME + column * width + width / 2;
        for (line, word) in kind.title().split(' ').rev().enumerate() {
            let _ = write!(svg, "<text x=\"{x}\" y=\"{}\" text-anchor=\"middle\">{word}</text>", HEAD - 8 - 13 * line);
        }
    }
    for (row, map) in joints.iter().enumerate() {
        let y = HEAD + row * height;
        let name = html_escaped(&robot.joints[map.joint].name);
        let _ = write!(svg, "<text x=\"0\" y=\"{}\">{name}</text>", y + 19);
        for (column, kind) in Kind::ALL.into_iter().enumerate() {
            let x = NAME + column * width;
            let part = map.reported().find(|part| part.follows == kind);
            let shade = part.map_or(0.0, |part| (part.rms / map.noise / DARKEST).clamp(0.1, 1.0));
            let _ = write!(
                svg,
                "<rect x=\"{x}\" y=\"{y}\" width=\"{}\" height=\"{}\" class=\"frame\" style=\"fill:#d55e00;fill-opacity:{:.2}\"/>",
                width - 2,
                height - 2,
                0.75 * shade
            );
            if let Some(part) = part {
                let (x, y, size) = (x + width / 2 - 1, y + 19, significant(part.rms));
                let _ = write!(svg, "<text x=\"{x}\" y=\"{y}\" text-anchor=\"middle\">{size}</text>");
            }
        }
    }
    svg + "</svg>"
}

fn html_escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::Part;

    #[test]
    fn significant_parts_alone_are_written_in_cells() {
        let part =
            |follows, rms, significant| Part { follows, rms, p: Some(0.0), family_wise_p: Some(0.0), significant };
        let map = JointMap {
            joint: 0,
            torque: 10.0,
            residual: 2.0,
            noise: 1.0,
            correlation: 0.0,
            sensor_noise: 1.0,
            reported_from: 0.25,
            misfit: false,
            parts: vec![part(Kind::Speed, 1.5, true), part(Kind::Load, 1.25, false), part(Kind::Lag, 0.2, true)],
            lines: Vec::new(),
        };
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/urdf/irb1600_6_120.urdf");
        let robot = crate::robot::load(path, crate::robot::InertiaCheck::Ignored).unwrap();
        let svg = picture(&robot, &[map]);
        assert!(svg.contains(">1.50<") && !svg.contains(">1.25<") && !svg.contains(">0.200<"), "{svg}");
        assert_eq!(svg.matches("<rect").count(), Kind::ALL.len());
    }
}
