#!/bin/sh
# Make .venv from the hashed lock files and install semtopo in it, editable. Run at the root.
# A uv at hand is used; else the locked one is installed by pip; if uv fails, pip does it all.
# PYTHON=... names another interpreter.
set -eu
bin=.venv/bin

fail() {
    echo "setup: $1" >&2
    exit 1
}

is_new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null
}

make_venv() {
    rm -rf .venv
    for python in ${PYTHON:-python3 python3.13 python3.12 python3.11}; do
        is_new_enough "$python" || continue
        "$python" -m venv .venv && return
        rm -rf .venv
        if command -v uv >/dev/null; then
            uv venv --quiet --python "$("$python" -c 'import sys; print(sys.executable)')" .venv && return
        fi
        fail "$python cannot make a virtual environment; install its venv module, or uv"
    done
    fail 'Python 3.11 or later is needed'
}

find_uv() {
    if [ -x "$bin/uv" ]; then
        echo "$bin/uv"
    elif ! command -v uv; then
        "$bin/python" -m pip install --quiet --require-hashes -r requirements-build.lock >&2 || true
        echo "$bin/uv"
    fi
}

install_with_uv() {
    "$1" pip sync --quiet --python "$bin/python" --require-hashes requirements.lock &&
        "$1" pip install --quiet --python "$bin/python" --no-deps --no-build-isolation --editable .
}

install_with_pip() {
    "$bin/python" -m pip --version >/dev/null 2>&1 || "$bin/python" -m ensurepip >/dev/null
    "$bin/python" -m pip install --quiet --require-hashes -r requirements.lock
    "$bin/python" -m pip install --quiet --no-deps --no-build-isolation --editable .
}

is_new_enough "$bin/python" || make_venv
install_with_uv "$(find_uv)" || install_with_pip
