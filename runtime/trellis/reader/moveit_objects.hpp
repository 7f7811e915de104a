// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <trellis/base/errors.hpp>
#include <trellis/scene/spatial/manipulator_scene.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

// The objects and the frames of a planning scene of MoveIt; its readers, of YAML and of RViz's text, share them.

/// Makes an Error at the line of a part of a file.
using MakeError = std::function<Error(const std::string&)>;

/// The points x with normal * x + offset = 0.
struct MoveitPlane {
  Vec3 normal;
  double offset = 0.0;
};

struct MoveitObject {
  struct Part {
    std::variant<Shape3, MoveitPlane> shape;
    Pose3 pose;  ///< in the object's frame
  };
  std::string id;
  Pose3 pose = {};  ///< in the world, or in its header's frame
  std::vector<Part> parts = {};
  std::map<std::string, Pose3> subframes = {};  ///< in the object's frame

  /// As MoveIt has it: where an object has one shape and no pose of its own, its frame is that of the shape.
  void adopt_frame_of_shape();
};

/// An object that a link carries.
struct MoveitAttached {
  MoveitObject object;  ///< its pose is in the frame of the link
  std::size_t link = 0;
  std::vector<std::string> touch;  ///< names of links
  MakeError fault;
};

/// What a scene contains while it is read.
class MoveitObjects {
 public:
  /// \param robot  at its base and with all values; nullptr: a scene is described without one, and frames that it does
  ///     not define are at the origin
  /// \param start  places the links; empty: only links that do not move have a frame
  MoveitObjects(const SphereModel* robot, Configuration start);

  /// A name of the frame in which the robot's base has its place.
  void name_world(const std::string& frame) { world_frames_.insert(frame); }
  /// Places a frame in the world.
  void place_frame(const std::string& frame, const Pose3& pose) { placed_[frame] = pose; }
  /// Returns the pose of a frame in the world, in MoveIt's order: links, attached objects, objects, frames that were
  /// placed, the world. \throws Error for another, with the nearest name
  [[nodiscard]] Pose3 frame(const std::string& name, const MakeError& fault) const;
  [[nodiscard]] std::optional<Pose3> find_frame(const std::string& name, const MakeError& fault) const;

  /// Adds an object; one of its name is replaced.
  void add(MoveitObject object);
  /// Adds parts to an object, whose frame stays.
  void append(const MoveitObject& object);
  /// Removes an object. \return whether there was one
  bool remove(const std::string& id);
  void remove_all() { objects_.clear(); }
  [[nodiscard]] MoveitObject* find(const std::string& id);
  [[nodiscard]] const std::vector<MoveitObject>& objects() const { return objects_; }
  std::vector<MoveitAttached> attached;
  /// The frames that objects are in, of which nothing is known; in a description alone.
  [[nodiscard]] const std::set<std::string>& unknown_frames() const { return unknown_; }

  /// Returns the world of the objects.
  /// \param robot  that moves in it, or nullptr
  [[nodiscard]] World3 world(const SphereModel* robot) const;

 private:
  const SphereModel* robot_;
  Configuration start_;
  std::set<std::string> world_frames_;
  std::map<std::string, Pose3> placed_;
  std::vector<MoveitObject> objects_;
  mutable std::set<std::string> unknown_;
};

}  // namespace trellis
