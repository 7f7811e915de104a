// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/report/report.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

/// Placeholders: @NAME@ for the given path of the script, @TITLE@ for its name.
constexpr std::string_view script = R"LUA(-- @TITLE@: a strategy of guiding spaces, compared with its planner alone.
--
--   to plan, and print the report:             trellis run @NAME@
--   to write a page that replays every run:    trellis run @NAME@ --html report.html
--   to print each strategy without planning:   trellis check @NAME@
--   to run its scenarios, what is expected:    trellis test @TEST@
--   to read about a word, here skeleton:       trellis help skeleton

-- Lengths are in metres, angles in radians. The whole robot stays inside the bounds.
local house = world {
  bounds = {0, 0, 10, 10},
  box {4, 0, 6, 7.5, name = "wall below the doorway"},
  box {4, 8, 6, 10, name = "wall above it"},
}

local doorway = problem {
  name  = "doorway",
  world = house,
  robot = robot.rectangle(0.6, 0.2),
  start = {1, 1, 0},  -- x, y and the angle
  goal  = {9, 1, 0},
}

-- Read `>>` as "guides": a path along the medial axis of the free workspace guides the tree. Guides can be guided too,
-- as in skeleton() >> shrink(0.5) >> planner.
local planner = rrt { step = 0.5 }
local guided = skeleton() >> planner

return experiment {
  problems   = doorway,
  strategies = { planner = planner, guided = guided },
  baseline   = "planner",             -- what the other is compared with
  seeds      = 5,                     -- runs of each; the same seed gives the same result
  measure    = tube { delta = 0.5 },  -- samples are of use within half a metre of the path
}
)LUA";

/// Placeholder: @FILE@ for the script's name in its folder.
constexpr std::string_view test_script = R"LUA(-- @TITLE@: what the strategies of @FILE@ are to achieve.
--
--   to run the scenarios:   trellis test @NAME@

scenario "the medial axis guides the tree through the doorway" (function()
  local it = given { script = "@FILE@" }
  local guided, planner = when { it.guided, it.planner, seeds = 20 }

  expect(guided, solves(at_least(0.95)))
  -- Compared seed by seed, with 95 % confidence.
  expect(guided, spends(below(planner).validity_checks()))
  -- In nats above uniform sampling, more is better: how many more nodes of its tree lie near its path.
  expect(guided, has_efficiency("root", above(0.5), { part = "mass" }))
end)

scenario "the same seed gives the same result" (function()
  local it = given { script = "@FILE@" }
  local guided = when { it.guided, seeds = 3 }
  expect(guided, is_deterministic())
end)
)LUA";

void replace_all(std::string& text, std::string_view what, std::string_view with) {
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + with.size())) {
    text.replace(at, what.size(), with);
  }
}

/// \throws Error for a name that no module can have: `require` could not load such a script.
void check_name(const std::string& name) {
  const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  const auto good = [&](char c) { return letter(c) || (c >= '0' && c <= '9'); };
  if (!name.empty() && letter(name.front()) && std::all_of(name.begin(), name.end(), good)) return;
  std::string offer;
  for (const char c : name) offer += good(c) ? c : '_';
  if (!offer.empty() && !letter(offer.front())) offer = "_" + offer;
  throw Error(
      fmt::format("new: '{}' is no name for a script: expected letters, digits and '_', a letter first{}", name,
                  std::any_of(offer.begin(), offer.end(), [](char c) { return c != '_'; }) ? ", as " + offer : ""));
}

[[noreturn]] void refuse(const fs::path& path) {
  throw Error(fmt::format("new: '{}' exists already, and is left as it is; choose another name", path.string()));
}

int create(const std::string& name) {
  const fs::path given(name);
  const fs::path path = given.extension() == ".lua" ? given : fs::path(name + ".lua");
  check_name(path.stem().string());
  const fs::path test = path.parent_path() / (path.stem().string() + "_test.lua");
  std::error_code error;
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(folder, error)) throw Error(fmt::format("new: there is no folder '{}'", folder.string()));
  const auto filled = [&](std::string_view form, const fs::path& file) {
    std::string text(form);
    replace_all(text, "@NAME@", file.string());
    replace_all(text, "@TEST@", test.string());
    replace_all(text, "@FILE@", path.filename().string());
    replace_all(text, "@TITLE@", path.stem().string());
    return text;
  };
  for (const fs::path& file : {path, test}) {
    if (fs::exists(file, error)) refuse(file);
  }
  write_new_file(path.string(), filled(script, path));
  try {
    write_new_file(test.string(), filled(test_script, test));
  } catch (const Error&) {
    fs::remove(path, error);  // both or none
    throw;
  }
  print_all(
      fmt::format("{}: a strategy and an experiment to change; run it with: trellis run {}\n"
                  "{}: what is expected of it; try it with: trellis test {}\n",
                  path.string(), path.string(), test.string(), test.string()));
  return success;
}

}  // namespace

void add_new(CommandLine& line) {
  const auto name = std::make_shared<std::string>();
  Subcommand verb =
      line.add("new", "write a small script to begin with, and its test", [name] { return create(*name); });
  verb.argument("NAME", "NAME", *name,
                "the script is NAME.lua, its test NAME_test.lua; files that exist are left as they are");
}

}  // namespace trellis::command
