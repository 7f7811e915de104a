// SPDX-License-Identifier: GPL-3.0-or-later
#include <dsl/command/verbs/train.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <dsl/command/command_line.hpp>
#include <dsl/command/commands.hpp>
#include <dsl/command/progress.hpp>
#include <dsl/command/store/outputs.hpp>
#include <trellis/base/error.hpp>
#include <trellis/memory/model.hpp>
#include <trellis/memory/search_model.hpp>
#include <trellis/reader/readers.hpp>
#include <trellis/report/report.hpp>
#include <trellis/scene/planar/scene.hpp>

namespace trellis::command {

namespace {

namespace fs = std::filesystem;

constexpr const char* splits = "train and validation";

std::vector<std::string> sorted_entries(const fs::path& folder, const std::string& extension) {
  std::vector<std::string> paths;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error)) {
    if (entry.path().extension() == extension) paths.push_back(entry.path().string());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// Returns the worlds of one split of a family, by name.
std::vector<LearningTask> tasks_in(const fs::path& folder) {
  std::vector<LearningTask> tasks;
  for (const std::string& path : sorted_entries(folder, ".png")) {
    for (const Problem& problem : read_problems(path, {})) {
      tasks.push_back({problem.name,
                       planar(*problem.scene).world,
                       {problem.start[0], problem.start[1]},
                       {problem.goal()[0], problem.goal()[1]}});
    }
  }
  if (tasks.empty()) {
    throw Error(fmt::format("--data: there are no worlds (*.png) in '{}'; a family is a folder with the folders {}",
                            folder.string(), splits));
  }
  return tasks;
}

/// Returns the requested families in a folder; all if none are requested.
std::vector<std::string> families_in(const std::string& data, const std::vector<std::string>& asked) {
  std::error_code ignored;
  if (!fs::is_directory(data, ignored)) throw Error(fmt::format("--data: there is no folder '{}'", data));
  std::vector<std::string> known;
  for (const auto& entry : fs::directory_iterator(data, ignored)) {
    if (fs::is_directory(entry.path() / "train", ignored)) known.push_back(entry.path().filename().string());
  }
  std::sort(known.begin(), known.end());
  if (known.empty()) {
    throw Error(fmt::format("--data: there is no family in '{}': a folder with the folders {}", data, splits));
  }
  for (const std::string& name : asked) {
    if (std::find(known.begin(), known.end(), name) != known.end()) continue;
    throw Error(fmt::format("--family: there is no family '{}' in '{}'{}; there are: {}", name, data,
                            did_you_mean(name, known), fmt::join(known, ", ")));
  }
  return asked.empty() ? known : asked;
}

/// Returns the worlds of one split of several families.
std::vector<LearningTask> tasks_of(const std::string& data, const std::vector<std::string>& families,
                                   const char* split) {
  std::vector<LearningTask> tasks;
  for (const std::string& family : families) {
    for (auto& task : tasks_in(fs::path(data) / family / split)) tasks.push_back(std::move(task));
  }
  return tasks;
}

std::string row(const std::string& family, const Validation& found) {
  if (found.tasks == 0) return fmt::format("{:<20}  no world with a path from start to goal\n", family);
  return fmt::format("{:<20}  {:>6}  {:>7.2f}  {:>7.2f}  {:>8.2f}  {:>8.2f} +- {:.2f}\n", family, found.tasks,
                     found.learned, found.uniform, found.straight, found.uniform - found.learned, found.error);
}

constexpr std::uint64_t most_count = 1'000'000;

std::int64_t count(const std::optional<std::uint64_t>& option, std::int64_t otherwise) {
  return option ? static_cast<std::int64_t>(*option) : otherwise;
}

/// Returns the mean effort of one family's searches, as expansions and edge evaluations.
std::string search_row(const std::string& family, const std::vector<SearchTrial>& trials) {
  if (trials.empty()) return fmt::format("{:<20}  no world with a path from start to goal over the grid\n", family);
  const auto n = static_cast<double>(trials.size());
  const auto means = [&](SearchTrial::Effort SearchTrial::*search) {
    SearchTrial::Effort sum;
    for (const SearchTrial& trial : trials) {
      sum.expansions += (trial.*search).expansions;
      sum.evaluations += (trial.*search).evaluations;
      sum.length += (trial.*search).length;
    }
    return fmt::format("{:>6.0f} {:>6.0f} {:>6.2f}", sum.expansions / n, sum.evaluations / n, sum.length / n);
  };
  std::size_t fewer = 0;
  std::size_t more = 0;
  for (const SearchTrial& trial : trials) {
    if (trial.learned.expansions < trial.euclidean.expansions) ++fewer;
    if (trial.learned.expansions > trial.euclidean.expansions) ++more;
  }
  return fmt::format("{:<20}  {:>6}  {}  {}  {}  {:>5}  {:>4}\n", family, trials.size(), means(&SearchTrial::learned),
                     means(&SearchTrial::euclidean), means(&SearchTrial::a_star), fewer, more);
}

int train_search(const TrainOptions& options, const std::vector<std::string>& families) {
  SearchTrainingSettings settings;
  settings.forest.seed = options.seed.value_or(settings.forest.seed);
  settings.samples = count(options.samples, settings.samples);
  settings.cells = count(options.cells, settings.cells);
  settings.rounds = count(options.rounds, settings.rounds);
  const auto learn_from = tasks_of(options.data, families, "train");
  const std::string description = fmt::format(
      "searches of {} worlds of {}, {} cells along the longer side, {} rounds, {} vertices of each search, "
      "seed {}",
      learn_from.size(), fmt::join(families, ", "), settings.cells, settings.rounds, settings.samples,
      settings.forest.seed);
  Progress progress(!options.quiet);
  const SearchModel model = SearchModel::train(learn_from, settings, description,
                                               [&](std::size_t done, std::size_t all) { progress.show(done, all); });
  std::string text = fmt::format("trained on {}\n\n{:<20}  {:>6}  {:>20}  {:>20}  {:>20}  {:>5}  {:>4}\n", description,
                                 "validation", "worlds", "learned", "Euclidean", "A*", "fewer", "more");
  for (const std::string& family : families) {
    progress.show("validating on " + family);
    text += search_row(family, try_searches(model, tasks_in(fs::path(options.data) / family / "validation")));
  }
  write_file(options.out, model.bytes());
  if (options.quiet) return success;
  print_all(
      text +
      "\nMeans over the worlds that have a path: expansions, edge evaluations, metres of path. learned and "
      "Euclidean:\ngreedy best-first search by either heuristic; A* evaluates an edge when its vertex is selected. "
      "fewer, more:\nworlds where learned expands fewer or more vertices than Euclidean.\n");
  return success;
}

}  // namespace

int train(const TrainOptions& options) {
  if (options.out.empty()) throw Error("--data: --out FILE says where the model goes");
  if (!options.search && (options.cells || options.rounds)) {
    throw Error(
        fmt::format("--{}: only a search heuristic is trained by searches of grids; expected together with "
                    "--search",
                    options.cells ? "cells" : "rounds"));
  }
  const std::vector<std::string> families = families_in(options.data, options.families);
  require_writable_file(options.out);
  if (options.search) return train_search(options, families);
  TrainingSettings settings;
  settings.forest.seed = options.seed.value_or(settings.forest.seed);
  settings.samples = count(options.samples, settings.samples);
  const auto learn_from = tasks_of(options.data, families, "train");
  const std::string description = fmt::format("{} worlds of {}, {} cells each, seed {}", learn_from.size(),
                                              fmt::join(families, ", "), settings.samples, settings.forest.seed);
  Progress progress(!options.quiet);
  const Model model = Model::train(learn_from, settings, description, [&](std::size_t done, std::size_t all) {
    progress.show(done, all);
    if (done == all) progress.show("growing the forest");
  });
  std::string text = fmt::format("trained on {}\n\n{:<20}  {:>6}  {:>7}  {:>7}  {:>8}  {}\n", description,
                                 "validation, nats", "worlds", "learned", "uniform", "straight", "uniform - learned");
  for (const std::string& family : families) {
    progress.show("validating on " + family);
    text += row(family, validate(model, tasks_in(fs::path(options.data) / family / "validation"), settings.tolerance));
  }
  write_file(options.out, model.bytes());
  if (options.quiet) return success;
  print_all(text +
            "\nThe divergence of the cells on nearly shortest paths from the samples of each; lower is "
            "better.\nuniform: free cells evenly. straight: less the longer the detour, obstacles ignored.\n");
  return success;
}

void add_training_options(Subcommand& verb, TrainOptions& options) {
  verb.text("--data", "FOLDER", options.data,
            "train a heuristic: a folder of families, each with the folders train and validation of PNGs");
  verb.text("--out", "FILE", options.out, "the file that the model is written to");
  verb.list("--family", "NAME", options.families, "families to train on, separated by commas, instead of all");
  verb.integer("--seed", "SEED", 0, most_count, options.seed, "of the samples and the forest (default 1)");
  verb.flag("--search", options.search,
            "train a heuristic of best_first on searches of the worlds' grids, instead of learned's classifier");
  verb.integer("--samples", "N", 1, most_count, options.samples,
               "cells drawn from each world (default 500); with --search, vertices from each search (default 60)");
  verb.integer("--cells", "N", 2, 1000, options.cells,
               "cells of the grid along a world's longer side, for --search (default 40)");
  verb.integer("--rounds", "N", 1, 1000, options.rounds, "rounds of data aggregation, for --search (default 10)");
  verb.flag("--quiet", options.quiet, "print neither figures nor progress of the training");
}

}  // namespace trellis::command
