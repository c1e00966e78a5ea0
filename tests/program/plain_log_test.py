"""The plainest logs come out right by default: one linear plant with an offset, sensor noise, a dead time or a loop.

Every log is v(k+1) = level + a (v(k) - level) + (1 - a) gain u(k+1-delay) + w(k), y(k) = v(k) + r(k), so gain and 63 %
response time are known in closed form: dead time included, the response passes 1 - 1/e between two samples.
"""
import itertools
import math
import re

from program import ProgramTest, attributes, h5py, main, modebank, np

SAMPLES, RUNS = 800, 6


def held(draw, count, low, high, values):
    """An input that keeps each value for `low` to `high` samples."""
    u = np.empty(0)
    while len(u) < count:
        u = np.append(u, np.full(draw.integers(low, high), draw.choice(values)))
    return u[:count]


def plant(draw, u, tau, gain, delay, level, noises):
    """Measured states of one run. tau in samples; noises: standard deviations of w and r."""
    a, v = math.exp(-1 / tau), np.full(len(u), float(level))
    for k in range(1, len(u)):
        v[k] = level + a * (v[k - 1] - level) + noises[0] * draw.standard_normal()
        v[k] += (1 - a) * gain * (u[k - delay] if k >= delay else 0)
    return v + noises[1] * draw.standard_normal(len(u))


def response_time(tau, delay, dt):
    """The time of this plant after a step at sample 0, by linear interpolation between samples."""
    left = [math.exp(-j / tau) for j in range(int(5 * tau))]
    j = next(j for j, value in enumerate(left) if value <= math.exp(-1))
    return dt * (delay - 1 + j - 1 + (left[j - 1] - math.exp(-1)) / (left[j - 1] - left[j]) + 1)


