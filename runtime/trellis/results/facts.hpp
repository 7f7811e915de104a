// SPDX-License-Identifier: GPL-3.0-or-later
// The plain data of results: what documents store, and all that reports are made of.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <trellis/measure/censored_cost.hpp>
#include <trellis/measure/efficiency.hpp>
#include <trellis/strategy/run_facts.hpp>

namespace trellis {

/// The contribution of a node to the roadmap of the earlier nodes.
enum class NodeClass : std::uint8_t {
  create,      ///< it sees no earlier node: a new component
  merge,       ///< it connects two or more components
  expand,      ///< it joins one component, and sees a new witness
  oversample,  ///< it joins one component and contributes nothing new
  invalid,     ///< it is invalid, as some nodes of a lazy roadmap; not part of the roadmap
};
std::string_view to_string(NodeClass c);

/// Metrics of one level's search other than its efficiency. NaN where there is nothing to measure.
///
/// The metrics use the roadmap that the nodes induce, whatever edges the planner made, so that trees, roadmaps and lazy
/// roadmaps are comparable. Nodes enter in the planner's order. Each connects to those of its `neighbours` nearest
/// valid earlier nodes that it sees, which means that the straight motion is valid. Once a node sees one node of a
/// component, the component's other nodes are not checked: they would connect nothing more. A node at the position of
/// an earlier one is an oversample.
///
/// Witnesses are valid quasi-random configurations of the space, equal for all searches of one space, validity and
/// seed. A node sees a witness likewise: one of its `neighbours` nearest witnesses, by a valid straight motion. Each
/// component checks motions to a witness only until it sees that witness, so that checks occur at the frontier of the
/// search only.
struct SearchMetrics {
  static constexpr double none = std::numeric_limits<double>::quiet_NaN();

  // Morales, Pearce and Amato 2006, Metrics for analyzing the evolution of C-space models.
  std::vector<NodeClass> classes;      ///< of each node
  std::array<std::size_t, 5> nodes{};  ///< by class
  std::size_t components = 0;          ///< of the final roadmap
  double coverage = none;              ///< share of the witnesses that at least one node sees
  double connectivity = none;          ///< share of the pairs of witnesses that one component sees

  // Burns and Brock 2003, Information theoretic construction of probabilistic roadmaps.
  /// The information that the proposals give about C, nats: log 2, the loss without information, minus the mean log
  /// loss of their model over a second set of witnesses, uniform on the whole space. The model predicts a configuration
  /// as valid with probability (v + 1) / (k + 2), with v the number of valid ones among the k = `model_neighbours`
  /// nearest proposals (all, where there are fewer). A repeated proposal adds no information. At most log(2 (k + 1) /
  /// (k + 2)); negative where the proposals mislead.
  double information = none;
  double information_per_sample = none;  ///< per proposal, repetitions included

  // Shares of the proposals; they sum to 1.
  double invalid = none;    ///< the proposal itself is invalid, whatever extension it caused
  double trapped = none;    ///< it is valid, and its extension was rejected
  double redundant = none;  ///< it is valid, and its node is an oversample
  double useful = none;     ///< the rest
};

/// The obstacles that rejected the proposals of a level.
struct Rejections {
  std::size_t rejected = 0;  ///< proposals without a node because the motion to them is invalid
  std::size_t examined = 0;  ///< of these, those with a located first invalid configuration
  /// The contacts there ("obstacle 3 (box 4 0 6 4.75)"), with their numbers, the most frequent first.
  std::vector<std::pair<std::string, std::size_t>> by;
};

/// The scores of one level's samples, tree and expansion, relative to one path.
struct Scores {
  Efficiency tree;
  Efficiency expansion;
};

/// The scores of a level of a run.
struct LevelScores {
  /// In the level's own space relative to the level's own path (the root's: the run's reported path). None without a
  /// target of its own. A role without samples, and a target without any valid configuration, score NaN.
  std::optional<Scores> own = {};
  /// Lifted to the root space by the chain of h's, relative to the root's path. None when the root found no path.
  std::optional<Scores> root = {};
  /// The mean of the same over the paths of other seeds. In the level's own space: the same level's paths under the
  /// same strategy; of a lower level if Measure::cross_levels. Lifted: the paths on which all strategies of the problem
  /// are scored.
  std::optional<Scores> own_cross = {};
  std::optional<Scores> root_cross = {};
  /// root_cross (or root, without other seeds) of a random subset of `equal_samples` samples: the number of the
  /// strategy with the fewest, where numbers differ much. The root level only.
  std::optional<Scores> equal = {};
  /// The ends of the scale for the root's values on its own path, with as many samples as the root has, at most
  /// `most_references`: the oracle, which samples T itself (S = C with a known solution), and uniform sampling of C.
  /// The root level only, scored by the headline's estimators.
  std::optional<Scores> oracle = {};
  std::optional<Scores> uniform = {};
  static constexpr std::size_t most_references = 1000;
  std::optional<SearchMetrics> metrics = {};
};

/// One level of a run.
struct LevelFacts : LevelAccounts {
  std::string space;
  std::size_t dimension = 0;  ///< number of coordinates
  std::size_t degrees = 0;    ///< degrees of freedom
  std::size_t proposals = 0;
  std::size_t accepted = 0;  ///< proposals that led to a node
  /// The parts of the heuristic, with the number of proposals that each drew.
  std::vector<std::pair<std::string, std::size_t>> sources;
  std::size_t nodes = 0;
  std::uint64_t validity_checks = 0;
  std::uint64_t motion_checks = 0;
  double seconds = 0.0;
  Status status = Status::untried;
  std::shared_ptr<const LevelScores> scores;  ///< nullptr: it was not scored
  std::optional<Rejections> rejections;

