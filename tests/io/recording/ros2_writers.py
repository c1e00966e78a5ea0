"""Writes MCAP and rosbag2's SQLite files, from their specifications alone, for tests."""
import ctypes
import sqlite3
import struct
import zlib

FORMATS = {"bool": "?", "int8": "b", "uint8": "B", "byte": "B", "char": "B", "int16": "h", "uint16": "H", "int32": "i",
           "uint32": "I", "int64": "q", "uint64": "Q", "float32": "f", "float64": "d"}


class Cdr:
    """XCDR1: each value at a multiple of its size, counted behind the encapsulation header."""

    def __init__(self, big_endian=False):
        self.order = ">" if big_endian else "<"
        self.bytes = bytearray()
        self.header = bytes([0, 0 if big_endian else 1, 0, 0])

    def put(self, kind, value):
        code = FORMATS[kind]
        size = struct.calcsize(code)
        self.bytes += bytes(-len(self.bytes) % size) + struct.pack(self.order + code, value)

    def put_string(self, text):
        data = text.encode() + b"\0"
        self.put("uint32", len(data))
        self.bytes += data

    def put_field(self, kind, value):
        if "[" in kind:
            base, count = kind[:-1].split("[")
            if not count:
                self.put("uint32", len(value))
            if isinstance(value, bytes):
                self.bytes += value
                return
            for element in value:
                self.put_field(base, element)
        elif kind == "string":
            self.put_string(value)
        elif kind == "time":
            self.put("int32", value.secs)
            self.put("uint32", value.nsecs)
        elif hasattr(value, "_slot_types"):  # a message within a message
            self.put_message(value)
        else:
            self.put(kind, value)

    def put_message(self, message):
        for name, kind in zip(message.__slots__, message._slot_types):
            if not (message._type == "std_msgs/Header" and name == "seq"):
                self.put_field(kind, getattr(message, name))


def cdr(message, big_endian=False):
    writer = Cdr(big_endian)
    writer.put_message(message)
    return writer.header + bytes(writer.bytes)


def lz4_frame(data):
    library = ctypes.CDLL("liblz4.so.1")
    library.LZ4F_compressFrameBound.restype = library.LZ4F_compressFrame.restype = ctypes.c_size_t
    room = library.LZ4F_compressFrameBound(ctypes.c_size_t(len(data)), None)
    out = ctypes.create_string_buffer(room)
    made = library.LZ4F_compressFrame(out, ctypes.c_size_t(room), data, ctypes.c_size_t(len(data)), None)
    return out.raw[:made]


def zstd_frame(data):
    library = ctypes.CDLL("libzstd.so.1")
    library.ZSTD_compressBound.restype = library.ZSTD_compress.restype = ctypes.c_size_t
    room = library.ZSTD_compressBound(ctypes.c_size_t(len(data)))
    out = ctypes.create_string_buffer(room)
    made = library.ZSTD_compress(out, ctypes.c_size_t(room), data, ctypes.c_size_t(len(data)), 3)
    return out.raw[:made]


PACK = {"": lambda data: data, "lz4": lz4_frame, "zstd": zstd_frame}
MAGIC = b"\x89MCAP0\r\n"


def text(value):
    data = value if isinstance(value, bytes) else value.encode()
    return struct.pack("<I", len(data)) + data


def record(op, content):
    return struct.pack("<BQ", op, len(content)) + content


