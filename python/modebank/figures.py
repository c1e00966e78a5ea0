"""Figures for papers from an archive or a study, drawn by matplotlib:

    python3 -m modebank.figures my_robot.h5 -o figures

writes each figure as PDF and SVG, and figures.tex, whose snippets include them in LaTeX. One function draws one figure. To
change a figure, copy this file, edit its function and run the copy: python3 my_figures.py my_robot.h5 -o figures
"""
import argparse
import pathlib
import re
import sys

import matplotlib
import numpy as np
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Circle, FancyArrowPatch
from scipy import stats

import modebank

COLUMN, PAGE = 3.5, 7.16  # inches: widths of a column and of a page in IEEE journals
# Colours of Okabe and Ito (2008), in the order of the modes' use. Page and figures share them.
MODES = ["#0072B2", "#E69F00", "#009E73", "#D55E00", "#CC79A7", "#56B4E9", "#F0E442", "#4A2570"]
FILTERS = {"baseline": "#D55E00", "noise_only": "#009E73", "one_motion": "#E69F00", "drifting": "#56B4E9", "nonlinear": "#F0E442",
           "combined": "#4A2570", "bank": "#0072B2"}
COMPETITORS = ["baseline", "noise_only", "one_motion", "drifting", "nonlinear"]
OTHERS, BAND, ACCEPTED = "#9a9a9a", "#d0d0d0", "#e6e6e6"
MOST_SAMPLES = 2000  # first samples of a run; a printed column shows no more
MOST_WINDOWS = 6000
RARE_SWITCH = 0.005  # probability per sample below which an arrow is left out
LEVEL = 0.95

STYLE = {
    "pdf.fonttype": 42, "svg.fonttype": "none", "text.parse_math": False, "savefig.dpi": 600,
    "font.family": "sans-serif", "font.sans-serif": ["Arial", "Liberation Sans", "DejaVu Sans"], "font.size": 7.5,
    "axes.labelsize": 7.5, "legend.fontsize": 7, "xtick.labelsize": 7, "ytick.labelsize": 7, "legend.frameon": False,
    "legend.handlelength": 1.2, "legend.columnspacing": 1.2, "legend.borderaxespad": 0.2, "axes.linewidth": 0.5, "lines.linewidth": 0.8,
    "axes.spines.top": False, "axes.spines.right": False, "xtick.major.width": 0.5, "ytick.major.width": 0.5, "axes.edgecolor": "#444444",
}


class LeftOut(Exception):
    """Raised if the archive has no data for a figure."""


def blank(width, height, rows=1, columns=1, **grid):
    figure = Figure(figsize=(width, height), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.03, h_pad=0.03)
    return figure, figure.subplots(rows, columns, **grid)


def legend(axes, *others, **more):
    """A legend above the plot, in as many columns as fit. `others`: axes on top of these."""
    handles, labels = (sum(parts, []) for parts in zip(*(part.get_legend_handles_labels() for part in (axes, *others))))
    columns = int(18 * axes.figure.get_figwidth()) // (max(map(len, labels)) + 4) // axes.get_subplotspec().get_gridspec().ncols
    axes.legend(handles, labels, loc="lower left", bbox_to_anchor=(0, 1), ncol=max(1, columns), **more)


def shown(name):
    """A channel's name for a legend: only the end of a long one. A blank in front keeps matplotlib from skipping names with an underscore."""
    return "\u2026" + name[-27:] if len(name) > 28 else " " + name if name.startswith("_") else name


def with_unit(name, unit):
    return f"{name} [{unit}]" if unit else name


def judged_role(archive):
    """The role of the judged runs: held-out if there are any, else training."""
    summary = archive.summary
    return "test" if ((summary["filter"] == "bank") & (summary["role"] == "test")).any() else "train"


