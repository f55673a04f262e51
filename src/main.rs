//! The `tauscope` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    tauscope::cli::main()
}
