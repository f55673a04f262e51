//! The arm in 3-D: shapes on nested frames, poses over time.

use super::{Track, part};
use crate::robot::visuals::{Shape, Visual, Visuals};
use crate::robot::{Pose, Robot};
use rerun::{RecordingStream, RecordingStreamResult, TimeColumn};

/// Poses in a second: more cannot be seen.
const POSES_HZ: f64 = 50.0;

/// Colour of an arm in outline.
const GHOST: [u8; 4] = [86, 180, 233, 110];

/// Logs the shapes once and the pose of every joint over time.
pub(super) fn log(
    stream: &RecordingStream,
    robot: &Robot,
    visuals: &Visuals,
    track: &Track,
) -> RecordingStreamResult<()> {
    let paths = paths(robot, track.name);
    for (index, visual) in visuals.shapes.iter().enumerate() {
        log_shape(stream, &format!("{}/shape_{index}", paths[visual.body]), visual, track.ghost)?;
    }
    let kept = kept(&track.time);
    let time = TimeColumn::new_duration_secs("time", kept.iter().map(|&sample| track.time[sample]));
    for index in 0..robot.bodies() {
        let (joint, coupling) = (robot.body(index), robot.coupling(index));
        let x = track.q.channel(coupling.coordinate);
        let q = |sample: usize| coupling.position(x[sample]);
        let poses: Vec<Pose> = kept.iter().map(|&sample| joint.origin.then(&joint.motion(q(sample)))).collect();
        // A row replaces the whole transform, so what does not change is repeated.
        let columns = rerun::Transform3D::update_fields()
            .with_many_translation(poses.iter().map(|pose| vector(&pose.translation)))
            .with_many_quaternion(poses.iter().map(quaternion))
            .columns_of_unit_batches()?;
        stream.send_columns(paths[index + 1].as_str(), [time.clone()], columns)?;
    }
    Ok(())
}

/// Entity paths of base and bodies: each inside the one it hangs on.
pub(super) fn paths(robot: &Robot, name: &str) -> Vec<String> {
    let mut paths = vec![format!("arm/{name}"); robot.bodies() + 1];
    for body in robot.outwards() {
        let parent = robot.parent(body).map_or(0, |parent| parent + 1);
        paths[body + 1] = format!("{}/{}", paths[parent], part(&robot.body(body).name));
    }
    paths
}

/// Samples at which the arm is posed, the last included.
fn kept(time: &[f64]) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for (sample, &t) in time.iter().enumerate() {
        if kept.last().is_none_or(|&last| t - time[last] > (1.0 - 1e-6) / POSES_HZ || sample + 1 == time.len()) {
            kept.push(sample);
        }
    }
    kept
}

fn log_shape(stream: &RecordingStream, path: &str, visual: &Visual, ghost: bool) -> RecordingStreamResult<()> {
    let own = visual.color.map(|part| (255.0 * part).round() as u8);
    let [r, g, b, a] = if ghost { GHOST } else { own };
    let color = rerun::Color::from_unmultiplied_rgba(r, g, b, a);
    let fill = if ghost { rerun::components::FillMode::MajorWireframe } else { rerun::components::FillMode::Solid };
    let scale = if let Shape::Mesh { scale, .. } = &visual.shape { *scale } else { [1.0; 3] };
    let at = rerun::Transform3D::from_translation(vector(&visual.pose.translation))
        .with_quaternion(quaternion(&visual.pose))
        .with_scale(scale.map(|factor| factor as f32));
    stream.log_static(path, &at)?;
    match &visual.shape {
        Shape::Box(size) => {
            let sizes = [size.map(|side| side as f32)];
            stream.log_static(path, &rerun::Boxes3D::from_sizes(sizes).with_colors([color]).with_fill_mode(fill))
        }
        Shape::Cylinder { radius, length } => stream.log_static(
            path,
            &rerun::Cylinders3D::from_lengths_and_radii([*length as f32], [*radius as f32])
                .with_colors([color])
                .with_fill_mode(fill),
        ),
        Shape::Sphere { radius } => stream.log_static(
            path,
            &rerun::Ellipsoids3D::from_radii([*radius as f32]).with_colors([color]).with_fill_mode(fill),
        ),
        Shape::Capsule { radius, length } => stream.log_static(
            path,
            &rerun::Capsules3D::from_lengths_and_radii([*length as f32], [*radius as f32])
                .with_colors([color])
                .with_fill_mode(fill),
        ),
        Shape::Mesh { path: file, .. } => {
            let asset = rerun::Asset3D::from_file_path(file);
            // The file was there a moment ago; without it the arm is drawn without this shape.
            asset.map_or(Ok(()), |asset| stream.log_static(path, &asset.with_albedo_factor(color.0)))
        }
    }
}

fn vector(v: &nalgebra::Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn quaternion(pose: &Pose) -> rerun::Quaternion {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(pose.rotation);
    let q = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
    rerun::Quaternion::from_xyzw([q.i as f32, q.j as f32, q.k as f32, q.w as f32])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fifty_poses_a_second_and_the_last() {
        let time: Vec<f64> = (0..=502).map(|k| f64::from(k) * 0.002).collect();
        let kept = kept(&time);
        assert_eq!(kept[..3], [0, 10, 20]);
        assert_eq!(kept.len(), 52);
        assert_eq!(kept[51], 502);
        let slow: Vec<f64> = (0..5).map(f64::from).collect();
        assert_eq!(super::kept(&slow), [0, 1, 2, 3, 4]);
    }
}
