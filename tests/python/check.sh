#!/usr/bin/env bash
# Builds the wheel of the Python package, installs it in a clean environment, and runs its tests and the notebook.
#
#   tests/python/check.sh [PYTHON]
#
# CARGO_TARGET_DIR says where cargo builds, as always.
set -euo pipefail
cd "$(dirname "$0")/../.."
python=${1:-python3}
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

echo "== wheel"
"$python" -m venv "$place/build"
"$place/build/bin/pip" install --quiet "maturin>=1.9,<2"
(cd python && "$place/build/bin/maturin" build --release --out "$place/wheels")

echo "== clean environment"
"$python" -m venv "$place/clean"
"$place/clean/bin/pip" install --quiet "$place"/wheels/*.whl
(cd "$place" && clean/bin/python -c "import tauscope; print('tauscope', tauscope.__version__)" && clean/bin/tauscope --version)

echo "== tests"
"$place/clean/bin/pip" install --quiet pytest pandas matplotlib nbclient nbformat ipykernel
"$place/clean/bin/python" -m pytest -q -p no:cacheprovider python/tests

echo "== notebook"
"$place/clean/bin/python" tests/python/notebook.py docs/tour.ipynb "$place"
