//! Arrays as numpy writes them.

use super::*;
use crate::error::Result;

/// A `.npy` of version 1.
fn array(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\0".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.as_bytes());
    bytes.extend(data);
    bytes
}

fn doubles(values: &[f64]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_le_bytes()).collect()
}

/// An archive without compression, and one file with.
fn archive(files: &[(&str, Vec<u8>)], deflated: usize) -> Vec<u8> {
    use std::io::Write;
    let (mut bytes, mut directory) = (Vec::new(), Vec::new());
    for (index, (name, content)) in files.iter().enumerate() {
        let packed = match index == deflated {
            false => content.clone(),
            true => {
                let mut encoder = flate2::write::DeflateEncoder::new(Vec::new(), flate2::Compression::default());
                encoder.write_all(content).unwrap();
                encoder.finish().unwrap()
            }
        };
        let offset = bytes.len() as u32;
        let method: u16 = if index == deflated { 8 } else { 0 };
        let mut common = Vec::new();
        common.extend([20u16, 0, method, 0, 0].iter().flat_map(|half| half.to_le_bytes()));
        common.extend([0, packed.len() as u32, content.len() as u32].iter().flat_map(|word| word.to_le_bytes()));
        common.extend((name.len() as u16).to_le_bytes());
        common.extend(0u16.to_le_bytes());
        bytes.extend(b"PK\x03\x04");
        bytes.extend(&common);
        bytes.extend(name.as_bytes());
        bytes.extend(packed);
        directory.extend(b"PK\x01\x02\x14\0");
        directory.extend(&common);
        directory.extend([0u8; 10]);
        directory.extend(offset.to_le_bytes());
        directory.extend(name.as_bytes());
    }
    let (start, size, count) = (bytes.len() as u32, directory.len() as u32, files.len() as u16);
    bytes.extend(directory);
    bytes.extend(b"PK\x05\x06\0\0\0\0");
    bytes.extend([count, count].iter().flat_map(|half| half.to_le_bytes()));
    bytes.extend([size, start].iter().flat_map(|word| word.to_le_bytes()));
    bytes.extend([0u8; 2]);
    bytes
}

fn read(bytes: &[u8], name: &str) -> Result<Table> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    if name.ends_with("z") { npz(&path) } else { npy(&path) }
}

