#!/usr/bin/env bash
# Drains and erodes the same land with fastscapelib, landlab and the binary, and compares. Not part of tests/run: what
# landlab brings along is 900 MB. Installs into target/peers what is not there yet.
#
# usage: peers.sh BINARY
set -euo pipefail
binary=$(realpath "$1")
here=$(dirname "$(realpath "$0")")
peers=$here/../../target/peers
wanted=$here/requirements-peers.txt
if ! cmp -s "$wanted" "$peers/installed"; then
    python3 -m venv "$peers"
    "$peers/bin/pip" install -q -r "$wanted"
    cp "$wanted" "$peers/installed"
fi
"$peers/bin/python" "$here/check_rivers.py" "$binary"
