// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/memory/library.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <mutex>
#include <string_view>
#include <utility>

#include <trellis/base/error.hpp>
#include <trellis/base/random.hpp>
#include <trellis/memory/bytes.hpp>
#include <trellis/memory/database.hpp>
#include <trellis/memory/identity.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis {

namespace {

constexpr int application = 0x54726C73;  // "Trls", in the header of the file
constexpr int version = 1;               // of the tables
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
  stored.robot = robot_hash(*problem.scene);
  stored.world = world_hash(*problem.scene);
  stored.length = path_length(problem.space, path);
  stored.path = path;
  return stored;
}

/// The queries.
class Library::Database : public trellis::Database {
 public:
  Database(const std::string& path, Library::Mode mode)
      : trellis::Database(existing(path, mode),
                          mode == Library::Mode::write ? trellis::Database::Mode::write : trellis::Database::Mode::read,
                          {"library of paths", "library"}) {
    recognise(mode);
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
  /// \throws Error for a file that is to be read and does not exist
  static std::string existing(const std::string& path, Library::Mode mode) {
    std::error_code ignored;
    if (mode == Library::Mode::read && !std::filesystem::exists(path, ignored)) {
      throw Error(
          fmt::format("{}: there is no such library of paths; trellis run SCRIPT --learn {} makes one", path, path));
    }
    return path;
  }

  /// Creates the tables of a new library, and checks the version of an existing one.
  void recognise(Library::Mode mode) const {
    if (mode == Library::Mode::write) {
      // The check runs within the transaction, so that only one of two processes that find an empty file creates the
      // tables.
      if (is_empty()) together("BEGIN IMMEDIATE", [&] { make_tables(); });
    } else if (is_empty()) {
      return;
    }
    if (ask("PRAGMA application_id") != application) {
      throw Error(fmt::format("{}: is a database, but no library of paths of trellis; it is left as it is", path()));
    }
    const std::int64_t found = ask("PRAGMA user_version");
    if (found != version) {
      throw Error(fmt::format("{}: the library is of version {}, and this trellis reads {}; it is unchanged", path(),
                              found, version));
    }
    if (mode == Library::Mode::write) {
      Statement check(*this, "PRAGMA quick_check(1)");
      if (!check.step() || check.bytes(0) != "ok") {
        throw Error(fmt::format("{}: the library is damaged; it is left as it is", path()));
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
    throw Error(fmt::format("{}: path {} of the library is damaged", path(), row.integer(0)));
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
