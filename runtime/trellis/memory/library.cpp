// SPDX-License-Identifier: GPL-3.0-or-later
// The only source that includes SQLite.
#include <trellis/memory/library.hpp>

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/memory/bytes.hpp>
#include <trellis/memory/identity.hpp>

namespace trellis {

namespace {

constexpr int application = 0x54726C73;  // "Trls", in the header of the file
constexpr int version = 1;               // of the tables
constexpr int patience_ms = 30000;       // timeout for another process that writes
constexpr std::size_t warped_points = 64;

constexpr const char* tables = R"sql(
CREATE TABLE path (
  id INTEGER PRIMARY KEY AUTOINCREMENT,
  problem TEXT NOT NULL,
  space_name TEXT NOT NULL,
  space TEXT NOT NULL,
  robot TEXT NOT NULL,
  world TEXT NOT NULL,
  length REAL NOT NULL,
  dimension INTEGER NOT NULL,
  points BLOB NOT NULL,
  hash TEXT NOT NULL
);
CREATE INDEX path_of ON path (space, robot);
)sql";

std::string hex(std::uint64_t value) { return fmt::format("{:016x}", value); }

/// Returns the mean distance of the pairs of points in the cheapest warping.
double warped(const Space& space, const Configurations& a, const Configurations& b, bool backwards) {
  struct Warping {
    double sum = std::numeric_limits<double>::infinity();
    double steps = 0.0;
  };
  const std::size_t n = a.size();
  const std::size_t m = b.size();
  std::vector<Warping> row(m);
  std::vector<Warping> last(m);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      Warping best = {0.0, 0.0};
      if (i > 0 || j > 0) {
        best = {};
        if (i > 0) best = last[j];
        if (j > 0 && row[j - 1].sum < best.sum) best = row[j - 1];
        if (i > 0 && j > 0 && last[j - 1].sum <= best.sum) best = last[j - 1];
      }
      row[j] = {best.sum + space.distance(a[i], b[backwards ? m - 1 - j : j]), best.steps + 1.0};
    }
    std::swap(row, last);
  }
  return last.back().sum / last.back().steps;
}

double distance_of_spread(const Space& space, const Configurations& a, const Configurations& b) {
  return std::min(warped(space, a, b, false), warped(space, a, b, true));
}

std::string bytes_of(const Configurations& path) {
  std::string bytes;
  bytes.reserve(8 * path.values().size());
  for (const double x : path.values()) put_number(bytes, x);
  return bytes;
}

}  // namespace

StoredPath stored_path(const Problem& problem, const Configurations& path) {
  StoredPath stored;
  stored.problem = problem.name;
  stored.space_name = problem.space.name();
  stored.space = identity(problem.space);
  stored.robot = identity(problem.scene->robot);
  stored.world = identity(problem.scene->world);
  stored.length = path_length(problem.space, path);
  stored.path = path;
  return stored;
}

