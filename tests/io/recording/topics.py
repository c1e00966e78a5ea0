#!/usr/bin/env python3
"""Recordings whose topics are easily confused, and independent readers for bags (python3-rosbag), MCAP and db3.

Usage: topics.py write FOLDER            the recordings
       topics.py read FILE OUT.json      {topic: [[receive time [ns], value of Float64 or null], ...]}, by receive time
"""
import bz2
import ctypes
import json
import pathlib
import random
import shutil
import sqlite3
import struct
import sys

FLOAT = ("std_msgs/Float64", "float64 data\n", struct.Struct("<d").pack)
RULE = "=" * 80
TRANSFORMS = ("tf2_msgs/TFMessage", f"""geometry_msgs/TransformStamped[] transforms
{RULE}
MSG: geometry_msgs/TransformStamped
Header header
string child_frame_id
Transform transform
{RULE}
MSG: std_msgs/Header
uint32 seq
time stamp
string frame_id
{RULE}
MSG: geometry_msgs/Transform
Vector3 translation
Quaternion rotation
{RULE}
MSG: geometry_msgs/Vector3
float64 x
float64 y
float64 z
{RULE}
MSG: geometry_msgs/Quaternion
float64 x
float64 y
float64 z
float64 w
""", lambda transform: struct.pack("<IIII", 1, 0, transform[0] // 10**9, transform[0] % 10**9) + text("odom")
              + text(transform[1]) + struct.pack("<7d", transform[2], 0, 0, 0, 0, 0, 1))
CDR_FLOAT = ("std_msgs/msg/Float64", "float64 data\n", lambda value: b"\0\1\0\0" + struct.pack("<d", value))


# ROS 1 bags as from `rosbag record`.

def fields(values):
    return b"".join(struct.pack("<I", len(k) + 1 + len(v)) + k + b"=" + v for k, v in values.items())


def bag_record(header, data):
    header = fields(header)
    return struct.pack("<I", len(header)) + header + struct.pack("<I", len(data)) + data


def bag_connection(number, topic, publisher, kind):
    header = {b"op": b"\7", b"conn": struct.pack("<I", number), b"topic": topic.encode()}
    return bag_record(header, fields({b"type": kind[0].encode(), b"md5sum": b"fdb28210bfa9d7c91146260178d9a584",
                                      b"message_definition": kind[1].encode(), **publisher}))


def write_bag(path, topics, messages, publisher=lambda topic: {}, index=True, kind=FLOAT, compression="none", chunks=1):
    """topics: of each connection; messages: [(connection, time [ns], value)]; publisher: further fields of its data."""
    connections = [bag_connection(c, topic, publisher(topic), kind) for c, topic in enumerate(topics)]
    out, infos, size = b"", b"", -(-len(messages) // chunks)
    begin = 13 + 4096 + 8
    for first in range(0, len(messages), size):
        body, entries = b"" if first else b"".join(connections), {}
        for c, time, value in messages[first:first + size]:
            stamp = struct.pack("<II", time // 10**9, time % 10**9)
            entries.setdefault(c, []).append(stamp + struct.pack("<I", len(body)))
            body += bag_record({b"op": b"\2", b"conn": struct.pack("<I", c), b"time": stamp}, kind[2](value))
        infos += bag_record({b"op": b"\6", b"ver": struct.pack("<I", 1), b"chunk_pos": struct.pack("<Q", begin + len(out)),
                             b"start_time": min(listed[0][:8] for listed in entries.values()),
                             b"end_time": max(listed[-1][:8] for listed in entries.values()),
                             b"count": struct.pack("<I", len(entries))},
                            b"".join(struct.pack("<II", c, len(listed)) for c, listed in entries.items()))
        out += bag_record({b"op": b"\5", b"compression": compression.encode(), b"size": struct.pack("<I", len(body))},
                          bz2.compress(body) if compression == "bz2" else body)
        for c, listed in entries.items():
            out += bag_record({b"op": b"\4", b"ver": struct.pack("<I", 1), b"conn": struct.pack("<I", c),
                               b"count": struct.pack("<I", len(listed))}, b"".join(listed))
    head = fields({b"op": b"\3", b"index_pos": struct.pack("<Q", (begin + len(out)) * index),
                   b"conn_count": struct.pack("<I", len(topics)), b"chunk_count": struct.pack("<I", infos.count(b"chunk_pos="))})
    path.write_bytes(b"#ROSBAG V2.0\n" + struct.pack("<I", len(head)) + head + struct.pack("<I", 4096 - len(head))
                     + b" " * (4096 - len(head)) + out + (b"".join(connections) + infos if index else b""))


# MCAP: channels are defined before their first use.

def text(value):
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(data)) + data


def mcap_record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def mcap_channel(number, topic):
    return mcap_record(4, struct.pack("<HH", number, 1) + text(topic) + text("cdr") + text(b""))


def write_mcap(path, chunks, chunked=True, summary=True):
    """chunks: [({channel: topic}, [(channel, time [ns], value)])]; a channel keeps its topic until it gets another.""" 
    schema = mcap_record(3, struct.pack("<H", 1) + text(CDR_FLOAT[0]) + text("ros2msg") + text(CDR_FLOAT[1]))
    out, indexes, last = b"\x89MCAP0\r\n" + mcap_record(1, text("ros2") + text("test")), [], {}
    for topics, messages in chunks:
        last.update(topics)
        body = schema + b"".join(mcap_channel(number, topic) for number, topic in topics.items())
        entries = {}
        for channel, time, value in messages:
            entries.setdefault(channel, []).append(struct.pack("<QQ", time, len(body)))
            body += mcap_record(5, struct.pack("<HIQQ", channel, 0, time, time) + CDR_FLOAT[2](value))
        if not chunked:
            out += body
            continue
        at, span = len(out), struct.pack("<QQ", messages[0][1], messages[-1][1])
        out += mcap_record(6, span + struct.pack("<QI", len(body), 0) + text("") + struct.pack("<Q", len(body)) + body)
        length, offsets, begin = len(out) - at, b"", len(out)
        for channel, listed in entries.items():
            offsets += struct.pack("<HQ", channel, len(out))
            out += mcap_record(7, struct.pack("<H", channel) + text(b"".join(listed)))
        indexes.append(mcap_record(8, span + struct.pack("<QQ", at, length) + text(offsets)
                                   + struct.pack("<Q", len(out) - begin) + text("") + struct.pack("<QQ", len(body), len(body))))
    out += mcap_record(15, struct.pack("<I", 0))
    at, total = len(out), sum(len(messages) for _, messages in chunks)
    if summary and chunked:
        out += schema + b"".join(mcap_channel(number, topic) for number, topic in last.items()) + b"".join(indexes)
        out += mcap_record(11, struct.pack("<QHIIIIQQ", total, 1, len(last), 0, 0, len(indexes), 0, 0) + text(b""))
    path.write_bytes(out + mcap_record(2, struct.pack("<QQI", at if summary and chunked else 0, 0, 0)) + b"\x89MCAP0\r\n")


def write_db3(path, topics, messages, killed=False):
    """killed: in the state after a killed recorder, with the journal not yet in the file."""
    database = sqlite3.connect(path.with_suffix(".live") if killed else path)
    if killed:
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA wal_autocheckpoint = 0")
    database.executescript("CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT,type TEXT,serialization_format TEXT,offered_qos_profiles TEXT);"
                           "CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER,timestamp INTEGER,data BLOB);")
    database.executemany("INSERT INTO topics VALUES(?,?,'std_msgs/msg/Float64','cdr','')", topics.items())
    database.executemany("INSERT INTO messages VALUES(NULL,?,?,?)", [(t, time, CDR_FLOAT[2](v)) for t, time, v in messages])
    database.commit()
    for end in ("", "-wal", "-shm") if killed else ():
        shutil.copy(f"{path.with_suffix('.live')}{end}", f"{path}{end}")
    database.close()


def write(folder):
    folder = pathlib.Path(folder)
    at = lambda k, c: 1700000000 * 10**9 + k * 10**8 + c * 10**7
    commands, speeds = [(0, at(k, 0), k / 8) for k in range(60)], [(1, at(k, 1), -k / 4) for k in range(60)]
    others = [(2, at(k, 5), 100.0 + k) for k in range(0, 60, 3)]
    three = sorted(commands + speeds + others, key=lambda message: message[1])
    names = ["/cmd", "/speed", "/cmd"]  # two publishers of one topic
    write_bag(folder / "header_only.bag", names, three)
    write_bag(folder / "no_index.bag", names, three, index=False)
    write_bag(folder / "repeated_in_data.bag", names, three, lambda topic: {b"topic": topic.encode(), b"latching": b""})
    write_bag(folder / "remapped.bag", names, three, lambda topic: {b"topic": b"/before_it_was_remapped"})
    frames = [(0, at(k, c), (at(k, c), frame, sign * k / 8)) for k in range(60) for c, frame, sign in ((0, "base", 1), (4, "arm", -1))]
    write_bag(folder / "tf.bag", ["/tf"], frames, kind=TRANSFORMS)
    channels = {0: "/cmd", 1: "/speed", 2: "/cmd"}
    for name, options in {"repeated": {}, "repeated_loose": {"chunked": False}}.items():
        write_mcap(folder / f"{name}.mcap", [(channels, three[:70]), (channels, three[70:])], **options)
    again = [({0: "/cmd", 1: "/speed"}, [m for m in three[:70] if m[0] < 2]), ({0: "/speed", 1: "/cmd"}, [m for m in three[70:] if m[0] < 2])]
    for name, options in {"reused": {}, "reused_no_summary": {"summary": False}, "reused_loose": {"chunked": False}}.items():
        write_mcap(folder / f"{name}.mcap", again, **options)
    drive(folder)
    for name, killed in {"repeated": False, "killed": True}.items():
        write_db3(folder / f"{name}.db3", {3: "/cmd", 1: "/speed", 7: "/cmd"}, [({0: 3, 1: 1, 2: 7}[c], t, v) for c, t, v in three], killed)


def drive(folder):
    """A speed that follows a command, as a bag of packed chunks and as MCAP."""
    source, speed, command, messages = random.Random(3), 0.0, 0.0, []
    for k in range(400):
        command = source.uniform(-1, 1) if source.random() < 0.1 else command
        speed = 0.8 * speed + 0.5 * command + source.gauss(0, 0.02)
        messages += [(c, 1700000000 * 10**9 + k * 10**8 + c * 10**7, value) for c, value in ((0, command), (1, speed))]
    write_bag(folder / "drive.bag", ["/cmd", "/speed"], messages, compression="bz2", chunks=40)
    write_mcap(folder / "drive.mcap", [({0: "/cmd", 1: "/speed"}, messages)])


# Independent readers.

def read_bag(path):
    import rosbag
    with rosbag.Bag(path) as bag:
        for topic, raw, time in bag.read_messages(raw=True):
            yield topic, time.to_nsec(), raw[1] if raw[0] == FLOAT[0] else b""


def unpack_zstd(data, size):
    out = ctypes.create_string_buffer(size)
    library = ctypes.CDLL("libzstd.so.1")
    library.ZSTD_decompress.restype = ctypes.c_size_t
    made = library.ZSTD_decompress(out, ctypes.c_size_t(size), data, ctypes.c_size_t(len(data)))
    return out.raw[:made]


def read_mcap(path):
    topics, types = {}, {}

    def string(data, at):
        length, = struct.unpack_from("<I", data, at)
        return data[at + 4:at + 4 + length], at + 4 + length

    def records(data, at):
        while at + 9 <= len(data):
            op, length = struct.unpack_from("<BQ", data, at)
            content, at = data[at + 9:at + 9 + length], at + 9 + length
            if op == 3:
                types[struct.unpack_from("<H", content)[0]] = string(content, 2)[0]
            elif op == 4:
                number, schema = struct.unpack_from("<HH", content)
                topics[number] = string(content, 4)[0].decode(), types.get(schema, b"")
            elif op == 5:
                number, _, time, _ = struct.unpack_from("<HIQQ", content)
                yield topics[number][0], time, content[22:] if topics[number][1] == CDR_FLOAT[0].encode() else b""
            elif op == 6:
                size, = struct.unpack_from("<Q", content, 16)
                name, begin = string(content, 28)
                packed = content[begin + 8:]
                yield from records({b"": lambda: packed, b"zstd": lambda: unpack_zstd(packed, size)}[name](), 0)
            elif op == 15:
                return

    yield from records(pathlib.Path(path).read_bytes(), 8)


def read_db3(path):
    database = sqlite3.connect(f"file:{path}?mode=ro&immutable=1", uri=True)
    for topic, kind, time, data in database.execute("SELECT name, type, timestamp, data FROM messages JOIN topics ON topics.id = topic_id ORDER BY messages.id"):
        yield topic, time, data if kind == CDR_FLOAT[0] else b""


def read(path, out):
    topics = {}
    reader = {".bag": read_bag, ".mcap": read_mcap, ".db3": read_db3}[pathlib.Path(path).suffix]
    for topic, time, data in reader(path):
        topics.setdefault(topic, []).append((time, struct.unpack("<d", data[-8:])[0] if data else None))
    for messages in topics.values():
        messages.sort(key=lambda message: message[0])
    pathlib.Path(out).write_text(json.dumps(topics))


if __name__ == "__main__":
    {"write": write, "read": read}[sys.argv[1]](*sys.argv[2:])
