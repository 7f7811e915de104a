// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <string_view>

#include <trellis/experiment/experiment.hpp>
#include <trellis/experiment/samples.hpp>
#include <trellis/results/directories.hpp>
#include <trellis/results/files.hpp>

namespace trellis {

namespace {

namespace fs = std::filesystem;

template <class T>
void append_number(std::string& out, T value) {
  char digits[64];  // NOLINT(modernize-avoid-c-arrays): to_chars' buffer
  const auto end = std::to_chars(digits, digits + sizeof digits, value).ptr;
  out.append(digits, end);
}

/// Appends q1,...,qn, each after a separator; missing coordinates stay empty.
void append_coordinates(std::string& out, View q, std::size_t columns) {
  for (std::size_t j = 0; j < columns; ++j) {
    out += ',';
    if (j < q.size()) append_number(out, q[j]);
  }
}

/// \param accepted  of each sample, by its index
template <class Accepted>
void append_samples(std::string& out, int level, std::string_view role, const Configurations& samples,
                    const Accepted& accepted, std::size_t columns) {
  for (std::size_t i = 0; i < samples.size(); ++i) {
    append_number(out, level);
    out += ',';
    out += role;
    out += ',';
    append_number(out, i);
    out += accepted(i) ? ",1" : ",0";
    append_coordinates(out, samples[i], columns);
    out += '\n';
  }
}

std::string samples_csv(const RunResult& run) {
  std::size_t columns = 0;
  for (const auto& level : run.levels) columns = std::max(columns, level.record.space.dimension());
  std::string out = "level,role,index,accepted";
  for (std::size_t j = 0; j < columns; ++j) out += fmt::format(",q{}", j + 1);
  out += '\n';
  for (const auto& level : run.levels) {
    const LevelRecord& record = level.record;
    const Search& search = record.search;
    const auto validated = [&](std::size_t i) { return search.validated.empty() || search.validated[i] != 0; };
    const auto added = [&](std::size_t i) { return i < search.fates.size() && search.fates[i] != Fate::rejected; };
    append_samples(out, record.level, "tree", search.nodes, validated, columns);
    append_samples(out, record.level, "expansion", search.proposals, added, columns);
  }
  return out;
}

std::string_view fate_name(Fate fate) {
  switch (fate) {
    case Fate::reached: return "reached";
    case Fate::advanced: return "advanced";
    case Fate::rejected: break;
  }
  return "rejected";
}

/// Appends the extensions of a level: the node, the proposal that it was extended towards, and the result; with a
/// motion model a row for each control of the motion.
void append_expansions(std::string& out, const LevelRecord& record, std::size_t controls) {
  const Search& search = record.search;
  const auto append_row = [&](std::uint32_t row) {
    out += ',';
    if (row != no_node) append_number(out, row);
  };
  const std::size_t count = std::min({search.proposals.size(), search.fates.size(), search.near.size()});
  for (std::size_t i = 0; i < count; ++i) {
    const bool driven = i < search.controls.ends.size();
    const std::size_t begin = driven ? search.controls.begin_of(i) : 0;
    const std::size_t pieces = driven ? search.controls.ends[i] - begin : 1;
    for (std::size_t k = 0; k < pieces; ++k) {
      append_number(out, record.level);
      out += ',';
      append_number(out, i);
      out += ',';
      append_number(out, k);
      out += ',';
      out += fate_name(search.fates[i]);
      append_row(search.near[i]);
      append_row(search.added[i]);
      if (controls > 0) {
        append_coordinates(out, driven ? search.controls.controls[begin + k] : View(), controls);
        out += ',';
        if (driven) append_number(out, search.controls.dt * search.controls.steps[begin + k]);
        out += ',';
        if (driven) append_number(out, search.controls.dt * search.controls.driven[begin + k]);
      }
      out += '\n';
    }
  }
}

std::string expansions_csv(const RunResult& run) {
  std::size_t controls = 0;
  for (const auto& level : run.levels) {
    controls = std::max(controls, level.record.search.controls.controls.dimension());
  }
  std::string out = "level,index,piece,fate,node,added";
  for (std::size_t j = 0; j < controls; ++j) out += fmt::format(",u{}", j + 1);
  if (controls > 0) out += ",duration,driven";
  out += '\n';
  for (const auto& level : run.levels) append_expansions(out, level.record, controls);
  return out;
}

std::string path_csv(const RunResult& run) {
  const std::size_t columns =
      run.levels.empty() ? run.run.path.dimension() : run.levels.front().record.space.dimension();
  std::string out;
  for (std::size_t j = 0; j < columns; ++j) out += fmt::format("{}q{}", j == 0 ? "" : ",", j + 1);
  out += '\n';
  for (std::size_t i = 0; i < run.run.path.size(); ++i) {
    std::string row;
    append_coordinates(row, run.run.path[i], columns);
    out.append(row, std::min<std::size_t>(1, row.size()));
    out += '\n';
  }
  return out;
}

}  // namespace

void write_samples(const ExperimentResult& result, const std::string& directory) {
  Directories problems;
  std::map<std::string, Directories> strategies;  // of each problem
  for (const auto& run : result.runs) {
    const fs::path place = fs::path(directory) / problems(run.problem) / strategies[run.problem](run.strategy) /
                           fmt::format("seed-{}", run.seed);
    make_directory(place.string());
    write_file((place / "samples.csv").string(), samples_csv(run), Flush::none);
    write_file((place / "expansions.csv").string(), expansions_csv(run), Flush::none);
    write_file((place / "path.csv").string(), path_csv(run), Flush::none);
  }
}

}  // namespace trellis
