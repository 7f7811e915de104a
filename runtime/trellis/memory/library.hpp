// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <trellis/base/configurations.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/space/space.hpp>

namespace trellis {

/// A path that solved a problem, with the identities of the problem's space, robot and world.
struct StoredPath {
  std::int64_t id = 0;      ///< in the order of insertion
  std::string problem;      ///< its name
  std::string space_name;   ///< "SE(2)"
  std::uint64_t space = 0;  ///< identity()
  std::uint64_t robot = 0;
  std::uint64_t world = 0;
  double length = 0.0;  ///< in the metric
  Configurations path;
};

/// Returns the record of a solved problem.
StoredPath stored_path(const Problem& problem, const Configurations& path);

/// A library of solved problems in a file (an SQLite database). A path is durable once `add` has returned; until then
/// it is stored completely or not at all. Several processes may open one library.
class Library {
 public:
  enum class Mode : std::uint8_t {
    read,   ///< the file must exist
    write,  ///< creates a missing file
  };

  /// \throws Error for a file that is no library, is damaged, or was written by a later version; does not change such a
  ///     file.
  explicit Library(const std::string& path, Mode mode = Mode::read);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  /// Returns all paths, in the order of their ids: one consistent state, even if other processes write.
  /// \throws Error where the file is damaged.
  [[nodiscard]] std::vector<StoredPath> paths() const;
  /// Adds a path that is farther than `novelty` metres from every path of the same space and robot. The distance of two
  /// paths is by dynamic time warping, which pairs points evenly spaced along them: the mean distance of the pairs, for
  /// the direction of the second path that gives the smaller one.
  /// Reads and writes the library in one transaction, so that two processes do not add the same path. `space` is that
  /// of the path. \return whether it added the path
  bool add(const StoredPath& stored, const Space& space, double novelty);

 private:
  class Database;
  std::unique_ptr<Database> database_;
};

/// Returns the content of a library at this process's first call: all runs see one state, even if other processes add
/// paths. Empty where there is no such file.
/// \throws Error as a Library does.
std::shared_ptr<const std::vector<StoredPath>> known_paths(const std::string& file);

}  // namespace trellis
