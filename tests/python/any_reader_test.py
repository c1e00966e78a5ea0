"""docs/howto/formats.md: its lines run unchanged, and the program prints them when it refuses such a file. Stubs
with the readers' interfaces stand in for the readers, which Debian has no packages of."""
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import types
import unittest
import unittest.mock
import warnings

import numpy as np
import pandas

import modebank
from simulated import QUICK, SOURCE

PAGE = (SOURCE / "docs/howto/formats.md").read_text(encoding="utf-8")
BLOCKS = dict(zip(("px4", "ardupilot", "parquet", "influxdb", "mcap"), re.findall(r"^```python\n(.*?)^```", PAGE, re.M | re.S)))
TRUE_DECAY = 0.7
RUN = modebank.run


def motion(samples=600):
    """A state with a decay of 0.7 per sample of 0.1 s, and its input."""
    rng = np.random.default_rng(1)
    left, right = (np.repeat(rng.uniform(-1, 1, samples // 5), 5) for _ in range(2))
    wz = np.zeros(samples)
    for k in range(1, samples):
        wz[k] = TRUE_DECAY * wz[k - 1] + 0.2 * (right[k - 1] - left[k - 1]) + 0.01 * rng.standard_normal()
    return pandas.DataFrame({"time": 0.1 * np.arange(samples), "wz": wz, "left": left, "right": right})


def pyulog(frame):
    stamps = (1e6 * frame.time).round().astype(np.uint64).to_numpy()
    topic = lambda name, **data: types.SimpleNamespace(name=name, multi_id=0, data={"timestamp": stamps, **data})
    rates = topic("vehicle_angular_velocity", **{"xyz[0]": 0 * frame.wz.to_numpy(), "xyz[2]": frame.wz.to_numpy()})
    motors = topic("actuator_motors", **{"control[0]": frame.left.to_numpy(), "control[1]": frame.right.to_numpy()})
    return {"pyulog": types.SimpleNamespace(ULog=lambda file: types.SimpleNamespace(data_list=[rates, motors]))}


def pymavlink(frame):
    def messages():
        for row in frame.itertuples():
            stamp = round(1e6 * row.time)
            yield {"mavpackettype": "IMU", "TimeUS": stamp, "I": 0, "GyrZ": row.wz}
            yield {"mavpackettype": "RCOU", "TimeUS": stamp, "C1": row.left, "C3": row.right}

    left = messages()

    def recv_match(type):
        return next((types.SimpleNamespace(to_dict=lambda m=m: m) for m in left if m["mavpackettype"] in type), None)

    mavutil = types.SimpleNamespace(mavlink_connection=lambda file: types.SimpleNamespace(recv_match=recv_match))
    return {"pymavlink": types.SimpleNamespace(mavutil=mavutil)}


def influxdb(frame):
    answer = frame.rename(columns={"time": "_time"}).assign(result="_result", table=0, _measurement="robot")
    answer["_time"] = pandas.Timestamp("2026-01-02T03:04:05Z") + pandas.to_timedelta(answer["_time"], unit="s")
    client = types.SimpleNamespace(query_api=lambda: types.SimpleNamespace(query_data_frame=lambda query: answer))
    return {"influxdb_client": types.SimpleNamespace(InfluxDBClient=lambda url, token, org: client)}


def mcap(frame):
    def iter_decoded_messages(topics):
        for row in frame.itertuples():
            yield None, types.SimpleNamespace(topic=topics[0]), types.SimpleNamespace(log_time=round(1e9 * row.time)), row

    make_reader = lambda stream, decoder_factories: types.SimpleNamespace(iter_decoded_messages=iter_decoded_messages)
    return {"mcap": types.ModuleType("mcap"), "mcap.reader": types.SimpleNamespace(make_reader=make_reader),
            "mcap_protobuf": types.ModuleType("mcap_protobuf"), "mcap_protobuf.decoder": types.SimpleNamespace(DecoderFactory=object)}


class AnyReader(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(scratch.name)

    def archive_of(self, block, stubs):
        """The archive of the page's lines, made in seconds."""
        quick = lambda *args, **keys: RUN(*args, **QUICK, **keys)
        names = {}
        with unittest.mock.patch.dict(sys.modules, stubs), unittest.mock.patch("modebank.run", quick), warnings.catch_warnings():
            warnings.simplefilter("ignore")  # warnings on split and times, and on a file that a line leaves open
            exec(BLOCKS[block], names)
        return names["archive"]

    def expect_the_motion(self, archive, state, inputs):
        self.assertEqual((archive.state_names, archive.input_names), ([state], inputs))
        decay = 1.0 + np.average(archive.A[:, 0, 0], weights=archive.weights)
        self.assertAlmostEqual(decay, TRUE_DECAY, delta=0.02)
        self.assertAlmostEqual(archive.dt, 0.1, 6)

    def test_px4(self):
        self.expect_the_motion(self.archive_of("px4", pyulog(motion())), "xyz[2]", ["control[0]", "control[1]"])

    def test_ardupilot(self):
        self.expect_the_motion(self.archive_of("ardupilot", pymavlink(motion())), "GyrZ", ["C1", "C3"])

    def test_parquet(self):
        with unittest.mock.patch("pandas.read_parquet", lambda file: motion()):
            self.expect_the_motion(self.archive_of("parquet", {}), "wz", ["left", "right"])

    def test_influxdb(self):
        self.expect_the_motion(self.archive_of("influxdb", influxdb(motion())), "wz", ["left", "right"])

    def test_mcap_with_protobuf(self):
        pathlib.Path("drive.mcap").touch()
        self.expect_the_motion(self.archive_of("mcap", mcap(motion())), "wz", ["left", "right"])

    def test_refusals_print_the_lines(self):
        for block, name, magic in (("px4", "flight.ulg", b"ULog\x01\x12\x35\x01"), ("ardupilot", "flight.bin", b"\xA3\x95\x80\x80"),
                                   ("parquet", "drive.parquet", b"PAR1\x15\x04")):
            pathlib.Path(name).write_bytes(magic)
            done = subprocess.run([os.environ["MODEBANK_PROGRAM"], "init", name], capture_output=True, text=True)
            self.assertEqual(done.returncode, 2, done.stderr)
            for line in BLOCKS[block].splitlines():
                self.assertIn(re.sub(r"\s+# .*", "", line).replace(name, str(pathlib.Path(name).resolve())), done.stderr.splitlines())

    def test_a_telemetry_log_is_refused_with_its_messages(self):
        pathlib.Path("flight.tlog").write_bytes(b"\0\5\xfa\x12\x34\x56\x78\x9a\xfe\x09\0\1")
        done = subprocess.run([os.environ["MODEBANK_PROGRAM"], "init", "flight.tlog"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 2, done.stderr)
        self.assertIn("a MAVLink telemetry log", done.stderr)
        self.assertIn(' type=["RAW_IMU", "SERVO_OUTPUT_RAW"]'.strip(), done.stderr)

    def test_protobuf_in_mcap_prints_the_lines(self):
        sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "io/recording"))
        import ros2_writers
        ros2_writers.write_mcap("drive.mcap", [("/motion", "robot.Motion", "")], [(0, 10**9 * k, b"1234") for k in range(9)],
                                encoding="protobuf", definition_form="protobuf")
        done = subprocess.run([os.environ["MODEBANK_PROGRAM"], "init", "drive.mcap"], capture_output=True, text=True)
        self.assertEqual(done.returncode, 1, done.stderr)
        self.assertIn("/motion (robot.Motion) cannot be read: its messages have the format \"protobuf\"", done.stderr)
        for line in BLOCKS["mcap"].splitlines():
            self.assertIn(re.sub(r"\s+# .*", "", line).replace("drive.mcap", str(pathlib.Path("drive.mcap").resolve())), done.stderr.splitlines())


if __name__ == "__main__":
    unittest.main()
