#!/usr/bin/env bash
# Makes a checkout ready to collect: environment, system libraries, Vulkan driver, assets.
# Safe to repeat: what is in place is left alone. Every system-wide step is announced first.
#   scripts/setup.sh                       what collecting needs
#   scripts/setup.sh test                  and what the tests need
#   scripts/setup.sh dev                   and ruff and pyright
#   scripts/setup.sh docs                  and what builds the documentation site
#   PYTHON=python3.12 scripts/setup.sh     use that interpreter
#   RTPHYS_SETUP=venv scripts/setup.sh     take no system-wide step at all
set -euo pipefail
cd "$(dirname "$0")/.."
. scripts/system.sh

case ${1:-run} in  # an extra of pyproject.toml, and the levels that it includes
    run) EXTRA="" LEVELS="run" ;;
    test) EXTRA="[test]" LEVELS="run test" ;;
    dev) EXTRA="[dev]" LEVELS="run test dev" ;;
    docs) EXTRA="[docs]" LEVELS="run docs" ;;
    *) die "$1 is not a level of the set-up: run, test, dev or docs" ;;
esac
LEVEL=${1:-run}
VENV=.venv
STAMP=$VENV/.setup-stamp          # one for each level: installed for these versions of the files
DRIVER_STAMP=$VENV/.driver-stamp  # a frame was rendered with this set of drivers

hash_of() { { cat "$@" 2>/dev/null || true; } | sha256sum | cut -d" " -f1; }
environment_key() { hash_of pyproject.toml manifests/constraints.txt scripts/setup.sh scripts/system.sh; }
driver_key() { hash_of /etc/os-release /usr/share/vulkan/icd.d/* /etc/vulkan/icd.d/*; }
stamped() { [ -f "$1" ] && [ "$(cat "$1")" = "$2" ]; }

find_python() {
    local name names=(python3 python3.13 python3.12 python3.11)
    [ -z "${PYTHON:-}" ] || names=("$PYTHON")
    for name in "${names[@]}"; do
        if "$name" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info < (3, 14))' 2>/dev/null; then
            command -v "$name"
            return
        fi
    done
    return 1
}

create_environment() {
    local python
    if ! python=$(find_python); then
        command -v python3 >/dev/null ||
            install_packages "Python is missing" python3 python3-venv
        python=$(find_python) || die "rtphys needs Python 3.11, 3.12 or 3.13; name one with PYTHON=…"
    fi
    "$python" -c 'import ensurepip, venv' 2>/dev/null ||
        install_packages "this Python cannot create virtual environments" \
            "$(basename "$(readlink -f "$python")")-venv"
    say "creating the virtual environment $VENV with $("$python" --version)"
    "$python" -m venv "$VENV"
}

install_dependencies() {
    say "installing rtphys$EXTRA and what it depends on into $VENV"
    "$VENV/bin/python" -m pip install --quiet --disable-pip-version-check \
        -c manifests/constraints.txt -e ".$EXTRA"
    headless_opencv ||
        "$VENV/bin/python" -m pip install --quiet --disable-pip-version-check \
            -c manifests/constraints.txt --force-reinstall --no-deps opencv-contrib-python-headless
}

# sapien pulls in opencv-python, which needs libGL and owns the same cv2/ folder as the headless
# build. pip unpacks the headless one last (see pyproject.toml), but an update may not.
headless_opencv() {
    "$VENV/bin/python" - <<'PY' 2>/dev/null
import sys, cv2
gui = [line.split()[-1] for line in cv2.getBuildInformation().splitlines() if "GUI:" in line]
sys.exit(gui != ["NONE"])
PY
}

# Wheels bring most of what they link; a bare machine lacks the rest. Each answer may hide the next
# (a library that is found may ask for another), hence the rounds.
ensure_libraries() {
    local broken packages round
    for round in 1 2 3; do
        broken=$("$VENV/bin/python" -W ignore -m rtphys.core.dependencies 2>/dev/null) && return
        packages=$(sed -n 's/.*: \([a-z0-9.+-]\{2,\}\)$/\1/p' <<<"$broken" | sort -u)
        [ -n "$packages" ] || break
        # shellcheck disable=SC2086  # one word a package
        install_packages "compiled packages miss system libraries (no window is opened)" $packages ||
            break
    done
    die "these packages cannot be loaded: $broken"
}

renders() {
    local answer status=0
    answer=$("$VENV/bin/python" -W ignore -m rtphys.sim.probe 2>/dev/null) || status=$?
    say "  $(sed -n 's/.*"detail": "\([^"]*\)".*/\1/p' <<<"${answer:-\"detail\": \"the test crashed\"}")"
    return "$status"
}

ensure_driver() {
    stamped "$DRIVER_STAMP" "$(driver_key)" && return
    say "looking for a Vulkan device that can render"
    if ! renders; then
        install_driver || no_pictures "no Vulkan driver" || return 0
        renders || no_pictures "the driver is installed, but no frame came out" || return 0
    fi
    driver_key >"$DRIVER_STAMP"
}

no_pictures() {
    warn "$1: everything but pictures works; '$VENV/bin/rtphys doctor' names the cure"
    return 1
}

build_assets() {
    "$VENV/bin/rtphys" assets --help >/dev/null 2>&1 || return 0
    say "building the builtin asset pack (skipped when it is there)"
    "$VENV/bin/rtphys" assets build
}

main() {
    local level
    if ! stamped "$STAMP-$LEVEL" "$(environment_key)" || [ ! -x "$VENV/bin/rtphys" ]; then
        [ -x "$VENV/bin/python" ] || create_environment
        install_dependencies
        ensure_libraries
        ensure_driver
        build_assets
        for level in $LEVELS; do environment_key >"$STAMP-$level"; done
        say "ready: $VENV/bin/rtphys --help"
    else
        ensure_driver
    fi
}

main "$@"