/// The database connection and the queries.
class Library::Database {
 public:
  Database(std::string path, Mode mode) : path_(std::move(path)) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (fs::is_directory(path_, ignored)) throw Error(fmt::format("{}: is a folder, not a library of paths", path_));
    if (mode == Mode::read && !fs::exists(path_, ignored)) {
      throw Error(
          fmt::format("{}: there is no such library of paths; trellis run SCRIPT --learn {} makes one", path_, path_));
    }
    check_header();
    // A read-only user may also have to write: to roll back the transaction of a process that was killed.
    int flags = SQLITE_OPEN_READWRITE | SQLITE_OPEN_FULLMUTEX;
    if (mode == Mode::write) flags |= SQLITE_OPEN_CREATE;
    int code = sqlite3_open_v2(path_.c_str(), &handle_, flags, nullptr);
    if (code != SQLITE_OK && mode == Mode::read) {
      sqlite3_close(handle_);
      code = sqlite3_open_v2(path_.c_str(), &handle_, SQLITE_OPEN_READONLY | SQLITE_OPEN_FULLMUTEX, nullptr);
    }
    try {
      if (code != SQLITE_OK) fail("cannot be opened");
      sqlite3_extended_result_codes(handle_, 1);
      sqlite3_busy_timeout(handle_, patience_ms);
      // With the rollback journal the library remains one file; the synced deletion of the journal is the commit.
      if (mode == Mode::write) run("PRAGMA synchronous = EXTRA");
      run("PRAGMA trusted_schema = OFF");
      recognise(mode);
    } catch (...) {
      sqlite3_close(handle_);
      throw;
    }
  }
  ~Database() { sqlite3_close(handle_); }
  Database(const Database&) = delete;
  Database& operator=(const Database&) = delete;

  /// A prepared statement.
  class Statement {
   public:
    Statement(const Database& database, std::string_view text) : database_(database) {
      if (sqlite3_prepare_v2(database.handle_, text.data(), static_cast<int>(text.size()), &statement_, nullptr) !=
          SQLITE_OK) {
        database.fail("cannot be read");
      }
    }
    ~Statement() { sqlite3_finalize(statement_); }
    Statement(const Statement&) = delete;
    Statement& operator=(const Statement&) = delete;

    /// Steps to the next row; false after the last.
    bool step() {
      const int code = sqlite3_step(statement_);
      if (code == SQLITE_ROW) return true;
      if (code != SQLITE_DONE) database_.fail("cannot be read or written");
      return false;
    }
    void bind(int place, const std::string& text) {
      check(sqlite3_bind_text(statement_, place, text.data(), static_cast<int>(text.size()), SQLITE_TRANSIENT));
    }
    void bind_blob(int place, const std::string& bytes) {
      check(sqlite3_bind_blob64(statement_, place, bytes.data(), bytes.size(), SQLITE_TRANSIENT));
    }
    void bind(int place, std::int64_t value) { check(sqlite3_bind_int64(statement_, place, value)); }
    void bind(int place, double value) { check(sqlite3_bind_double(statement_, place, value)); }

    [[nodiscard]] std::int64_t integer(int column) const { return sqlite3_column_int64(statement_, column); }
    [[nodiscard]] double number(int column) const { return sqlite3_column_double(statement_, column); }
    [[nodiscard]] std::string bytes(int column) const {
      const auto* data = static_cast<const char*>(sqlite3_column_blob(statement_, column));
      const auto size = static_cast<std::size_t>(sqlite3_column_bytes(statement_, column));
      return data != nullptr ? std::string(data, size) : std::string();
    }

   private:
    void check(int code) const {
      if (code != SQLITE_OK) database_.fail("cannot be written");
    }
    const Database& database_;
    sqlite3_stmt* statement_ = nullptr;
  };

  void run(const char* text) const {
    if (sqlite3_exec(handle_, text, nullptr, nullptr, nullptr) != SQLITE_OK) fail("cannot be read or written");
  }
  [[nodiscard]] std::int64_t ask(const char* text) const {
    Statement statement(*this, text);
    return statement.step() ? statement.integer(0) : 0;
  }

  /// Runs `body` in a transaction: its queries see one state of the library; an exception rolls it back.
  template <class Body>
  void together(const char* begin, const Body& body) const {
    run(begin);
    try {
      body();
      run("COMMIT");
    } catch (...) {
      // If the rollback fails too, closing or reopening the file rolls back.
      sqlite3_exec(handle_, "ROLLBACK", nullptr, nullptr, nullptr);
      throw;
    }
  }

  [[nodiscard]] std::vector<StoredPath> read(const char* condition, const StoredPath* like) const {
    Statement rows(*this, fmt::format("SELECT id, problem, space_name, space, robot, world, length, dimension, points, "
                                      "hash FROM path {} ORDER BY id",
                                      condition));
    if (like != nullptr) {
      rows.bind(1, hex(like->space));
      rows.bind(2, hex(like->robot));
    }
    std::vector<StoredPath> all;
    while (rows.step()) all.push_back(path_of(rows));
    return all;
  }

  void insert(const StoredPath& stored) const {
    Statement row(*this,
                  "INSERT INTO path (problem, space_name, space, robot, world, length, dimension, points, hash) VALUES "
                  "(?, ?, ?, ?, ?, ?, ?, ?, ?)");
    const std::string points = bytes_of(stored.path);
    row.bind(1, stored.problem);
    row.bind(2, stored.space_name);
    row.bind(3, hex(stored.space));
    row.bind(4, hex(stored.robot));
    row.bind(5, hex(stored.world));
    row.bind(6, stored.length);
    row.bind(7, static_cast<std::int64_t>(stored.path.dimension()));
    row.bind_blob(8, points);
    row.bind(9, hex(stable_hash(points)));
    row.step();
  }

 private:
  [[noreturn]] void fail(const char* what) const {
    const int code = handle_ != nullptr ? sqlite3_extended_errcode(handle_) : SQLITE_NOMEM;
    switch (code & 0xFF) {
      case SQLITE_NOTADB: throw Error(fmt::format("{}: is no library of paths; it is left as it is", path_));
      case SQLITE_CORRUPT: throw Error(fmt::format("{}: the library is damaged; it is left as it is", path_));
      case SQLITE_BUSY:
      case SQLITE_LOCKED:
        throw Error(fmt::format("{}: another process has been writing for {} s", path_, patience_ms / 1000));
      case SQLITE_READONLY: throw Error(fmt::format("{}: the library may not be written", path_));
      case SQLITE_FULL: throw Error(fmt::format("{}: there is no room left on the disk", path_));
      default:
        throw Error(fmt::format("{}: the library {}: {}", path_, what,
                                handle_ != nullptr ? sqlite3_errmsg(handle_) : "out of memory"));
    }
  }

  /// SQLite takes a file of one byte for an empty database, and would overwrite it.
  void check_header() const {
    constexpr std::string_view magic("SQLite format 3\0", 16);
    constexpr std::size_t header = 100;
    std::ifstream file(path_, std::ios::binary);
    if (!file || !std::filesystem::is_regular_file(path_)) return;
    std::string begin(header, '\0');
    file.read(begin.data(), static_cast<std::streamsize>(begin.size()));
    begin.resize(static_cast<std::size_t>(file.gcount()));
    if (begin.empty()) return;  // of a process that ended before its first path
    if (!std::string_view(begin).starts_with(magic.substr(0, begin.size()))) {
      throw Error(fmt::format("{}: is no library of paths; it is left as it is", path_));
    }
    if (begin.size() < header) throw Error(fmt::format("{}: the library is damaged; it is left as it is", path_));
  }

  /// Creates the tables of a new library, and checks the version of an existing one.
  void recognise(Mode mode) const {
    if (mode == Mode::write) {
      // The check runs within the transaction, so that only one of two processes that find an empty file creates the
      // tables.
      if (is_empty()) together("BEGIN IMMEDIATE", [&] { make_tables(); });
    } else if (is_empty()) {
      return;
    }
    if (ask("PRAGMA application_id") != application) {
      throw Error(fmt::format("{}: is a database, but no library of paths of trellis; it is left as it is", path_));
    }
    const std::int64_t found = ask("PRAGMA user_version");
    if (found != version) {
      throw Error(fmt::format("{}: the library is of version {}, and this trellis reads {}; it is unchanged", path_,
                              found, version));
    }
    if (mode == Mode::write) {
      Statement check(*this, "PRAGMA quick_check(1)");
      if (!check.step() || check.bytes(0) != "ok") {
        throw Error(fmt::format("{}: the library is damaged; it is left as it is", path_));
      }
    }
  }

  void make_tables() const {
    if (!is_empty()) return;
    run(tables);
    run(fmt::format("PRAGMA application_id = {}; PRAGMA user_version = {}", application, version).c_str());
  }

  /// Whether the file has no bytes, as after a process was killed before its first path.
  [[nodiscard]] bool is_empty() const {
    return ask("PRAGMA application_id") == 0 && ask("PRAGMA user_version") == 0 &&
           ask("SELECT count(*) FROM sqlite_schema") == 0;
  }

  [[nodiscard]] std::uint64_t hash_of(const Statement& row, int column) const {
    const std::string text = row.bytes(column);
    std::uint64_t value = 0;
    for (const char c : text) {
      const auto digit = std::string_view("0123456789abcdef").find(c);
      if (digit == std::string_view::npos || text.size() != 16) damaged(row);
      value = 16 * value + digit;
    }
    return value;
  }

  [[noreturn]] void damaged(const Statement& row) const {
    throw Error(fmt::format("{}: path {} of the library is damaged", path_, row.integer(0)));
  }

  [[nodiscard]] StoredPath path_of(const Statement& row) const {
    StoredPath stored;
    stored.id = row.integer(0);
    stored.problem = row.bytes(1);
    stored.space_name = row.bytes(2);
    stored.space = hash_of(row, 3);
    stored.robot = hash_of(row, 4);
    stored.world = hash_of(row, 5);
    stored.length = row.number(6);
    const std::int64_t dimension = row.integer(7);
    const std::string points = row.bytes(8);
    constexpr std::int64_t most_dimensions = 1000;
    const bool sound = dimension > 0 && dimension <= most_dimensions && !points.empty() &&
                       points.size() % (8 * static_cast<std::size_t>(dimension)) == 0 &&
                       hash_of(row, 9) == stable_hash(points);
    if (!sound) damaged(row);
    stored.path = Configurations(static_cast<std::size_t>(dimension));
    stored.path.reserve(points.size() / 8 / static_cast<std::size_t>(dimension));
    Configuration q(static_cast<std::size_t>(dimension));
    for (std::size_t at = 0; at < points.size(); at += 8 * q.size()) {
      for (std::size_t j = 0; j < q.size(); ++j) q[j] = number_at(points, at + 8 * j);
      if (!std::all_of(q.begin(), q.end(), [](double x) { return std::isfinite(x); })) damaged(row);
      stored.path.push(q);
    }
    return stored;
  }

  std::string path_;
  sqlite3* handle_ = nullptr;

 public:
  /// Whether there are tables to read.
  [[nodiscard]] bool has_paths() const { return !is_empty(); }
};

