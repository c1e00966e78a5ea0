#!/usr/bin/env python3
"""The command of `next` obeyed until it is ready: what its forecast then loses against the best that any configuration here reaches."""
import re

from benchmark import SOURCES, Arguments, head, line, significant
from forecasts import TEN, configurations, named, run, scores, size

PROTOCOL = """Each set begins with its [data] section alone, and each option that `next` says to repeat with is added until `next` names none. The best is the highest log score and the least RMSE
of all filters, of this trail and of the shipped configuration on the same runs. `named`: the filter to predict with, chosen by training runs; `least error`: the one that is named where errors count."""
SHIPPED = {"ICE, one half": "husky_ice", "FLOORING, one half": "flooring", "DRIVE, one half": "drive_husky", "DART, one half": "dart", "tanks, one half": "cascaded_tanks",
           "robot arm": "robot_arm", "buck converter": "buck_converter", "Husky bag": "husky_outdoor"}
MOST_STEPS = 6


def follow(program, config, archive):
    """The options that `next` proposed one after the other, the last summary and the processor time of all."""
    options, seconds = [], 0.0
    while True:
        summary, more = run(program, config, archive, *options)
        seconds += more
        proposed = re.search(r"run CONFIG (--[a-z_.]+) ('[^']*'|[\w.+-]+)", summary["next"])
        if not proposed or len(options) >= 2 * MOST_STEPS:
            return options, summary, seconds
        options += [proposed.group(1), proposed.group(2).strip("'")]


def trail(title, given, config, archive):
    options, summary, seconds = follow(given.program, config, archive)
    best = archive.with_stem(archive.stem + "_shipped")
    if title in SHIPPED:
        run(given.program, SOURCES / "configs" / f"{SHIPPED[title]}.ini", best, "--data.root", given.data, "--filter.horizon", f"1,{TEN}")
    for steps in (1, TEN):
        reached = scores(archive, steps)
        if not reached:
            continue
        forecast = named(summary, steps)
        every = [*reached.values(), *(scores(best, steps).values() if title in SHIPPED else ())]
        score, error = max(row["log_score"] for row in every), min(every, key=size)
        of, point = reached[forecast["filter"]], reached[forecast["point_filter"]]
        excess = [100 * (size(row) / size(error) - 1) for row in (of, point)]
        line(title, " ".join(options) or "ready at once", f"{seconds:.0f}", steps, f"{forecast['filter']} {of['log_score']:.3f}", f"{score:.3f}", f"{score - of['log_score']:.3f}",
             significant(error["rmse"]), f"{excess[0]:.1f} %", f"{forecast['point_filter']}: {excess[1]:.1f} %")


def main():
    given = Arguments(__doc__)
    head(given.program, "Trails of `next`", PROTOCOL,
         ["data, what trains", "trail", "seconds", "ahead", "named", "best", "loses", "least RMSE", "named: over it", "least error: over it"])
    for title, config, archive in configurations(given):
        trail(title, given, config, archive)


if __name__ == "__main__":
    main()
