// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/store/outputs.hpp>
#include <dsl/command/verbs/learn.hpp>
#include <dsl/command/verbs/train.hpp>
#include <trellis/base/error.hpp>
#include <trellis/instance/characteristic_length.hpp>
#include <trellis/memory/library.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis::command {

namespace {

std::string counted(std::size_t count, const char* one, const char* many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

/// The printed data on the paths of one problem.
struct Row {
  std::set<std::uint64_t> worlds;
  std::size_t paths = 0;
  double shortest = 0.0;
  double longest = 0.0;
};

std::string summary(const std::vector<StoredPath>& paths) {
  std::map<std::tuple<std::string, std::string, std::uint64_t>, Row> rows;
  for (const StoredPath& path : paths) {
    Row& row = rows[{path.problem, path.space_name, path.robot}];
    row.worlds.insert(path.world);
    row.shortest = row.paths == 0 ? path.length : std::min(row.shortest, path.length);
    row.longest = std::max(row.longest, path.length);
    ++row.paths;
  }
  std::string text = fmt::format("{:<24}  {:<12}  {:<16}  {:>6}  {:>5}  {}\n", "problem", "space", "robot", "worlds",
                                 "paths", "length, m");
  for (const auto& [key, row] : rows) {
    const auto& [problem, space, robot] = key;
    const std::string length = row.shortest == row.longest ? fmt::format("{:.2f}", row.shortest)
                                                           : fmt::format("{:.2f} to {:.2f}", row.shortest, row.longest);
    text += fmt::format("{:<24}  {:<12}  {:016x}  {:>6}  {:>5}  {}\n", problem, space, robot, row.worlds.size(),
                        row.paths, length);
  }
  return text;
}

std::string listing(const std::vector<StoredPath>& paths) {
  std::string text = fmt::format("{:>6}  {:<24}  {:<12}  {:<16}  {:<16}  {:>6}  {:>9}\n", "path", "problem", "space",
                                 "robot", "world", "points", "length, m");
  for (const StoredPath& path : paths) {
    text += fmt::format("{:>6}  {:<24}  {:<12}  {:016x}  {:016x}  {:>6}  {:>9.2f}\n", path.id, path.problem,
                        path.space_name, path.robot, path.world, path.path.size(), path.length);
  }
  return text;
}

int experience(const std::string& file, bool list) {
  const std::vector<StoredPath> paths = Library(file).paths();
  std::string text = fmt::format("{}: {}\n", file, counted(paths.size(), "path", "paths"));
  if (!paths.empty()) text += "\n" + (list ? listing(paths) : summary(paths));
  print_all(text);
  return success;
}

}  // namespace

void add_experience(CommandLine& line) {
  struct Options {
    std::string library;
    bool list = false;
    TrainOptions training;
  };
  const auto options = std::make_shared<Options>();
  Subcommand verb = line.add("experience", "print a library of paths, or train a heuristic on worlds", [options] {
    if (options->training.data.empty() == options->library.empty()) {
      throw Error("experience: expected LIBRARY, a file of trellis run --learn, or --data FOLDER to train on");
    }
    return options->library.empty() ? train(options->training) : experience(options->library, options->list);
  });
  verb.optional_argument("LIBRARY", "FILE", options->library, "a file as trellis run --learn makes it");
  verb.flag("--list", options->list, "a line for each path of the library, not for each problem");
  add_training_options(verb, options->training);
}

void learn(const Experiment& experiment, const ExperimentResult& result, const std::string& file,
           std::optional<double> novelty, bool quiet) {
  Library library(file, Library::Mode::write);
  std::size_t solved = 0;
  std::size_t added = 0;
  for (const RunResult& run : result.runs) {
    if (!run.run.solved) continue;
    const auto problem = std::find_if(experiment.problems.begin(), experiment.problems.end(),
                                      [&](const Problem& p) { return p.name == run.problem; });
    const double least = novelty.value_or(characteristic_length(*problem->scene, problem->space));
    ++solved;
    added += library.add(stored_path(*problem, run.run.path), problem->space, least) ? 1 : 0;
  }
  if (quiet) return;
  print_message(fmt::format("{}: {} of {} found {} new and added", file, added, counted(solved, "path", "paths"),
                            added == 1 ? "was" : "were"));
}

}  // namespace trellis::command
