// SPDX-License-Identifier: GPL-3.0-or-later
// What a report says first: the strategies, what each needs relative to the baseline, and what each of their guides
// saves. The printed report and the page lay out these rows; they compute nothing.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/measure/sequential_test.hpp>

namespace trellis {

struct ExperimentFacts;
struct ExperimentSummary;
struct Verdict;

/// A difference of costs of less than this factor is no reason to keep or to drop a guide, even where it is shown.
inline constexpr double least_effect = 1.1;

/// The verdict of a row, in words.
struct AnswerVerdict {
  enum class Kind : std::uint8_t {
    none,   ///< nothing to decide: the baseline
    good,   ///< "pays", "keep it"
    bad,    ///< "costs", "drop it"
    small,  ///< "hardly matters", "no difference", "changes nothing"
    open,   ///< "not shown", "not tested", "never set up"
  };
  Kind kind = Kind::none;
  std::string word = {};
  std::string more = {};  ///< what would decide it: "budget spent: --ablation 4", "~80 seeds would probably show it"
};

/// A row of the table: a strategy, or below it the same strategy without one of its guides.
struct AnswerRow {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  std::string label;        ///< "nested", "without lazy()"
  std::string strategy;     ///< its name; of a row without a guide that of the complete strategy
  std::string guide = {};   ///< Ablation::key of the guide that it is without; "" for a strategy
  std::size_t indent = 0;   ///< 1 for a row without a guide
  std::size_t solved = 0;   ///< of `runs`; at least so many where runs were cut off
  std::size_t runs = 0;     ///< 0: it was not run
  std::size_t cut_off = 0;  ///< runs that were stopped before they found a path
  /// Validity checks until the first path, the median; an unsolved run is infinite. A bracket where runs were cut off.
  RatioBracket checks = {none, none};
  /// Of a strategy to the baseline; of a row without a guide to the complete strategy, so that the guide pays above 1.
  std::optional<MedianRatio> ratio = {};
  AnswerVerdict verdict = {};
  double seconds = none;  ///< median
  double length = none;   ///< of the path, metres: the mean over the solved runs

  // The cells as reports print them; "" for an empty one.
  [[nodiscard]] std::string solved_text() const;    ///< "15/15", "≥3/8" where runs were cut off
  [[nodiscard]] std::string checks_text() const;    ///< "5,590", "≥27,208", "none" where most runs found no path
  [[nodiscard]] std::string ratio_text() const;     ///< "0.11"
  [[nodiscard]] std::string interval_text() const;  ///< "[0.065, 0.29]"
  [[nodiscard]] std::string ms_text() const;        ///< "2.7"
  [[nodiscard]] std::string length_text() const;    ///< "37.7"
};

/// The strategies on one problem, or on all problems together: the baseline first, then by their ratios.
struct AnswerTable {
  std::string problem;  ///< "": all problems together
  std::string title;    ///< "false_gaps, 15 seeds: validity checks until the first path, medians"
  std::vector<AnswerRow> rows;

  /// Returns the largest finite median, the length of a full bar; 0 without one.
  [[nodiscard]] double most_checks() const;
};

/// The ratios of several problems, strategies by problems.
struct AnswerMatrix {
  struct Cell {
    std::optional<RatioBracket> ratio = {};
    bool shown = false;  ///< whether the runs show a difference

    [[nodiscard]] std::string text() const;  ///< "0.11", "0.93~" where none is shown
  };
  struct Line {
    std::string label;           ///< "nested", "nested without lazy()"
    std::string strategy;        ///< as AnswerRow::strategy
    std::string guide = {};      ///< as AnswerRow::guide
    std::vector<Cell> cells;     ///< one for each problem
    AnswerVerdict verdict = {};  ///< "pays 6 of 6", "keep 2, drop 1 of 6", "hardly matters"
  };
  std::vector<std::string> problems;
  std::string reference;            ///< the strategy whose checks are listed: the baseline
  std::vector<std::string> checks;  ///< its cells, as AnswerRow::checks_text()
  std::vector<Line> strategies;     ///< relative to the baseline, by the geometric mean of their ratios
  std::vector<Line> guides;         ///< without a guide, relative to the complete strategy
};

/// Many problems, by their groups. A median ratio hides runs that it does not describe: the range shows them.
struct AnswerGroups {
  struct Line {
    std::string strategy;
    std::vector<double> ratios;  ///< of each group: the median over its runs of checks relative to the baseline's
    std::size_t cheaper = 0;     ///< runs with fewer checks than the baseline
    std::size_t runs = 0;        ///< that the strategy or the baseline solved
    double lo = 0.0;             ///< the ratio that 10 % of the runs are below
    double hi = 0.0;             ///< 90 %
  };
  std::vector<std::pair<std::string, std::size_t>> groups;  ///< with their numbers of problems; none: no groups
  std::vector<Line> lines;
};

/// A sentence below the table.
struct AnswerNote {
  std::string topic;  ///< "legend", "why", "set-up", "certified", "unsolved", "warning", "verdict", "search", "team"
  std::string text;
};

/// What a report says first. One problem: its table. Up to `most_single_problems`: the matrix. More: the table of all
/// problems together, and the groups.
struct Answer {
  /// "nested needs 9 times fewer validity checks than rrt_connect; both its guides earn their place"
  std::string sentence;
  std::string title;                    ///< of what follows
  std::string baseline;                 ///< "" for none
  std::vector<AnswerTable> tables;      ///< of each problem
  std::optional<AnswerTable> together;  ///< of several problems
  std::optional<AnswerMatrix> matrix;
  std::optional<AnswerGroups> groups;
  std::vector<AnswerNote> notes;  ///< in the order of the report
  std::string next;               ///< what to do next

  /// Returns the table that the report prints; nullptr where it prints the matrix.
  [[nodiscard]] const AnswerTable* table() const;
};

/// Returns what a report says first.
/// \param summary  of the experiment, but for its answer
Answer answer_of(const ExperimentFacts& experiment, const ExperimentSummary& summary);

/// Returns the verdict on a strategy against the baseline: "pays", "costs", "hardly matters", ...
AnswerVerdict answer_on_strategy(const Verdict& verdict);
/// Returns the verdict on a guide of a strategy: "keep it", "drop it", "hardly matters", ...
AnswerVerdict answer_on_guide(const Verdict& verdict);
/// Returns the inverse of a ratio and of its interval: 0 becomes infinity.
MedianRatio inverse(const MedianRatio& ratio);

}  // namespace trellis
