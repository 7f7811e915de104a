// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include <trellis/reader/formats.hpp>
#include <trellis/reader/mesh_file.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/scene/scene.hpp>
#include <trellis/scene/spatial/robot.hpp>
#include <trellis/scene/spatial/world.hpp>

namespace trellis {

// The readers of scenes in space; callers use read_scene.

/// Whether the ending of the file's name is .env or .query: Parasol's planning library (PPL).
bool is_ppl(const SourceText& text);
/// Reads an environment of PPL and its queries, which are beside it: NAME.env and NAME.query.
///
/// Each body is a mesh (.g or .obj) about the mean of its vertices, or about what its option -a names. Where the
/// environment has no active body, the robot is in NAME.robot, or in the only file of the folder that ends so. A robot
/// that moves in the plane makes a planar scene, for which the bodies must be upright prisms.
SceneFile read_ppl(const SourceText& text, const ReadOptions& options);

/// Whether the text is a plan of the Robotics Library (rl): XML with the root `rlplan`.
bool is_rl_plan(const SourceText& text);
/// Reads a plan of rl: its start and goal, the model of a body with six degrees of freedom, and the scene in VRML.
SceneFile read_rl_plan(const SourceText& text, const ReadOptions& options);

/// Whether the file is a configuration of OMPL.app: it has a section [problem].
bool is_ompl_app(const SourceText& text);
/// Reads a configuration of OMPL.app for a rigid body: the meshes of robot and world, bounds, start and goal. Meshes of
/// COLLADA are turned as assimp turns them for OMPL.app.
SceneFile read_ompl_app(const SourceText& text, const ReadOptions& options);

/// Meshes of a scene by their names in its file, which are relative to the file's folder. Reads each once.
class MeshFolder {
 public:
  /// \param scene  the scene file
  explicit MeshFolder(std::string scene) : scene_(std::move(scene)) {}
  /// Names a mesh that the scene needs at a line.
  void need(const std::string& name, std::size_t line);
  /// Reads what was needed.
  /// \throws Error that lists all missing files
  void load(const MeshOptions& options, std::vector<std::string>& warnings);
  [[nodiscard]] const MeshFile& at(const std::string& name) const { return files_.at(name); }

 private:
  std::string scene_;
  std::map<std::string, std::size_t> lines_;
  std::map<std::string, MeshFile> files_;
};

/// Returns the path of a file that another one names, relative to its folder. Where no file has this name but one has
/// it in other letters of upper and lower case, that one.
std::string beside(const std::string& file, const std::string& name);

/// Returns a problem of space in the robot's default space: a radian weighs the robot's bounding radius unless the
/// options say otherwise.
Problem spatial_problem(std::string name, World3 world, Robot3 robot, const ReadOptions& options);

/// The configuration of a rigid body at a pose.
Configuration configuration_of(const Robot3& robot, const Pose3& pose);

}  // namespace trellis
