// SPDX-License-Identifier: GPL-3.0-or-later
// h that follows a path in C by steps, just ahead of what is connected.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/path_guide.hpp>

namespace trellis {

/// Whether every lift of the point of the path in S at an arc length is known to be valid without a check.
using PointIsFree = std::function<bool(double at)>;

/// A path in S, validated in C at some points only.
struct SparsePath {
  /// In C from start to goal, each valid; where `refuted` is set, the valid points before and after it.
  Configurations waypoints;
  std::vector<double> at;                ///< of each waypoint, the arc length in S of the point that it lifts
  std::optional<Configuration> refuted;  ///< a point of the path in S of which no lift was valid, or that is excluded
  double refuted_at = 0.0;               ///< its arc length in S
};

/// Validates a path in S sparsely in C (LazySP's candidate path, Dellin and Srinivasa 2016, with vertices for edges):
/// points `spacing` apart are lifted and checked, from both ends in turn, up to the first of which no lift is valid.
/// Its validity checks are C's.
class SparseValidation {
 public:
  /// \param spacing  metres in the metric of S between points that are checked, > 0
  /// \param even     moves what lifts start from evenly from one end to the other, so that both ends meet
  SparseValidation(const Space& s, double spacing, bool even = false)
      : s_(s), spacing_(spacing), even_(even), known_(s), waypoints_(0) {}

  /// \param path  in S, from f of the start to f of the goal, or only towards it
  /// \param whole  whether it ends at the goal
  SparsePath validate(Instance& parent, const Configurations& path, bool whole, const PointLift& lift,
                      const PointIsFree& free = {});

 private:
  /// Validity in C, by collision checks even where C presumes it: what presumes would validate nothing.
  bool valid(Instance& parent, View q);

  Space s_;
  double spacing_;
  bool even_;
  std::shared_ptr<Validity> checked_;      ///< of a C that presumes validity
  NearestIndex known_;                     ///< points of S that were lifted
  Configurations waypoints_;               ///< the configurations that they were lifted to last
  std::vector<std::uint8_t> usable_;       ///< whether these are valid
  std::vector<std::uint64_t> checked_at_;  ///< epoch of C when that was found
  std::uint64_t calls_ = 0;
};

/// The stretches of a path that are known to be valid as they are, edge by edge.
class VerifiedStretches {
 public:
  VerifiedStretches(const Instance& instance, const Configurations& path);
  /// Of each edge, whether it was verified.
  [[nodiscard]] const std::vector<char>& edges() const { return edges_; }
  [[nodiscard]] bool all() const;
  /// Whether the point at an arc length lies on one.
  [[nodiscard]] bool contains(double at) const;
  /// The waypoints of a sparse path between them, and their own points, in order; of each edge, whether it was
  /// verified.
  [[nodiscard]] std::pair<Configurations, std::vector<char>> merged_into(const SparsePath& sparse) const;

 private:
  const Configurations& path_;
  std::vector<double> lengths_;
  std::vector<char> edges_;
};

/// Of each edge of a path, whether it is known to be valid: it was verified, or the instance presumes it. Then a tree
/// may go along it as it is; beside it, it would lose what was found out about its points.
std::vector<char> known_edges(const Instance& instance, const Configurations& path, std::vector<char> verified = {});

/// h along a path in C in steps of the planner: a point of the path a little ahead of the node that has come farthest
/// along it, then uniform on a ball about it. The balls are small at first and grow where nothing is added; so does the
/// stretch that proposals are drawn from, backwards. Two trees have two ends to go on from.
///
/// Where an edge of the path was verified, its end is proposed itself, for a node on the edge.
///
/// Evidence refutes a path: so many guided proposals in a row at one place of it that were found blocked.
class StepHeuristic final : public PathFollower {
 public:
  struct Settings {
    double radius = 0.1;         ///< metres in the metric, of the balls
    double step = 0.5;           ///< metres in the metric, longest extension of the planner
    std::int64_t evidence = 60;  ///< blocked proposals that refute; 0: none do
  };
  /// \param reached   the nodes of the tree from the start, and of the one from the goal, that there are already
  /// \param verified  of each edge of the path, whether it is known to be valid; empty: none is
  StepHeuristic(std::string source, const Space& space, Configurations path, const Settings& settings,
                const std::array<const NearestIndex*, 2>& reached, std::vector<char> verified = {});

