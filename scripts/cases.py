#!/usr/bin/env python3
"""Runs gonio on a folder of small inputs that once failed, and says for each whether what comes is right.

    scripts/cases.py FOLDER [--gonio PATH] [--only scenes,light,shaders,hostile,signatures] [--seconds 60]

The folder has the rooms scenes, light, shaders (with shaders.json beside them), hostile and signatures. A file without an
expectation here is run and listed as not judged. The exit code is 1 if any row is wrong.
"""

import argparse
import ast
import json
import os
import resource
import shutil
import struct
import subprocess
import sys
import tempfile
import xml.etree.ElementTree
from pathlib import Path

MEMORY = 4_000_000 * 1024  # bytes of address space
SECONDS = 60


class Came:
    """What one run of the command gave."""

    def __init__(self, code, out, err):
        self.code, self.out, self.err = code, out, err
        # Drivers write there too.
        said = [line for line in (out + err).splitlines() if "XDG_RUNTIME_DIR" not in line]
        self.text = "\n".join(said)

    def line(self, *words):
        """The first line that has the first of the words that any line has."""
        for word in words:
            for line in self.text.splitlines():
                if word in line:
                    return line.strip()
        return self.text.strip().split("\n")[0]

    def summary(self):
        if self.code is None:
            return "did not end in time"
        return f"exit {self.code}: {self.line('error:', 'warning:', 'BROKEN', 'overflow', 'roughness', 'estimate', 'pairs of')}"


class Gonio:
    """The command, under the limits, with an empty folder for what it writes."""

    def __init__(self, path, seconds):
        self.seconds = seconds
        self.path = str(Path(path).resolve())
        self.folder = Path(tempfile.mkdtemp(prefix="gonio-cases-"))

    def run(self, *arguments):
        def limit():
            resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))

        command = [self.path, *map(str, arguments)]
        process = subprocess.Popen(command, cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, preexec_fn=limit)
        try:
            out, err = process.communicate(timeout=self.seconds)
            code = process.returncode
        except subprocess.TimeoutExpired:
            process.kill()
            out, err = process.communicate()
            code = None
        return Came(code, out.decode(errors="replace"), err.decode(errors="replace"))

    def irradiance(self, env):
        """E under a map, and the run."""
        shutil.rmtree(self.folder / "o", ignore_errors=True)
        came = self.run("light", "--env", env, "--normals", "4x4", "--format", "npy", "--out", "o")
        file = self.folder / "o" / "irradiance.npy"
        return came, read_npy(file) if came.code == 0 and file.exists() else None


def read_npy(path):
    """The numbers of an NPY file of float32, float64 or float16."""
    data = path.read_bytes()
    start, size = (10, struct.unpack_from("<H", data, 8)[0]) if data[6] == 1 else (12, struct.unpack_from("<I", data, 8)[0])
    header = ast.literal_eval(data[start : start + size].decode())
    kind = {"f4": "f", "f8": "d", "f2": "e"}[header["descr"][1:]]
    body = data[start + size :]
    return struct.unpack(f"{header['descr'][0]}{len(body) // struct.calcsize(kind)}{kind}", body)


def near(a, b, factor=1.0):
    """Whether a is factor · b, within what two tables may differ by."""
    if a is None or b is None or len(a) != len(b):
        return False
    scale = max(abs(x) for x in b)
    return scale > 0 and all(abs(x - factor * y) <= 1e-4 * factor * scale for x, y in zip(a, b))


def is_clean_error(came):
    """An error for people: a code of the guide, and a message."""
    return came.code in (2, 3) and "error:" in came.text and "panicked" not in came.text


# ---- scenes: what was wanted, and whether it came -------------------------------------------------------------------

def dry(*wanted):
    """The scene is read, and these texts are among what is said."""
    return lambda came: came.code == 0 and all(text in came.text for text in wanted)


def quiet(*wanted):
    """The same, without a warning."""
    return lambda came: dry(*wanted)(came) and "warning:" not in came.text


SCENES = {
    "a1_animation_without_node": ("read", quiet("roughness 0.5000")),
    "a2_scene_without_nodes": ("read", quiet("roughness 0.5000")),
    "a3_extras_string": ("read", quiet("roughness 1.0000")),
    "a3_extras_number": ("read", quiet("roughness 0.5000")),
    "b1_half_jpeg": ("the whole range, and a warning", dry("warning:", "b1_half.jpg", "roughness 0.0000 … 1.0000")),
    "b1_whole_jpeg": ("roughness .161 … .882", quiet("roughness 0.1608 … 0.8824")),
    "e1_anisotropic": ("read; eval has values", quiet("ggx-anisotropic")),
    "f1_base_color_1.00016": ("warned of, clamped, the others kept", dry("warning:", "1.00016", "good:", "bad:")),
    "f3_bom": ("read", quiet("roughness 0.5000")),
    "f4_backslash": ("read, or a true message", dry("roughness 0.1569 … 0.6275")),
    "f7_upper_data_uri": ("read", quiet("roughness 0.1569 … 0.6275")),
    "f8_required_unknown": ("a warning that names the extension", dry("warning:", "FOO_bar")),
    "f10_unlit_only": ("says unlit", lambda came: is_clean_error(came) and "unlit" in came.text),
    "f11_msft_lod": ("works", dry("roughness 1.0000")),
    "g1_everything": ("works", dry("ggx-anisotropic")),
}


