#!/usr/bin/env python3
"""Compares two result files of heartservo_speed_goals: every row of both, and how many times the first the second is.

Times of different machines are comparable only after division by what the machines can do; --scale does that for rows in
ms, us or ns by the files' multiply-add rates. Ends with 1 if a row that met its goal in the first file misses it in the
second, or if a time has grown by more than --tolerance.
"""
import argparse
import json
import sys


def load(path):
    try:
        with open(path, encoding="utf-8") as file:
            data = json.load(file)
        return data, {row["name"]: row for row in data["rows"]}
    except (OSError, ValueError, KeyError, TypeError) as error:
        sys.exit(f"compare_speed.py: {path}: not a result file of heartservo_speed_goals ({error})")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("before")
    parser.add_argument("after")
    parser.add_argument("--tolerance", type=float, default=0.25, help="share by which a time may grow (default 0.25)")
    parser.add_argument("--scale", action="store_true", help="divide times by the machines' multiply-add rates")
    arguments = parser.parse_args()
    before_all, before = load(arguments.before)
    after_all, after = load(arguments.after)
    scale = 1.0
    if arguments.scale:
        scale = after_all["machine"]["gflops"] / before_all["machine"]["gflops"]
    worse = []
    print(f"{'':<52}{'before':>12}{'after':>12}{'ratio':>9}")
    for name, old in before.items():
        new = after.get(name)
        if new is None:
            print(f"{name:<52}{old['value']:>12.4g}{'-':>12}")
            continue
        is_time = old["unit"] in ("ms", "us", "ns")
        value = new["value"] * (scale if is_time else 1)
        ratio = value / old["value"] if old["value"] else float("nan")
        remark = ""
        if old.get("met") and not new.get("met", True):
            remark = "misses its goal now"
        elif is_time and ratio > 1 + arguments.tolerance:
            remark = "slower"
        if remark:
            worse.append(name)
        print(f"{name:<52}{old['value']:>12.4g}{value:>12.4g}{ratio:>8.2f}x  {old['unit']}  {remark}".rstrip())
    for name in after.keys() - before.keys():
        print(f"{name:<52}{'-':>12}{after[name]['value']:>12.4g}")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
