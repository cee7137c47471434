#!/usr/bin/env python3
"""How long a first result takes: from the start of `gonio bake` to its end, for a 64 × 64 table of GGX's
split sum without a cross-check. Cold has no cache of compiled shaders (Mesa's is off), warm has one.

    cargo build --release
    scripts/startup.py [--runs 20] [--device NAME] [BINARY …]

Several binaries are run in turns, as a machine may have more than one speed."""

import argparse
import os
import re
import statistics
import subprocess
import tempfile
import time

RECIPE = """
[[tables]]
name = "dfg"
quantity = "split_sum"
model = "ggx"
axes = { mu = 64, roughness = 64 }
"""


def bake(binary, device, folder, cold):
    """Milliseconds of one bake, and what it says of its stages."""
    environment = dict(os.environ, MESA_SHADER_CACHE_DIR=os.path.join(folder, "cache"))
    if cold:
        environment["MESA_SHADER_CACHE_DISABLE"] = "true"
    command = [binary, "bake", os.path.join(folder, "dfg.toml"), "--out", os.path.join(folder, "out")]
    command += ["--check", "0", "--format", "npy", "--device", device]
    start = time.perf_counter()
    done = subprocess.run(command, env=environment, capture_output=True, text=True)
    milliseconds = 1e3 * (time.perf_counter() - start)
    if done.returncode != 0:
        raise SystemExit(f"{binary}: {done.stderr}")
    stages = re.search(r"^ms\s+(.*)$", done.stdout, re.MULTILINE).group(1)
    return milliseconds, {name: float(ms) for name, ms in (stage.split() for stage in stages.split(", "))}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("binaries", nargs="*", metavar="BINARY", default=["target/release/gonio"])
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--device", default="auto")
    arguments = parser.parse_args()
    kinds = [(binary, cold) for binary in arguments.binaries for cold in (True, False)]
    runs = {kind: [] for kind in kinds}
    with tempfile.TemporaryDirectory() as folder:
        with open(os.path.join(folder, "dfg.toml"), "w") as recipe:
            recipe.write(RECIPE)
        # The first round fills the caches, of files too.
        for count in range(arguments.runs + 1):
            for binary, cold in kinds:
                run = bake(binary, arguments.device, folder, cold)
                if count > 0:
                    runs[binary, cold].append(run)
    for binary, cold in kinds:
        times = [milliseconds for milliseconds, _ in runs[binary, cold]]
        stages = [stages for _, stages in runs[binary, cold]]
        medians = {name: statistics.median(stage[name] for stage in stages) for name in stages[0]}
        named = ", ".join(f"{name} {ms:.0f}" for name, ms in medians.items() if ms > 0)
        rest = statistics.median(times) - sum(medians.values())
        print(f"{binary} {'cold' if cold else 'warm'}: median {statistics.median(times):.0f} ms, "
              f"{min(times):.0f} to {max(times):.0f}; {named}, start and end of the process {rest:.0f}")


if __name__ == "__main__":
    main()