def scenes(gonio, folder):
    for path in sorted(folder.glob("*.gl*")):
        wanted, right = SCENES.get(path.stem, ("", None))
        came = gonio.run("bake", path, "--dry-run")
        yield path.name, wanted, came.summary(), right and right(came)
        if path.stem == "e1_anisotropic":
            yield from evaluations(gonio, path)


def evaluations(gonio, path):
    """One pair, a list of pairs, and the commands that `check` prints."""
    scene = ["--scene", path] if "--scene" in gonio.run("eval", "--help").out else [path]
    material = ["--material", "M"]
    one = gonio.run("eval", *scene, *material, "--theta-i", "0.5", "--phi-i", "0.3", "--theta-e", "0.7", "--phi-e", "2")
    yield f"{path.name}, eval", "values", one.summary(), one.code == 0
    (gonio.folder / "pairs.csv").write_text("theta_i,phi_i,theta_e,phi_e\n0.5,0.3,0.7,2\n0.1,0,0.2,1\n")
    many = gonio.run("eval", *scene, *material, "--pairs", "pairs.csv", "--out", "values.csv")
    lines = (gonio.folder / "values.csv").read_text().splitlines() if many.code == 0 else []
    rows = [line for line in lines if line and not line.startswith("#")]
    yield f"{path.name}, eval --pairs", "two rows", many.summary(), many.code == 0 and len(rows) == 3
    check = gonio.run("check", path, "--budget", "1e4")
    printed = [line.strip() for line in check.out.splitlines() if line.strip().startswith("gonio eval")]
    failed = [line for line in printed if subprocess.run(
        ["bash", "-c", line.replace("gonio", gonio.path, 1)], cwd=gonio.folder, capture_output=True).returncode != 0]
    came = f"{len(failed)} of {len(printed)} fail" + "".join(f": {line}" for line in failed[:1])
    yield f"{path.name}, what check prints", "every command works", came, bool(printed) and not failed


# ---- light ----------------------------------------------------------------------------------------------------------

def light(gonio, folder):
    of = {path.name: gonio.irradiance(path) for path in sorted(folder.iterdir())}

    def judge(name):
        came, values = of[name]
        truth = lambda other: of[other][1] if other in of else None
        mentions = lambda *words: all(word in came.text for word in words)
        match name:
            case "c1_cropped_data_window.exr":
                return "E of c1_full.exr", near(values, truth("c1_full.exr"))
            case "c6_luminance_only.exr" | "c6_blender_multilayer.exr":
                return "read, or the channels listed", values is not None or (is_clean_error(came) and mentions("channel"))
            case "d2_exposure_2.hdr":
                return "E of d2_no_exposure.hdr halved", near(values, truth("d2_no_exposure.hdr"), 0.5)
            case "d3_plus_y.hdr":
                return "read, or a true message", values is not None or (is_clean_error(came) and mentions("+Y"))
            case "d4_crlf.hdr":
                return "E of d2_no_exposure.hdr", near(values, truth("d2_no_exposure.hdr"))
            case "c1_full.exr" | "d2_no_exposure.hdr":
                return "read", values is not None
        return "", None

    for name, (came, values) in of.items():
        wanted, right = judge(name)
        mean = "" if values is None else f"; mean E {sum(values) / len(values):.6g}"
        yield name, wanted, came.summary() + mean, right


# ---- shaders --------------------------------------------------------------------------------------------------------

def shaders(gonio, folder):
    rows = folder.parent / "shaders.json"
    for row in json.loads(rows.read_text()) if rows.exists() else []:
        came = gonio.run("check", "--wgsl", folder.parent / row["file"], "--entry", row["entry"], *row["arguments"], "--json")
        name, should = Path(row["file"]).name, row["should_break"]
        try:
            findings = {f["property"]: f["verdict"] for f in json.loads(came.out)["findings"]}
        except (ValueError, KeyError):
            yield name, should or "kept", came.summary(), False if should != "?" else None
            continue
        broken = [name for name, verdict in findings.items() if verdict != "kept"]
        said = f"exit {came.code}: {', '.join(broken) + ' broken' if broken else 'all kept'}"
        if should == "?":
            yield name, "(judged by --like alone)", said, None
        elif should is None:
            yield name, "all kept", said, came.code == 0 and not broken
        else:
            wanted = should.split()
            extra = [name for name in broken if name not in wanted]
            said += f" (beyond what was wanted: {', '.join(extra)})" if extra else ""
            yield name, f"{', '.join(wanted)} broken", said, came.code == 1 and all(w in broken for w in wanted)


# ---- hostile --------------------------------------------------------------------------------------------------------

def shader(gonio, path, *more):
    return gonio.run("check", "--wgsl", path, "--entry", "brdf", *more)


def hostile(gonio, folder):
    for path in sorted(folder.iterdir()):
        yield (path.name, *judge_hostile(gonio, path))


