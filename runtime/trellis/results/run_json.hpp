// SPDX-License-Identifier: GPL-3.0-or-later
// The entry of a run in documents and in files of records: one list of fields writes it and reads it. For sources that
// include the JSON library.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include <trellis/results/columns.hpp>
#include <trellis/results/facts.hpp>
#include <trellis/results/quantities.hpp>

namespace trellis::json {

using Json = nlohmann::ordered_json;

/// Returns a number, "inf" or "-inf", or null for NaN.
Json number(double x);

/// Returns the place of a quantity in an object.
Json& place_of(const Quantity& quantity, Json& object);

/// What of a measured set to write: what reports read, that with the profile along the path, or all.
enum class Contents : std::uint8_t { reported, profile, all };

/// The measured set of samples relative to a target; null without a score.
Json measured_set(const Efficiency* scored, Contents contents = Contents::reported);
/// What one estimator finds. \param by  its estimates \param of  the set, which bounds it
Json estimate(const Estimate& by, const Efficiency& of);
Efficiency read_measured_set(const Json& json);

/// An entry of `runs`.
Json run(const RunFacts& run);
RunFacts read_run(const Json& json);

/// The scores of a level: its `measure` and its `metrics`.
/// \param root  whether it is the root, whose own space is the root's, so that the scores lifted to it are the same
void add_scores(const LevelScores* scores, bool root, Json& level);
/// \return nullptr where the level has no scores
std::shared_ptr<LevelScores> read_scores(const Json& level, bool root);

/// Adds the columns of a set of samples to its row of a table: the estimates themselves, which reports bound (shown()).
/// \param profile  whether to write the profile along the path
void add_set(const Efficiency& set, bool profile, Json& row);
Efficiency read_set(const Json& row);

/// The runs of a document, one after another: their entries, and the tables `levels`, `measure` and `setups` beside
/// them.
class RunTables {
 public:
  /// Adds a run. \return its entry of `runs`, on one line without its end
  std::string add(const RunFacts& run);
  /// Returns the tables as fields of the document.
  [[nodiscard]] std::string text() const;

 private:
  ColumnWriter levels_;
  ColumnWriter measure_;
  /// The set-up of a strategy's guides on a problem: the longest of its runs.
  struct SetUp {
    std::string problem;
    std::string strategy;
    double seconds = 0.0;
    double shared_seconds = 0.0;
    double work = 0.0;
    double queries = 0.0;
  };
  std::vector<SetUp> set_ups_;
  std::size_t runs_ = 0;
};
/// Reads both tables: the levels of the runs.
void read_tables(const Json& levels, const Json& measure, std::vector<RunFacts>& runs);

/// The scores of a level of all seeds together.
Json pooled(const PooledScores& pooled);

/// The number of times that a level was solved again, by reason.
Json resolves(const Resolves& resolves);

/// Returns the document of an experiment and its runs without what reports derive: its end is missing.
std::string document(const ExperimentFacts& experiment);

/// Returns the JSON in one line; bytes of names that are not UTF-8 become U+FFFD.
std::string dump(const Json& json);
/// Returns an array with one entry to a line: readable, and tools of lines can select one.
std::string lines(const Json::array_t& entries);

}  // namespace trellis::json
