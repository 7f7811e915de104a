// SPDX-License-Identifier: GPL-3.0-or-later
// The entry of a run in documents and in files of records: one list of fields writes it and reads it. For sources that
// include the JSON library.
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>

#include <trellis/experiment/facts.hpp>
#include <trellis/report/quantities.hpp>

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

/// The scores of a level of all seeds together.
Json pooled(const PooledScores& pooled);

/// The number of times that a level was solved again, by reason.
Json resolves(const Resolves& resolves);

/// Returns the JSON in one line; bytes of names that are not UTF-8 become U+FFFD.
std::string dump(const Json& json);
/// Returns an array with one entry to a line: readable, and tools of lines can select one.
std::string lines(const Json::array_t& entries);

}  // namespace trellis::json
