// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <dsl/language/core/construct.hpp>
#include <dsl/language/core/script_place.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `problem`.
/// \param warnings  receives those about goals that nothing reaches
void open_problem(lua::Stack& stack, const std::shared_ptr<std::vector<std::string>>& warnings);

const Construct& problem_construct();
/// scenes.load("FILE", { resolution = 0.02 }).
const Construct& load_construct();
/// scenes.robot "FILE".
const Construct& robot_file_construct();
/// scenes.exists "FILE".
const Construct& exists_construct();
/// The readable members of a problem.
struct ObjectType;
ObjectType problem_type();

/// Finds a scene file: an absolute path, else in the script's folder, else in the folder of scenes, which the
/// environment's TRELLIS_SCENES names. "" if it does not exist.
std::string find_scene(const std::string& file, const std::string& script_folder);
/// The message for a file that find_scene does not find: the paths that it tried.
std::string missing_scene(const std::string& file, const std::string& script_folder);
/// Returns the path of a file of scenes or meshes that a script names, and reports it to the place's watch.
/// \throws Error that starts with the function's name, for a file that does not exist, or that the script may not read
std::string scene_path(const char* function, const std::string& file, const ScriptPlace& place);
/// Returns the path of a folder that a script names, which it may read as it may read files.
/// \throws Error that starts with the function's name
std::string scene_folder(const char* function, const std::string& folder, const ScriptPlace& place);

/// scenes.load(file, options): returns a list of problems. Without the place's trust, the file lies in the script's
/// folder or in the folder of scenes.
/// \param warnings  receives what the file contains and the problems do not
lua::Callback scene_loader(ScriptPlace place, std::shared_ptr<std::vector<std::string>> warnings);
/// scenes.robot(file): returns a robot; reads the same files.
lua::Callback robot_loader(ScriptPlace place);
/// scenes.exists(file).
lua::Callback scene_finder(std::string script_folder, bool trust);

}  // namespace trellis::dsl