#[test]
fn arrays_under_their_names() {
    let t = array("'<f8'", "False", "(3,)", &doubles(&[0.0, 0.1, 0.2]));
    let q = array("'<f8'", "False", "(3, 2)", &doubles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let tau = array("'<f8'", "True", "(3, 2)", &doubles(&[7.0, 8.0, 9.0, 10.0, 11.0, 12.0]));
    let single = array("'<f4'", "False", "(3, 1)", &[1.5f32, 2.5, 3.5].map(f32::to_le_bytes).concat());
    let big = array("'>i2'", "False", "(3,)", &[0, 1, 0xFF, 0xFE, 1, 0]);
    let table = read(
        &archive(&[("time.npy", t), ("q.npy", q), ("tau.npy", tau), ("amp.npy", single), ("n.npy", big)], 1),
        "log.npz",
    )
    .unwrap();
    assert_eq!(table.header, ["time", "q[0]", "q[1]", "tau[0]", "tau[1]", "amp", "n"]);
    assert_eq!(table.columns[1], [1.0, 3.0, 5.0]);
    assert_eq!(table.columns[4], [10.0, 11.0, 12.0]);
    assert_eq!((&table.columns[5][..], &table.columns[6][..]), (&[1.5, 2.5, 3.5][..], &[1.0, -2.0, 256.0][..]));
}

#[test]
fn one_arm_of_a_simulator_of_many() {
    let t = array("'<f8'", "False", "(3,)", &doubles(&[0.0, 0.1, 0.2]));
    let q = array("'<f8'", "False", "(3, 1, 2)", &doubles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let many = array("'<f8'", "False", "(3, 2, 1)", &doubles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let table = read(&archive(&[("t.npy", t), ("q.npy", q), ("tau.npy", many)], 9), "log.npz").unwrap();
    assert_eq!(table.header, ["t", "q[0]", "q[1]", "tau[0]", "tau[1]"]);
    assert_eq!(table.columns[2], [2.0, 4.0, 6.0]);
}

#[test]
fn names_of_joints_in_an_array() {
    let letters: Vec<u8> = "ab".chars().flat_map(|letter| (letter as u32).to_le_bytes()).collect();
    let table = read(
        &archive(
            &[
                ("names.npy", array("'<U1'", "False", "(2,)", &letters)),
                ("t.npy", array("'<f8'", "False", "(3,)", &doubles(&[0.0, 1.0, 2.0]))),
                ("position.npy", array("'<f8'", "False", "(2, 3)", &doubles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))),
            ],
            9,
        ),
        "log.npz",
    )
    .unwrap();
    assert_eq!(table.header, ["t", "a_position", "b_position"]);
    assert_eq!(table.columns[2], [4.0, 5.0, 6.0]);
}

#[test]
fn an_array_without_names_is_refused() {
    let plain = array("'<f8'", "False", "(2, 3)", &doubles(&[0.0; 6]));
    let error = read(&plain, "log.npy").unwrap_err().to_string();
    assert!(error.contains("2 x 3") && error.contains("np.savez"), "{error}");
    let fields =
        array("[('t', '<f8'), ('q', '<f8', (2,))]", "False", "(2,)", &doubles(&[0.0, 1.0, 2.0, 0.5, 3.0, 4.0]));
    let table = read(&fields, "log.npy").unwrap();
    assert_eq!(table.header, ["t", "q[0]", "q[1]"]);
    assert_eq!(table.columns[2], [2.0, 4.0]);
    let whole = array("'<f8'", "False", "(2, 3)", &doubles(&[0.0; 6]));
    for length in 0..whole.len() {
        assert!(read(&whole[..length], "log.npy").is_err(), "{length}");
        let _ = read(&archive(&[("t.npy", whole[..length].to_vec())], 9)[..length], "log.npz");
    }
}

#[test]
fn a_period_stands_in_for_times_and_names_of_columns_belong_to_one_array() {
    let letters = |names: &str| names.chars().flat_map(|letter| (letter as u32).to_le_bytes()).collect::<Vec<u8>>();
    let data = array("'<f8'", "False", "(3, 2)", &doubles(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]));
    let named = |name: &str, value: f64| {
        let step = array("'<f8'", "False", "()", &doubles(&[value]));
        let names = array("'<U2'", "False", "(2,)", &letters("q1r1"));
        let files = [("data.npy", data.clone()), (name, step), ("columns.npy", names)];
        read(&archive(&files, 9), "log.npz").unwrap()
    };
    let table = named("dt.npy", 0.25);
    assert_eq!(
        (&table.header[..], &table.columns[2][..]),
        (&["q1", "r1", "t"].map(String::from)[..], &[0.0, 0.25, 0.5][..])
    );
    assert_eq!(named("rate_hz.npy", 4.0).columns[2], [0.0, 0.25, 0.5]);
    assert_eq!(named("mass.npy", 4.0).header, ["q1", "r1"]);
}

#[test]
fn positions_of_several_arms_are_refused_with_how_to_take_one() {
    let arrays = |shape: &str, count: usize| {
        let values: Vec<f64> = (0..count).map(|k| k as f64).collect();
        let npy = |shape: &str, values: &[f64]| array("'<f8'", "False", shape, &doubles(values));
        let files = [("t.npy", npy("(4,)", &values[..4])), ("joint_pos.npy", npy(shape, &values))];
        read(&archive(&files, usize::MAX), "log.npz")
    };
    let refused = arrays("(4, 3, 2)", 24).unwrap_err().to_string();
    assert!(refused.contains("positions of 3 arms") && refused.contains("joint_pos[:, 0]"), "{refused}");
    // One arm of one.
    assert_eq!(arrays("(4, 1, 2)", 8).unwrap().header, ["t", "joint_pos[0]", "joint_pos[1]"]);
}
