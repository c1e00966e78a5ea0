"""Logs: one drive in every format gives one answer by one command; units of time and delays of topics are found."""
import struct
import sys

from program import SOURCE, ProgramTest, arrays, differing, facts, h5py, main, modebank, np, write_csv

sys.path.insert(0, str(SOURCE / "tests/io/recording"))
import topics  # noqa: E402, writers of bags, MCAP and db3

QUICK = ("--window.model=linear", "--mixture.components=1..2", "--bank.refine=none")
BEGIN_NS = 1_714_557_600_000_000_000


def drive(samples=480):
    """Times [ns from the beginning], held commands [m/s], and a speed that follows them, in two modes of 60 samples."""
    draw = np.random.default_rng(5)
    command, speed = np.repeat(draw.uniform(-1, 1, samples // 6), 6), np.zeros(samples)
    for k in range(samples - 1):
        speed[k + 1] = speed[k] + (0.5, 0.15)[k // 60 % 2] * (command[k] - speed[k]) + draw.normal(0, 0.01)
    return 100_000_000 * np.arange(samples), command, speed


def write_mat5(path, columns):
    """A MAT file of version 5, uncompressed: of each column vector its flags, shape, name and values."""
    def element(kind, data):
        return struct.pack("<II", kind, len(data)) + data + bytes(-len(data) % 8)

    content = b"MATLAB 5.0 MAT-file".ljust(124) + struct.pack("<HH", 0x0100, 0x4D49)
    for name, values in columns.items():
        content += element(14, element(6, struct.pack("<II", 6, 0)) + element(5, struct.pack("<ii", len(values), 1))
                           + element(1, name.encode()) + element(9, np.asarray(values, "<f8").tobytes()))
    path.write_bytes(content)


def write_mat73(path, columns):
    """A MAT file of version 7.3: HDF5 with MATLAB's words in its user block; a column is a row of HDF5."""
    with h5py.File(path, "w", userblock_size=512) as file:
        for name, values in columns.items():
            file[name] = np.asarray(values, "f8")[None, :]
            file[name].attrs["MATLAB_class"] = np.bytes_("double")
    with open(path, "r+b") as file:
        file.write(b"MATLAB 7.3 MAT-file".ljust(124) + struct.pack("<HH", 0x0200, 0x4D49))


class Logs(ProgramTest):
    def setUp(self):
        super().setUp()
        self.stamps, self.command, self.speed = drive()
        self.columns = {"time": self.stamps / 1e9, "cmd": self.command, "speed": self.speed}

    def messages(self, late_ns=0):
        both = [(channel, BEGIN_NS + int(stamp) + late, float(value))
                for channel, values, late in ((0, self.command, 0), (1, self.speed, late_ns))
                for stamp, value in zip(self.stamps, values)]
        return sorted(both, key=lambda message: message[1])

    def answer(self, log, *words):
        """The facts of `run LOG` and the arrays of its archive."""
        return facts("run", log, *words, *QUICK, cwd=self.folder), arrays((self.folder / log).with_suffix(".h5"))

    def test_every_format_gives_one_answer(self):
        write_csv(self.folder / "text.csv", self.columns, *self.columns.values())
        for unit, stamps in ("ns", BEGIN_NS + self.stamps), ("ms", self.stamps // 1_000_000):
            write_csv(self.folder / f"{unit}.csv", ("stamp", "cmd", f"speed\n[{unit}]", "m/s", "m/s"), stamps,
                      self.command, self.speed, separator=";", decimal=",")  # its second line is one of units
        topics.write_bag(self.folder / "ros1.bag", ["/cmd", "/speed"], self.messages(), compression="bz2", chunks=5)
        topics.write_mcap(self.folder / "ros2.mcap", [({0: "/cmd", 1: "/speed"}, self.messages())])
        topics.write_db3(self.folder / "sqlite.db3", {0: "/cmd", 1: "/speed"}, self.messages())
        with h5py.File(self.folder / "hdf.hdf5", "w") as file:
            file.update(self.columns)
        write_mat5(self.folder / "five.mat", self.columns)
        write_mat73(self.folder / "seven.mat", self.columns)
        said, reference = self.answer("text.csv")
        at = np.rint(10 * reference["data/time"]).astype(int)
        for name, values in (("time", self.columns["time"]), ("state", self.speed), ("input", self.command)):
            np.testing.assert_allclose(reference["data/" + name].ravel(), values[at], rtol=0, atol=1e-12)
        for log in ("ns.csv", "ms.csv", "ros1.bag", "ros2.mcap", "sqlite.db3", "hdf.hdf5", "five.mat", "seven.mat"):
            with self.subTest(log=log):
                found, archive = self.answer(log)
                self.assertEqual(found["summary"]["answer"], said["summary"]["answer"])
                for name in ("data/time", "data/state", "data/input", "bank/A", "bank/B", "bank/Q"):
                    np.testing.assert_allclose(archive[name], reference[name], rtol=0, atol=1e-12, err_msg=name)
                score, expected = (of["evaluation/summary"]["log_score"] for of in (archive, reference))
                np.testing.assert_allclose(score, expected, rtol=1e-9)
        modebank("run", "text.ini", "--archive.output", "again.h5", cwd=self.folder)  # the configuration beside it
        self.assertEqual(differing(self.folder / "text.h5", self.folder / "again.h5"), [])

    def test_the_delay_between_two_topics_is_found_and_undone(self):
        self.stamps, self.command, self.speed = drive(1200)
        topics.write_bag(self.folder / "late.bag", ["/cmd", "/speed"], self.messages(late_ns=300_000_000))
        _, archive = self.answer("late.bag")
        np.testing.assert_allclose(archive["data/runs"]["lag_s"], 0.3, atol=0.05)  # half a period


if __name__ == "__main__":
    main()
