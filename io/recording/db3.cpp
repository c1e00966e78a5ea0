#include "io/recording/db3.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <map>
#include <unordered_map>

#include "io/recording/decompress.hpp"
#include "modebank/base/error.hpp"

namespace modebank {

namespace {

struct SqlError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Database {
 public:
  /// With `immutable`, SQLite uses no locks and no journal and writes no other files.
  Database(const std::filesystem::path& path, bool immutable) {
    const int flags = SQLITE_OPEN_READONLY | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX | SQLITE_OPEN_PRIVATECACHE;
    const int status = sqlite3_open_v2(uri(path, immutable).c_str(), &handle_, flags, nullptr);
    if (status != SQLITE_OK) {
      const std::string why = sqlite3_errstr(status);
      sqlite3_close(handle_);
      throw ConfigurationError(fmt::format("cannot read {}: {}", path.string(), why));
    }
    for (const int forbidden : {SQLITE_DBCONFIG_TRUSTED_SCHEMA, SQLITE_DBCONFIG_ENABLE_TRIGGER,
                                SQLITE_DBCONFIG_ENABLE_VIEW, SQLITE_DBCONFIG_ENABLE_LOAD_EXTENSION})
      sqlite3_db_config(handle_, forbidden, 0, nullptr);
    sqlite3_db_config(handle_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_limit(handle_, SQLITE_LIMIT_LENGTH, static_cast<int>(most_message_bytes));
    sqlite3_limit(handle_, SQLITE_LIMIT_ATTACHED, 0);
    sqlite3_exec(handle_, "PRAGMA cell_size_check = ON; PRAGMA mmap_size = 0;", nullptr, nullptr, nullptr);
  }
  ~Database() { sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  sqlite3* handle() const { return handle_; }

 private:
  static std::string uri(const std::filesystem::path& path, bool immutable) {
    std::string text = "file:";
    for (const char c : std::filesystem::absolute(path).string()) {
      if (c == '?' || c == '#' || c == '%')
        text += fmt::format("%{:02x}", static_cast<unsigned char>(c));
      else
        text += c;
    }
    return text + (immutable ? "?mode=ro&immutable=1" : "?mode=ro");
  }

  sqlite3* handle_ = nullptr;
};

class Query {
 public:
  Query(const Database& database, const std::string& sql) : database_(database) {
    if (sqlite3_prepare_v2(database.handle(), sql.c_str(), -1, &statement_, nullptr) != SQLITE_OK) fail();
  }
  ~Query() { sqlite3_finalize(statement_); }
  Query(const Query&) = delete;
  Query& operator=(const Query&) = delete;

  bool next() {
    const int status = sqlite3_step(statement_);
    if (status != SQLITE_ROW && status != SQLITE_DONE) fail();
    return status == SQLITE_ROW;
  }
  std::int64_t integer(int column) { return sqlite3_column_int64(statement_, column); }
  std::string_view bytes(int column) {
    const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_, column));
    if (data == nullptr && sqlite3_errcode(database_.handle()) == SQLITE_NOMEM) fail();
    return {data == nullptr ? "" : data, static_cast<std::size_t>(sqlite3_column_bytes(statement_, column))};
  }
  std::string text(int column) { return std::string(bytes(column)); }

 private:
  [[noreturn]] void fail() const { throw SqlError(sqlite3_errmsg(database_.handle())); }

  const Database& database_;
  sqlite3_stmt* statement_ = nullptr;
};

/// Whether there is a journal with messages beside the file. A recorder that was killed leaves such a journal.
bool has_journal(const std::filesystem::path& path) {
  std::error_code error;
  return std::filesystem::file_size(path.string() + "-wal", error) > 0 && !error;
}

/// Opens the database, together with its journal if that is readable. With a journal, SQLite needs a third file,
/// FILE-shm.
std::unique_ptr<Database> open_database(const std::filesystem::path& path, std::vector<std::string>& notes) {
  if (!has_journal(path)) return std::make_unique<Database>(path, true);
  try {
    auto database = std::make_unique<Database>(path, false);
    Query(*database, "SELECT count(*) FROM sqlite_master").next();
    return database;
  } catch (const SqlError& error) {
    notes.push_back(fmt::format("{0}-wal has messages that were never moved into {0}; they are not read ({1})",
                                path.string(), error.what()));
    return std::make_unique<Database>(path, true);
  }
}

class Db3 : public Container {
 public:
  explicit Db3(const std::filesystem::path& path) : path_(path), database_(open_database(path, notes_)) {
    try {
      check_tables();
      read_topics();
      read_definitions();
    } catch (const SqlError& error) {
      throw DataError(damage(error));
    }
    count_messages();
  }

  std::string visit(const std::vector<bool>& wanted, const MessageSink& sink) override {
    std::string list;
    for (const auto& [id, connection] : by_id_)
      if (wanted[connection]) list += fmt::format("{}{}", list.empty() ? "" : ",", id);
    return run("SELECT topic_id, timestamp, data FROM messages WHERE topic_id IN (" + list + ") ORDER BY rowid", sink);
  }