Library::Library(const std::string& path, Mode mode) : database_(std::make_unique<Database>(path, mode)) {}
Library::~Library() = default;

std::vector<StoredPath> Library::paths() const {
  std::vector<StoredPath> all;
  database_->together("BEGIN", [&] {
    if (database_->has_paths()) all = database_->read("", nullptr);
  });
  return all;
}

std::shared_ptr<const std::vector<StoredPath>> known_paths(const std::string& file) {
  static std::mutex mutex;
  static std::map<std::string, std::shared_ptr<const std::vector<StoredPath>>> known;
  std::error_code ignored;
  const std::string key = std::filesystem::absolute(file, ignored).lexically_normal().string();
  const std::scoped_lock lock(mutex);
  auto& paths = known[key];
  if (!paths) {
    const bool there = std::filesystem::exists(file, ignored);
    paths = std::make_shared<const std::vector<StoredPath>>(there ? Library(file).paths() : std::vector<StoredPath>());
  }
  return paths;
}

bool Library::add(const StoredPath& stored, const Space& space, double novelty) {
  if (stored.path.size() < 2) throw Fault("a path of less than two configurations solves nothing");
  if (stored.path.dimension() != space.dimension()) throw Fault("a path of another space");
  const Configurations points = evenly_spread(space, stored.path, warped_points);
  bool added = false;
  database_->together("BEGIN IMMEDIATE", [&] {
    const auto known = database_->read("WHERE space = ? AND robot = ?", &stored);
    added = std::none_of(known.begin(), known.end(), [&](const StoredPath& other) {
      return distance_of_spread(space, points, evenly_spread(space, other.path, warped_points)) <= novelty;
    });
    if (added) database_->insert(stored);
  });
  return added;
}

}  // namespace trellis
