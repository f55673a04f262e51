#!/usr/bin/env bash
# Builds the wheel of the Python package as `pip install ./python` does, installs it in a clean environment, and runs its tests and the notebook.
#
#   tests/python/check.sh [PYTHON]
#
# CARGO_TARGET_DIR says where cargo builds, as always: what a release build of the command has left there is used again.
set -euo pipefail
cd "$(dirname "$0")/../.."
python=${1:-python3}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

# Nothing is checked where that is not possible; where REQUIRE_PYTHON is set, that is a failure.
skip() {
    if [ -n "${REQUIRE_PYTHON:-}" ]; then
        echo "python: failed, $1" >&2
        exit 1
    fi
    echo "python: skipped, $1"
    exit 0
}

# Says how long a part took.
part() {
    echo "== $1 (${SECONDS} s so far)"
}

part "wheel"
"$python" -c "" 2>"$place/none" || skip "there is no $python"
"$python" -m venv "$place/build" >"$place/none" 2>&1 || skip "$python makes no environments (Debian: apt-get install python3-venv)"
maturin=$place/build/bin/maturin
if ! "$place/build/bin/pip" install --quiet --disable-pip-version-check "maturin>=1.9,<2"; then
    maturin=$(command -v maturin) || skip "maturin cannot be installed (is there a network?)"
fi
(cd python && "$maturin" build --release --out "$place/wheels")

part "clean environment"
"$python" -m venv "$place/clean"
"$place/clean/bin/pip" install --quiet --disable-pip-version-check "$place"/wheels/*.whl
(cd "$place" && clean/bin/python -c "import tauscope; print('tauscope', tauscope.__version__)" && clean/bin/tauscope --version)

part "tests"
"$place/clean/bin/pip" install --quiet --disable-pip-version-check pytest pandas matplotlib nbclient nbformat ipykernel
"$place/clean/bin/python" -m pytest -q -p no:cacheprovider --durations=5 python/tests

part "notebook"
"$place/clean/bin/python" tests/python/notebook.py docs/tour.ipynb "$place"
part "done"
