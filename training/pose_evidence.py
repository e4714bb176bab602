#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Fits how much an alignment speaks for its pose, and judges the fit on rooms kept out.

  training/pose_evidence.py --train FILE... --test FILE... [--write src/tracking/pose_evidence_model.inc]

Each FILE is what posefusion_pose_samples prints of one recording. The model is a logistic one: a sum
of terms, each a hinge of one quantity, none of which may count against its meaning (more of the map
seen through never speaks for a pose). Right and wrong weigh the same, so the sum is the natural
logarithm of the likelihood ratio. Needs NumPy."""
import argparse
import csv
import math
import pathlib

import numpy

WRONG_M, WRONG_DEG = 0.10, 5.0  # beyond which a pose counts as wrong, as everywhere
# Right and wrong are not told apart so near the limit: such samples only judge.
UNCLEAR = 0.3

# Sign (enum PoseSign), whether more of it speaks for the pose, and the places between which its slope
# stays: from the first to the last it counts at all.
SIGNS = {
    "overlap": (True, (0.0, 0.1, 0.2, 0.35, 0.6, 1.0)),
    "contradicted": (False, (0.0, 0.05, 0.1, 0.2, 0.35, 1.0)),
    "seen_through": (False, (0.0, 0.03, 0.08, 0.2, 1.0)),
    "hidden": (False, (0.0, 0.15, 0.35, 1.0)),
    "correlation": (True, (-1.0, 0.0, 0.3, 0.5, 0.7, 0.85, 1.0)),
    "log_spread": (True, (-3.0, -2.0, -1.3, -0.9, -0.5)),
    "view": (True, (0.0, 0.15, 0.4, 1.0)),
    "log_sigma": (False, (-2.6, -2.2, -1.8, -1.4)),
}


class Samples:
    def __init__(self, files):
        values, off, self.kinds, self.files = [], [], [], []
        for file in files:
            with open(file, newline="") as lines:
                for row in csv.DictReader(lines):
                    values.append([float(row[sign]) for sign in SIGNS])
                    off.append(max(float(row["off_m"]) / WRONG_M, float(row["off_deg"]) / WRONG_DEG))
                    self.kinds.append(row["kind"])
                    self.files.append(pathlib.Path(file).stem)
        self.values = numpy.array(values)
        self.off = numpy.array(off)
        self.kinds, self.files = numpy.array(self.kinds), numpy.array(self.files)
        self.right = self.off <= 1

    def where(self, chosen):
        part = Samples([])
        part.values, part.off, part.right = self.values[chosen], self.off[chosen], self.right[chosen]
        part.kinds, part.files = self.kinds[chosen], self.files[chosen]
        return part


def terms():
    """Sign, whether it rises, and the two places of each term, in the order of the weights."""
    return [(sign, rises, low, high) for sign, (rises, places) in SIGNS.items()
            for low, high in zip(places, places[1:])]


def columns(values):
    """One column for each term: how far its sign is between its places; negative where the sign
    speaks against the pose, so that no weight is below 0."""
    index = list(SIGNS).index
    return numpy.column_stack([(1 if rises else -1) * (numpy.clip(values[:, index(sign)], low, high) - low)
                               for sign, rises, low, high in terms()])


def fit(samples, penalty):
    """Weights (none below 0) and the constant of the likeliest model, each class weighing the same;
    a penalty on the weights' sizes, so that terms which tell nothing are 0."""
    clear = numpy.abs(samples.off - 1) > UNCLEAR
    x, right = columns(samples.values[clear]), samples.right[clear]
    middle, scale = x.mean(axis=0), numpy.maximum(x.std(axis=0), 1e-3)
    x = (x - middle) / scale
    y = numpy.where(right, 1.0, -1.0)
    of_right, of_wrong = 0.5 / right.sum(), 0.5 / (~right).sum()
    weight = numpy.where(right, of_right, of_wrong)
    w, constant = numpy.zeros(x.shape[1]), 0.0
    # Accelerated projected gradient: the problem is convex.
    step = 4.0 / (numpy.linalg.norm(x * numpy.sqrt(weight)[:, None], 2) ** 2 + 1)
    v, c, t = w.copy(), constant, 1.0
    for _ in range(20000):
        margin = y * (x @ v + c)
        slope = -weight * y / (1 + numpy.exp(numpy.clip(margin, -50, 50)))
        w_new = numpy.maximum(0, v - step * (x.T @ slope + penalty))
        c_new = c - step * slope.sum()
        t_new = (1 + math.sqrt(1 + 4 * t * t)) / 2
        v = w_new + (t - 1) / t_new * (w_new - w)
        c = c_new + (t - 1) / t_new * (c_new - constant)
        moved = numpy.abs(w_new - w).max()
        w, constant, t = w_new, c_new, t_new
        if moved < 1e-6:
            break
    return w / scale, constant - (w / scale * middle).sum()


