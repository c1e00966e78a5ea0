#!/usr/bin/python3
"""Speed of reading recordings with 99 % unneeded images, compared with cat and the compressors' own programs.

Usage: large_recordings.py PROGRAM BAG FOLDER [MEGABYTES]

Writes the drive in BAG (husky_outdoor_test1.bag) with camera images between its messages. Formats are bag (none, lz4, bz2) and
MCAP (none, lz4, zstd), each of MEGABYTES when unpacked (2000; bz2: a tenth). `PROGRAM run` reads each file, and the
same drive without images; the difference is the cost of the images. Each figure is the least of three measurements, taken
in turn from a warm cache: processor seconds (user and system, all threads) and wall-clock seconds.
"""
import os
import pathlib
import resource
import subprocess
import sys
import time

import genpy.dynamic
import numpy
import rosbag

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "io/recording"))
import ros2_writers  # noqa: E402

CHUNK = 4 << 20
Image = genpy.dynamic.generate_dynamic("camera/Image", "uint8[] data\n")["camera/Image"]
CONFIG = """[data]
inputs = {file}
state = /imu/data.angular_velocity.y
input = /husky_velocity_controller/odom.twist.twist.linear.x, /husky_velocity_controller/odom.twist.twist.angular.z
missing = gap
disorder = sort
"""


def image(number):
    """An image of 900 kB that compresses to about half."""
    made = Image()
    made.data = numpy.random.default_rng(number % 7).integers(0, 16, 921600, numpy.uint8).tobytes()
    return made


def drive(bag_path, megabytes):
    """(topic, message, time), with images evenly in between."""
    with rosbag.Bag(bag_path) as bag:
        messages = list(bag.read_messages())
    images = [image(i) for i in range(7)]
    count, written = int(megabytes * 1e6 / 921600), 0
    for i, (topic, message, at) in enumerate(messages):
        yield topic, message, at
        while written * len(messages) < (i + 1) * count:
            yield "/camera", images[written % 7], at
            written += 1


def write_bag(path, bag_path, megabytes, compression):
    with rosbag.Bag(path, "w", compression=compression, chunk_threshold=CHUNK) as bag:
        for topic, message, at in drive(bag_path, megabytes):
            bag.write(topic, message, at)


class Messages:
    """The drive in the form for ros2_writers, generated without storing it."""

    def __init__(self, bag_path, megabytes):
        self.bag_path, self.megabytes = bag_path, megabytes
        self.topics, self.packed, self.definitions = [], {}, []
        self.list = []
        for topic, message, at in drive(bag_path, megabytes):
            if topic not in self.topics:
                self.topics.append(topic)
                self.definitions.append((topic, message._type.replace("/", "/msg/"), message._full_text))
            key = id(message) if topic == "/camera" else None
            payload = self.packed.get(key) or ros1(message)
            if key:
                self.packed[key] = payload
            self.list.append((self.topics.index(topic), at.to_nsec(), payload))


def ros1(message):
    import io
    buffer = io.BytesIO()
    message.serialize(buffer)
    return buffer.getvalue()


def write_mcap(path, bag_path, megabytes, compression):
    made = Messages(bag_path, megabytes)
    ros2_writers.write_mcap(path, made.definitions, made.list, compression, chunk_bytes=CHUNK, encoding="ros1",
                            definition_form="ros1msg")


def spent(command):
    """CPU seconds and wall-clock seconds."""
    before, begin = resource.getrusage(resource.RUSAGE_CHILDREN), time.monotonic()
    with open(os.devnull, "wb") as nothing:
        done = subprocess.run(command, stdout=nothing, stderr=subprocess.PIPE)
    if done.returncode:
        sys.exit(f"{command}: {done.stderr.decode()}")
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime, time.monotonic() - begin


def reading(program, path, folder):
    config = folder / (path.name + ".ini")
    config.write_text(CONFIG.format(file=path))
    return [program, "run", str(config), "--until=windows", "--job.threads=2", "--force",
            f"--archive.output={folder / 'out.h5'}"]


def main():
    program, bag_path, folder = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3])
    megabytes = float(sys.argv[4]) if len(sys.argv) > 4 else 2000
    folder.mkdir(exist_ok=True)
    forms = [("none", "bag", ["cat"], 1), ("none", "mcap", ["cat"], 1), ("lz4", "bag", ["lz4", "-dc"], 1),
             ("lz4", "mcap", ["lz4", "-dc"], 1), ("zstd", "mcap", ["zstd", "-dc"], 1), ("bz2", "bag", ["bzip2", "-dc"], 10)]
    print("| recording | MB unpacked | reads it [s of processor / clock] | without images | peer | peer [s] |\n|---|---|---|---|---|---|")
    for compression, form, peer, less in forms:
        write = write_bag if form == "bag" else write_mcap
        path, small = folder / f"big_{compression}.{form}", folder / f"small_{compression}.{form}"
        named = compression if form == "bag" or compression != "none" else ""
        for file, size in ((path, megabytes / less), (small, 0)):
            if not file.exists():
                write(str(file), bag_path, size, named)
        packed = path
        if compression != "none":  # the peer unpacks the uncompressed recording as one stream
            plain, packed = folder / f"plain_{less}.{form}", folder / f"plain_{less}.{form}.{compression}"
            if not plain.exists():
                write(str(plain), bag_path, megabytes / less, "none" if form == "bag" else "")
            if not packed.exists():
                with open(packed, "wb") as out:
                    subprocess.run([peer[0], "-c", str(plain)], stdout=out, check=True)
        rows = {"big": [], "small": [], "peer": []}
        for _ in range(3):
            rows["big"].append(spent(reading(program, path, folder)))
            rows["small"].append(spent(reading(program, small, folder)))
            rows["peer"].append(spent(peer + [str(packed)]))
        cells = {name: " / ".join(f"{min(column):.2f}" for column in zip(*values)) for name, values in rows.items()}
        print(f"| {form}, {compression} | {megabytes / less:.0f} | {cells['big']} | {cells['small']} | {' '.join(peer)} | {cells['peer']} |",
              flush=True)


if __name__ == "__main__":
    main()
