// ROS 2 bags in SQLite (.db3), as rosbag2 writes them.
#include <fmt/core.h>
#include <sqlite3.h>

#include <map>

#include "tools/command/error.hpp"
#include "tools/log/binary_stream.hpp"
#include "tools/log/formats/formats.hpp"
#include "tools/log/formats/laser_scan.hpp"

namespace odoless {
namespace {

using Database = std::unique_ptr<sqlite3, int (*)(sqlite3*)>;
using Statement = std::unique_ptr<sqlite3_stmt, int (*)(sqlite3_stmt*)>;

/// Letters that mean themselves in a path of a URI.
std::string to_uri(const std::filesystem::path& path) {
  std::string uri = "file:";
  for (const char letter : std::filesystem::absolute(path).string()) {
    const bool is_plain = letter != '?' && letter != '#' && letter != '%' && letter > ' ' && letter <= '~';
    uri += is_plain ? std::string(1, letter) : fmt::format("%{:02x}", static_cast<unsigned char>(letter));
  }
  // Without a writer's log beside it nobody writes to it: then no lock and no file beside it is needed either.
  const bool is_live = std::filesystem::exists(path.string() + "-wal");
  return uri + (is_live ? "?mode=ro" : "?immutable=1");
}

class SqliteBag : public MessageLog {
 public:
  explicit SqliteBag(const std::string& name)
      : MessageLog("ROS 2 bag (SQLite)", name), database_(open(name)), messages_(nullptr, &sqlite3_finalize) {
    check_tables();
    read_topics();
    messages_ = prepare("SELECT topic_id, timestamp, data FROM messages ORDER BY id");
  }

 protected:
  bool read(Head& head) override {
    if (!step(messages_)) {
      return false;
    }
    const auto topic = topics_by_id_.find(sqlite3_column_int64(messages_.get(), 0));
    if (topic == topics_by_id_.end()) {
      fail("a message of no known topic");
    }
    head.topic = topic->second;
    head.recorded_ns = sqlite3_column_int64(messages_.get(), 1);
    return true;
  }

  DecodedScan decode() override { return decode_laser_scan(bytes(messages_, 2), RosEncoding::kCdr); }

 private:
  [[noreturn]] void fail(const std::string& wrong) const {
    throw DataError(name(), 0, wrong,
                    "a whole .db3 file of rosbag2, unpacked, with the -wal file beside it if it has one");
  }

  [[noreturn]] void fail() const { fail(fmt::format("SQLite says: {}", sqlite3_errmsg(database_.get()))); }

  /// The database trusts nothing that the file says of functions, triggers or sizes.
  Database open(const std::string& path) {
    sqlite3* opened = nullptr;
    const int status = sqlite3_open_v2(to_uri(path).c_str(), &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    Database database(opened, &sqlite3_close);
    if (status != SQLITE_OK) {
      throw NoInputError(fmt::format("{}: SQLite cannot open it: {}", path, sqlite3_errstr(status)));
    }
    sqlite3_db_config(opened, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_limit(opened, SQLITE_LIMIT_LENGTH, static_cast<int>(BinaryStream::kPieceBytesMax));
    return database;
  }

  Statement prepare(const char* text) const {
    sqlite3_stmt* prepared = nullptr;
    if (sqlite3_prepare_v2(database_.get(), text, -1, &prepared, nullptr) != SQLITE_OK) {
      fail();
    }
    return {prepared, &sqlite3_finalize};
  }

  bool step(const Statement& statement) const {
    const int status = sqlite3_step(statement.get());
    if (status != SQLITE_ROW && status != SQLITE_DONE) {
      fail();
    }
    return status == SQLITE_ROW;
  }

  static std::string_view bytes(const Statement& statement, int column) {
    const void* const data = sqlite3_column_blob(statement.get(), column);
    const int size = sqlite3_column_bytes(statement.get(), column);
    return data == nullptr ? std::string_view() : std::string_view(static_cast<const char*>(data), std::size_t(size));
  }

  /// Tables and no views, behind which an endless query can stand.
  void check_tables() const {
    const Statement statement = prepare(
        "SELECT count(*) FROM sqlite_schema WHERE type = 'table' AND name IN ('topics', 'messages') AND rootpage > 0");
    if (!step(statement) || sqlite3_column_int(statement.get(), 0) != 2) {
      fail("an SQLite file without the tables topics and messages");
    }
  }

  void read_topics() {
    const Statement statement = prepare("SELECT id, name, type, serialization_format FROM topics");
    while (step(statement)) {
      const std::string type(bytes(statement, 2));
      const std::string encoding(bytes(statement, 3));
      topics_by_id_[sqlite3_column_int64(statement.get(), 0)] =
          topic_of(bytes(statement, 1), encoding == "cdr" ? type : fmt::format("{} as {}", type, encoding),
                   encoding == "cdr" && is_laser_scan(type));
    }
  }

  Database database_;
  Statement messages_;
  std::map<std::int64_t, std::size_t> topics_by_id_;
};

}  // namespace

bool is_sqlite_bag(std::string_view head) {
  using namespace std::string_view_literals;
  return head.starts_with("SQLite format 3\0"sv);
}

std::unique_ptr<MessageLog> open_sqlite_bag(std::unique_ptr<ByteStream>, const std::filesystem::path& path) {
  return std::make_unique<SqliteBag>(path.string());
}

}  // namespace odoless