def report(name, samples, evidence, limit):
    right, wrong = evidence[samples.right], evidence[~samples.right]
    if not len(right) or not len(wrong):
        return print(f"{name}: {len(right)} right, {len(wrong)} wrong")
    at_95 = numpy.quantile(right, 0.05)
    print(f"{name}: {len(right)} right, {len(wrong)} wrong; at 95 % of the right (above {at_95:.2f}) "
          f"{100 * (wrong >= at_95).mean():.2f} % of the wrong; above {limit:.2f} "
          f"{100 * (right >= limit).mean():.1f} % of the right, {100 * (wrong >= limit).mean():.2f} % "
          f"({(wrong >= limit).sum()}) of the wrong")


def calibration(samples, evidence):
    """Prints the stated and the true probability in bins of a tenth, right and wrong weighing the
    same, and their mean difference."""
    stated = 1 / (1 + numpy.exp(-evidence))
    weight = numpy.where(samples.right, 0.5 / samples.right.sum(), 0.5 / (~samples.right).sum())
    error, total = 0.0, 0.0
    for low in numpy.arange(0, 1, 0.1):
        chosen = (stated >= low) & (stated < low + 0.1 + (low > 0.85))
        if not chosen.any():
            continue
        share = weight[chosen].sum()
        truth = weight[chosen & samples.right].sum() / share
        mean = (weight[chosen] * stated[chosen]).sum() / share
        print(f"  stated {mean:.3f}: {truth:.3f} of {chosen.sum()}")
        error += share * abs(truth - mean)
        total += share
    print(f"  calibration error {100 * error / total:.2f} %")


def write(path, weights, constant):
    """The model as the table that src/tracking/pose_evidence.cpp includes."""
    lines = ["// SPDX-License-Identifier: BSD-3-Clause",
             "// Written by training/pose_evidence.py: docs/algorithm-evidence.md is its card.",
             f"constexpr double kConstant = {constant:.3f};", "constexpr Term kTerms[] = {"]
    for (sign, rises, low, high), weight in zip(terms(), weights):
        if weight > 0.005:
            lines.append(f"    {{PoseSign::{sign}, {low:g}, {high:g}, {weight if rises else -weight:.2f}}},")
    pathlib.Path(path).write_text("\n".join(lines + ["};"]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--train", nargs="+", required=True)
    parser.add_argument("--test", nargs="+", default=[])
    parser.add_argument("--penalty", type=float, default=1e-3)
    parser.add_argument("--limit", type=float, default=math.log(0.95 / 0.05),
                        help="log-odds of sure_to_return")
    parser.add_argument("--write")
    options = parser.parse_args()
    train = Samples(options.train)
    weights, constant = fit(train, options.penalty)
    evidence = lambda s: columns(s.values) @ weights + constant
    for (sign, _, low, high), weight in zip(terms(), weights):
        print(f"{sign:16s} {low:5g} to {high:5g}: {weight:8.2f}")
    print(f"constant {constant:.3f}")
    if options.write:
        write(options.write, weights, constant)
    report("train", train, evidence(train), options.limit)
    if options.test:
        test = Samples(options.test)
        report("kept out", test, evidence(test), options.limit)
        for kind in sorted(set(test.kinds)):
            part = test.where(test.kinds == kind)
            report(f"  {kind}", part, evidence(part), options.limit)
        for file in sorted(set(test.files)):
            part = test.where(test.files == file)
            report(f"  {file}", part, evidence(part), options.limit)
        calibration(test, evidence(test))


if __name__ == "__main__":
    main()
