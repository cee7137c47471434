#!/usr/bin/env bash
# Licences, duplicates and sources of all crates, offline; and known vulnerabilities where a database of them is at hand
# (`cargo deny fetch db` gets one).
set -euo pipefail
cd "$(dirname "$0")/.."

if ! command -v cargo-deny >/dev/null; then
    echo "cargo-deny is not here (cargo install cargo-deny --locked); the suite checks what it can without" >&2
    exec cargo test --release --test suite supply_chain::
fi
cargo deny --offline --locked check licenses bans sources
if compgen -G "${CARGO_HOME:-$HOME/.cargo}/advisory-dbs/*/" >/dev/null; then
    cargo deny --offline --locked check advisories
else
    echo "advisories: not checked, as no database is here (cargo deny fetch db)"
fi
