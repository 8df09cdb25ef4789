#!/bin/sh
# Put the peers of the benchmarks into .venv/peers, from their hashed lock file. Run at the root.
# They are kept apart, since one asks for an older numpy than it needs.
set -eu
bin=.venv/bin
peers=.venv/peers
lock=requirements-bench.lock

install_with_uv() {
    "$bin/uv" pip install --quiet --python "$bin/python" --target "$1" --no-deps --require-hashes -r "$lock"
}

install_with_pip() {
    "$bin/python" -m pip install --quiet --target "$1" --no-deps --require-hashes -r "$lock"
}

if cmp -s "$lock" "$peers/$lock"; then
    exit 0
fi
rm -rf "$peers" "$peers.new"
install_with_uv "$peers.new" || install_with_pip "$peers.new"
rm -rf "$peers.new/tests"  # it would hide the tests of this project
cp "$lock" "$peers.new/"
mv "$peers.new" "$peers"
