"""Logs and mistakes of the field: which columns `init` takes and names and which files stay."""
import shutil

from program import ProgramTest, main, modebank, np, proposal


def plant(samples=600, seed=1):
    """Times, an input that is held for ten samples, and the state that follows it."""
    draw = np.random.default_rng(seed)
    u, x = np.repeat(draw.uniform(-1, 1, samples // 10), 10), np.zeros(samples)
    for k in range(samples - 1):
        x[k + 1] = 0.9 * x[k] + 0.1 * u[k] + 0.01 * draw.standard_normal()
    return 0.05 * np.arange(samples), u, x


class FieldTest(ProgramTest):
    def run_program(self, *words, **options):
        done = modebank(*words, cwd=self.folder, **options)
        return done.stdout + done.stderr

    def write(self, name, header="", **columns):
        rows = np.column_stack(list(columns.values()))
        np.savetxt(self.folder / name, rows, "%.12g", ",", header=header or ",".join(columns), comments="")


class Columns(FieldTest):
    def expect(self, state, inputs, *files):
        keys, doubts, _ = proposal(self.folder, *files or ["log.csv"])
        self.assertEqual((keys["state"], keys.get("input", "")), (state, inputs))
        return keys, doubts

    def test_movement_outweighs_words(self):
        for run in range(3):
            t, u, x = plant(seed=run)
            self.write(f"ship_{run}.csv", U=np.full(len(t), 4 + run), delta=u, r=x)
        self.expect("r", "delta", "ship_0.csv", "ship_1.csv", "ship_2.csv")
        t, u, x = plant()
        noise = 0.001 * np.random.default_rng(7).standard_normal(len(t))
        self.write("log.csv", time=t, gyro_x=x, gyro_y=noise[::-1], gyro_z=noise, cmd=u)
        self.assertIn("gyro_z hardly moves beside gyro_x", self.expect("gyro_x", "cmd")[1])
        self.write("log.csv", "Ewe/V,time/s,I/mA,Efficiency/%,Q/mA.h", a=x, b=t, c=u, d=100 * (t > 9), e=np.cumsum(u))
        self.expect("Ewe/V", "I/mA")

    def test_moving_channels_that_are_not_taken_are_named(self):
        t, u, x = plant()
        others = {f"sensor_{i}": np.sin(0.1 * i * t) for i in range(1, 10)}
        self.write("log.csv", time=t, wz=x, throttle=u, **others)
        self.assertIn("sensor_6 and 3 more", self.expect("wz", "throttle")[1])

    def test_a_set_point_is_not_the_only_input(self):
        t, u, x = plant()
        goal = np.repeat(np.random.default_rng(2).uniform(-1, 1, 6), 100)
        self.write("log.csv", time=t, level_setpoint_cm=goal, level_cm=x, temperature=np.cos(t), pump_pct=u)
        self.expect("level_cm", "pump_pct")
        self.write("log.csv", time=t, speed_setpoint=goal, speed=x, collective=u)
        self.assertIn("collective", self.expect("speed", "speed_setpoint, collective")[0]["input"])

    def test_clocks_counters_and_ends_are_no_signals(self):
        t, u, x = plant()
        stamp = 1650775094.78 + t
        end, frame = np.arange(len(t)) == len(t) - 1, np.arange(len(t)) // 3
        self.write("log.csv", s=np.floor(stamp), ns=np.round(stamp % 1 * 1e9), y=x, u=u, frame=frame, end=end, done=end)
        keys, doubts = self.expect("y", "u")
        self.assertEqual((keys["time"], "frame" in doubts), ("s, ns", False))

    def test_angles_that_wrap_and_inputs_at_their_limit(self):
        t, u, x = plant()
        self.write("log.csv", time=t, heading_deg=np.cumsum(20 + 9 * x) % 360, throttle=np.clip(60 + 80 * u, 0, 100))
        doubts = self.expect("heading_deg", "throttle")[1]
        self.assertIn("heading_deg jumps by 360", doubts)
        self.assertIn("data.derive = turned = unwrap", doubts)
        self.assertIn("throttle stands at its limit, 100", doubts)

    def test_stated_keys_settle_doubts(self):
        t, u, x = plant()
        self.write("log.csv", aa=x, bb=u)
        words = ("run", "log.csv", "--archive.output", "out.h5", "--dry-run")
        self.assertIn("data.rate_hz", self.run_program(*words))
        told = self.run_program(*words, "--data.rate_hz", 20, "--data.state", "aa", "--data.input", "bb")
        self.assertNotIn("doubt", told)

    def test_without_times_the_screen_counts_samples(self):
        t, u, x = plant()
        self.write("log.csv", speed=x, throttle=u)
        screen = self.run_program("run", "log.csv", "--archive.output", "out.h5", "--bank.refine",
                                  "none", "--mixture.components", 1).split("\nread ")[1]
        self.assertRegex(screen, r"without times[^$]*\d samples +\d")
        shown = self.run_program("show", "out.h5").split("\nmodes in words")[1]
        self.assertNotRegex(screen.split("files")[0] + shown, r"\d s\b")


class Configured(FieldTest):
    def setUp(self):
        super().setUp()
        t, u, x = plant()
        self.write("log.csv", time=t, speed=x, throttle=u)
        self.configuration = ("[data]\ninputs = log.csv\nstate = speed\ninput = throttle\nsplit = last 30 %\n"
                              "[window]\nmodel = linear\n[mixture]\ncomponents = 1\n[bank]\nrefine = none\n")
        (self.folder / "c.ini").write_text(self.configuration)


class Files(Configured):
    def test_no_command_replaces_another_result(self):
        self.run_program("run", "c.ini")
        made = (self.folder / "c.h5").read_bytes()
        shutil.copy(self.folder / "c.h5", self.folder / "bank.h5")
        for words in (("--archive.bank", "bank.h5"), ("--until", "windows")):
            self.assertIn("c.h5", self.run_program("run", "c.ini", *words, status=1))
            self.assertEqual((self.folder / "c.h5").read_bytes(), made)
        self.run_program("run", "c.ini")

    def test_a_broken_configuration_is_no_log(self):
        (self.folder / "robot.cfg").write_text(self.configuration.replace("state =", "state"))
        self.assertIn("robot.cfg:3", self.run_program("run", "robot.cfg", status=2))

    def test_each_derived_channel_stays(self):
        self.write("log.csv", 'time,"speed, km/h",throttle', a=plant()[0], b=plant()[2], c=plant()[1])
        derived = ("--data.derive", "fast = throttle * 2", "--data.derive", "slow = throttle / 2")
        self.run_program("run", "log.csv", "--archive.output", "out.h5", "--bank.refine", "none",
                         "--mixture.components", 1, "--data.input", "fast, slow", *derived)
        self.assertEqual((self.folder / "out.ini").read_text().count("derive ="), 3)  # init's own, fast and slow

    def test_keys_that_contradict_each_other_are_named(self):
        told = self.run_program("run", "c.ini", "--bank.process_variance", 0.01, "--bank.refine", "em", status=2)
        self.assertRegex(told, "bank.process_variance.*bank.refine")


if __name__ == "__main__":
    main()
