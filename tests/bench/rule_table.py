#!/usr/bin/python3
"""Tables from the output of measure_rule: rule_table.py CSV"""
import collections
import csv
import sys


def main():
    rows = list(csv.DictReader(open(sys.argv[1])))
    taken, gains, of_nothing = collections.defaultdict(list), collections.defaultdict(list), collections.Counter()
    for row in rows:
        key = row["proposal"], row["worth"]
        taken[key].append(int(row["taken"]))
        if row["gain"] != "nan":
            gains[key].append(float(row["gain"]))
        if float(row["worth"]) == 0:
            of_nothing[row["seed"]] += int(row["taken"])
    print("| proposal | nothing there | worth 0.06 nats, six runs | worth 0.03 nats, twelve runs | gain where nothing is there: mean, most |")
    print("|---|---|---|---|---|")
    for proposal in dict.fromkeys(row["proposal"] for row in rows):
        cells = [f"{sum(taken[proposal, worth])} of {len(taken[proposal, worth])}" for worth in ("0", "0.06", "0.03")]
        nothing = gains[proposal, "0"] or [float("nan")]
        print(f"| {proposal} | {' | '.join(cells)} | {sum(nothing) / len(nothing):.4f}, {max(nothing):.4f} |")
    print(f"| any | {sum(count > 0 for count in of_nothing.values())} of {len(of_nothing)} | | | |")


if __name__ == "__main__":
    main()
