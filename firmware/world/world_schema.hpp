#pragma once

#include <cstdint>
#include <string>

#include "firmware/world/database.hpp"

namespace odoless {

/// "odow": what `file` and SQLite's application_id know a world by.
inline constexpr std::int64_t kWorldApplication = 0x6f646f77;
/// Of the tables; each has its migration from the one before.
inline constexpr int kWorldVersion = 1;

/// What kind of file this is.
enum class WorldKind : std::uint8_t { kEmpty, kWorld, kOther };

/// @param wrong  Where it is kOther: what it is, for a person.
[[nodiscard]] WorldKind kind_of(Database& database, std::string& wrong);

/// Brings an empty or older file to kWorldVersion; the transaction is the caller's.
FileFailure migrate(Database& database);

/// Whether the tables are those of kWorldVersion, to the letter: then nothing of the file's own making is run.
[[nodiscard]] bool has_our_tables(Database& database);

/// What SQLite finds wrong with the file's pages; empty: nothing. @param whole  Indices and all constraints, too.
[[nodiscard]] std::string damage_of(Database& database, bool whole);

}  // namespace odoless
