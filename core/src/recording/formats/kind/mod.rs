//! What kind of file a log is, from its content: what is not read is called by its name, with the command that converts it.

mod xml;

use crate::error::{Error, Result};
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Formats that are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Format {
    /// A table in text.
    Text,
    /// Parquet.
    #[cfg(feature = "parquet")]
    Parquet,
    /// MCAP, SQLite, or the folder of a bag.
    #[cfg(feature = "bags")]
    Bag,
    /// Arrays of numpy under their names.
    Npz,
    /// One array of numpy.
    Npy,
}

/// Bytes of a file that are looked at.
const LOOKED_AT: u64 = 4096;

/// The format of a file.
///
/// # Errors
/// A file that cannot be read, or that is no log that can be.
pub(crate) fn of(path: &Path) -> Result<Format> {
    let extension = path.extension().map(|extension| extension.to_string_lossy().to_lowercase()).unwrap_or_default();
    #[cfg(feature = "bags")]
    let bag = super::bag::is_bag(path);
    #[cfg(not(feature = "bags"))]
    let bag = false;
    if path.is_dir() && !bag {
        let problem = "a directory without metadata.yaml is no ROS 2 bag; give the .mcap or .db3 file in it, or run ros2 bag \
                       reindex";
        return Err(Error::input(path, None, "directory", problem));
    }
    let mut start = Vec::new();
    if !path.is_dir() {
        match File::open(path) {
            Ok(file) => {
                let read = file.take(LOOKED_AT).read_to_end(&mut start);
                read.map_err(|source| Error::io(path, "read the recording", source))?;
                if start.trim_ascii_start().starts_with(b"<") || start.starts_with(b"\xEF\xBB\xBF<") {
                    // The root of an XML file may stand behind a long comment, and a macro anywhere.
                    start = std::fs::read(path).map_err(|source| Error::io(path, "read the recording", source))?;
                }
            }
            Err(source) => return Err(Error::io(path, "read the recording", source)),
        }
    }
    let is = |magic: &[u8]| start.starts_with(magic);
    if is(b"\x93NUMPY") {
        return Ok(Format::Npy);
    }
    if is(b"PK") && (super::numpy::is_npz(path) || extension == "npz") {
        return Ok(Format::Npz);
    }
    if is(b"PAR1") {
        return parquet(path);
    }
    let name = path.file_name().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
    if let Some((what, cure)) = refused(&start, &extension, &name, bag) {
        return Err(Error::input(path, None, "file", format!("this is {what}, which is not read as a log; {cure}")));
    }
    #[cfg(feature = "bags")]
    if bag || is(b"\x89MCAP0\r\n") || is(b"SQLite format 3\0") {
        return Ok(Format::Bag);
    }
    #[cfg(not(feature = "bags"))]
    if is(b"\x89MCAP0\r\n") || is(b"SQLite format 3\0") {
        return Err(unknown_format(path));
    }
    if extension == "parquet" && !is_lines(&start) { parquet(path) } else { Ok(Format::Text) }
}

/// Whether the start of a file is text in lines: a table in text, whatever its name says.
fn is_lines(start: &[u8]) -> bool {
    let is_text = |byte: &u8| !byte.is_ascii_control() || byte.is_ascii_whitespace();
    start.contains(&b'\n') && start.iter().all(is_text)
}

#[cfg(feature = "parquet")]
fn parquet(_: &Path) -> Result<Format> {
    Ok(Format::Parquet)
}

#[cfg(not(feature = "parquet"))]
fn parquet(path: &Path) -> Result<Format> {
    Err(unknown_format(path))
}

/// The name of a log must give its format.
pub(crate) fn unknown_format(path: &Path) -> Error {
    let kinds = match (cfg!(feature = "parquet"), cfg!(feature = "bags")) {
        (true, true) => ".csv, .parquet, .mcap or .db3 (or is the folder of a ROS 2 bag)",
        (true, false) => ".csv or .parquet (this build reads no ROS 2 bags: build it with the feature `bags`)",
        (false, true) => {
            ".csv, .mcap or .db3 (or is the folder of a ROS 2 bag; this build reads no Parquet files: build it with the feature \
             `parquet`)"
        }
        (false, false) => {
            ".csv (this build reads neither Parquet files nor ROS 2 bags: build it with the features `parquet` and `bags`)"
        }
    };
    Error::input(path, None, "extension", format!("the name of a log must end in {kinds}, which gives its format"))
}

/// Logs are written in fewer formats than they are read in.
pub(crate) fn not_written(path: &Path) -> Error {
    let kinds = match (cfg!(feature = "parquet"), cfg!(feature = "bags")) {
        (true, true) => ".csv, .parquet, .mcap or .db3",
        (true, false) => ".csv or .parquet (this build writes no ROS 2 bags: build it with the feature `bags`)",
        (false, true) => {
            ".csv, .mcap or .db3 (this build writes no Parquet files: build it with the feature `parquet`)"
        }
        (false, false) => {
            ".csv (this build writes neither Parquet files nor ROS 2 bags: build it with the features `parquet` and `bags`)"
        }
    };
    Error::input(path, None, "extension", format!("logs are written as {kinds}, which the end of the name chooses"))
}

