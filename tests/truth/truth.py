"""Writes values.csv and integrals.csv beside itself: see README.md."""

import csv
import sys
from pathlib import Path

from mpmath import mp

sys.dont_write_bytecode = True  # the folder is a source tree

import cases
import models
from geometry import Pair

HERE = Path(__file__).parent
DIGITS = 50


def number(x, digits=DIGITS):
    return mp.nstr(x, digits, strip_zeros=False, min_fixed=1, max_fixed=0) if x else "0"


def double(x):
    return format(x, ".17g")


def parameters_text(parameters):
    return ";".join(f"{name}={double(value)}" for name, value in parameters.items())


def write(name, header, rows):
    with open(HERE / name, "w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(header)
        for row in rows:
            writer.writerow(row)
            file.flush()


def values():
    for model, parameters, angles in cases.values():
        texts = []
        for mp.dps in (120, 80):  # by 80 digits and by 120: 50 must be the same
            components = models.lobe(model, parameters)(Pair.of_angles(*angles))
            texts.append([number(x) for x in components])
        assert texts[0] == texts[1], (model, parameters, angles, texts)
        a, b, *_ = [*texts[0], ""]
        yield [model, parameters_text(parameters), *map(double, angles), a, b]


def main():
    what = sys.argv[1:] or ["values", "integrals"]
    if "values" in what:
        write("values.csv", "model parameters theta_i phi_i theta_e phi_e A B".split(), values())
    if "integrals" in what:
        import integrals

        write("integrals.csv", "model parameters quantity theta_i A B".split(), integrals.rows(number, double, parameters_text))


if __name__ == "__main__":
    main()
