#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

struct sqlite3;
struct sqlite3_stmt;

namespace odoless {

/// What went wrong with a file; default: nothing.
struct [[nodiscard]] FileFailure {
  int error = 0;       ///< errno, or the one that says it best
  std::string text{};  ///< for a person

  [[nodiscard]] bool any() const { return error != 0; }
};

/// A database of SQLite. Trusts nothing that the file says of functions, triggers or sizes.
///
/// Thread: one at a time.
class Database {
 public:
  enum class Use { kRead, kWrite };

  Database() = default;
  ~Database() { close(); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// A file that is only read needs no lock and no file beside it where nobody writes to it.
  FileFailure open(const std::filesystem::path& path, Use use);
  /// An empty one that is no file.
  FileFailure open_in_memory();
  void close();
  [[nodiscard]] bool is_open() const { return database_ != nullptr; }

  /// One or more statements without an answer.
  FileFailure run(const std::string& sql);
  /// Of the last call that failed.
  [[nodiscard]] FileFailure failure() const;
  [[nodiscard]] sqlite3* get() const { return database_; }

 private:
  FileFailure open(const std::string& uri, int flags);

  sqlite3* database_ = nullptr;
};

/// One statement of SQL, run once or row by row.
///
/// Thread: that of its database, which it must not outlive.
class Statement {
 public:
  Statement(Database& database, const char* sql);
  ~Statement();
  Statement(const Statement&) = delete;
  Statement& operator=(const Statement&) = delete;

  /// Binds all values in their order, and runs to the end. @return  Whether it could.
  template <class... Values>
  [[nodiscard]] bool run(const Values&... values) {
    int at = 0;
    (bind(++at, values), ...);
    const bool is_done = !next() && !has_failed_;
    rewind();
    return is_done;
  }
  /// @return  Whether there is another row; false also where it failed.
  [[nodiscard]] bool next();
  [[nodiscard]] bool has_failed() const { return has_failed_; }

  void bind(int at, std::int64_t value);
  void bind(int at, int value) { bind(at, static_cast<std::int64_t>(value)); }
  void bind(int at, double value);
  void bind(int at, const std::string& value);
  void bind(int at, std::span<const std::byte> value);

  /// Of the row; columns count from 0. What lies there lasts until the next row.
  [[nodiscard]] std::int64_t integer(int column) const;
  [[nodiscard]] double real(int column) const;
  [[nodiscard]] std::string text(int column) const;
  [[nodiscard]] std::span<const std::byte> bytes(int column) const;

 private:
  void rewind();

  sqlite3_stmt* statement_ = nullptr;
  bool has_failed_ = false;
};

/// The integer that a query gives in its first row; -1: it gives none.
[[nodiscard]] std::int64_t integer_of(Database& database, const char* sql);

}  // namespace odoless
