#!/usr/bin/env python3
"""measure_demo.py PROGRAM [SEEDS]: what `modebank demo` finds beside the truth over seeds; the tables of docs/results/simulated.md."""
import json
import resource
import subprocess
import sys
import tempfile


def demo(program, seed):
    """The findings of one demo, and its processor time [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    with tempfile.TemporaryDirectory() as folder:
        done = subprocess.run([program, "demo", "--json", "--job.seed", str(seed), "-o", f"{folder}/demo"], check=True, capture_output=True, text=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return json.loads(done.stdout)["truth"], after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def digits(error):
    """Decimals down to the second digit of an error."""
    return max(0, 1 - int(f"{error:e}".partition("e")[2]))


def main():
    seeds = range(1, int(sys.argv[2]) + 1 if len(sys.argv) > 2 else 6)
    runs = [demo(sys.argv[1], seed) for seed in seeds]
    rows, scaled = {}, []
    for truth, _ in runs:
        for mode in truth["modes"]:
            for number in mode["numbers"]:
                row = rows.setdefault((mode["ground"], number["name"], number["unit"], number["truth"]), [])
                row.append(f"{number['found']:.{digits(number['error'])}f} ± {number['error']:.{digits(number['error'])}f}")
                scaled.append((number["found"] - number["truth"]) / number["error"])
    print("| ground | number | true | " + " | ".join(f"seed {seed}" for seed in seeds) + " |")
    print("|---|---|---|" + "---|" * len(runs))
    for (ground, name, unit, true), found in sorted(rows.items(), key=lambda row: row[0][0]):
        print(f"| {ground} | {name} [{unit}] | {true:.3g} | " + " | ".join(found) + " |")
    print("| | modes | 2 | " + " | ".join(str(len(truth["modes"])) for truth, _ in runs) + " |")
    print("| | samples given to their ground | | " + " | ".join(f"{100 * truth['agreement']:.1f} %" for truth, _ in runs) + " |")
    print("| | processor time [s] | | " + " | ".join(f"{seconds:.1f}" for _, seconds in runs) + " |")
    spread = (sum(z * z for z in scaled) / len(scaled)) ** 0.5
    print(f"\n{len(scaled)} numbers; (found - true) / error: root mean square {spread:.2f}, largest {max(map(abs, scaled)):.2f}")


if __name__ == "__main__":
    main()
