"""Tables of a configuration with either half of the runs training, by the machinery of ablation.py."""
import concurrent.futures
import os
import tempfile

from benchmark import SOURCES, preamble
from ablation import FEATURES, Bench, Stages, cells, halves, outcome, replaced, table


def both_halves(given, title, protocol, config, old="", new="", recipe=None, more=()):
    """`old`, `new`: text in the configuration's data paths and its replacement. `recipe`: name and configuration of a published
    recipe that gets a row of its own. `more`: further rows, as ablation.py's FEATURES."""
    os.environ["MODEBANK_DATA"] = str(given.data)
    preamble(given.program, title, protocol)
    with concurrent.futures.ThreadPoolExecutor(1) as pool:
        of_config(given, config, old, new, lambda stages, folds: table(stages, title, folds, [*FEATURES[:1], *more], pool))
        if recipe:
            of_config(given, recipe[1], old, new, lambda stages, folds: recipe_row(stages, folds, recipe[0], pool))


def recipe_row(stages, folds, name, pool):
    results = [outcome(pool.submit(stages.rows, fold, {})) for fold in folds]
    print(f"| {name} | {next((r for r in results if isinstance(r, str)), '') or cells(results, 'bank')} |", flush=True)


def of_config(given, config, old, new, show):
    bench = Bench(given.program, str(SOURCES / "configs" / config), str(given.out / "finished.json"))
    options = replaced(bench.text, {}, old, new) if old else {}
    with tempfile.TemporaryDirectory() as folder:
        show(Stages(bench, folder), halves(bench, options))
