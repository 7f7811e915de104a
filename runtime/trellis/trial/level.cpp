// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/trial/level.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <string_view>

#include <trellis/base/error.hpp>
#include <trellis/experiment/experiment.hpp>
#include <trellis/report/summary.hpp>

namespace trellis::trial {

namespace {

std::string without_spaces(std::string_view text) {
  std::string kept;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) == 0) kept += c;
  }
  return kept;
}

/// Returns "lazy" of "lazy(margin=0.2)", "rrt" of "rrt{step=0.5}".
std::string component_of(const std::string& text) { return text.substr(0, text.find_first_of("({")); }

std::vector<std::string> segments_of(std::string_view path) {
  std::vector<std::string> segments;
  constexpr std::string_view arrow = ">>";
  for (std::size_t at = 0; at <= path.size();) {
    const std::size_t end = std::min(path.find(arrow, at), path.size());
    segments.push_back(without_spaces(path.substr(at, end - at)));
    at = end + arrow.size();
  }
  return segments;
}

bool is_called(const LevelSummary& level, const std::string& segment) {
  const std::string name = without_spaces(level.name);
  if (segment == name || segment == component_of(name)) return true;
  // The planner's name also denotes the root, as at the end of a strategy.
  return level.parent < 0 && component_of(segment) == level.planner;
}

/// Whether the segments name the level, the level that it guides, and so on towards the root.
bool is_chain(const std::vector<LevelSummary>& levels, std::size_t level, const std::vector<std::string>& segments) {
  auto at = static_cast<int>(level);
  for (const std::string& segment : segments) {
    if (at < 0 || !is_called(levels[static_cast<std::size_t>(at)], segment)) return false;
    at = levels[static_cast<std::size_t>(at)].parent;
  }
  return true;
}

std::string listed(const std::vector<LevelSummary>& levels) {
  std::string text;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    text += fmt::format("{}{} ({})", text.empty() ? "" : ", ", i, levels[i].name);
  }
  return text;
}

}  // namespace

std::string find_level(const std::vector<RunResult>& runs, const std::string& name) {
  ExperimentFacts all;
  for (const RunResult& run : runs) all.runs.push_back(facts_of(run));
  const RunsSummary summary = summarise(all.select("", runs.empty() ? "" : runs.front().strategy));
  const std::vector<LevelSummary>& levels = summary.levels;
  const std::string missing =
      summary.beside.not_set_up > 0
          ? fmt::format(
                "; in {} of {} runs {} solved the problem before its guides were set up: bound = 0 begins with "
                "them",
                summary.beside.not_set_up, summary.runs, levels.front().planner)
          : "";
  if (!name.empty() && name.find_first_not_of("0123456789") == std::string::npos) {
    constexpr std::size_t digits = 4;
    const std::size_t number = name.size() <= digits ? std::stoul(name) : levels.size();
    if (number < levels.size()) return levels[number].key;
    throw Error(fmt::format("there is no level {}; the levels are: {}{}", name, listed(levels), missing));
  }
  const auto segments = segments_of(name);
  std::vector<std::size_t> found;
  for (std::size_t i = 0; i < levels.size(); ++i) {
    if (is_chain(levels, i, segments)) found.push_back(i);
  }
  if (found.size() == 1) return levels[found.front()].key;
  if (found.empty()) {
    std::vector<std::string> known;
    for (const LevelSummary& level : levels) {
      known.push_back(component_of(level.name));
      known.push_back(level.name);
    }
    throw Error(fmt::format("no level is called '{}'{}; the levels are: {}{}", name, did_you_mean(name, known),
                            listed(levels), missing));
  }
  std::string numbers;
  for (const std::size_t i : found) numbers += fmt::format("{}{}", numbers.empty() ? "" : ", ", i);
  throw Error(
      fmt::format("the levels {} are all called '{}'; give one by its number, or by its route to the root, as "
                  "\"skeleton >> lazy\"; the levels are: {}",
                  numbers, name, listed(levels)));
}

}  // namespace trellis::trial
