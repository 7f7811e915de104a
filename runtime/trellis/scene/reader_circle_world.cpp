// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <map>
#include <optional>
#include <utility>
#include <variant>

#include <trellis/base/errors.hpp>
#include <trellis/scene/reader_formats.hpp>

namespace trellis {

namespace {

double number(const SourceText& text, std::size_t line, const std::string& word, const char* what) {
  double value = 0.0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size() || !std::isfinite(value)) {
    throw text.error(line, fmt::format("{} is '{}', expected a finite number", what, word));
  }
  return value;
}

long index(const SourceText& text, std::size_t line, const std::string& word) {
  long value = 0;
  const auto [end, fault] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (fault != std::errc() || end != word.data() + word.size() || value < 0) {
    throw text.error(line, fmt::format("the index is '{}', expected a whole number of at least 0", word));
  }
  return value;
}

Obstacle circle_of(const SourceText& text, std::size_t line, const std::vector<std::string>& words) {
  if (words.size() != 4) {
    throw text.error(line, fmt::format("a row of {} words, expected 4: index x y r", words.size()));
  }
  const long name = index(text, line, words[0]);
  const Disc disc{{number(text, line, words[1], "x"), number(text, line, words[2], "y")},
                  number(text, line, words[3], "the radius")};
  if (disc.radius <= 0.0) {
    throw text.error(line, fmt::format("the radius is {}, expected a number greater than 0", disc.radius));
  }
  return {fmt::format("circle {}", name), disc};
}

World world_of(const SourceText& text) {
  ErrorList errors;
  std::vector<Obstacle> obstacles;
  Box2 bounds;
  for (std::size_t i = 2; i < text.lines.size(); ++i) {
    const auto words = words_of(text.lines[i]);
    if (words.empty()) continue;
    errors.attempt([&] {
      obstacles.push_back(circle_of(text, i + 1, words));
      const Box2 box = bounding_box(std::get<Disc>(obstacles.back().shape));
      if (obstacles.size() == 1) bounds = box;
      bounds.lo = {std::min(bounds.lo.x, box.lo.x), std::min(bounds.lo.y, box.lo.y)};
      bounds.hi = {std::max(bounds.hi.x, box.hi.x), std::max(bounds.hi.y, box.hi.y)};
    });
  }
  errors.raise();
  if (obstacles.empty()) throw text.error(text.lines.size(), "no circles, expected at least one row: index x y r");
  return {bounds, std::move(obstacles)};
}

struct Query {
  std::size_t line = 0;  // of its first occurrence
  std::array<std::optional<Configuration>, 2> ends;
};

constexpr std::array<const char*, 2> labels = {"start:", "goal:"};

void read_query(const SourceText& text, std::size_t line, const std::vector<std::string>& words,
                std::map<long, Query>& queries) {
  if (words.size() != 4) {
    throw text.error(line, fmt::format("a row of {} words, expected 4: index start:|goal: x y", words.size()));
  }
  const long name = index(text, line, words[0]);
  const auto label = static_cast<std::size_t>(std::find(labels.begin(), labels.end(), words[1]) - labels.begin());
  if (label == labels.size()) {
    throw text.error(line, fmt::format("'{}' after the index, expected 'start:' or 'goal:'", words[1]));
  }
  auto& query = queries.try_emplace(name, Query{line, {}}).first->second;
  auto& end = query.ends[label];
  if (end) throw text.error(line, fmt::format("a second '{}' of query {}, expected one", words[1], name));
  end = Configuration{};  // a row with mistakes is there too
  end = Configuration{number(text, line, words[2], "x"), number(text, line, words[3], "y")};
}

std::map<long, Query> queries_of(const SourceText& text) {
  ErrorList errors;
  std::map<long, Query> queries;
  for (std::size_t i = 0; i < text.lines.size(); ++i) {
    const auto words = words_of(text.lines[i]);
    if (words.empty()) continue;
    errors.attempt([&] { read_query(text, i + 1, words, queries); });
  }
  for (const auto& [name, query] : queries) {
    for (std::size_t k = 0; k < labels.size(); ++k) {
      if (!query.ends[k]) errors.add(text.error(query.line, fmt::format("query {} has no '{}' row", name, labels[k])));
    }
  }
  errors.raise();
  if (queries.empty())
    throw text.error(std::max<std::size_t>(text.lines.size(), 1), "no queries, expected at least one");
  return queries;
}

}  // namespace

bool is_circle_world(const SourceText& text) {
  return text.lines.size() >= 2 && words_of(text.lines[1]) == std::vector<std::string>{"x", "y", "r"};
}

std::vector<Problem> read_circle_world(const SourceText& text, const ReadOptions& options) {
  ErrorList errors;
  std::shared_ptr<const Scene> scene;
  errors.attempt([&] { scene = std::make_shared<const Scene>(Scene{world_of(text), Robot::point()}); });
  std::map<long, Query> queries;
  errors.attempt([&] {
    const std::filesystem::path path(text.path);
    std::string file = path.filename().string();
    const std::string from = "obstacles", to = "queries";
    const auto at = file.rfind(from);
    if (at == std::string::npos) {
      throw text.error(1, fmt::format("a circle world's file name must hold '{}', so that the file of its queries is "
                                      "known, got '{}'",
                                      from, file));
    }
    file.replace(at, from.size(), to);
    queries = queries_of(SourceText::load((path.parent_path() / file).string()));
  });
  errors.raise();
  std::vector<Problem> problems;
  for (auto& [name, query] : queries) {
    problems.push_back(problem_in(fmt::format("circles/{}", name), scene, options));
    problems.back().start = *query.ends[0];
    problems.back().goal = *query.ends[1];
  }
  return problems;
}

}  // namespace trellis