/// What a file is that is not read, and what to do about it.
fn refused(start: &[u8], extension: &str, name: &str, bag: bool) -> Option<(&'static str, String)> {
    let python = |code: String| format!("convert it: python -c \"{code}\"");
    let stem = name.rsplit_once('.').map_or(name, |(stem, _)| stem);
    let is = |magic: &[u8]| start.starts_with(magic);
    let text = String::from_utf8_lossy(start.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(start)).into_owned();
    let text = text.trim_start();
    let found = if is(b"#ROSBAG") {
        let cure = format!("convert it: pip install rosbags; rosbags-convert --src {name} --dst {stem}");
        ("a bag of ROS 1", cure)
    } else if is(b"MATLAB 5.0 MAT-file") {
        let code = format!(
            "import numpy, scipy.io; numpy.savez('{stem}.npz', **{{k: v for k, v in scipy.io.loadmat('{name}').items() if \
             k[0] != '_'}})"
        );
        ("a file of MATLAB", format!("{} (variables t, q, tau), or save it there with writetable", python(code)))
    } else if is(b"\x89HDF") {
        let code = format!(
            "import h5py, numpy; f = h5py.File('{name}'); d = {{}}; f.visititems(lambda k, v: d.update({{k.replace('/', '_'): v[()]}}) if \
             hasattr(v, 'shape') else None); numpy.savez('{stem}.npz', **d)"
        );
        ("a file of HDF5 (MATLAB 7.3 writes these too)", python(code))
    } else if (is(b"PK") && (extension == "xlsx" || contains(start, b"[Content_Types].xml"))) || is(b"\xD0\xCF\x11\xE0")
    {
        let cure = format!("export it as CSV: libreoffice --headless --convert-to csv {name}");
        ("a spreadsheet", cure)
    } else if is(b"PK") {
        ("a ZIP archive", format!("unpack it: unzip {name}"))
    } else if is(b"\x1F\x8B") {
        ("compressed with gzip", format!("unpack it: gunzip {name}"))
    } else if is(b"BZh") {
        ("compressed with bzip2", format!("unpack it: bunzip2 {name}"))
    } else if is(b"\xFD7zXZ") {
        ("compressed with xz", format!("unpack it: unxz {name}"))
    } else if is(b"\x28\xB5\x2F\xFD") && !bag {
        ("compressed with Zstandard", format!("unpack it: unzstd {name}"))
    } else if is(b"ARROW1") {
        let code = format!("import pandas; pandas.read_feather('{name}').to_parquet('{stem}.parquet')");
        ("a file of Arrow", python(code))
    } else if is(b"\xFF\xFF\xFF\xFF") && ["arrow", "arrows", "ipc", "feather"].contains(&extension) {
        let code = format!(
            "import pyarrow.ipc, pyarrow.parquet; pyarrow.parquet.write_table(pyarrow.ipc.open_stream('{name}').read_all(), '{stem}.parquet')"
        );
        ("a stream of Arrow", python(code))
    } else if is(b"ORC") && extension == "orc" {
        ("a file of ORC", python(format!("import pandas; pandas.read_orc('{name}').to_parquet('{stem}.parquet')")))
    } else if is(b"TDSm") {
        let code = format!("import nptdms; nptdms.TdmsFile.read('{name}').as_dataframe().to_csv('{stem}.csv')");
        ("a file of LabVIEW (TDMS)", format!("{} (pip install nptdms)", python(code)))
    } else if is(b"MDF     ") {
        let code = format!("import asammdf; asammdf.MDF('{name}').to_dataframe().to_csv('{stem}.csv')");
        ("a measurement file of ASAM (MDF)", format!("{} (pip install asammdf)", python(code)))
    } else if start.len() > 2 && start[0] == 0x80 && (2..=5).contains(&start[1]) {
        let code = format!("import pandas; pandas.DataFrame(pandas.read_pickle('{name}')).to_csv('{stem}.csv')");
        ("a pickle of Python", python(code))
    } else if text.starts_with('<') {
        xml::kind(text, name)
    } else if is(b"#usda") || is(b"PXR-USDC") {
        let cure = format!(
            "convert it with `usd_to_urdf -o robot.urdf {name}` (pip install nvidia-srl-usd-to-urdf), give that with --robot, and \
             as the log a table, a ROS 2 bag or .npz"
        );
        ("a USD scene", cure)
    } else if text.starts_with('{')
        || text.strip_prefix('[').is_some_and(|rest| rest.trim_start().starts_with(['{', '[']))
    {
        // One object a line.
        let lines = if text.lines().filter(|line| line.starts_with('{')).count() > 1 { ", lines=True" } else { "" };
        let code = format!("import pandas; pandas.read_json('{name}'{lines}).to_csv('{stem}.csv', index=False)");
        ("JSON", python(code))
    } else if text.starts_with("header:") {
        ("the text of ros2 topic echo", "record it with ros2 bag record, or echo it with --csv".to_owned())
    } else if extension == "toml" || text.starts_with("schema = \"tauscope") {
        ("a file of settings", "give a dataset with --dataset, and as the log the file that it names".to_owned())
    } else {
        return None;
    };
    Some(found)
}

