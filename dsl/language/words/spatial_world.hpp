// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/lua/stack.hpp>

// The words of space: poses and the shapes that have no counterpart in the plane.

namespace trellis::dsl {

struct ObjectType;

/// Registers pose, sphere, cylinder, capsule, convex, mesh and point_cloud.
/// \param place  of the script, whose files `mesh` and `point_cloud` read
/// \param warnings  receives those about meshes
void open_spatial_world(lua::Stack& stack, const ScriptPlace& place,
                        const std::shared_ptr<std::vector<std::string>>& warnings);

/// The constructs of this file, for help.
std::vector<const Construct*> spatial_world_constructs();
/// Poses and their readable members.
std::vector<ObjectType> spatial_world_types();

/// The field `pose` of shapes.
const Field& pose_field();
/// Returns the field `pose` of a call, the identity where it is not given.
Pose3 pose_of(const Arguments& arguments);

/// Returns "; the pose has rpy = {0, 90, 0}: angles are radians: write math.rad(90)" for a pose that a script gave an
/// angle of more than a full turn, else "".
std::string pose_hint(lua::Stack& stack, const Pose3& pose);

/// "(1, 2, 3), turned by 1.57 rad about (0, 0, 1)".
std::string pose_text(const Pose3& pose);

}  // namespace trellis::dsl
