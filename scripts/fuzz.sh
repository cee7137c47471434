#!/usr/bin/env bash
# Runs each parser under a coverage-guided fuzzer, a minute or the seconds given, with at most 1 GiB of memory.
#
#     scripts/fuzz.sh [SECONDS [TARGET…]]
#
# It installs nothing: cargo-fuzz and a nightly toolchain are needed. An input that fails stays in fuzz/artifacts/TARGET.
set -euo pipefail
cd "$(dirname "$0")/.."
seconds=${1:-60}

missing=
command -v cargo-fuzz >/dev/null || missing+=$'\n  cargo install cargo-fuzz --locked'
rustup toolchain list 2>/dev/null | grep -q '^nightly' || missing+=$'\n  rustup toolchain install nightly --profile minimal'
if [ -n "$missing" ]; then
    echo "scripts/fuzz.sh needs:$missing" >&2
    exit 2
fi

(cd fuzz && cargo +nightly run --release --quiet --bin seeds corpus)
targets=("${@:2}")
if [ ${#targets[@]} = 0 ]; then mapfile -t targets < <(cargo +nightly fuzz list | grep -v '^seeds$'); fi
cargo +nightly fuzz build
failed=()
for target in "${targets[@]}"; do
    echo "== $target"
    log=fuzz/target/$target.log
    # The sanitiser's own memory counts in rss_limit_mb; malloc_limit_mb is for one request.
    cargo +nightly fuzz run "$target" "fuzz/corpus/$target" -- -max_total_time="$seconds" -max_len=65536 \
        -rss_limit_mb=2048 -malloc_limit_mb=1024 -timeout=20 -print_final_stats=1 >"$log" 2>&1 || failed+=("$target")
    grep -E 'panicked|ERROR|SUMMARY|stat::(number_of_executed_units|average_exec|peak_rss)' "$log" || true
done
if [ ${#failed[@]} -gt 0 ]; then
    echo "failed: ${failed[*]}; see fuzz/artifacts" >&2
    exit 1
fi