def judge_hostile(gonio, path):
    """What was wanted, what came, and whether it is right."""
    match path.name:
        case "dwaa_one_byte_aborts.exr":
            came, _ = gonio.irradiance(path)
            return "an error, never an abort", came.summary(), is_clean_error(came)
        case "dwaa_good_for_comparison.exr":
            came, values = gonio.irradiance(path)
            return "read, or an error", came.summary(), values is not None or is_clean_error(came)
        case "dfd_panic.gltf":
            came = gonio.run("bake", path, "--dry-run")
            return "a warning and the whole range", came.summary(), dry("warning:", "roughness 0.0000 … 1.0000")(came)
        case "anisotropic_film_takes_minutes.gltf":
            came = gonio.run("bake", path, "--out", "film")
            return "tables", came.summary(), came.code == 0 and (gonio.folder / "film" / "manifest.json").exists()
        case "longcomment.csv":
            came = gonio.run("eval", "--model", "ggx", "--set", "alpha=0.1", "--pairs", path, "--out", "long.csv")
            return "an error that names the line", came.summary(), is_clean_error(came) and "line 2" in came.text
        case "own_compute.wgsl" | "bom.wgsl":
            came = shader(gonio, path)
            return "taken, kept", came.summary(), came.code == 0
        case "negative_but_passes.wgsl":
            return judge_cut(gonio, path)
        case "one_dispatch_takes_minutes.wgsl":
            came = shader(gonio, path)
            return "ends within the limit", came.summary(), came.code in (1, 3) and "panicked" not in came.text
        case "call_tree_40_hangs_for_hours.wgsl" | "sum_of_15000_terms_overflows_the_stack.wgsl":
            came = shader(gonio, path)
            return "works, or an error", came.summary(), came.code == 0 or is_clean_error(came)
        case "names_ufffe.toml":
            came = gonio.run("check", path, "--budget", "1e4", "--junit", "names.xml")
            try:
                xml.etree.ElementTree.parse(gonio.folder / "names.xml")
                text = (gonio.folder / "names.xml").read_text()
                return "valid XML", came.summary(), came.code == 0 and "\ufffe" not in text
            except (OSError, xml.etree.ElementTree.ParseError) as error:
                return "valid XML", f"{came.summary()}; {error}", False
        case "escape_sequence_key.toml":
            came = gonio.run("bake", path, "--dry-run")
            return "escaped", came.summary(), came.code == 2 and "\x1b" not in came.text
    return "", "not run by itself", None


def judge_cut(gonio, path):
    """A driver that stops loops may not lead to a promise kept: in text, JSON and JUnit."""
    came = shader(gonio, path, "--json", "--junit", "cut.xml")
    wanted = "not checked (or negative, where no loop is cut), exit 1; JSON and JUnit say it"
    try:
        report = json.loads(came.out)
        verdicts = {finding["verdict"] for finding in report["findings"]}
        suite = xml.etree.ElementTree.parse(gonio.folder / "cut.xml").getroot()
        bad = sum(int(suite.get(key, "0")) for key in ("failures", "errors"))
    except (ValueError, KeyError, OSError, xml.etree.ElementTree.ParseError):
        return wanted, came.summary(), False
    right = came.code == 1 and not report["kept"] and verdicts != {"kept"} and bad > 0
    return wanted, f"exit {came.code}: {', '.join(sorted(verdicts))}; {bad} in JUnit", right


# ---- signatures -----------------------------------------------------------------------------------------------------

def signatures(gonio, folder):
    for path in sorted(folder.glob("*.wgsl")):
        came = shader(gonio, path)
        first = came.line("error:")
        if came.code in (0, 1):
            yield path.name, "taken or refused", f"taken, exit {came.code}", True
        else:
            yield path.name, "taken or refused", f"refused: {first}", is_clean_error(came)


ROOMS = {"scenes": scenes, "light": light, "shaders": shaders, "hostile": hostile, "signatures": signatures}


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--gonio", default=Path(__file__).parent.parent / "target/release/gonio")
    parser.add_argument("--only", default=",".join(ROOMS), help="rooms, separated by commas")
    parser.add_argument("--seconds", type=float, default=SECONDS, help="the limit of time; more on a machine that is busy")
    arguments = parser.parse_args()
    gonio = Gonio(arguments.gonio, arguments.seconds)
    wrong = judged = 0
    try:
        for room in arguments.only.split(","):
            folder = (arguments.folder / room).resolve()
            if not folder.is_dir():
                continue
            print(f"\n{room}\n{'':6} {'row':42} {'wanted':44} came")
            for name, wanted, came, right in ROOMS[room](gonio, folder):
                word = {True: "right", False: "WRONG", None: "-"}[right]
                judged += right is not None
                wrong += right is False
                came = came.replace(f"{folder}{os.sep}", "")
                print(f"{word:6} {name:42} {wanted:44} {came[:200]}", flush=True)
    finally:
        shutil.rmtree(gonio.folder, ignore_errors=True)
    print(f"\n{wrong} of {judged} rows are wrong" if wrong else f"\nall {judged} rows are right")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
