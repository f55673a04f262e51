//! The arm in 3-D: shapes on nested frames, poses over time.

use super::rrd::{Archetype, Component, Index, RrdFile, Store, blob, numbers, texts, tuples};
use super::{Track, part};
use crate::robot::visuals::{Shape, Visual, Visuals};
use crate::robot::{Pose, Robot};
use arrow_array::types::{Float32Type, UInt8Type, UInt32Type};
use std::io::{self, Write};
use std::path::Path;

const TRANSFORM: Archetype = Archetype("archetypes.Transform3D");
const MESH: Archetype = Archetype("archetypes.Asset3D");

/// Poses in a second: more cannot be seen.
const POSES_HZ: f64 = 50.0;

/// Colour of an arm in outline.
const GHOST: [u8; 4] = [86, 180, 233, 110];

/// How shapes are filled, in the viewer's numbers.
const WIREFRAME: u8 = 1;
const SOLID: u8 = 3;

/// Logs the shapes once and the pose of every joint over time.
pub(super) fn log(
    file: &mut RrdFile<impl Write>,
    recording: &Store,
    robot: &Robot,
    visuals: &Visuals,
    track: &Track,
) -> io::Result<()> {
    let paths = paths(robot, track.name);
    for (index, visual) in visuals.shapes.iter().enumerate() {
        let path = format!("/{}/shape_{index}", paths[visual.body]);
        file.log(recording, &path, &[], &placed(visual))?;
        // The mesh's file was there a moment ago; without it the arm is drawn without this shape.
        if let Ok(shape) = shape(visual, track.ghost) {
            file.log(recording, &path, &[], &shape)?;
        }
    }
    let kept = kept(&track.time);
    let time = Index::seconds("time", kept.iter().map(|&sample| track.time[sample]));
    for index in 0..robot.bodies() {
        let (joint, coupling) = (robot.body(index), robot.coupling(index));
        let x = track.q.channel(coupling.coordinate);
        let q = |sample: usize| coupling.position(x[sample]);
        let poses: Vec<Pose> = kept.iter().map(|&sample| joint.origin.then(&joint.motion(q(sample)))).collect();
        // A row replaces the whole transform, so what does not change is repeated.
        file.log(recording, &format!("/{}", paths[index + 1]), std::slice::from_ref(&time), &transform(&poses))?;
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

fn transform(poses: &[Pose]) -> [Component; 2] {
    let translations = tuples::<Float32Type, 3>(poses.iter().map(|pose| vector(&pose.translation)));
    let quaternions = tuples::<Float32Type, 4>(poses.iter().map(quaternion));
    [
        TRANSFORM.component("translation", "components.Translation3D", translations),
        TRANSFORM.component("quaternion", "components.RotationQuat", quaternions),
    ]
}

/// Where a shape is on its body.
fn placed(visual: &Visual) -> Vec<Component> {
    let scale = if let Shape::Mesh { scale, .. } = &visual.shape { *scale } else { [1.0; 3] };
    let scale = tuples::<Float32Type, 3>([scale.map(|factor| factor as f32)]);
    let mut placed = transform(std::slice::from_ref(&visual.pose)).to_vec();
    placed.push(TRANSFORM.component("scale", "components.Scale3D", scale));
    placed
}

fn shape(visual: &Visual, ghost: bool) -> io::Result<Vec<Component>> {
    let own = visual.color.map(|part| (255.0 * part).round() as u8);
    let color = numbers::<UInt32Type>([u32::from_be_bytes(if ghost { GHOST } else { own })]);
    let solid = |half_sizes: [f64; 3]| {
        let half_sizes = tuples::<Float32Type, 3>([half_sizes.map(|half| half as f32)]);
        vec![("half_sizes", "components.HalfSize3D", half_sizes)]
    };
    let long = |length: f64, radius: f64| {
        let number = |value: f64| numbers::<Float32Type>([value as f32]);
        vec![("lengths", "components.Length", number(length)), ("radii", "components.Radius", number(radius))]
    };
    let (archetype, size) = match &visual.shape {
        Shape::Box(sizes) => ("archetypes.Boxes3D", solid(sizes.map(|side| 0.5 * side))),
        Shape::Sphere { radius } => ("archetypes.Ellipsoids3D", solid([*radius; 3])),
        Shape::Cylinder { radius, length } => ("archetypes.Cylinders3D", long(*length, *radius)),
        Shape::Capsule { radius, length } => ("archetypes.Capsules3D", long(*length, *radius)),
        Shape::Mesh { path, .. } => {
            let mut mesh = vec![
                MESH.component("blob", "components.Blob", blob(std::fs::read(path)?)),
                MESH.component("albedo_factor", "components.AlbedoFactor", color),
            ];
            let format = media_type(path).map(|media| texts([media]));
            mesh.extend(format.map(|format| MESH.component("media_type", "components.MediaType", format)));
            return Ok(mesh);
        }
    };
    let archetype = Archetype(archetype);
    let fill = numbers::<UInt8Type>([if ghost { WIREFRAME } else { SOLID }]);
    let mut shape: Vec<Component> =
        size.into_iter().map(|(field, kind, values)| archetype.component(field, kind, values)).collect();
    shape.push(archetype.component("colors", "components.Color", color));
    shape.push(archetype.component("fill_mode", "components.FillMode", fill));
    Ok(shape)
}

/// Media type of a mesh by the name of its file.
fn media_type(path: &Path) -> Option<&'static str> {
    let extension = path.extension()?.to_str()?.to_lowercase();
    match extension.as_str() {
        "stl" => Some("model/stl"),
        "obj" => Some("model/obj"),
        "glb" => Some("model/gltf-binary"),
        "gltf" => Some("model/gltf+json"),
        "dae" => Some("model/vnd.collada+xml"),
        _ => None,
    }
}

fn vector(v: &nalgebra::Vector3<f64>) -> [f32; 3] {
    [v.x as f32, v.y as f32, v.z as f32]
}

fn quaternion(pose: &Pose) -> [f32; 4] {
    let rotation = nalgebra::Rotation3::from_matrix_unchecked(pose.rotation);
    let q = nalgebra::UnitQuaternion::from_rotation_matrix(&rotation);
    [q.i as f32, q.j as f32, q.k as f32, q.w as f32]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_are_named_by_their_extension() {
        assert_eq!(media_type(Path::new("a/B.STL")), Some("model/stl"));
        assert_eq!(media_type(Path::new("a/b.dae")), Some("model/vnd.collada+xml"));
        assert_eq!(media_type(Path::new("a/b.3ds")), None);
    }

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