  /// Returns the score of a role; nullptr where there is none.
  [[nodiscard]] const Efficiency* score(std::optional<Scores> LevelScores::*where, Efficiency Scores::*role) const {
    return scores && ((*scores).*where) ? &((*((*scores).*where)).*role) : nullptr;
  }
};

/// A run without its samples. `length` and `clearance` are NaN where there is none.
struct RunFacts : RunTotals {
  std::string problem;
  std::string strategy;
  std::uint64_t seed = 0;
  std::vector<std::string> reasons;  ///< why it found no path
  std::vector<LevelFacts> levels;
};

/// Returns the validity checks of a run until its first path.
CensoredCost path_cost(const RunFacts& run);

/// Returns the names of what may become of a conflict, by TeamConflict::Resolved: "none", "schedule", ...
const std::array<const char*, 5>& resolved_names();

/// A reason to solve a level again.
struct ResolveReason {
  const char* name;  ///< in the JSON document
  const char* text;  ///< in reports
  std::uint64_t Resolves::*count;
};
inline constexpr std::array<ResolveReason, 8> resolve_reasons = {{
    {"invalid_path", "its path proved invalid in C", &Resolves::invalid_path},
    {"rejections", "C rejected guided proposals", &Resolves::rejections},
    {"lost_place", "another level refuted a place on its path", &Resolves::lost_place},
    {"presumed_valid", "a configuration that it presumes valid is invalid", &Resolves::presumed_valid},
    {"changed_world", "its obstacles changed", &Resolves::changed_world},
    {"new_turn", "its turn came with new samples", &Resolves::new_turn},
    {"further_path", "its guide asked for another path", &Resolves::further_path},
    {"refuted_path", "its path could not be certified", &Resolves::refuted_path},
}};

/// A level's samples of all seeds of a strategy pooled, lifted to the root, on the paths on which single runs are
/// scored. On each path the pool omits the seed that found it, because a run is never scored on its own path there. The
/// result differs from that of one run: a mixture of distributions with different supports covers more than each of
/// them.
struct PooledScores {
  std::string problem;
  std::string strategy;
  std::string key = "0";    ///< of the level, LevelRecord::key
  std::size_t seeds = 0;    ///< in the pool of a path
  std::size_t targets = 0;  ///< paths; the scores are means over them
  Scores scores;
};

/// Validity checks until the first path, with and without a part of a strategy, on one seed.
struct TestedPair {
  std::uint64_t seed = 0;
  CensoredCost with;
  CensoredCost without;
};

/// A strategy with and without one of its guides on a problem: runs that are not scored (Experiment::ablation).
struct LeftOut {
  std::string problem;
  std::string strategy;  ///< the name of the complete strategy
  std::string key;       ///< of the guide, Ablation::key
  /// In the order of the test: the seeds of the experiment, then the next ones. Without the pairs of which the
  /// experiment has both runs; none where the strategy cannot be set up without the guide.
  std::vector<TestedPair> pairs = {};
  double work = 0.0;  ///< of the runs that the experiment does not have
};

/// The costs of a strategy that divides a team on a problem in which some robots pass through each other: runs that are
/// not scored (Experiment::ablation).
struct Uncoupled {
  std::string problem;
  std::string strategy;
  /// The numbers of the robots: of two, that pass through each other; of one, that passes through all others; none:
  /// all pass through all.
  std::vector<std::size_t> robots;
  /// As LeftOut::pairs. A run without the coupling counts as solved where its path is certified among all robots.
  std::vector<TestedPair> pairs = {};
  double work = 0.0;  ///< as LeftOut::work
  /// Where all pass through all: for each pair the pairs of robots, by their numbers, that touch on the path found.
  std::vector<std::vector<std::vector<std::size_t>>> touching = {};
};

/// A guide of a strategy that may be left out, to decide whether it pays.
struct GuideFacts {
  std::string key;    ///< Ablation::key
  std::string guide;  ///< Ablation::guide
  std::string equal;  ///< the strategy of the experiment that searches as this one does without the guide; "" for none
};

struct StrategyFacts {
  std::string name;
  std::string text;           ///< in the syntax of a script
  std::string spec = {};      ///< with every option, as JSON
  std::string shares = {};    ///< "uniform share of proposals 0.05 at each guided level"
  std::string ablation = {};  ///< "without shrink(0.5)"; "" for a strategy of the script
  std::string of = {};        ///< of an ablation: the complete strategy
  bool guided = false;
  std::vector<GuideFacts> guides = {};
};

struct ProblemFacts {
  std::string name;
  std::string group = {};  ///< "" for none
  bool tuned = false;      ///< the strategies were tuned on the group
  /// Why no run can find a path, or hardly one. Of the first problem with a strategy that solves fewer than half of its
  /// runs; "" for others and where nothing is known.
  std::string obstruction = {};
};

/// The worlds and robots of an experiment, for pictures: arrays of the document, as JSON (docs/formats.md).
struct Scenery {
  std::string worlds = "[]";
  std::string robots = "[]";
  std::string scenes = "[]";  ///< of each problem its world, its robot, and what its coordinates mean
};

/// An experiment with its runs, from a process that ran it or from a document of results.
struct ExperimentFacts {
  int format = 0;           ///< of the document
  std::string script;       ///< the path as given on the command line, "" for none
  std::string version;      ///< of the program that ran it
  std::string description;  ///< the object `experiment` of the document, as JSON
  std::vector<StrategyFacts> strategies;
  std::vector<ProblemFacts> problems;
  std::vector<std::uint64_t> seeds;
  std::string given_baseline;           ///< of the script, "" for none
  double ablation = 0.0;                ///< Experiment::ablation
  bool spatial = false;                 ///< whether the first problem's world has three dimensions
  bool measured = false;                ///< whether sampling efficiency was computed
  std::string target;                   ///< of the measure, in words
  std::string tubes;                    ///< a sentence that compares the guides' tubes with the target
  std::string omitted;                  ///< the values that are omitted to save time
  std::vector<std::string> estimators;  ///< those requested
  std::vector<RunFacts> runs;
  std::vector<PooledScores> pooled;
  std::vector<LeftOut> left_out;
  std::vector<Uncoupled> uncoupled;
  Scenery scenery;
  std::string samples;  ///< the folder of the packed samples, relative to the document; "" for none

  /// Returns the strategy to compare the others with, as baseline_of().
  [[nodiscard]] std::string baseline() const;
  /// Returns the runs of a strategy on a problem, in their order; with an empty `problem`, on all problems.
  [[nodiscard]] std::vector<const RunFacts*> select(const std::string& problem, const std::string& strategy) const;
};

/// The overview reports more problems than these together, by their single runs.
inline constexpr std::size_t most_single_problems = 6;

/// The format of the document that this version writes, and the oldest one that has all that reports read: format 4
/// adds worlds, robots and samples; format 5 has tables of levels and of their scores.
inline constexpr int document_format = 5;
inline constexpr int oldest_reported_format = 3;

/// Sets what the object `experiment` of a document has. May throw exceptions of the JSON library.
void read_experiment(const std::string& line, ExperimentFacts& facts);

/// Whether fewer than half of the runs found a path, or the only one did not.
inline bool mostly_unsolved(std::size_t solved, std::size_t runs) {
  return solved < runs && (2 * solved < runs || runs == 1);
}

}  // namespace trellis