def modes_by_use(archive):
    """Modes to draw one by one, most used first (at most eight, each used 1 % or more), and all others."""
    use = np.asarray(archive.weights, float).copy()
    if "/evaluation/diagnostics" in archive:
        table = archive["/evaluation/diagnostics"]
        rows = table[(table["filter"] == "bank") & (table["role"] == judged_role(archive)) & (table["mode"] >= 0)]
        use[rows["mode"]] = rows["usage"]
    order = np.argsort(-use, kind="stable")
    told = min(8, max(1, np.count_nonzero(use >= 0.01)))
    return list(order[:told]), list(order[told:])


def mode_title(archive, mode):
    names = archive.attributes("/bank").get("mode_names", [])
    return f"{mode} {names[mode]}" if mode < len(names) and names[mode] else str(mode)


def bank_title(archive):
    return f"bank, {archive.modes} mode{'' if archive.modes == 1 else 's'}"


def judged_run(archive, name=None):
    """The run of this name, or the first judged run."""
    if "/bank" not in archive or "/evaluation/bank" not in archive:
        raise LeftOut("the archive holds no evaluation of a bank")
    table = archive["/data/runs"]
    return archive.run(name or table[table["role"] == judged_role(archive)]["name"].iloc[0])


def predicted(archive, run, filter="bank"):
    """Prediction of each state one sample ahead, and half the width of its 95 % band."""
    evaluation, states = run[filter], run["state"].shape[1]
    variance = np.diagonal(evaluation["innovation_covariance"], axis1=1, axis2=2)
    center = np.asarray(evaluation["prediction"]) @ np.asarray(archive[f"/{filter}/C"])[:, :states].T
    return center, stats.norm.ppf((1 + LEVEL) / 2) * np.sqrt(variance)


def draw_modes(archive, run, axes):
    """Draws mode probabilities stacked over time."""
    told, others = modes_by_use(archive)
    probability = np.asarray(run["bank"]["mode_probability"])[:MOST_SAMPLES]
    layers = [probability[:, k] for k in told] + ([probability[:, others].sum(axis=1)] if others else [])
    names = [mode_title(archive, k) for k in told] + ([f"{len(others)} other{'s' if others[1:] else ''}"] if others else [])
    axes.stackplot(run["time"][:MOST_SAMPLES], layers, colors=MODES[:len(told)] + [OTHERS], labels=map(shown, names), linewidth=0)
    axes.set(ylabel="P(mode)", ylim=(0, 1), xlabel="time [s]", xlim=run["time"][[0, min(MOST_SAMPLES, len(run["time"])) - 1]])
    if len(names) > 1:
        legend(axes, handleheight=0.8)