def write_mcap(path, topics, messages, compression="", summary=True, chunked=True, chunk_bytes=65536, encoding="cdr", definition_form="ros2msg"):
    """topics: [(name, type, definition)]; messages: [(topic's position, receive time [ns], payload)]."""
    schemas = [record(0x03, struct.pack("<H", i + 1) + text(kind) + text(definition_form) + text(definition))
               for i, (_, kind, definition) in enumerate(topics)]
    channels = [record(0x04, struct.pack("<HH", i, i + 1) + text(name) + text(encoding) + text(b""))
                for i, (name, _, _) in enumerate(topics)]
    with open(path, "wb") as out:
        out.write(MAGIC + record(0x01, text("ros2") + text("test")))
        chunk_indexes = []
        described = set()
        chunk, index = bytearray(), {}

        def close_chunk():
            if not index:
                return
            packed = PACK[compression](bytes(chunk))
            times = [time for entries in index.values() for time, _ in entries]
            at = out.tell()
            out.write(record(0x06, struct.pack("<QQQI", min(times), max(times), len(chunk), zlib.crc32(chunk)) + text(compression)
                             + struct.pack("<Q", len(packed)) + packed))
            length, offsets = out.tell() - at, b""
            start = out.tell()
            for channel, entries in sorted(index.items()):
                offsets += struct.pack("<HQ", channel, out.tell())
                listing = b"".join(struct.pack("<QQ", *entry) for entry in entries)
                out.write(record(0x07, struct.pack("<H", channel) + text(listing)))
            chunk_indexes.append(record(0x08, struct.pack("<QQQQ", min(times), max(times), at, length) + text(offsets)
                                        + struct.pack("<Q", out.tell() - start) + text(compression)
                                        + struct.pack("<QQ", len(packed), len(chunk))))
            chunk.clear()
            index.clear()

        for topic, time, payload in messages:
            data = b""
            if topic not in described:
                data = schemas[topic] + channels[topic]
                described.add(topic)
            message = record(0x05, struct.pack("<HIQQ", topic, 0, time, time) + payload)
            if not chunked:
                out.write(data + message)
                continue
            chunk += data
            index.setdefault(topic, []).append((time, len(chunk)))
            chunk += message
            if len(chunk) > chunk_bytes:
                close_chunk()
        close_chunk()
        out.write(record(0x0f, struct.pack("<I", 0)))
        if summary:
            at = out.tell()
            counts = b"".join(struct.pack("<HQ", i, sum(1 for t, _, _ in messages if t == i)) for i in range(len(topics)))
            times = [time for _, time, _ in messages]
            content = b"".join(schemas + channels + chunk_indexes) + record(
                0x0b, struct.pack("<QHIIIIQQ", len(messages), len(topics), len(topics), 0, 0, len(chunk_indexes), min(times),
                                  max(times)) + text(counts))
            end = struct.pack("<BQQQ", 0x02, 20, at, 0)
            out.write(content + end + struct.pack("<I", zlib.crc32(content + end)))
        else:
            out.write(record(0x02, struct.pack("<QQI", 0, 0, 0)))
        out.write(MAGIC)


def write_db3(path, topics, messages, definitions=False, compressed=False):
    database = sqlite3.connect(path)
    database.executescript("""
CREATE TABLE topics(id INTEGER PRIMARY KEY,name TEXT NOT NULL,type TEXT NOT NULL,serialization_format TEXT NOT NULL,offered_qos_profiles TEXT NOT NULL);
CREATE TABLE messages(id INTEGER PRIMARY KEY,topic_id INTEGER NOT NULL,timestamp INTEGER NOT NULL, data BLOB NOT NULL);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);""")
    if definitions:
        database.execute("CREATE TABLE message_definitions(id INTEGER PRIMARY KEY,topic_type TEXT NOT NULL,encoding TEXT NOT NULL,"
                         "encoded_message_definition TEXT NOT NULL,type_description_hash TEXT NOT NULL)")
        database.executemany("INSERT INTO message_definitions VALUES(NULL,?,'ros2msg',?,'')", [(k, d) for _, k, d in topics])
    database.executemany("INSERT INTO topics VALUES(?,?,?,'cdr','')", [(i + 1, n, k) for i, (n, k, _) in enumerate(topics)])
    pack = zstd_frame if compressed else bytes
    database.executemany("INSERT INTO messages VALUES(NULL,?,?,?)", [(t + 1, time, pack(p)) for t, time, p in messages])
    database.commit()
    database.close()