  std::string sample(const MessageSink& sink) override {
    std::string list;
    for (const std::int64_t id : sample_ids_) list += fmt::format("{}{}", list.empty() ? "" : ",", id);
    return run("SELECT topic_id, timestamp, data FROM messages WHERE rowid IN (" + list + ") ORDER BY rowid", sink);
  }

  void close() override { database_.reset(); }

 private:
  std::string damage(const SqlError& error) const {
    return fmt::format("{}: SQLite: {}", path_.string(), error.what());
  }

  /// Accepts only tables. rosbag2 writes no views or virtual tables, and modules of virtual tables could execute code.
  void check_tables() {
    for (const char* name : {"topics", "messages"}) {
      Query query(
          *database_,
          fmt::format("SELECT 1 FROM sqlite_schema WHERE name = '{}' AND type = 'table' AND rootpage > 0", name));
      if (!query.next())
        throw DataError(fmt::format("{}: this SQLite database is not a recording of rosbag2 (it has no table {})",
                                    path_.string(), name));
    }
  }

  void read_topics() {
    Query query(*database_, "SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    while (query.next() && connections_.size() < most_connections) {
      Connection connection;
      connection.topic = query.text(1);
      connection.type = query.text(2);
      connection.encoding_name = query.text(3);
      if (connection.encoding_name == "cdr") connection.encoding = Connection::Encoding::cdr;
      if (by_id_.emplace(query.integer(0), connections_.size()).second) connections_.push_back(std::move(connection));
    }
  }

  /// Newer recordings contain the definitions that the recorder found.
  void read_definitions() {
    Query table(*database_,
                "SELECT 1 FROM sqlite_schema WHERE name = 'message_definitions' AND type = 'table' AND rootpage > 0");
    if (!table.next()) return;
    Query query(*database_, "SELECT topic_type, encoding, encoded_message_definition FROM message_definitions");
    while (query.next()) {
      const std::string type = query.text(0);
      if (query.bytes(2).size() > most_definition_bytes) continue;
      for (Connection& connection : connections_)
        if (connection.type == type && connection.definition.empty()) {
          connection.definition_form = query.text(1);
          connection.definition = query.text(2);
        }
    }
  }

  void count_messages() {
    std::unordered_map<std::size_t, std::pair<std::int64_t, std::int64_t>> ends;
    std::size_t of_no_topic = 0;
    try {
      // Reads row by row, so that rows before any damage count. Does not read the payload, which comes after these
      // columns.
      Query query(*database_, "SELECT rowid, topic_id FROM messages ORDER BY rowid");
      while (query.next()) {
        const auto found = by_id_.find(query.integer(1));
        if (found == by_id_.end()) {
          ++of_no_topic;
          continue;
        }
        constexpr std::uint64_t looked_at = 10;  // publishers of one topic, with other names
        if (++connections_[found->second].messages < looked_at) sample_ids_.push_back(query.integer(0));
        ends.try_emplace(found->second, query.integer(0), 0).first->second.second = query.integer(0);
      }
    } catch (const SqlError& error) {
      notes_.push_back(damage(error) + "; data before that are read");
      damage_noted_ = true;
    }
    if (of_no_topic > 0)
      notes_.push_back(fmt::format("{}: {} messages are left out, because the table topics lacks their numbers",
                                   path_.string(), of_no_topic));
    for (const auto& [connection, first_last] : ends)
      sample_ids_.insert(sample_ids_.end(), {first_last.first, first_last.second});
  }

  std::string run(const std::string& sql, const MessageSink& sink) {
    std::vector<std::string> stated;
    if (!database_) database_ = open_database(path_, stated);
    try {
      Query query(*database_, sql);
      while (query.next()) {
        const auto found = by_id_.find(query.integer(0));
        if (found == by_id_.end()) continue;
        sink({found->second, query.integer(1), plain(query.bytes(2))});
      }
    } catch (const SqlError& error) {
      return damage_noted_ ? "" : damage(error);
    }
    return {};
  }

  /// rosbag2 may compress each message with zstd. The first bytes of a zstd frame are not those of any CDR
  /// encapsulation.
  std::string_view plain(std::string_view payload) {
    constexpr std::string_view zstd_magic = "\x28\xb5\x2f\xfd";
    if (payload.substr(0, zstd_magic.size()) != zstd_magic) return payload;
    const std::uint64_t declared = zstd_content_bytes(payload);
    if (declared > most_message_bytes) throw SqlError("the size of a compressed message is missing or too large");
    const Unpacked unpacked = unpack(Compression::zstd, payload, declared, buffer_);
    if (!unpacked.failure.empty()) throw SqlError("a compressed message: " + unpacked.failure);
    return unpacked.bytes;
  }

  std::filesystem::path path_;
  std::unique_ptr<Database> database_;
  std::map<std::int64_t, std::size_t> by_id_;
  std::vector<std::int64_t> sample_ids_;
  bool damage_noted_ = false;
  Buffer buffer_;
};

}  // namespace

std::unique_ptr<Container> open_db3(const std::filesystem::path& path) { return std::make_unique<Db3>(path); }

}  // namespace modebank