def local_models(archive, width=COLUMN):
    """Local models of windows, coloured by mixture component, with the components' 95 % ellipses. Diamonds: modes of the bank."""
    if "/mixture/labels" not in archive:
        raise LeftOut("the archive holds no mixture")
    clustered = "/mixture/features" in archive
    points = np.asarray(archive["/mixture/features" if clustered else "/windows/parameters"])
    about = archive.attributes("/windows")
    names = archive.attributes("/mixture")["feature_names"] if clustered else about["parameter_names"]
    # Features as in Salvi et al., figure 2b: a parameter of A and two of B; others where these are missing.
    first = [i for i, name in enumerate(names) if name.startswith("A")][:1]
    first += [i for i, name in enumerate(names) if name.startswith("B")][:3 - len(first)]
    used = (first + [i for i in range(len(names)) if i not in first])[:3]
    if len(used) < 2:
        raise LeftOut("the model has one parameter")
    called = dict(zip(about["parameter_names"], about["parameter_labels"]))
    weight, label = archive["/mixture/weights"], archive["/mixture/labels"]
    told = np.sort(np.argsort(-np.asarray(weight), kind="stable")[:8])
    order = told[np.argsort(-np.asarray(weight)[told], kind="stable")]  # points of lighter modes are on top of the others
    every = -(-len(points) // MOST_WINDOWS)
    pairs = [(0, 1), (0, 2), (1, 2)] if len(used) == 3 else [(0, 1)]
    figure, grid = blank(width, width * (0.95 if len(pairs) == 3 else 0.7), *((2, 2) if len(pairs) == 3 else (1, 1)), squeeze=False)
    theta = np.empty((0, 0))
    if "/bank" in archive and not clustered:
        of_model = "/bank/motion_parameters" if "/bank/motion_parameters" in archive else "/bank/parameters"
        theta = np.asarray(archive[of_model])[modes_by_use(archive)[0]]
    radius = np.sqrt(stats.chi2.ppf(LEVEL, 2))
    angle = np.linspace(0, 2 * np.pi, 97)
    for axes, pair in zip(grid.flat, pairs):
        i, j = used[pair[0]], used[pair[1]]
        rest = ~np.isin(label, order)
        axes.plot(points[rest, i][::every], points[rest, j][::every], "+", color=OTHERS, markersize=1.5, markeredgewidth=0.4)
        boundaries = []
        for k in order:
            colour = MODES[list(told).index(k)]
            of = np.flatnonzero(label == k)[::every]
            axes.plot(points[of, i], points[of, j], ".", color=colour, markersize=1.5, markeredgewidth=0)
            values, vectors = np.linalg.eigh(archive["/mixture/covariances"][k][np.ix_([i, j], [i, j])])
            circle = np.sqrt(values.clip(0))[:, None] * radius * np.array([np.cos(angle), np.sin(angle)])
            boundaries.append(np.asarray(archive["/mixture/means"])[k, [i, j]][:, None] + vectors @ circle)
            axes.plot(*boundaries[-1], color="white", linewidth=1.8)
            axes.plot(*boundaries[-1], color=colour, linewidth=1)
        if theta.shape[1] > max(i, j):
            axes.plot(theta[:, i], theta[:, j], "D", color="black", markeredgecolor="white", markersize=3.5, markeredgewidth=0.6)
        axes.set(xlim=frame(points[:, i], [b[0] for b in boundaries]), ylim=frame(points[:, j], [b[1] for b in boundaries]),
                 xlabel=called.get(names[i], names[i]), ylabel=called.get(names[j], names[j]))
    key = [Line2D([], [], marker="o", linestyle="", color=MODES[list(told).index(k)], markersize=3, label=f"{k} ({100 * weight[k]:.0f} %)") for k in order]
    if rest.any():
        others = "none" if len(told) == len(weight) else f"{len(weight) - len(told)} others, none"
        key.append(Line2D([], [], marker="+", linestyle="", color=OTHERS, markersize=3, label=others))
    if len(theta):
        key.append(Line2D([], [], marker="D", linestyle="", color="black", markersize=3, label="mode of the bank"))
    place = {"loc": "upper left"} if len(pairs) == 3 else {"loc": "lower left", "bbox_to_anchor": (0, 1), "ncol": 4}
    grid.flat[-1].legend(handles=key, title="component (weight)", **place)
    if len(pairs) == 3:
        grid.flat[3].axis("off")
    return figure


def frame(values, boundaries):
    """Limits of an axis without outlying windows: 96 % of the windows, and ellipses as far as they add at most a quarter."""
    low, high = np.nanpercentile(values, [2, 98])
    room, ellipses = 0.25 * (high - low), np.concatenate(boundaries)
    low, high = max(min(low, ellipses.min()), low - room), min(max(high, ellipses.max()), high + room)
    margin = 0.04 * (high - low) or 0.5
    return low - margin, high + margin


def selection(archive, width=COLUMN):
    """Criteria over the number of mixture components: lower is better. Grey: the choice."""
    if "/mixture/candidates" not in archive or len(archive["/mixture/candidates"]) < 2:
        raise LeftOut("the archive holds no two candidates")
    table = archive["/mixture/candidates"]
    table = table[table["status"] == "fitted"]
    figure, axes = blank(width, 2.3)
    for chosen in table["components"][table["selected"] == 1]:
        axes.axvline(chosen, color=ACCEPTED, linewidth=5, label="chosen")
    for name, colour, marker in (("bic", MODES[0], "o"), ("aic", MODES[2], "^")):
        axes.plot(table["components"], table[name], marker + "-", color=colour, markersize=3, label=name.upper())
    axes.set(xlabel="components K", ylabel="BIC, AIC")
    axes.xaxis.get_major_locator().set_params(integer=True)
    legend(axes)
    return figure


def estimates(archive, run=None, state=0, width=COLUMN):
    """A state measured, and predicted one sample ahead by one Kalman filter (baseline) and by the bank with its 95 % band. Bottom:
    probabilities of the modes."""
    run = judged_run(archive, run)
    center, half = (values[:MOST_SAMPLES, state] for values in predicted(archive, run))
    time = run["time"][:MOST_SAMPLES]
    figure, (top, bottom) = blank(width, 2.8, 2, height_ratios=[3, 2], sharex=True)
    top.fill_between(time, center - half, center + half, color=BAND, linewidth=0, label="95 % band")
    top.plot(time, run["state"][:MOST_SAMPLES, state], color="black", linewidth=1.1, label="measured")
    if "baseline" in run.keys():
        top.plot(time, predicted(archive, run, "baseline")[0][:MOST_SAMPLES, state], color=FILTERS["baseline"], linewidth=0.6, label="baseline")
    top.plot(time, center, color=FILTERS["bank"], linewidth=0.6, label=bank_title(archive))
    data = archive.attributes("/data")
    top.set_ylabel(with_unit(data["state_names"][state], data["state_units"][state]))
    legend(top)
    draw_modes(archive, run, bottom)
    return figure


def pit(archive, width=COLUMN):
    """Histogram of the probability integral transform (PIT) of one-step predictions: flat for a consistent filter. Grey: where 95 % of
    its bars lie."""
    if "/evaluation/summary" not in archive:
        raise LeftOut("the archive holds no scores")
    runs = archive["/data/runs"]
    runs = [archive.run(name) for name in runs[runs["role"] == judged_role(archive)]["name"]]
    figure, axes = blank(width, 2.1)
    edges = np.linspace(0, 1, 21)
    for filter in [name for name in (*COMPETITORS, "bank") if name in runs[0].keys()]:
        values = np.concatenate([np.ravel(run[filter]["pit"]) for run in runs])
        counts, _ = np.histogram(values[np.isfinite(values)], edges)
        samples = counts.sum()
        if not axes.patches:
            low, high = stats.binom.ppf([(1 - LEVEL) / 2, (1 + LEVEL) / 2], samples, 1 / 20) * 20 / samples
            axes.axhspan(low, high, color=ACCEPTED, linewidth=0, label="95 % if uniform")
        title = bank_title(archive) if filter == "bank" else filter.replace("_", " ")
        axes.stairs(counts * 20 / samples, edges, color=FILTERS[filter], linewidth=0.9, label=title)
    axes.set(xlim=(0, 1), xlabel="PIT of the one-step prediction", ylabel="density")
    axes.set_ylim(bottom=0)
    legend(axes)
    return figure


def coverage(archive, width=COLUMN):
    """Share of samples whose normalised innovation squared (NIS) lies above (upwards) or below (downwards) its 95 % interval; a
    consistent filter has 2.5 % on either side."""
    if "/evaluation/summary" not in archive:
        raise LeftOut("the archive holds no scores")
    pooled = archive.summary[archive.summary["run"] == "*"].set_index(["filter", "role"])
    names, shares = [], []
    for filter in (*COMPETITORS, "bank"):
        row = [100 * pooled[side].get((filter, role), np.nan) for role in ("train", "test") for side in ("nis_above", "nis_below")]
        if np.isfinite(row).any():
            names.append(bank_title(archive) if filter == "bank" else filter.replace("_", " "))
            shares.append(row)
    figure, axes = blank(width, 2.3)
    position, shares = np.arange(len(names)), np.asarray(shares, float)
    for column, colour, label, move in ((0, MODES[0], "training", -0.19), (2, MODES[1], "held out", 0.19)):
        axes.bar(position + move, shares[:, column], 0.34, color=colour, label=label)
        axes.bar(position + move, -shares[:, column + 1], 0.34, color=colour)
    for bound, name in ((2.5, "consistent: 2.5 %"), (-2.5, "_")):
        axes.axhline(bound, color="black", linewidth=0.6, dashes=(6, 3), label=name)
    axes.axhline(0, color="black", linewidth=0.5)
    turned = {"rotation": 35, "ha": "right", "rotation_mode": "anchor"} if len(names) > 4 else {}
    axes.set_xticks(position, names, **turned)
    axes.tick_params(axis="x", length=0)
    axes.yaxis.set_major_formatter(lambda value, _: f"{abs(value):g}")
    axes.set_ylabel("NIS below | above [%]")
    legend(axes)
    return figure


def transition(archive, width=COLUMN):
    """Switches between modes: arrows are as wide as the root of their probability per sample; rare switches are left out. A larger disc
    is a mode with more windows."""
    if "/bank" not in archive or archive.modes < 2:
        raise LeftOut("there are no two modes")
    modes, probability = modes_by_use(archive)[0], np.asarray(archive["/bank/transition"])
    figure, axes = blank(width, width * 0.9)
    angle = 2 * np.pi * np.arange(len(modes)) / len(modes)
    discs = []
    for i, k in enumerate(modes):
        at = 0.9 * np.array([np.sin(angle[i]), np.cos(angle[i])]) if len(modes) > 1 else np.zeros(2)
        discs.append(Circle(at, 0.12 + 0.13 * np.sqrt(archive.weights[k]), facecolor=MODES[i], edgecolor="#444444", linewidth=0.5, zorder=3))
        axes.add_patch(discs[-1])
        light = np.dot(matplotlib.colors.to_rgb(MODES[i]), [0.299, 0.587, 0.114]) > 0.51
        axes.annotate(mode_title(archive, k).replace(" ", "\n", 1), at, ha="center", va="center", color="black" if light else "white", zorder=4)
    for i, k in enumerate(modes):
        for j, other in enumerate(modes):
            share = probability[k, other]
            if i == j or share < RARE_SWITCH:
                continue
            axes.add_patch(FancyArrowPatch(
                discs[i].center, discs[j].center, patchA=discs[i], patchB=discs[j], shrinkA=0, shrinkB=1, color=MODES[i],
                connectionstyle="arc3,rad=-0.25", arrowstyle="-|>,head_width=2.5,head_length=4", linewidth=0.4 + 4 * np.sqrt(share)))
            if len(modes) <= 5:  # more than five modes leave no room for numbers
                way = np.subtract(discs[j].center, discs[i].center)
                axes.annotate(f"{share:.2g}", np.add(discs[i].center, discs[j].center) / 2 + 0.2 * np.array([-way[1], way[0]]), ha="center", va="center", zorder=4)
    axes.set(xlim=(-1.3, 1.3), ylim=(-1.2, 1.2), aspect="equal")
    axes.axis("off")
    return figure


def headline(study):
    """The log score by which studies compare settings, and its title."""
    effects = study["/answers/main_effects"]
    for score, name in (("bank_test_log_score", "held-out log score [nats]"), ("bank_train_log_score", "training log score [nats]")):
        if np.isfinite(effects["best"][effects["score"] == score]).any():
            return score, name
    raise LeftOut("no run has a log score")


def better_part(best):
    """The range of scores to draw; runs further below are outside the frame."""
    low, high = np.nanmin(best), np.nanmax(best)
    reach = high - low or max(0.1, 0.1 * abs(high))
    return low - 0.5 * reach, high + 0.1 * reach


def finished(study):
    table = study["/study"]
    return table[table["status"] == "done"]


def effects(study, width=COLUMN):
    """Effects of the varied settings on the log score: the best that each value reaches over all other settings, and the mean of its
    runs. Runs far below are outside the frame."""
    score, title = headline(study)
    table, runs = study["/answers/main_effects"], finished(study)
    table = table[table["score"] == score]
    keys = [key for key in dict.fromkeys(table["key"]) if (table["key"] == key).sum() > 1][:8]
    if not keys:
        raise LeftOut("no key has two values with finished runs")
    columns = min(2, len(keys))
    rows = -(-len(keys) // columns)
    figure, grid = blank(width, 0.4 + 1.5 * rows, rows, columns, squeeze=False, sharey=True)
    for axes, key in zip(grid.flat, keys):
        of = table[table["key"] == key]
        position, values = np.arange(len(of)), list(of["value"])
        axes.plot([position_of(value, values) for value in runs[key]], runs[score], ".", color=OTHERS, markersize=2, label="runs")
        axes.plot(position, of["mean"], "--", color=MODES[1], label="mean")
        axes.plot(position, of["best"], "o-", color=MODES[0], markersize=3, label="best")
        axes.set_xticks(position, [value if len(value) <= 10 else value[:8] + ".." for value in values])
        axes.set(xlabel=key, xlim=(-0.5, len(of) - 0.5), ylim=better_part(table["best"]))
    for axes in grid.flat[len(keys):]:
        axes.axis("off")
    grid[0, 0].set_ylabel(title)
    legend(grid[0, 0])
    return figure


def position_of(value, values):
    """Index of a run's value among the texts of a table of effects."""
    texts = [f"{value:g}", str(value)] if isinstance(value, (int, float, np.number)) else [str(value)]
    return next((values.index(text) for text in texts if text in values), np.nan)


def draw(archive, run=None, width=COLUMN):
    """{name: figure} for which the archive has data, and {name: reason} for the others."""
    if "/answers" in archive:
        tasks = [("effects", effects, {})]
    else:
        states = range(len(archive.attributes("/data")["state_names"]) if "/data" in archive else 1)
        tasks = [("local_models", local_models, {}), ("selection", selection, {})]
        tasks += [("estimates" + (f"_{i + 1}" if i else ""), estimates, {"run": run, "state": i}) for i in states]
        tasks += [("pit", pit, {}), ("coverage", coverage, {}), ("transition", transition, {})]
    drawn, left_out = {}, {}
    with matplotlib.rc_context(STYLE):
        for name, function, options in tasks:
            try:
                drawn[name] = function(archive, width=width, **options)
                drawn[name].caption = " ".join(function.__doc__.split())
            except LeftOut as reason:
                left_out[name] = str(reason)
    return drawn, left_out


def snippet(name, figure):
    caption = re.sub(r"([%&#$_{}])", r"\\\1", figure.caption)
    return (f"\\begin{{figure}}\n  \\centering\n  \\includegraphics[width=\\columnwidth]{{{name}}}\n"
            f"  \\caption{{{caption}}}\n  \\label{{fig:{name}}}\n\\end{{figure}}\n")


def main():
    parser = argparse.ArgumentParser(prog="python3 -m modebank.figures", description="Draws the figures of an archive or a study for a paper.")
    parser.add_argument("archive", help="an archive, or a study's folder")
    parser.add_argument("-o", "--output", required=True, type=pathlib.Path, metavar="FOLDER", help="the folder that the figures are written to")
    parser.add_argument("--run", help="the run that figures over time draw; the first held-out run without it")
    parser.add_argument("--page", action="store_true", help="as wide as a page (7.16 in) instead of a column (3.5 in)")
    parser.add_argument("--png", action="store_true", help="also write PNG of 600 dots per inch")
    options = parser.parse_args()
    path = pathlib.Path(options.archive)
    try:
        archive = modebank.Archive(path / "study.h5" if path.is_dir() else path)
        drawn, left_out = draw(archive, options.run, PAGE if options.page else COLUMN)
    except (modebank.ConfigurationError, modebank.DataError, KeyError) as error:
        sys.exit(f"modebank.figures: {error.args[0]}")
    options.output.mkdir(parents=True, exist_ok=True)
    with matplotlib.rc_context(STYLE):
        for name, figure in drawn.items():
            for ending in ("pdf", "svg", "png")[:3 if options.png else 2]:
                figure.savefig(options.output / f"{name}.{ending}")
    (options.output / "figures.tex").write_text("% \\usepackage{graphicx}\n" + "".join(snippet(*named) for named in drawn.items()), encoding="utf-8")
    print(f"{options.output}: {', '.join(drawn)}")
    for name, reason in left_out.items():
        print(f"left out: {name}: {reason}")


if __name__ == "__main__":
    main()
