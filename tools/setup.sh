#!/usr/bin/env bash
# Install what is missing and build lumel into .venv of this tree:
#
#     tools/setup.sh          what `lumel` needs to run
#     tools/setup.sh dev      also what its tests and linters need
#
# What only apt has comes from apt (with sudo where we are not root); all the rest goes into .venv. PYTHON=... picks the interpreter.
set -euo pipefail
cd "$(dirname "$0")/.."
mode=${1:-run}
if [[ $mode != run && $mode != dev ]]; then
    echo "setup: unknown mode '$mode'; allowed: dev, or nothing" >&2
    exit 2
fi

# Whether interpreter $1 runs and is new enough.
good_python() { command -v "$1" >/dev/null && "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; }

# Print the interpreter to use, or nothing.
find_python() {
    local candidate
    for candidate in ${PYTHON:-python3.13 python3.12 python3.11 python3}; do
        if good_python "$candidate"; then
            echo "$candidate"
            return
        fi
    done
}

# Print the apt packages that interpreter $1 still needs to make a virtual environment and to compile a module.
python_packages() {
    "$1" - <<'END'
import importlib.util, pathlib, sys, sysconfig
version = f"python{sys.version_info.major}.{sys.version_info.minor}"
if not all(importlib.util.find_spec(name) for name in ("venv", "ensurepip")):
    print(f"{version}-venv")
if not pathlib.Path(sysconfig.get_path("include"), "Python.h").exists():
    print(f"{version}-dev")
END
}

# Whether header $1 is where compilers look.
have_header() { [[ -e /usr/include/$1 || -e /usr/local/include/$1 ]]; }

# Whether there is a browser that tests/python/browser.py finds.
have_browser() { command -v chromium-headless-shell || command -v chromium || command -v google-chrome; } >/dev/null

# Whether this is Debian itself: Ubuntu's apt has no browser.
is_debian() { grep -qx 'ID=debian' /etc/os-release 2>/dev/null; }

# Print the apt packages that are missing.
missing_packages() {
    command -v g++ >/dev/null || echo g++
    command -v cmake >/dev/null || echo cmake
    command -v ninja >/dev/null || echo ninja-build
    have_header embree4/rtcore.h || have_header embree3/rtcore.h || echo libembree-dev
    have_header oneapi/tbb/version.h || echo libtbb-dev
    if [[ $mode == dev ]]; then
        have_header gtest/gtest.h || echo libgtest-dev
        have_browser || ! is_debian || echo chromium-headless-shell
    fi
    if [[ -n $python ]]; then
        python_packages "$python"
    else
        echo python3 python3-venv python3-dev
    fi
}

# Install the apt packages given, refreshing apt's lists only if the first try fails; stop with their names where we may not.
install_packages() {
    local sudo=()
    if [[ $(id -u) != 0 ]]; then
        if ! { command -v sudo && { sudo -n true || [[ -t 0 ]]; }; } >/dev/null 2>&1; then
            echo "setup: these packages are missing and it takes root to install them. Ask for: apt-get install $*" >&2
            exit 1
        fi
        sudo=(sudo)
    fi
    if ! command -v apt-get >/dev/null; then
        echo "setup: there is no apt-get here; install by other means what Debian calls: $*" >&2
        exit 1
    fi
    echo "setup: installing $*"
    local install=(env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "$@")
    "${sudo[@]}" "${install[@]}" >/dev/null 2>&1 || { "${sudo[@]}" apt-get update -qq && "${sudo[@]}" "${install[@]}" >/dev/null; }
}

python=$(find_python)
if [[ -z $python && -n ${PYTHON:-} ]]; then
    echo "setup: PYTHON=$PYTHON does not run or is older than 3.11" >&2
    exit 1
fi
packages=$(missing_packages)
if [[ -n $packages ]]; then
    # shellcheck disable=SC2086  # one word a package
    install_packages $packages
    python=$(find_python)
fi
if [[ -z $python ]]; then
    echo "setup: lumel needs Python 3.11 or newer; none of python3.13, python3.12, python3.11, python3 is" >&2
    exit 1
fi

# Make the virtual environment anew unless one that works is there.
if ! .venv/bin/python -c 'import pip' 2>/dev/null; then
    rm -rf .venv
    "$python" -m venv .venv
fi

# Build in place: Python files are used where they lie, and the compiled module is kept up to date in build/python.
export PIP_DISABLE_PIP_VERSION_CHECK=1
mapfile -t requires < <(.venv/bin/python -c 'import tomllib; print(*tomllib.load(open("pyproject.toml", "rb"))["build-system"]["requires"], sep="\n")')
extras=
[[ $mode == dev ]] && extras='[dev]'
echo "setup: installing Python packages and building lumel"
.venv/bin/pip install -q "${requires[@]}"
.venv/bin/pip install -q --no-build-isolation --config-settings=build-dir=build/python --editable ".$extras"
