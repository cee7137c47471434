#!/usr/bin/env bash
# Runs the tests on each software Vulkan driver, and compares what fails with tests/drivers.txt: a failure that is
# not listed there fails, and so does a listed one that passes. Says what each driver does (`gonio devices`).
# Arguments go to `cargo test`.
#
# lavapipe is the system's. The others are unpacked beside it, from Debian's packages, and nothing is installed.
set -euo pipefail
cd "$(dirname "$0")/.."

cache="$(realpath -m "${CARGO_TARGET_DIR:-target}")/drivers"
expected=tests/drivers.txt
keyring=/usr/share/keyrings/debian-archive-keyring.gpg
mkdir -p "$cache"/{lists,archives}/partial "$cache/icd"

# apt with lists of its own: the system's stay as they are.
private_apt() {
    local command=$1
    shift
    "$command" -q -o Dir::Etc::SourceList="$cache/sources.list" -o Dir::Etc::SourceParts=- \
        -o Dir::State::Lists="$cache/lists" -o Dir::Cache="$cache" "$@"
}

# unpack DRIVER PACKAGE LIBRARY: the driver's library, out of the package, and a manifest that names it.
unpack() {
    local driver=$1 package=$2 library=$3
    rm -rf "${cache:?}/$driver"
    mkdir -p "$cache/$driver"
    (cd "$cache/$driver" && private_apt apt-get download "$package" && dpkg-deb -x ./*.deb .) || return 1
    local path
    path=$(find "$cache/$driver" -name "$library" | head -n 1)
    [ -n "$path" ] || return 1
    printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "%s", "api_version": "1.3.0"}}\n' "$path" \
        >"$cache/icd/$driver.json"
}

install_drivers() {
    local system
    system=$(compgen -G '/usr/share/vulkan/icd.d/lvp_icd*.json' | head -n 1) ||
        { echo "lavapipe is not here: run scripts/test.sh, or apt-get install mesa-vulkan-drivers libvulkan1" >&2; exit 1; }
    ln -sf "$system" "$cache/icd/lavapipe.json"
    if [ -e "$cache/icd/lavapipe-backports.json" ] && [ -e "$cache/icd/swiftshader.json" ]; then return; fi
    if ! command -v apt-get >/dev/null || [ ! -e "$keyring" ]; then return; fi
    for suite in "debian bookworm" "debian bookworm-backports" "debian-security bookworm-security"; do
        echo "deb [signed-by=$keyring] http://deb.debian.org/${suite% *} ${suite#* } main"
    done >"$cache/sources.list"
    # A driver that cannot be unpacked is told in the table.
    private_apt apt-get update >"$cache/apt.log" 2>&1 || return 0
    unpack lavapipe-backports mesa-vulkan-drivers/bookworm-backports libvulkan_lvp.so >>"$cache/apt.log" 2>&1 || true
    unpack swiftshader chromium-common libvk_swiftshader.so >>"$cache/apt.log" 2>&1 || true
}

# Lines "test result" of cargo's output; a test of the suite is FILE::NAME.
results() {
    awk '/^ +Running /     { file = $2 == "unittests" ? "unit::" : "" }
         /^ +Doc-tests /   { file = "doc::" }
         /^test .* \.\.\. / { name = $0; sub(/^test /, "", name); sub(/ - should panic/, "", name)
                             sub(/ \.\.\. .*/, "", name); gsub(/ /, "", name); print file name, $NF }' "$1"
}

# The atlas of GGX: largest relative errors, and how many values change when ωi and ωe are exchanged.
figures() {
    awk -F, 'NR == 1 { for (k = 1; k <= NF; k++) column[$k] = k; next }
             { max = $column["max"] + 0; low = $column["alpha_from"] + 0; unequal += $column["unequal"]
               if (low > 0.99e-4 && max > large) large = max
               if (max > all) all = max }
             END { printf "%-13.1e %-13.1e %d\n", large, all, unequal }' "$1"
}

install_drivers
cargo build --release --quiet
gonio="${CARGO_TARGET_DIR:-target}/release/gonio"
row='%-19s %6s %7s %9s   %s\n'
table=$(printf "$row" driver passed failed expected "GGX α≥1e-4    to 1e-6       unequal   adapter")
canaries=
wrong=()
for driver in lavapipe lavapipe-backports swiftshader; do
    export VK_DRIVER_FILES="$cache/icd/$driver.json"
    if [ ! -e "$VK_DRIVER_FILES" ]; then
        table+=$'\n'$(printf "$row" "$driver" - - - "not run: it cannot be unpacked here, see $cache/apt.log")
        continue
    fi
    echo "== $driver: $cache/$driver.log"
    cargo test --release --no-fail-fast "$@" >"$cache/$driver.log" 2>&1 || true
    results "$cache/$driver.log" | sort -u >"$cache/$driver.results"
    awk '$2 == "FAILED" { print $1 }' "$cache/$driver.results" >"$cache/$driver.failed"
    awk -v driver="$driver" '$1 == driver { print $2 }' "$expected" | sort >"$cache/$driver.expected"
    if [ ! -s "$cache/$driver.results" ]; then wrong+=("$driver: no test was run"); fi
    while read -r test; do
        wrong+=("$driver: $test fails")
    done < <(comm -23 "$cache/$driver.failed" "$cache/$driver.expected")
    while read -r test; do
        if grep -qxF "$test ok" "$cache/$driver.results"; then
            wrong+=("$driver: $test passes; take it out of $expected")
        elif [ $# = 0 ]; then
            wrong+=("$driver: there is no test $test; take it out of $expected")
        fi
    done < <(comm -13 "$cache/$driver.failed" "$cache/$driver.expected")
    "$gonio" atlas --model ggx --out "$cache/$driver.atlas" >/dev/null 2>&1 || wrong+=("$driver: gonio atlas fails")
    passed=$(grep -c ' ok$' "$cache/$driver.results" || true)
    adapter=$("$gonio" devices 2>/dev/null | sed -n '1{s/ (auto)//;h};2{s/^.*, //;H;x;s/\n/, /p}')
    # What its driver does: what follows the second line, as long as it is indented.
    canary=$("$gonio" devices 2>/dev/null | awk 'NR > 2 { if (!/^    /) exit; print }')
    canaries+=$'\n\n'"$driver"$'\n'"$canary"
    table+=$'\n'$(printf "$row" "$driver" "$passed" "$(wc -l <"$cache/$driver.failed")" \
        "$(wc -l <"$cache/$driver.expected")" "$(figures "$cache/$driver.atlas/atlas.csv")   $adapter")
done

printf '\n%s%s\n' "$table" "$canaries"
if [ ${#wrong[@]} -gt 0 ]; then
    printf '\nNot as expected (%s):\n' "$expected"
    printf '  %s\n' "${wrong[@]}"
    exit 1
fi