class PlainLogs(ProgramTest):
    def write(self, run, dt, header, *columns):
        lines = [header] + [f"{dt * k:.2f}," + ",".join(f"{value:.4f}" for value in row)
                            for k, row in enumerate(zip(*columns))]
        (self.folder / f"run_{run}.csv").write_text("\n".join([*lines, ""]))

    def files(self):
        return sorted(path.name for path in self.folder.glob("run_*.csv"))

    def learned(self, *words):
        """Attributes of /structure and arrays of /baseline."""
        modebank("init", *self.files(), "-o", "x.ini", "--force", cwd=self.folder)
        done = modebank("run", "x.ini", "--until", "windows", "--archive.output", "out.h5", "--force", *words,
                        cwd=self.folder)
        self.told = " ".join(done.stdout.split())
        with h5py.File(self.folder / "out.h5") as file:
            single = {name: item[()] for name, item in file["baseline"].items() if hasattr(item, "dtype")}
        return attributes(self.folder / "out.h5", "structure"), single

    def near(self, single, name, truth, share=0.05):
        value, error = single[name].ravel()[0], single[name + "_standard_error"].ravel()[0]
        self.assertLess(abs(value - truth), max(4 * error, 1e-3 * abs(truth)), f"{name} {value} +- {error}")
        self.assertLess(error, share * abs(truth))

    def test_a_heater_with_offset_sensor_noise_and_dead_time(self):
        for run in range(RUNS):
            draw = np.random.default_rng(run)
            u = held(draw, SAMPLES, 20, 90, [0, 10, 20, 30, 40])
            self.write(run, 1, "time,temperature_c,heater_w", plant(draw, u, 60, 0.8, 3, 20, (0.03, 0.1)), u)
        structure, single = self.learned()
        self.assertEqual((structure["noise_lags"], structure["differences"]), (1, 0))
        self.assertEqual(attributes(self.folder / "out.h5", "baseline")["input_delay"].tolist(), [3])
        self.near(single, "steady_gain", 0.8)
        self.near(single, "response_time_s", response_time(60, 3, 1))
        np.testing.assert_allclose(single["R"], 0.01, rtol=0.25)
        self.assertIn("temperature_c per heater_w: 63 % of", modebank("show", "out.h5", cwd=self.folder).stdout)
        self.assertNotIn("doubt", self.told)

    def test_a_held_input_that_acts_at_once_is_no_doubt_but_one_that_rests_is(self):
        for run in range(RUNS):
            draw = np.random.default_rng(50 + run)
            u = held(draw, SAMPLES, 10, 60, [0, 1])
            self.write(run, 0.1, "time,speed,motor_v,valve_v", plant(draw, u, 20, 2, 0, 0, (0.02, 0.05)), u, 0 * u)
        self.learned("--data.input", "motor_v, valve_v")
        self.assertEqual(re.findall(r"doubt (\S+)", self.told), ["valve_v"])

    def test_a_level_that_wanders_is_taken_in_differences(self):
        levels = []
        for run in range(RUNS):
            draw = np.random.default_rng(100 + run)
            u = held(draw, SAMPLES, 20, 90, [0, 10, 20, 30, 40])
            wander = np.cumsum(0.05 * draw.standard_normal(SAMPLES)) + 5 * draw.standard_normal()
            y = plant(draw, u, 30, 0.8, 2, 20, (0.0, 0.1)) + wander
            self.write(run, 1, "time,temperature_c,heater_w", y, u)
            levels.append(wander[SAMPLES // 2:])
        structure, single = self.learned()
        self.assertEqual(structure["differences"], 1)
        self.near(single, "steady_gain", 0.8, 0.2)
        np.testing.assert_allclose(single["Q"].flat[0], 0.05**2 * (1 + np.exp(-2 / 30)), rtol=0.3)  # (1 - a/q) steps
        deviations = [np.std(three) for three in itertools.combinations(levels, 3)]  # three runs train
        told = re.search(r"the level of temperature_c wanders or differs by run \(sd ([.\d]+)", self.told)
        self.assertTrue(0.8 * min(deviations) < float(told[1]) < 1.2 * max(deviations), told[0])

    def test_the_screen_has_the_operating_point_and_names_an_input_that_was_left_out(self):
        means = []
        for run in range(RUNS):
            draw = np.random.default_rng(300 + run)
            u, v = (held(draw, 400, 10, 60, values) for values in ([-1, 0, 1], [-10, 0, 10]))
            y = plant(draw, u, 20, 2, 1, 10, (0.02, 0.05)) + plant(draw, v, 20, 0.02, 2, 0, (0, 0))
            self.write(run, 0.1, "time,altitude_m,thrust_n,collective_pct,battery_v", y, u, v,
                       np.cumsum(draw.standard_normal(400)))
            means.append(np.mean(y))
        told = modebank("run", *self.files(), "--archive.output", "out.h5", "--bank.refine", "none", cwd=self.folder).stdout
        told = " ".join(told.split())
        gained = re.search(r"collective_pct also moves altitude_m \((\d+) nats\): "
                           "data.input = thrust_n, collective_pct;", told)
        self.assertGreater(int(gained[1]), 6)
        self.assertNotIn("battery_v also moves", told)
        self.assertIn("collective_pct also moves altitude_m", (self.folder / "out.ini").read_text())
        point = re.search(r"means: altitude_m ([.\d]+)[^;]*; altitude_m ([.\d]+)[^;]* at zero input", told)
        self.assertTrue(min(means) <= float(point[1]) <= max(means), told)
        self.assertAlmostEqual(float(point[2]), 10, delta=0.5)

    def test_an_integrator_is_told_by_its_slope_and_dead_time(self):
        """A speed that follows the input with a lag of 8 samples, and its sum, which alone is measured."""
        for run in range(RUNS):
            draw = np.random.default_rng(400 + run)
            u = held(draw, SAMPLES, 10, 40, [-1, 0, 1])
            a, speed, y = math.exp(-1 / 8), 0.0, np.zeros(SAMPLES)
            for k in range(1, SAMPLES):
                y[k] = y[k - 1] + 0.05 * speed
                speed = a * speed + (1 - a) * 0.5 * u[k] + 0.002 * draw.standard_normal()
            self.write(run, 0.05, "time,position_m,motor_v", y + 0.002 * draw.standard_normal(SAMPLES), u)
        self.learned()
        told = re.search(r"position_m per motor_v: integrates ([.\d]+)\D* per s after ([.\d]+) s, or settles",
                         self.told)
        self.assertAlmostEqual(float(told[1]), 0.5, delta=0.05)
        self.assertAlmostEqual(float(told[2]), 0.05 * (a / (1 - a)), delta=0.1)

    def test_help_finds_the_constant_by_other_words(self):
        for words in ("offset", "bias", "operating point"):
            self.assertIn("--window.intercept", modebank("help", words).stdout)

    def test_delay_0_below_the_sensor_noise_is_a_doubt(self):
        """A controller of the measured speed, whose set point is smooth: within a sample it gives the noise away."""
        for run in range(RUNS):
            draw, v = np.random.default_rng(500 + run), 2.0
            y, u = np.zeros(SAMPLES), np.zeros(SAMPLES)
            for k in range(SAMPLES):
                y[k] = v + 0.05 * draw.standard_normal()
                u[k] = 2 * (2 + math.sin(0.013 * k + run) + 0.5 * math.sin(0.05 * k) - y[k])
                v = 0.9 * v + 0.1 * u[k] + 0.02 * draw.standard_normal()
            self.write(run, 0.05, "time,speed,throttle", y, u)
        self.learned("--data.input", "throttle")
        gained = re.search(r"throttle of the same sample would gain (\d+) nats", self.told)
        self.assertGreater(int(gained[1]), 6)
        done = modebank("run", "x.ini", "--until", "windows", "--archive.output", "out.h5", "--force", "--data.input",
                        "throttle", "--window.model", "auto", "--window.input_delay", "0", cwd=self.folder)
        self.assertRegex(" ".join(done.stdout.split()), "speed is predicted within .* below its sensor noise of 0.0[3-6]")

    def loop(self, moves):
        """Speed under a controller of the logged set point, throttle = 2 (set point - speed)."""
        for run in range(RUNS):
            draw = np.random.default_rng(200 + run)
            target = np.round(held(draw, SAMPLES, 40, 160, draw.uniform(0, 4, 9)), 1) if moves else np.full(SAMPLES, 2.0)
            y, u, v = np.zeros(SAMPLES), np.zeros(SAMPLES), 0.0
            for k in range(SAMPLES):
                y[k] = np.round(v + 0.02 * draw.standard_normal(), 3)
                u[k] = 2 * (target[k] - y[k])
                v = 0.9 * v + 0.1 * u[k] + 0.01 * draw.standard_normal()
            self.write(run, 0.05, "time,speed_setpoint,speed,throttle", target, y, u)

    def test_a_set_point_that_acts_through_the_actuator_is_left_out(self):
        self.loop(moves=True)
        told = modebank("run", *self.files(), "--data.input", "throttle, speed_setpoint", "--archive.output", "out.h5",
                        cwd=self.folder)
        self.assertRegex(told.stdout, r"throttle = 2\.0+ \(speed_setpoint - speed\)")
        with h5py.File(self.folder / "out.h5") as file:
            self.assertGreater(file["baseline/steady_gain"].size, 0)

    def test_a_set_point_at_rest_is_refused(self):
        self.loop(moves=False)
        message = modebank("run", *self.files(), "--data.input", "throttle", cwd=self.folder, status=1).stderr
        self.assertRegex(message, "throttle = .* set point")
        modebank("init", *self.files(), "-o", "x.ini", "--force", cwd=self.folder)
        done = modebank("run", "x.ini", "--until", "windows", "--data.input", "throttle", cwd=self.folder)
        self.assertRegex(" ".join(done.stdout.split()), "doubt throttle = .* set point")


if __name__ == "__main__":
    main()