/// Whether bytes hold others.
fn contains(bytes: &[u8], part: &[u8]) -> bool {
    bytes.windows(part.len()).any(|window| window == part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn said(name: &str, content: &[u8]) -> String {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        std::fs::write(&path, content).unwrap();
        of(&path).map_or_else(|error| error.to_string(), |format| format!("{format:?}"))
    }

    #[test]
    fn what_is_not_there_is_no_matter_of_its_extension() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a.npz", "a.csv", "a.mcap", "a.xyz", "a", "none/a.npy", "none/"] {
            let error = of(&folder.path().join(name)).unwrap_err().to_string();
            assert!(error.contains("cannot read the recording: No such file or directory"), "{name}: {error}");
        }
    }

    #[test]
    fn files_are_known_by_what_is_in_them() {
        for (name, content, words) in [
            ("a.bag", &b"#ROSBAG V2.0\n"[..], ["bag of ROS 1", "rosbags-convert --src a.bag --dst a"]),
            ("a.mat", b"MATLAB 5.0 MAT-file, Platform", ["file of MATLAB", "savez('a.npz'"]),
            ("b.mat", b"\x89HDF\r\n\x1a\n", ["HDF5", "h5py.File('b.mat')"]),
            ("a.ipc", b"\xFF\xFF\xFF\xFF\x10\0", ["stream of Arrow", "open_stream('a.ipc')"]),
            ("a.orc", b"ORC\x0A\0", ["file of ORC", "read_orc('a.orc')"]),
            ("a.tdms", b"TDSm\x0E\0", ["LabVIEW", "TdmsFile.read('a.tdms')"]),
            ("a.mf4", b"MDF     4.10", ["ASAM", "asammdf.MDF('a.mf4')"]),
            ("a.xlsx", b"PK\x03\x04\0\0", ["a spreadsheet", "convert-to csv a.xlsx"]),
            ("a.csv", b"PK\x03\x04\0\0", ["a ZIP archive", "unzip a.csv"]),
            ("corrected.toml", b"robot = \"a.urdf\"\n", ["a file of settings", "--dataset"]),
            ("a.json", b" {\"t\": [0]}", ["JSON", "read_json('a.json')"]),
            ("a.jsonl", b"{\"t\": 0}\n{\"t\": 1}\n", ["JSON", "read_json('a.jsonl', lines=True)"]),
            ("a.csv.gz", b"\x1F\x8B\x08\0", ["gzip", "gunzip a.csv.gz"]),
            ("a.csv", b"<?xml?><robot name=\"r\">", ["URDF", "--robot"]),
            ("a.csv", b"<mujoco model=\"r\">", ["MuJoCo", "--robot"]),
            ("a.csv", b"<robot><xacro:include/></robot>", ["xacro file", "`xacro a.csv -o robot.urdf`"]),
            ("a.usda", b"#usda 1.0\n", ["USD", "usd_to_urdf"]),
            ("a.txt", b"header:\n  stamp:\n", ["ros2 topic echo", "--csv"]),
            ("a.pkl", b"\x80\x04\x95\0", ["pickle", "read_pickle('a.pkl')"]),
        ] {
            let said = said(name, content);
            assert!(words.iter().all(|word| said.contains(word)), "{name}: {said}");
            assert_eq!(said.lines().count(), 1);
        }
        for (name, content, format) in [
            ("a.txt", &b"t q1 tau1\n"[..], "Text"),
            ("a.parquet", b"t,q1,tau1\r\n0,1,2", "Text"),
            ("a", b"t,q1,tau1\n", "Text"),
            ("a.bin", b"\x93NUMPY\x01", "Npy"),
        ] {
            assert_eq!(said(name, content), format);
        }
    }

    #[test]
    fn a_build_says_what_it_was_made_without() {
        let mut parquet = ["a.csv", "a.parquet"].map(|name| said(name, b"PAR1\0")).to_vec();
        // Lines that hold other bytes than text, and text without lines.
        parquet.extend([&b"t\0\n"[..], b"t,q1"].map(|content| said("a.parquet", content)));
        let bags = said("a.mcap", b"\x89MCAP0\r\n");
        match cfg!(feature = "parquet") {
            true => assert_eq!(parquet, ["Parquet"; 4]),
            false => assert!(parquet.iter().all(|said| said.contains("Parquet files") && said.contains("`parquet`"))),
        }
        match cfg!(feature = "bags") {
            true => assert_eq!(bags, "Bag"),
            false => {
                assert!(bags.contains("ROS 2 bags: build it with the feature") && bags.contains("`bags`"), "{bags}")
            }
        }
    }
}
