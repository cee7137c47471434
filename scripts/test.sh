#!/usr/bin/env bash
# Runs the tests. Where no Vulkan driver is found on Debian or Ubuntu it installs software Vulkan first.
# --long runs them with all of their cases and on more drivers (scripts/drivers.sh), those that need the sample data in
# GONIO_DATA, and the parsers on mutated files, by chance and under a fuzzer (scripts/fuzz.sh).
set -euo pipefail
cd "$(dirname "$0")/.."

has_vulkan() {
    if [ -n "${VK_DRIVER_FILES:-${VK_ICD_FILENAMES:-}}" ]; then return 0; fi
    compgen -G '/usr/share/vulkan/icd.d/*.json' >/dev/null || compgen -G '/etc/vulkan/icd.d/*.json' >/dev/null
}

if ! has_vulkan && command -v apt-get >/dev/null; then
    echo "No Vulkan driver here: installing software Vulkan (mesa-vulkan-drivers, libvulkan1) with apt-get."
    as_root=()
    if [ "$(id -u)" != 0 ]; then as_root=(sudo); fi
    "${as_root[@]}" apt-get update -q
    "${as_root[@]}" apt-get install -q -y --no-install-recommends mesa-vulkan-drivers libvulkan1
fi

if [ "${1:-}" = --long ]; then
    status=0
    scripts/drivers.sh "${@:2}" || status=1
    # All cases of the tests that otherwise take some of each kind.
    GONIO_THOROUGH=1 cargo test --release --workspace || status=1
    # Without GONIO_DATA they fail and say so.
    cargo test --release --test suite sample_data -- --ignored || status=1
    # Half an hour: tables of random models and settings against the reference.
    cargo test --release --test suite thousand:: -- --ignored --nocapture || status=1
    cargo test --release --test suite outputs::killed -- --ignored --nocapture || status=1
    cargo test --release --lib fuzz:: -- --ignored --nocapture || status=1
    scripts/fuzz.sh || status=1
    exit $status
fi

# The reference integrates adaptively: optimised, or it takes minutes.
cargo test --release --workspace "$@"
