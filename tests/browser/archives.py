"""Archives from which pages are made, and modebank's command line."""
import pathlib
import random
import subprocess


# Without refinement, which takes long and adds no kind of number to a page.
QUICK = ("--bank.refine", "none")
# More parameters than the demo's three.
LAGS = ("--window.state_lags", "2", "--window.input_lags", "2")
HOSTILE_STATE = "<script>window.hostile=1</script>"
HOSTILE_MODE = "<img src=x onerror='window.hostile=5'> %{y} &lt;"
HOSTILE_INPUT = "\"><img src=x onerror='window.hostile=2'>&amp;"
HOSTILE_RUN = "</script><b>run</b> 'é\"漢 ${x} {{data}}"
HOSTILE_UNIT = "<i>rad</i>&s"


class Modebank:
    def __init__(self, program, source, work):
        self.program, self.source, self.work = program, pathlib.Path(source), pathlib.Path(work)

    def __call__(self, *arguments):
        result = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True, cwd=self.work)
        assert result.returncode == 0, f"modebank {arguments}: status {result.returncode}\n{result.stderr}"

    def page(self, name, *archives):
        """Made once."""
        page = self.work / f"{name}.html"
        if not page.exists():
            self("report", *archives, "-o", page)
        return page

    def run(self, name, config, *options):
        archive = self.work / f"{name}.h5"
        self("run", config, "--archive.output", archive, *options)
        return archive


def demo_data(modebank):
    data = modebank.work / "demo_data"
    modebank("simulate", modebank.source / "configs/simulate_demo.ini", "--simulate.output", data)
    return data


def demo(modebank, data, name, *options):
    return modebank.run(name, modebank.source / "configs/demo.ini", "--data.root", data, *LAGS,
                       "--mixture.restarts", "2", *QUICK, *options)


def rows(file, run):
    """The rows of a run in arrays over samples of an open archive."""
    (row,) = [row for row in file["data/runs"][:] if row["name"].decode() == run]
    return slice(row["first"], row["first"] + row["samples"])


def hostile(modebank):
    """Two runs in one file with names, channels and units that attack a page."""
    folder = modebank.work / "hostile"
    folder.mkdir(exist_ok=True)
    quote = lambda text: '"' + text.replace('"', '""') + '"'
    generator = random.Random(1)
    with open(folder / "log.csv", "w", encoding="utf-8") as file:
        file.write(f"time,{quote(HOSTILE_STATE)},{quote(HOSTILE_INPUT)},right,trial\n")
        for run in (HOSTILE_RUN.replace("/", "\\"), "plain"):
            state = 0.0
            for k in range(120):
                left, right = generator.uniform(-0.5, 0.5), generator.uniform(-0.5, 0.5)
                file.write(f"{0.1 * k:.3f},{state!r},{left!r},{right!r},{quote(run)}\n")
                state += -0.4 * state - 0.2 * left + 0.2 * right + 0.01 * generator.uniform(-0.5, 0.5)
    config = folder / "hostile.ini"
    config.write_text(f"[data]\ninputs = log.csv\nstate = {HOSTILE_STATE}\ninput = {HOSTILE_INPUT}, right\nrun = trial\n"
                      f"state_unit = {HOSTILE_UNIT}\n[mixture]\ncomponents = 1..2\n[bank]\nrefine = none\nmode_names = {HOSTILE_MODE}\n", encoding="utf-8")
    return modebank.run("hostile", config, "--data.root", folder)


def study(modebank, data):
    folder = modebank.work / "study"
    config = modebank.work / "study.ini"
    config.write_text((modebank.source / "configs/demo.ini").read_text() + "\n[mixture]\nrestarts = 1\n[study]\n"
                      "vary = window.length = 15 | 25\nvary = mixture.components = 1 | 2 | 3\nvary = mixture.covariance = full | diagonal\n",
                      encoding="utf-8")
    modebank("study", config, "--data.root", data, "--study.output", folder, *QUICK)
    return folder
