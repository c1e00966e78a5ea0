#!/usr/bin/env python3
"""Recordings for tests, from a ROS 1 bag that python3-rosbag reads.

Usage: recordings.py reference BAG OUT.json       every column of every topic, as python3-rosbag reads them
       recordings.py convert BAG BEGIN END FOLDER   these seconds of the bag as bag, MCAP and db3, each compression
"""
import io
import json
import pathlib
import re
import sys

import genpy
import rosbag

import ros2_writers


def leaves(value, path, out):
    """The columns of one message: [(path, value)]."""
    if isinstance(value, genpy.Message):
        for name in value.__slots__:
            leaves(getattr(value, name), f"{path}.{name}", out)
    elif isinstance(value, (genpy.Time, genpy.Duration)):
        out.append((path, value.to_sec()))
    elif isinstance(value, (list, tuple)):
        for i, element in enumerate(value):
            leaves(element, f"{path}[{i}]", out)
    else:
        out.append((path, value))
    return out


def reference(bag_path, out_path):
    topics = {}
    with rosbag.Bag(bag_path) as bag:
        for topic, message, time in bag.read_messages():
            columns = topics.setdefault(topic, {})
            for path, value in leaves(message, topic, []) + [(f"{topic}.receive_time", time.to_sec())]:
                columns.setdefault(path, []).append(value)
    pathlib.Path(out_path).write_text(json.dumps(topics))


def ros2_definition(text):
    """A definition of ROS 1 in ROS 2's form: a header has no count, and times are messages."""
    text = re.sub(r"^uint32 seq\s*$", "", text, flags=re.MULTILINE)
    text = re.sub(r"^time ", "builtin_interfaces/Time ", text, flags=re.MULTILINE)
    return re.sub(r"^Header ", "std_msgs/Header ", text, flags=re.MULTILINE)


def ros1(message):
    out = io.BytesIO()
    message.serialize(out)
    return out.getvalue()


def convert(bag_path, begin, end, folder):
    folder = pathlib.Path(folder)
    messages, types = [], {}
    with rosbag.Bag(bag_path) as bag:
        start = bag.get_start_time()
        for topic, message, time in bag.read_messages():
            if time.to_sec() - start > float(end):
                break
            if time.to_sec() - start < float(begin):
                continue
            messages.append((topic, message, time))
            types[topic] = (type(message)._type, type(message)._full_text)
    for compression in ("none", "bz2", "lz4"):
        with rosbag.Bag(str(folder / f"drive_{compression}.bag"), "w", compression=compression, chunk_threshold=65536) as bag:
            for topic, message, time in messages:
                bag.write(topic, message, time)
    topics = [(name, kind.replace("/", "/msg/"), ros2_definition(text)) for name, (kind, text) in sorted(types.items())]
    number = {name: i for i, (name, _, _) in enumerate(topics)}
    written = [(number[topic], time.to_nsec(), ros2_writers.cdr(message)) for topic, message, time in messages]
    for compression in ("", "lz4", "zstd"):
        ros2_writers.write_mcap(folder / f"drive_{compression or 'none'}.mcap", topics, written, compression)
    ros2_writers.write_mcap(folder / "drive_no_summary.mcap", topics, written, "zstd", summary=False)
    ros2_writers.write_mcap(folder / "drive_no_chunks.mcap", topics, written, chunked=False)
    ros1_topics = [(name, kind, text) for name, (kind, text) in sorted(types.items())]
    ros1_written = [(number[topic], time.to_nsec(), ros1(message)) for topic, message, time in messages]
    ros2_writers.write_mcap(folder / "drive_ros1.mcap", ros1_topics, ros1_written, "lz4", encoding="ros1", definition_form="ros1msg")
    ros2_writers.write_db3(folder / "drive.db3", topics, written)
    ros2_writers.write_db3(folder / "drive_zstd.db3", topics, written, compressed=True)
    split = folder / "drive_split"
    split.mkdir()
    third = len(written) // 3 + 1
    names = []
    for part in range(3):
        names.append(f"drive_split_{part}.mcap")
        ros2_writers.write_mcap(split / names[-1], topics, written[part * third:(part + 1) * third], "lz4")
    listing = "".join(f"    - {name}\n" for name in names)
    (split / "metadata.yaml").write_text(f"rosbag2_bagfile_information:\n  version: 5\n  relative_file_paths:\n{listing}  duration:\n    nanoseconds: 1\n")


if __name__ == "__main__":
    {"reference": reference, "convert": convert}[sys.argv[1]](*sys.argv[2:])
