//! What the crates need: the core without simulator, command and columnar files, which a program that only diagnoses must not
//! pay for.

use std::collections::BTreeSet;
use std::process::Command;

/// Packages that the core needs with `features`, itself included.
fn needs(features: &str) -> BTreeSet<String> {
    let cargo = std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into());
    let arguments = ["tree", "--offline", "--package", "tauscope-core", "--edges", "normal,build", "--prefix", "none"];
    let output = Command::new(cargo)
        .args(arguments)
        .args(["--format", "{lib}", "--features", features])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let names = String::from_utf8(output.stdout).unwrap();
    names.lines().map(|line| line.trim_end_matches(" (*)").to_owned()).collect()
}

#[test]
fn the_core_needs_neither_simulator_nor_command_nor_columnar_files() {
    let plain = needs("");
    assert!(["tauscope_core", "nalgebra", "faer", "rand"].iter().all(|name| plain.contains(*name)), "{plain:?}");
    let heavy =
        ["rapier", "parry", "clap", "arrow", "parquet", "rerun", "mcap", "rusqlite", "libsqlite3", "zstd", "lz4"];
    let found: Vec<&String> = plain.iter().filter(|name| heavy.iter().any(|heavy| name.starts_with(heavy))).collect();
    assert!(found.is_empty(), "{found:?}");
    for (feature, brought) in [("parquet", "arrow_array"), ("bags", "mcap")] {
        let with = needs(feature);
        assert!(with.contains(brought) && with.is_superset(&plain), "{feature}: {with:?}");
        assert!(
            !with.iter().any(|name| ["rapier", "parry", "clap", "rerun"].iter().any(|heavy| name.starts_with(heavy)))
        );
    }
}
