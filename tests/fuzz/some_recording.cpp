#include "tests/fuzz/some_recording.hpp"

#include <bzlib.h>
#include <lz4frame.h>
#include <sqlite3.h>
#include <zlib.h>
#include <zstd.h>

#include <bit>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>

#include "tests/fuzz/mutate.hpp"
#include "tests/fuzz/scratch.hpp"

namespace modebank::fuzz {

namespace {

template <class T>
std::string number(T value) {
  std::string bytes(sizeof value, '\0');
  std::memcpy(bytes.data(), &value, sizeof value);
  return bytes;
}

std::string counted(const std::string& text) { return number(static_cast<std::uint32_t>(text.size())) + text; }

/// Writes values side by side, or each at a multiple of its size behind the header of CDR.
class Wire {
 public:
  explicit Wire(bool cdr) : cdr_(cdr) {
    if (cdr) bytes_ = std::string("\0\1\0\0", 4);
  }
  template <class T>
  Wire& put(T value) {
    while (cdr_ && bytes_.size() % sizeof value != 0 && sizeof value <= 4) bytes_ += '\0';
    while (cdr_ && (bytes_.size() - 4) % sizeof value != 0) bytes_ += '\0';
    bytes_ += number(value);
    return *this;
  }
  Wire& text(const std::string& value) {
    put(static_cast<std::uint32_t>(value.size() + (cdr_ ? 1 : 0)));
    bytes_ += value;
    if (cdr_) bytes_ += '\0';
    return *this;
  }
  Wire& reals(std::initializer_list<double> values, bool counted_list) {
    if (counted_list) put(static_cast<std::uint32_t>(values.size()));
    for (const double value : values) put(value);
    return *this;
  }
  Wire& header() {
    if (!cdr_) put(std::uint32_t{7});  // seq
    return put(std::int32_t{1'700'000'000}).put(std::uint32_t{500}).text("base");
  }
  std::string bytes() const { return bytes_; }

 private:
  bool cdr_;
  std::string bytes_;
};

constexpr const char *header1 = "====\nMSG: std_msgs/Header\nuint32 seq\ntime stamp\nstring frame_id\n",
                     *header2 =
                         "====\nMSG: std_msgs/Header\nbuiltin_interfaces/Time stamp\nstring frame_id\n"
                         "====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
                     *vector3 = "====\nMSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";

SomeType imu() {
  const std::string own = "std_msgs/Header header\ngeometry_msgs/Vector3 rate\nfloat64[9] covariance\n";
  const auto message = [](bool cdr) {
    return Wire(cdr).header().reals({0.1, 0.2, -0.3}, false).reals({1, 0, 0, 0, 1, 0, 0, 0, 1}, false).bytes();
  };
  return {"t/Imu", own + header1 + vector3, own + header2 + vector3, message(false), message(true)};
}

SomeType joints() {
  const std::string own = "std_msgs/Header header\nstring[] name\nfloat64[] position\nfloat64[] velocity\n";
  const auto message = [](bool cdr) {
    Wire wire(cdr);
    wire.header().put(std::uint32_t{2}).text("left").text("right");
    return wire.reals({1.0, 2.0}, true).reals({3.0, 4.0}, true).bytes();
  };
  return {"t/Joints", own + header1, own + header2, message(false), message(true)};
}

SomeType everything() {
  const std::string front =
                        "bool a\nint8 b\nuint16 c\nint32 LIMIT=5\nint64 d\nfloat32 e\nuint8[] blob\nt/Pair[2] pairs\n"
                        "t/Pair[] more\nstring s\n",
                    pair = "====\nMSG: t/Pair\nint16 x # of two\nuint64 y\n";
  const auto message = [](bool cdr) {
    Wire wire(cdr);
    wire.put(std::uint8_t{1}).put(std::int8_t{-1}).put(std::uint16_t{3}).put(std::int64_t{-4}).put(2.5F);
    wire.put(std::uint32_t{3}).put(std::uint8_t{1}).put(std::uint8_t{2}).put(std::uint8_t{3});
    for (int i = 0; i < 2; ++i) wire.put(static_cast<std::int16_t>(i)).put(std::uint64_t{9});
    wire.put(std::uint32_t{1}).put(std::int16_t{5}).put(std::uint64_t{6});
    return wire.text("end").put(std::int32_t{1}).put(std::uint32_t{2}).bytes();
  };
  return {
      "t/Everything", front + "time at\n" + pair,
      front + "builtin_interfaces/Time at\n" + pair + "====\nMSG: builtin_interfaces/Time\nint32 sec\nuint32 nanosec\n",
      message(false), message(true)};
}

/// How many of the numbers and texts of one recording are wrong.
class Faults {
 public:
  explicit Faults(Random& random)
      : random_(random), one_in_(random.pick({std::size_t{0}, std::size_t{40}, std::size_t{6}})) {}
  bool here() { return one_in_ > 0 && random_.one_in(one_in_); }
  template <class T>
  T of(T value) {
    if (!here()) return value;
    return static_cast<T>(random_.one_in(2) ? odd_whole(random_)
                                            : static_cast<std::uint64_t>(value) + random_.below(9) - 4);
  }
  std::string of(const std::string& text) {
    static const std::vector<std::string> tokens = definition_tokens();
    return here() ? mutated_text(random_, {text}, tokens) : text;
  }
  std::string of_bytes(const std::string& bytes) { return here() ? mutated_bytes(random_, bytes) : bytes; }

 private:
  Random& random_;
  std::size_t one_in_;
};

std::string lz4(const std::string& content) {
  std::string packed(LZ4F_compressFrameBound(content.size(), nullptr), '\0');
  packed.resize(LZ4F_compressFrame(packed.data(), packed.size(), content.data(), content.size(), nullptr));
  return packed;
}

std::string bz2(const std::string& content) {
  auto bytes = static_cast<unsigned>(content.size() + content.size() / 100 + 700);
  std::string packed(bytes, '\0'), copy = content;
  BZ2_bzBuffToBuffCompress(packed.data(), &bytes, copy.data(), static_cast<unsigned>(copy.size()), 1, 0, 0);
  packed.resize(bytes);
  return packed;
}

std::string zstd(const std::string& content) {
  std::string packed(ZSTD_compressBound(content.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), content.data(), content.size(), 1));
  return packed;
}

constexpr std::uint32_t begin_s = 1'700'000'000;

/// One topic of a recording in the making.
struct Topic {
  std::uint32_t number = 0;
  SomeType type;
  std::string name;
};

std::vector<Topic> some_topics(Random& random, Faults& faults) {
  std::vector<Topic> topics;
  for (std::uint32_t i = 0; i <= random.below(3); ++i)
    topics.push_back({faults.of(i), random.pick(some_types()), faults.of("/topic" + std::to_string(i))});
  return topics;
}

namespace bag {

std::string field(const std::string& name, const std::string& value) { return counted(name + "=" + value); }

std::string record(std::uint8_t op, const std::string& fields, const std::string& data, Faults& faults) {
  const std::string header = fields + field("op", number(faults.of(op)));
  return number(faults.of(static_cast<std::uint32_t>(header.size()))) + header +
         number(faults.of(static_cast<std::uint32_t>(data.size()))) + data;
}

std::string connection(const Topic& topic, Faults& faults) {
  return record(7, field("conn", number(topic.number)) + field("topic", topic.name),
                field("topic", topic.name) + field("type", faults.of(topic.type.name)) +
                    field("md5sum", std::string(32, '0')) + field("message_definition", faults.of(topic.type.ros1)),
                faults);
}

std::string stamp(std::uint32_t k, Faults& faults) {
  return number(faults.of(begin_s + k)) + number(faults.of(std::uint32_t{5}));
}

/// A chunk with its indexes; `counts` gets its messages by connection.
std::string chunk(const std::vector<Topic>& topics, std::uint32_t& k, Random& random, Faults& faults,
                  std::map<std::uint32_t, std::uint32_t>& counts) {
  std::string content;
  for (const Topic& topic : topics) content += connection(topic, faults);
  std::map<std::uint32_t, std::string> entries;
  for (std::size_t left = random.below(6); left > 0; --left, ++k) {
    const Topic& topic = random.pick(topics);
    entries[topic.number] += stamp(k, faults) + number(faults.of(static_cast<std::uint32_t>(content.size())));
    ++counts[topic.number];
    content += record(2, field("conn", number(topic.number)) + field("time", stamp(k, faults)),
                      faults.of_bytes(topic.type.ros1_message), faults);
  }
  const std::string compression = random.pick({"none", "bz2", "lz4"});
  const std::string packed = compression == "bz2" ? bz2(content) : compression == "lz4" ? lz4(content) : content;
  std::string bytes = record(5,
                             field("compression", faults.of(compression)) +
                                 field("size", number(faults.of(static_cast<std::uint32_t>(content.size())))),
                             faults.of_bytes(packed), faults);
  for (const auto& [conn, list] : entries)
    bytes += record(4,
                    field("ver", number(std::uint32_t{1})) + field("conn", number(faults.of(conn))) +
                        field("count", number(faults.of(counts[conn]))),
                    list, faults);
  return bytes;
}

}  // namespace bag

namespace mcap {

std::string record(std::uint8_t op, const std::string& content, Faults& faults) {
  return number(faults.of(op)) + number(faults.of(static_cast<std::uint64_t>(content.size()))) + content;
}

struct Channels {
  std::string schemas, channels;
};

Channels describe(const std::vector<Topic>& topics, bool ros1, Faults& faults) {
  Channels described;
  for (const Topic& topic : topics) {
    const auto number16 = static_cast<std::uint16_t>(topic.number);
    const auto schema = static_cast<std::uint16_t>(topic.number + 1);
    described.schemas +=
        record(3,
               number(faults.of(schema)) + counted(faults.of(topic.type.name)) + counted(ros1 ? "ros1msg" : "ros2msg") +
                   counted(faults.of(ros1 ? topic.type.ros1 : topic.type.ros2)),
               faults);
    described.channels += record(4,
                                 number(number16) + number(faults.of(schema)) + counted(topic.name) +
                                     counted(faults.of(std::string(ros1 ? "ros1" : "cdr"))) + counted(""),
                                 faults);
  }
  return described;
}

std::string message(const Topic& topic, bool ros1, std::uint32_t k, Faults& faults) {
  const std::uint64_t at_ns = (std::uint64_t{begin_s} + k) * 1'000'000'000;
  return record(5,
                number(static_cast<std::uint16_t>(topic.number)) + number(k) + number(faults.of(at_ns)) +
                    number(at_ns) + faults.of_bytes(ros1 ? topic.type.ros1_message : topic.type.ros2_message),
                faults);
}

std::uint32_t checksum(const std::string& content) {
  return static_cast<std::uint32_t>(
      crc32(0, reinterpret_cast<const Bytef*>(content.data()), static_cast<uInt>(content.size())));
}

}  // namespace mcap

}  // namespace

const std::vector<SomeType>& some_types() {
  static const std::vector<SomeType> types{imu(), joints(), everything()};
  return types;
}

std::vector<std::string> definition_tokens() {
  return {"bool",
          "byte",
          "char",
          "int8",
          "uint8",
          "int16",
          "uint32",
          "int64",
          "uint64",
          "float32",
          "float64",
          "string",
          "wstring",
          "time",
          "duration",
          "Header",
          "[]",
          "[3]",
          "[<=3]",
          "[0]",
          "[4294967296]",
          "[-1]",
          "string<=10",
          "t/Pair",
          "p/T",
          "T",
          "====\nMSG: p/T\n",
          "====\nMSG: t/Pair\n",
          "\nMSG: ",
          "X=1",
          "#",
          "\"x\"",
          "\nuint8[] more",
          "/",
          "geometry_msgs/msg/Vector3",
          "ros1msg",
          "ros2msg",
          "cdr",
          "none",
          "lz4",
          "zstd"};
}

std::string some_bag(Random& random) {
  Faults faults(random);
  const std::vector<Topic> topics = some_topics(random, faults);
  std::string body, infos;
  const std::size_t chunks = random.below(4);
  const std::string magic = "#ROSBAG V2.0\n";
  const auto front = [&](std::uint64_t index_at, std::size_t count) {
    return magic +
           bag::record(3,
                       bag::field("index_pos", number(index_at)) +
                           bag::field("conn_count", number(faults.of(static_cast<std::uint32_t>(topics.size())))) +
                           bag::field("chunk_count", number(faults.of(static_cast<std::uint32_t>(count)))),
                       std::string(16, ' '), faults);
  };
  const std::size_t front_bytes = front(0, 0).size();
  std::uint32_t k = 0;
  for (std::size_t i = 0; i < chunks; ++i) {
    std::map<std::uint32_t, std::uint32_t> counts;
    const std::uint64_t at = front_bytes + body.size();
    body += bag::chunk(topics, k, random, faults, counts);
    std::string list;
    for (const auto& [conn, count] : counts) list += number(faults.of(conn)) + number(faults.of(count));
    infos += bag::record(6,
                         bag::field("ver", number(std::uint32_t{1})) + bag::field("chunk_pos", number(faults.of(at))) +
                             bag::field("start_time", bag::stamp(0, faults)) +
                             bag::field("end_time", bag::stamp(k, faults)) +
                             bag::field("count", number(faults.of(static_cast<std::uint32_t>(counts.size())))),
                         list, faults);
  }
  const bool indexed = !random.one_in(4);
  std::string bytes = front(indexed ? front_bytes + body.size() : 0, chunks) + body;
  if (indexed) {
    for (const Topic& topic : topics) bytes += bag::connection(topic, faults);
    bytes += infos;
  }
  return random.one_in(3) ? mutated_bytes(random, bytes) : bytes;
}

std::string some_mcap(Random& random) {
  using mcap::record;
  Faults faults(random);
  const bool ros1 = random.one_in(3), chunked = !random.one_in(4);
  const std::vector<Topic> topics = some_topics(random, faults);
  const mcap::Channels described = mcap::describe(topics, ros1, faults);
  const std::string magic("\x89MCAP0\r\n", 8);
  std::string bytes = magic + record(1, counted("ros2") + counted("fuzz"), faults), chunk_indexes;
  if (!chunked) bytes += described.schemas + described.channels;
  std::uint32_t k = 0;
  for (std::size_t chunks = random.below(4); chunks > 0; --chunks) {
    std::string content = chunked ? described.schemas + described.channels : "";
    std::map<std::uint16_t, std::string> entries;
    for (std::size_t left = random.below(6); left > 0; --left, ++k) {
      const Topic& topic = random.pick(topics);
      entries[static_cast<std::uint16_t>(topic.number)] +=
          number(faults.of(std::uint64_t{k})) + number(faults.of(static_cast<std::uint64_t>(content.size())));
      content += mcap::message(topic, ros1, k, faults);
    }
    if (!chunked) {
      bytes += content;
      continue;
    }
    const std::string compression = random.pick({"", "lz4", "zstd"});
    const std::string packed = compression == "lz4" ? lz4(content) : compression == "zstd" ? zstd(content) : content;
    const std::uint64_t at = bytes.size(), unpacked = content.size();
    const std::uint32_t sum = random.one_in(2) ? 0 : faults.of(mcap::checksum(content));
    bytes += record(6,
                    number(std::uint64_t{0}) + number(std::uint64_t{9}) + number(faults.of(unpacked)) + number(sum) +
                        counted(faults.of(compression)) + number(faults.of(static_cast<std::uint64_t>(packed.size()))) +
                        faults.of_bytes(packed),
                    faults);
    const std::uint64_t length = bytes.size() - at;
    std::string offsets;
    for (const auto& [channel, list] : entries) {
      offsets += number(faults.of(channel)) + number(faults.of(static_cast<std::uint64_t>(bytes.size())));
      bytes += record(7, number(channel) + counted(list), faults);
    }
    chunk_indexes += record(8,
                            number(std::uint64_t{0}) + number(std::uint64_t{9}) + number(faults.of(at)) +
                                number(faults.of(length)) + counted(offsets) + number(std::uint64_t{0}) +
                                counted(compression) + number(std::uint64_t{packed.size()}) + number(unpacked),
                            faults);
  }
  bytes += record(0x0f, number(std::uint32_t{0}), faults);
  const std::uint64_t summary_at = random.one_in(5) ? 0 : bytes.size();
  if (summary_at > 0) {
    bytes += described.schemas + described.channels + chunk_indexes;
    bytes += record(0x0b, number(faults.of(std::uint64_t{k})) + std::string(34, '\0') + counted(""), faults);
  }
  bytes +=
      record(2, number(faults.of(summary_at)) + number(std::uint64_t{0}) + number(std::uint32_t{0}), faults) + magic;
  return random.one_in(3) ? mutated_bytes(random, bytes) : bytes;
}

namespace {

void run_sql(sqlite3* database, const std::string& sql) {
  if (sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr) != SQLITE_OK)
    throw std::runtime_error(std::string("a recording's SQL: ") + sqlite3_errmsg(database));
}

std::string blob(const std::string& bytes) {
  static constexpr char digits[] = "0123456789abcdef";
  std::string hex = "x'";
  for (const char c : bytes) hex += {digits[static_cast<unsigned char>(c) >> 4], digits[c & 15]};
  return hex + "'";
}

/// SQL's text for a value, of another type now and then.
std::string value(Random& random, Faults& faults, const std::string& sql) {
  if (!faults.here()) return sql;
  return random.pick({std::string("NULL"), std::string("'text'"), std::string("1.5"), std::string("x'00ff'"),
                      std::to_string(static_cast<std::int64_t>(odd_whole(random)))});
}

}  // namespace

std::string some_db3(Random& random) {
  Faults faults(random);
  std::vector<Topic> topics = some_topics(random, faults);
  sqlite3* database = nullptr;
  sqlite3_open(":memory:", &database);
  run_sql(database, "PRAGMA page_size = 512; BEGIN;");
  run_sql(database,
          "CREATE TABLE topics(id INTEGER PRIMARY KEY, name, type, serialization_format, offered_qos_profiles);"
          "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id, timestamp, data);");
  if (random.one_in(2))
    run_sql(database,
            "CREATE TABLE message_definitions(id INTEGER PRIMARY KEY, topic_type, encoding, "
            "encoded_message_definition, type_description_hash);");
  const bool defined =
      sqlite3_exec(database, "SELECT 1 FROM message_definitions", nullptr, nullptr, nullptr) == SQLITE_OK;
  for (std::uint32_t i = 0; i < topics.size(); ++i) {
    topics[i].number = i + 1;
    const std::string id = std::to_string(i + 1), type = blob(faults.of(topics[i].type.name));
    run_sql(database, "INSERT INTO topics VALUES(" + id + ", CAST(" + blob(topics[i].name) + " AS TEXT), CAST(" + type +
                          " AS TEXT), " + value(random, faults, "'cdr'") + ", '')");
    if (defined)
      run_sql(database, "INSERT INTO message_definitions VALUES(" + id + ", CAST(" + type + " AS TEXT), " +
                            value(random, faults, "'ros2msg'") + ", CAST(" + blob(faults.of(topics[i].type.ros2)) +
                            " AS TEXT), '')");
  }
  for (std::uint32_t k = 0; k < random.below(8); ++k) {
    const Topic& topic = random.pick(topics);
    run_sql(database, "INSERT INTO messages VALUES(" + std::to_string(k + 1) + ", " +
                          value(random, faults, std::to_string(topic.number)) + ", " +
                          value(random, faults, std::to_string(begin_s + k) + "000000000") + ", " +
                          value(random, faults, blob(faults.of_bytes(topic.type.ros2_message))) + ")");
  }
  run_sql(database, "COMMIT");
  sqlite3_int64 size = 0;
  unsigned char* const image = sqlite3_serialize(database, "main", &size, 0);
  std::string bytes(reinterpret_cast<const char*>(image), static_cast<std::size_t>(size));
  sqlite3_free(image);
  sqlite3_close(database);
  return random.one_in(2) ? mutated_bytes(random, bytes) : bytes;
}

}  // namespace modebank::fuzz
