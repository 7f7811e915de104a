// SPDX-License-Identifier: GPL-3.0-or-later
// The only source that includes SQLite.
#include <trellis/memory/database.hpp>

#include <fmt/format.h>
#include <sqlite3.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <limits>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/input_file.hpp>

namespace trellis {

namespace {

constexpr int patience_ms = 30000;  // timeout for another process that writes

}  // namespace

Database::Database(std::string path, Mode mode, Names names) : path_(std::move(path)), names_(names) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) {
    throw Error(fmt::format("{}: is a folder, not a {}", path_, names_.kind));
  }
  if (std::filesystem::exists(path_, ignored) && !std::filesystem::is_regular_file(path_, ignored)) {
    throw Error(fmt::format("{}: the {} cannot be read: {}", path_, names_.brief,
                            input_fault(path_, std::numeric_limits<std::uintmax_t>::max())));
  }
  check_header();
  try {
    open(mode);
  } catch (...) {
    sqlite3_close(handle_);
    throw;
  }
}

Database::~Database() { sqlite3_close(handle_); }

void Database::open(Mode mode) {
  // A read-only user may also have to write: to roll back the transaction of a process that was killed.
  int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_FULLMUTEX;
  if (mode != Mode::read) flags |= SQLITE_OPEN_CREATE;
  int code = sqlite3_open_v2(path_.c_str(), &handle_, flags, nullptr);
  if (code != SQLITE_OK && mode == Mode::read) {
    sqlite3_close(handle_);
    code = sqlite3_open_v2(path_.c_str(), &handle_, SQLITE_OPEN_READONLY | SQLITE_OPEN_FULLMUTEX, nullptr);
  }
  if (code != SQLITE_OK) fail("cannot be opened");
  sqlite3_extended_result_codes(handle_, 1);
  sqlite3_busy_timeout(handle_, patience_ms);
  // With the rollback journal the database remains one file; the synced deletion of the journal is the commit.
  if (mode == Mode::write) run("PRAGMA synchronous = EXTRA");
  run("PRAGMA trusted_schema = OFF");
}

void Database::run(const char* text) const {
  if (sqlite3_exec(handle_, text, nullptr, nullptr, nullptr) != SQLITE_OK) fail("cannot be read or written");
}

std::int64_t Database::ask(const char* text) const {
  Statement statement(*this, text);
  return statement.step() ? statement.integer(0) : 0;
}

void Database::roll_back() const { sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr); }

void Database::fail(const char* what) const {
  const int code = handle_ != nullptr ? sqlite3_extended_errcode(handle_) : SQLITE_NOMEM;
  switch (code & 0xFF) {
    case SQLITE_NOTADB: throw Error(fmt::format("{}: is no {}; it is left as it is", path_, names_.kind));
    case SQLITE_CORRUPT: throw Error(fmt::format("{}: the {} is damaged; it is left as it is", path_, names_.brief));
    case SQLITE_BUSY:
    case SQLITE_LOCKED:
      throw Error(fmt::format("{}: another process has been writing for {} s", path_, patience_ms / 1000));
    case SQLITE_READONLY: throw Error(fmt::format("{}: the {} may not be written", path_, names_.brief));
    case SQLITE_FULL: throw Error(fmt::format("{}: there is no room left on the disk", path_));
    default:
      throw Error(fmt::format("{}: the {} {}: {}", path_, names_.brief, what,
                              handle_ != nullptr ? sqlite3_errmsg(handle_) : "out of memory"));
  }
}

/// SQLite takes a file of one byte for an empty database, and would overwrite it.
void Database::check_header() const {
  constexpr std::string_view magic("SQLite format 3\0", 16);
  constexpr std::size_t header = 100;
  std::ifstream file(path_, std::ios::binary);
  if (!file) return;
  std::string begin(header, '\0');
  file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  begin.resize(static_cast<std::size_t>(file.gcount()));
  if (begin.empty()) return;  // of a process that ended before its first transaction
  if (!std::string_view(begin).starts_with(magic.substr(0, begin.size()))) {
    throw Error(fmt::format("{}: is no {}; it is left as it is", path_, names_.kind));
  }
  if (begin.size() < header) {
    throw Error(fmt::format("{}: the {} is damaged; it is left as it is", path_, names_.brief));
  }
}

Database::Statement::Statement(const Database& database, std::string_view text) : database_(database) {
  if (sqlite3_prepare_v2(database.handle_, text.data(), static_cast<int>(text.size()), &statement_, nullptr) !=
      SQLITE_OK) {
    database.fail("cannot be read");
  }
}

Database::Statement::~Statement() { sqlite3_finalize(statement_); }

bool Database::Statement::step() {
  const int code = sqlite3_step(statement_);
  if (code == SQLITE_ROW) return true;
  if (code != SQLITE_DONE) database_.fail("cannot be read or written");
  return false;
}

void Database::Statement::reset() {
  check(sqlite3_reset(statement_));
  check(sqlite3_clear_bindings(statement_));
}

void Database::Statement::bind(int place, const std::string& text) {
  check(sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
}
void Database::Statement::bind_blob(int place, const std::string& bytes) {
  check(sqlite3_bind_blob64(statement_, place, bytes.data(), bytes.size(), SQLITE_TRANSIENT));
}
void Database::Statement::bind(int place, std::int64_t value) { check(sqlite3_bind_int64(statement_, place, value)); }
void Database::Statement::bind(int place, double value) { check(sqlite3_bind_double(statement_, place, value)); }

std::int64_t Database::Statement::integer(int column) const { return sqlite3_column_int64(statement_, column); }
double Database::Statement::number(int column) const { return sqlite3_column_double(statement_, column); }
std::string Database::Statement::bytes(int column) const {
  const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_, column));
  const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
  return data != nullptr ? std::string(data, size) : std::string();
}

void Database::Statement::check(int code) const {
  if (code != SQLITE_OK) database_.fail("cannot be written");
}

}  // namespace trellis