  void select_tree(TreeSide side) override {
    if (std::exchange(side_, static_cast<std::size_t>(side)) != side_) ++epoch_;
  }
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override;
  [[nodiscard]] bool worth_connecting(View from, View to) const override;
  [[nodiscard]] double progress() const override { return progress_; }
  [[nodiscard]] double connected() const override { return std::min(length(), fronts_[0].at + fronts_[1].at); }
  /// An edge away from the path costs five times its length; one that takes a short cut from one part of it to another,
  /// what the path does between them, up to that.
  [[nodiscard]] double edge_factor(View a, View b) const override;
  [[nodiscard]] double density(View q) const override { return target() ? 0.0 : current().density(q); }
  [[nodiscard]] double atom_mass() const override { return target() ? 1.0 : 0.0; }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }
  void record(DensityRecord& record, double share) const override {
    if (target()) {
      record.add_atoms(share);
    } else {
      record.add(current().density(), share);
    }
  }
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] Configurations lifted_path() const override { return path_; }
  [[nodiscard]] double radius() const override { return settings_.radius; }
  [[nodiscard]] std::optional<Configuration> refuted_place() const override { return refuted_place_; }

 private:
  static constexpr std::size_t sizes = 5;
  /// Proposals are at most so many steps ahead: the farther, the more they cut corners, and are blocked there.
  static constexpr double most_ahead = 1.0;
  /// The end of what is connected, seen from one tree.
  struct Front {
    double at = 0.0;                    ///< arc length from that tree's end of the path
    std::uint32_t row = no_node;        ///< the node there
    double ahead = 0.0;                 ///< how far ahead proposals are
    std::int64_t failures = 0;          ///< guided proposals in a row without progress
    std::int64_t blocked = 0;           ///< of these, found blocked
    std::size_t vertex = 0;             ///< of the path, counted from that tree's end, that it passed last
    bool exact = false;                 ///< the node there lies on the edge after `vertex`
    std::optional<std::size_t> target;  ///< the vertex that is proposed itself, counted likewise
    std::array<std::optional<TubeKernel>, sizes> kernels;
    std::size_t size = 0;  ///< of the kernel in use
    bool aimed = false;    ///< it draws from [from, to]
    double from = 0.0;     ///< arc length from the path's first point
    double to = 0.0;
  };

  /// What a proposal is drawn from where no vertex is proposed itself; made when it is asked for.
  [[nodiscard]] TubeKernel& current() const;
  [[nodiscard]] double length() const { return lengths_.back(); }
  [[nodiscard]] const Configurations& centres() const;
  /// So near to the path that a node counts for it wherever on the path that is.
  [[nodiscard]] double very_near() const { return 0.5 * settings_.radius; }
  /// The vertex that is proposed itself, if any.
  [[nodiscard]] const std::optional<std::size_t>& target() const { return fronts_[side_].target; }
  /// A vertex of the path, and its arc length, counted from a side's end.
  [[nodiscard]] View vertex_of(std::size_t side, std::size_t i) const {
    return std::as_const(path_)[side == 0 ? i : path_.size() - 1 - i];
  }
  [[nodiscard]] double length_to(std::size_t side, std::size_t i) const {
    return side == 0 ? lengths_[i] : length() - lengths_[path_.size() - 1 - i];
  }
  /// Whether the edge after a vertex, seen from a side, was verified.
  [[nodiscard]] bool verified_after(std::size_t side, std::size_t i) const {
    return i + 1 < path_.size() && !verified_.empty() && verified_[side == 0 ? i : path_.size() - 2 - i] != 0;
  }
  /// The vertex that a side's next proposal is, where it goes along what was verified or comes to it.
  [[nodiscard]] std::optional<std::size_t> next_target(std::size_t side) const;
  /// A front has come to the vertex that was proposed itself, or part of the way. Whether it has.
  bool follow_target(std::size_t side, const Outcome& outcome);
  /// Chooses the stretch and the balls that a side's next proposals are drawn from.
  void aim(std::size_t side);
  /// Where a node is along the path: the nearest place within the window ahead of a front.
  /// \param far  or beyond the window, where it is very near
  [[nodiscard]] std::optional<double> place(std::size_t side, View q, bool far) const;

  std::string source_;
  Space space_;
  Configurations path_;
  std::vector<double> lengths_;
  Settings settings_;
  std::vector<char> verified_;  ///< per edge; empty: none
  double bin_ = 0.0;            ///< length of a bin of the path, metres
  std::size_t last_bin_ = 0;
  mutable Configurations centres_;               ///< of bins along the path, made when they are asked for
  mutable std::unique_ptr<NearestIndex> index_;  ///< of these, made when it is asked for
  mutable std::array<Front, 2> fronts_;          ///< their kernels are made when they are asked for
  std::size_t side_ = 0;
  double progress_ = 0.0;
  std::uint64_t epoch_ = 0;
  std::optional<Configuration> refuted_place_;
};

}  // namespace trellis
