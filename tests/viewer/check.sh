#!/usr/bin/env bash
# Reads recordings with rerun's own tools, in the version for which tauscope writes.
#
#   tests/viewer/check.sh RRD...
set -euo pipefail
here=$(dirname "$0")
version=$(sed -n 's/^pub const VIEWER_VERSION: &str = "\(.*\)";/\1/p' "$here/../../src/report/viewer/mod.rs")
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
# Rerun keeps its settings there.
export HOME="$place"
python3 -m venv "$place/venv"
if ! "$place/venv/bin/pip" install --quiet --disable-pip-version-check "rerun-sdk==$version"; then
    echo "viewer: skipped, rerun-sdk $version cannot be installed (is there a network?)"
    exit 0
fi
"$place/venv/bin/rerun" analytics disable
for file in "$@"; do
    # `verify` asks for the index at the end of a file, which `merge` adds to what it has read.
    "$place/venv/bin/rerun" rrd merge "$file" -o "$place/indexed.rrd"
    "$place/venv/bin/rerun" rrd verify "$place/indexed.rrd"
done
