// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <dsl/language/construct.hpp>
#include <dsl/language/script_place.hpp>
#include <dsl/lua/stack.hpp>

namespace trellis::dsl {

/// Registers `problem`.
void open_problem(lua::Stack& stack);

const Construct& problem_construct();
/// scenes.load("FILE", { resolution = 0.02 }).
const Construct& load_construct();
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

/// scenes.load(file, options): returns a list of problems. Without the place's trust, the file lies in the script's
/// folder or in the folder of scenes.
lua::Callback scene_loader(ScriptPlace place);
/// scenes.exists(file).
lua::Callback scene_finder(std::string script_folder, bool trust);

}  // namespace trellis::dsl
