#!/usr/bin/env python3
# SPDX-License-Identifier: GPL-3.0-or-later
"""Compares the stiffness figures of two summary.json files of millpose; for continuous integration.

usage: compare_stiffness.py EXPECTED.json ACTUAL.json [--percent P]

Status 0 when every figure of `stiffness` (mm/N) and the number of planned points agree, 1 when one differs by more
than P percent (default 0.1) or is there in one file alone, 2 when a file cannot be read."""
import argparse
import json
import sys


def figures(summary):
    """{"lambda_t1.worst": value or None, …, "points.planned": count}"""
    found = {f"{index}.{which}": value for index, spread in summary["stiffness"].items()
             if isinstance(spread, dict) and index != "units" for which, value in spread.items()}
    found["points.planned"] = summary["points"]["planned"]
    return found


def differs(expected, actual, percent):
    if expected is None or actual is None:
        return expected is not actual
    return abs(actual - expected) > percent / 100 * abs(expected)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("expected")
    parser.add_argument("actual")
    parser.add_argument("--percent", type=float, default=0.1)
    arguments = parser.parse_args()
    try:
        expected, actual = (figures(json.load(open(name, encoding="utf-8")))
                            for name in (arguments.expected, arguments.actual))
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
        print(f"compare_stiffness: {error}", file=sys.stderr)
        return 2
    changed = 0
    for name in sorted(expected.keys() | actual.keys()):
        before, after = expected.get(name), actual.get(name)
        if differs(before, after, arguments.percent):
            changed += 1
            print(f"{name}: expected {before}, got {after}")
    print(f"{changed} of {len(expected.keys() | actual.keys())} figures changed by more than {arguments.percent} %")
    return 1 if changed else 0


if __name__ == "__main__":
    sys.exit(main())
