#include "firmware/world/database.hpp"

#include <fmt/format.h>
#include <sqlite3.h>

#include <cerrno>
#include <cstring>

namespace odoless {
namespace {

constexpr int kBlob_bytes_max = 16 << 20;
constexpr int kPatience_ms = 1000;  // for another reader or writer

/// Letters that mean themselves in a path of a URI.
std::string to_uri(const std::filesystem::path& path, Database::Use use) {
  std::string uri = "file:";
  std::error_code ignored;
  for (const char letter : std::filesystem::absolute(path, ignored).string()) {
    const bool is_plain = letter != '?' && letter != '#' && letter != '%' && letter > ' ' && letter <= '~';
    uri += is_plain ? std::string(1, letter) : fmt::format("%{:02x}", static_cast<unsigned char>(letter));
  }
  if (use == Database::Use::kWrite) {
    return uri + "?mode=rw";
  }
  const bool is_live = std::filesystem::exists(path.string() + "-wal", ignored) ||
                       std::filesystem::exists(path.string() + "-journal", ignored);
  return uri + (is_live ? "?mode=ro" : "?immutable=1");
}

/// @param system_error  Of the failed call; sqlite3_system_errno knows it of some calls only.
int errno_of(int status, int system_error) {
  switch (status & 0xff) {
    case SQLITE_FULL:
      return ENOSPC;
    case SQLITE_READONLY:
      return EROFS;
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      return EBUSY;
    case SQLITE_NOMEM:
      return ENOMEM;
    case SQLITE_CORRUPT:
    case SQLITE_NOTADB:
      return EBADMSG;
    case SQLITE_IOERR:
    case SQLITE_CANTOPEN:
      return system_error != 0 ? system_error : EIO;
    default:
      return EINVAL;
  }
}

}  // namespace

FileFailure Database::open(const std::filesystem::path& path, Use use) {
  return open(to_uri(path, use), use == Use::kRead ? SQLITE_OPEN_READONLY : SQLITE_OPEN_READWRITE);
}

FileFailure Database::open_in_memory() { return open(":memory:", SQLITE_OPEN_READWRITE); }

FileFailure Database::open(const std::string& uri, int flags) {
  close();
  errno = 0;
  if (sqlite3_open_v2(uri.c_str(), &database_, flags | SQLITE_OPEN_URI | SQLITE_OPEN_NOMUTEX, nullptr) != SQLITE_OK) {
    FileFailure failed = failure();
    close();
    return failed;
  }
  sqlite3_extended_result_codes(database_, 1);
  sqlite3_db_config(database_, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
  sqlite3_db_config(database_, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_limit(database_, SQLITE_LIMIT_LENGTH, kBlob_bytes_max);
  sqlite3_busy_timeout(database_, kPatience_ms);
  return {};
}

void Database::close() {
  sqlite3_close(database_);
  database_ = nullptr;
}

FileFailure Database::run(const std::string& sql) {
  errno = 0;
  return sqlite3_exec(database_, sql.c_str(), nullptr, nullptr, nullptr) == SQLITE_OK ? FileFailure{} : failure();
}

FileFailure Database::failure() const {
  const int system_error = errno;
  const int status = database_ == nullptr ? SQLITE_NOMEM : sqlite3_extended_errcode(database_);
  const int error = errno_of(status, system_error);
  const bool is_systems = error != EINVAL && error != EBADMSG && error != EBUSY;
  return {error, is_systems ? std::strerror(error) : sqlite3_errstr(status)};  // NOLINT(concurrency-mt-unsafe)
}

Statement::Statement(Database& database, const char* sql) {
  has_failed_ = sqlite3_prepare_v2(database.get(), sql, -1, &statement_, nullptr) != SQLITE_OK;
}

Statement::~Statement() { sqlite3_finalize(statement_); }

bool Statement::next() {
  if (has_failed_) {
    return false;
  }
  errno = 0;
  const int status = sqlite3_step(statement_);
  has_failed_ = status != SQLITE_ROW && status != SQLITE_DONE;
  return status == SQLITE_ROW;
}

void Statement::rewind() {
  sqlite3_reset(statement_);
  sqlite3_clear_bindings(statement_);
}

void Statement::bind(int at, std::int64_t value) { sqlite3_bind_int64(statement_, at, value); }

void Statement::bind(int at, double value) { sqlite3_bind_double(statement_, at, value); }

void Statement::bind(int at, const std::string& value) {
  sqlite3_bind_text(statement_, at, value.data(), static_cast<int>(value.size()), SQLITE_STATIC);
}

void Statement::bind(int at, std::span<const std::byte> value) {
  sqlite3_bind_blob(statement_, at, value.empty() ? "" : static_cast<const void*>(value.data()),
                    static_cast<int>(value.size()), SQLITE_STATIC);
}

std::int64_t Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }

double Statement::real(int column) const { return sqlite3_column_double(statement_, column); }

std::string Statement::text(int column) const {
  const std::span<const std::byte> raw = bytes(column);
  return {reinterpret_cast<const char*>(raw.data()), raw.size()};  // NOLINT(*-reinterpret-cast): bytes of a text
}

std::span<const std::byte> Statement::bytes(int column) const {
  const void* const data = sqlite3_column_blob(statement_, column);
  const int size = sqlite3_column_bytes(statement_, column);
  return {static_cast<const std::byte*>(data), data == nullptr ? 0 : static_cast<std::size_t>(size)};
}

std::int64_t integer_of(Database& database, const char* sql) {
  Statement statement(database, sql);
  return statement.next() ? statement.integer(0) : -1;
}

}  // namespace odoless
