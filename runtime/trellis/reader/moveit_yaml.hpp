// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <trellis/reader/moveit_objects.hpp>
#include <trellis/reader/yaml_entry.hpp>

namespace trellis {

// Messages of ROS as YAML, as `rostopic echo`, robowflex and MotionBenchMaker write them: vectors are lists or maps of
// x, y and z, and what is missing is 0.

/// Returns the vector of a key; 0 without it.
Vec3 vector_at(const YamlEntry& entry, const std::string& key);
/// Returns the quaternion of a key, x, y, z, w; without it, or where all four are 0, the identity.
Quaternion quaternion_at(const YamlEntry& entry, const std::string& key);
/// Returns a pose of 'position' and 'orientation'.
Pose3 pose_of(const YamlEntry& entry);
/// Returns a transform of 'translation' and 'rotation'.
Pose3 transform_of(const YamlEntry& entry);
/// Returns the frame of the entry's header; "" without one.
std::string frame_of(const YamlEntry& entry);
bool truth_of(const YamlEntry& entry);
/// Returns the shape of a primitive: a box, a sphere or a cylinder.
Shape3 primitive_of(const YamlEntry& entry);

/// A message about an object of a scene.
struct ObjectMessage {
  enum class Operation : std::uint8_t { add, remove, append, move };
  Operation operation = Operation::add;
  std::string frame;    ///< of its header
  MoveitObject object;  ///< in that frame
  bool placed = false;  ///< it has a pose of its own
  bool shaped = false;  ///< it has poses of its shapes
  std::vector<Pose3> shape_poses = {};
};

/// Reads a collision object. Meshes that it names by a file are read from its folder.
ObjectMessage object_message_of(const YamlEntry& entry, const std::string& scene, std::vector<std::string>& warnings);

}  // namespace trellis
