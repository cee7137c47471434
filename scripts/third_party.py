#!/usr/bin/env python3
"""Writes THIRD-PARTY.md: the licences of what the gonio program is made of, on any platform.

    scripts/third_party.py > THIRD-PARTY.md

The crates come from `cargo metadata` and the texts from the crates' own files; a crate that may be used under Apache-2.0 is
used under it, so that one text serves most. `cargo fetch` first, as crates of other platforms are listed too.
"""

import json
import re
import subprocess
import sys
from collections import defaultdict
from pathlib import Path

MIT = """Permission is hereby granted, free of charge, to any person obtaining a copy of this software and associated
documentation files (the "Software"), to deal in the Software without restriction, including without limitation the rights to
use, copy, modify, merge, publish, distribute, sublicense, and/or sell copies of the Software, and to permit persons to whom
the Software is furnished to do so, subject to the following conditions:

The above copyright notice and this permission notice shall be included in all copies or substantial portions of the Software.

THE SOFTWARE IS PROVIDED "AS IS", WITHOUT WARRANTY OF ANY KIND, EXPRESS OR IMPLIED, INCLUDING BUT NOT LIMITED TO THE
WARRANTIES OF MERCHANTABILITY, FITNESS FOR A PARTICULAR PURPOSE AND NONINFRINGEMENT. IN NO EVENT SHALL THE AUTHORS OR
COPYRIGHT HOLDERS BE LIABLE FOR ANY CLAIM, DAMAGES OR OTHER LIABILITY, WHETHER IN AN ACTION OF CONTRACT, TORT OR OTHERWISE,
ARISING FROM, OUT OF OR IN CONNECTION WITH THE SOFTWARE OR THE USE OR OTHER DEALINGS IN THE SOFTWARE."""

# The fonts that are drawn with, of epaint_default_fonts, and the files there that hold their licences.
FONTS = [("Hack", "Hack-Regular.txt"), ("Ubuntu Light", "UFL.txt")]


def packages():
    """Those of the normal dependency tree, without our own."""
    command = ["cargo", "metadata", "--locked", "--offline", "--format-version", "1"]
    metadata = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
    by_id = {package["id"]: package for package in metadata["packages"]}
    nodes = {node["id"]: node for node in metadata["resolve"]["nodes"]}
    found, next_ones = set(), [metadata["resolve"]["root"]]
    while next_ones:
        here = next_ones.pop()
        if here not in found:
            found.add(here)
            for dep in nodes[here]["deps"]:
                if any(kind["kind"] is None for kind in dep["dep_kinds"]):
                    next_ones.append(dep["pkg"])
    chosen = [by_id[id] for id in found if by_id[id]["source"]]
    return sorted(chosen, key=lambda package: (package["name"], package["version"]))


def text_of(package):
    """The licence that the crate is used under, and its text."""
    folder = Path(package["manifest_path"]).parent
    files = sorted(p for p in folder.iterdir() if p.is_file() and re.match(r"(?i)licen[cs]e|copying|unlicense", p.name))
    expression = package["license"]
    for name in ["Apache-2.0", "MIT", "BSD-3-Clause", "ISC", "Zlib"]:
        if not re.search(rf"(^|[ (/]){re.escape(name)}($|[ )/])", expression):
            continue
        if name == "Apache-2.0":
            return name, None
        named = [p for p in files if name.split("-")[0].lower() in p.name.lower()]
        for path in named + files:
            return name, path.read_text(errors="replace").strip()
        if name == "MIT":
            authors = ", ".join(package["authors"]) or f"the authors of {package['name']}"
            return name, f"Copyright (c) {authors}\n\n{MIT}"
    sys.exit(f"{package['name']}: no text for {expression}")


def main():
    apache, others, apache_text, fonts = [], defaultdict(list), None, None
    for package in packages():
        folder = Path(package["manifest_path"]).parent
        label = f"{package['name']} {package['version']}"
        if package["name"] == "epaint_default_fonts":
            fonts = folder / "fonts"
        if "Unicode-3.0" in package["license"]:
            others["Unicode-3.0", (folder / "LICENSE-UNICODE").read_text().strip()].append(label)
        name, text = text_of(package)
        if text is None:
            apache.append(label)
        else:
            others[name, text].append(label)
    apache_text = Path("LICENSE-APACHE").read_text().strip()
    print("# Third-party notices\n")
    print("The `gonio` program is made of gonio itself (MIT OR Apache-2.0), the crates below and two fonts. Which crates are in")
    print("it depends on the platform. `scripts/third_party.py` writes this page, and `gonio licenses` prints it.\n")
    print(f"## Apache-2.0\n\n{', '.join(apache)}.\n\n```text\n{apache_text}\n```\n")
    for (name, text), labels in sorted(others.items(), key=lambda item: (item[0][0], item[1])):
        print(f"## {name}: {', '.join(labels)}\n\n```text\n{text}\n```\n")
    for name, file in FONTS:
        print(f"## Font: {name}\n\n```text\n{(fonts / file).read_text(errors='replace').strip()}\n```\n")


if __name__ == "__main__":
    main()
