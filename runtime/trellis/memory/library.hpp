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

/// A path that solved a problem, and what it was found in.
struct StoredPath {
  std::int64_t id = 0;      ///< in the order in which paths were added
  std::string problem;      ///< its name
  std::string space_name;   ///< "SE(2)"
  std::uint64_t space = 0;  ///< identity()
  std::uint64_t robot = 0;
  std::uint64_t world = 0;
  double length = 0.0;  ///< in the metric
  Configurations path;
};

/// What is to be stored of a solved problem.
StoredPath stored_path(const Problem& problem, const Configurations& path);

/// How far apart two paths of a space are, in metres: the mean distance between what dynamic time warping sets beside
/// each other of points evenly spread over them, in the direction of the second that brings them nearer.
double path_distance(const Space& space, const Configurations& a, const Configurations& b);

/// A library of solved problems in a file (an SQLite database). A path that `add` has returned for is there whatever
/// happens to the process afterwards; one that it has not returned for is there as a whole or not at all. Several
/// processes may have one library open.
class Library {
 public:
  enum class Mode : std::uint8_t {
    read,   ///< the file must be there
    write,  ///< made where there is none
  };

  /// Throws Error for a file that is no library, is damaged, or was written by a later version; such a file is left as
  /// it is.
  explicit Library(const std::string& path, Mode mode = Mode::read);
  ~Library();
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;

  /// All paths, in the order of their ids: one state of the library, whoever writes meanwhile. Throws Error where the
  /// file turns out to be damaged.
  [[nodiscard]] std::vector<StoredPath> paths() const;
  /// Adds a path that is farther than `novelty` metres (path_distance) from every path of the same space and robot;
  /// whether it was added. The library is looked at and written as one step, so that two processes do not both add what
  /// one of them has. `space` is that of the path.
  bool add(const StoredPath& stored, const Space& space, double novelty);

 private:
  class Database;
  std::unique_ptr<Database> database_;
};

/// What a library held when this process first asked for it: all runs see one state, whoever adds meanwhile. Nothing
/// where there is no such file. Throws Error as a Library does.
std::shared_ptr<const std::vector<StoredPath>> known_paths(const std::string& file);

/// The distance within which two paths are one where nobody says otherwise: the robot's bounding radius, or 2 % of the
/// space's diameter for a point.
double default_novelty(const Space& space, const Robot& robot);

}  // namespace trellis
