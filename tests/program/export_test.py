"""The exported bank is the archive's: in JSON to the bit, and in C it says of held-out runs what `run` said."""
import json
import shutil
import statistics
import subprocess
import unittest

from program import ProgramTest, arrays, demo, learn, main, modebank, np, slices

# Reads samples (time, inputs, measurements) and prints what the filter says of each.
DRIVER = r"""#include "robot.h"
#include <stdio.h>
static void print(const double *values, int count) { while (count-- > 0) printf("%.17g ", *values++); }
int main(void) {
  static robot_filter filter;
  static robot_estimate said;
  double numbers[1 + ROBOT_INPUTS + ROBOT_MEASUREMENTS];
  robot_restart(&filter);
  for (int read = 0; scanf("%lf", numbers + read) == 1;) {
    if (++read < 1 + ROBOT_INPUTS + ROBOT_MEASUREMENTS) continue;
    robot_step(&filter, numbers[0], numbers + 1, numbers + 1 + ROBOT_INPUTS, &said);
    print(said.prediction, ROBOT_MEASUREMENTS);
    print(said.state, ROBOT_MEASUREMENTS);
    print(&said.innovation_covariance[0][0], ROBOT_MEASUREMENTS * ROBOT_MEASUREMENTS);
    print(said.mode_probability, ROBOT_MODES);
    print(&said.log_density, 1);
    read = 0;
  }
}
"""
COMPILER = "gcc -std=c99 -Wall -Wextra -Werror -o driver driver.c robot.c -lm"
SAID = ("prediction", "state", "innovation_covariance", "mode_probability", "log_density")


class Export(ProgramTest):
    def check_c(self, archive, *words):
        modebank("export", archive, "--to", "c", "-o", "robot.c", *words, cwd=self.folder)
        (self.folder / "driver.c").write_text(DRIVER)
        subprocess.run(COMPILER.split(), cwd=self.folder, check=True)
        data, bank = arrays(archive, "/data"), arrays(archive, "/evaluation/bank")
        samples = np.column_stack([data["time"], data["input"], data["state"]])
        expected = np.column_stack([bank[name].reshape(len(samples), -1) for name in SAID])
        for place in slices(archive, role="test").values():
            lines = " ".join(map(repr, samples[place].ravel().tolist()))
            done = subprocess.run(self.folder / "driver", input=lines, capture_output=True, text=True, check=True)
            np.testing.assert_allclose(np.array(done.stdout.split(), float), expected[place].ravel(), 1e-9, 1e-10)

    @unittest.skipUnless(shutil.which("gcc"), "gcc is absent: apt-get install gcc")
    def test_c_filters_as_evaluated(self):
        self.check_c(demo() / "demo.h5")
        learn(self.folder, "--bank.measurement_variance", "1e-5", states=("wz", "vx"))
        self.check_c(self.folder / "test.h5", "--force")  # its band is too wide

    def test_json_is_the_archives_bank(self):
        modebank("export", demo() / "demo.h5", "--to", "json", "-o", self.folder / "bank.json")
        page, bank = json.loads((self.folder / "bank.json").read_text()), arrays(demo() / "demo.h5", "/bank")
        said = {name: page[name]["value"] for name in "CR"} | {"transition": page["transition"]["T"]}
        said |= {name: [mode[name]["value"] for mode in page["modes"]] for name in "ABcQ"}
        bank["A"] += np.eye(bank["A"].shape[-1])  # archives hold the increment of a step
        for name, values in said.items():
            self.assertEqual(np.reshape(values, bank[name].shape).tolist(), bank[name].tolist(), name)
        for mode, Q in zip(page["modes"], bank["Q"], strict=True):
            np.testing.assert_allclose(mode["Q_per_s"]["value"], Q / page["dt_s"], rtol=1e-15)
        for gate in page["gates"]:  # of one signal: the square of a normal variable
            self.assertEqual(gate["signals"], 1)
            self.assertAlmostEqual(gate["nis"], statistics.NormalDist().inv_cdf((1 + gate["share"]) / 2) ** 2, 9)


if __name__ == "__main__":
    main()
