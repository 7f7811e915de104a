// SPDX-License-Identifier: GPL-3.0-or-later
// h that follows a path in C in steps of the planner, just ahead of the connected nodes.
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

/// Whether every lift of the path's point at an arc length in S is known to be valid without a check.
using PointIsFree = std::function<bool(double at)>;

/// A path in S, sparsely validated in C.
struct SparsePath {
  /// In C from start to goal, each valid. If `refuted` is set: the valid waypoints before and after it.
  Configurations waypoints;
  std::vector<double> at;                ///< arc length in S of the point that each waypoint lifts
  std::optional<Configuration> refuted;  ///< a point of the path in S that has no valid lift, or that is excluded
  double refuted_at = 0.0;               ///< its arc length in S
};

/// Validates a path in S sparsely in C (LazySP's candidate path, Dellin and Srinivasa 2016, with vertices in place of
/// edges): lifts and checks points at distances of `spacing`, alternating from both ends, until a point has no valid
/// lift. C counts the validity checks.
class SparseValidation {
 public:
  /// \param spacing  distance in S between checked points, in metres in the metric, > 0
  /// \param even  interpolates the configurations from which lifts start between both ends, so that the two parts meet
  SparseValidation(const Space& s, double spacing, bool even = false)
      : s_(s), spacing_(spacing), even_(even), known_(s), waypoints_(0) {}

  /// \param path  in S, from f of the start to f of a goal or only towards one
  /// \param goal  the goal of C that the path leads to; empty if it ends at none
  /// \param free  optional; points that need no check
  SparsePath validate(Instance& parent, const Configurations& path, View goal, const PointLift& lift,
                      const PointIsFree& free = {});

 private:
  /// Validity in C by collision checks, also if C presumes validity: a presumption would validate nothing.
  bool valid(Instance& parent, View q);

  Space s_;
  double spacing_;
  bool even_;
  std::shared_ptr<Validity> checked_;      ///< collision checks of a C that presumes validity
  NearestIndex known_;                     ///< points of S with a lift
  Configurations waypoints_;               ///< the last lift of each point
  std::vector<std::uint8_t> usable_;       ///< whether the lift is valid
  std::vector<std::uint64_t> checked_at_;  ///< epoch of C at that check
  std::uint64_t calls_ = 0;
};

/// The verified parts of a path, edge by edge.
class VerifiedStretches {
 public:
  VerifiedStretches(const Instance& instance, const Configurations& path);
  /// For each edge, whether it is verified.
  [[nodiscard]] const std::vector<char>& edges() const { return edges_; }
  [[nodiscard]] bool all() const;
  /// Whether the point at an arc length lies on a verified edge.
  [[nodiscard]] bool contains(double at) const;
  /// The points of the verified parts and, between these parts, the waypoints of a sparse path, in order; and for each
  /// edge, whether it is verified.
  [[nodiscard]] std::pair<Configurations, std::vector<char>> merged_into(const SparsePath& sparse) const;

 private:
  const Configurations& path_;
  std::vector<double> lengths_;
  std::vector<char> edges_;
};

/// For each edge of a path, whether it is known to be valid: it was verified, or the instance presumes it. A tree may
/// follow such an edge exactly; beside the edge, the result of its validation would not apply.
std::vector<char> known_edges(const Instance& instance, const Configurations& path, std::vector<char> verified = {});

/// h along a path in C, in steps of the planner: picks a point of the path slightly ahead of the connected node that is
/// farthest along it, then draws uniformly from the ball about the point. The balls grow while no node is added, and
/// the interval of points extends backwards. With two trees there are two such nodes.
///
/// If the next edge of the path is verified, h proposes the edge's end itself, for a node on the edge.
///
/// Consecutive guided proposals that are blocked at one place are the evidence that refutes the path.
class StepHeuristic final : public PathFollower {
 public:
  struct Settings {
    double radius = 0.1;         ///< of the balls, in metres in the metric
    double step = 0.5;           ///< longest extension of the planner, in metres in the metric
    std::int64_t evidence = 60;  ///< number of blocked proposals that refutes the path; 0: never
  };
  /// \param reached  the existing nodes of the tree from the start, and of the tree from the goal
  /// \param verified  for each edge of the path, whether it is known to be valid; empty: none is
  StepHeuristic(std::string source, const Space& space, Configurations path, const Settings& settings,
                const std::array<const ReachedIndex*, 2>& reached, std::vector<char> verified = {});

  void select_tree(TreeSide side) override {
    if (std::exchange(side_, static_cast<std::size_t>(side)) != side_) ++epoch_;
  }
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override;
  [[nodiscard]] bool worth_connecting(View from, View to) const override;
  [[nodiscard]] double progress() const override { return progress_; }
  [[nodiscard]] double connected() const override { return std::min(length(), fronts_[0].at + fronts_[1].at); }
  /// An edge away from the path costs five times its length. A shortcut between two parts of the path costs as much as
  /// the path between them, at most five times its own length.
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override;
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
  /// Limit of the distance ahead, in steps: proposals farther ahead cut corners and are blocked there.
  static constexpr double most_ahead = 1.0;
  /// The end of the connected part of the path, from the side of one tree.
  struct Front {
    double at = 0.0;                    ///< arc length from that tree's end of the path, in metres in the metric
    std::uint32_t row = no_node;        ///< node at the front
    double ahead = 0.0;                 ///< distance of proposals ahead of it
    std::int64_t failures = 0;          ///< consecutive guided proposals without progress
    std::int64_t blocked = 0;           ///< those of them that were blocked
    std::size_t vertex = 0;             ///< last vertex of the path that it passed, counted from that tree's end
    bool exact = false;                 ///< its node lies on the edge after `vertex`
    std::optional<std::size_t> target;  ///< vertex proposed itself, counted from that tree's end
    std::array<std::optional<TubeKernel>, sizes> kernels;
    std::size_t size = 0;  ///< index of the active kernel
    bool aimed = false;    ///< the active kernel draws from [from, to]
    double from = 0.0;     ///< arc length from the path's first point
    double to = 0.0;
  };

  /// The kernel of the next proposal, if no vertex is proposed itself. Made when first needed.
  [[nodiscard]] TubeKernel& current() const;
  [[nodiscard]] double length() const { return lengths_.back(); }
  [[nodiscard]] const Configurations& centres() const;
  /// For a configuration at a distance of a bin's centre: the number of bins, at least 1, from there to the first one
  /// whose centre can be within another distance of it, by the triangle inequality.
  [[nodiscard]] std::size_t bins_to(double distance, double within) const {
    return bin_ > 0.0 ? std::max<std::size_t>(1, static_cast<std::size_t>((distance - within) / bin_)) : 1;
  }
  /// A node within this distance of the path counts as on it at any arc length, also outside of the window.
  [[nodiscard]] double very_near() const { return 0.5 * settings_.radius; }
  /// The vertex that is proposed itself, if any.
  [[nodiscard]] const std::optional<std::size_t>& target() const { return fronts_[side_].target; }
  /// The i-th vertex of the path, and its arc length, counted from a side's end.
  [[nodiscard]] View vertex_of(std::size_t side, std::size_t i) const {
    return std::as_const(path_)[side == 0 ? i : path_.size() - 1 - i];
  }
  [[nodiscard]] double length_to(std::size_t side, std::size_t i) const {
    return side == 0 ? lengths_[i] : length() - lengths_[path_.size() - 1 - i];
  }
  /// Whether the edge after the i-th vertex, counted from a side's end, is verified.
  [[nodiscard]] bool verified_after(std::size_t side, std::size_t i) const {
    return i + 1 < path_.size() && !verified_.empty() && verified_[side == 0 ? i : path_.size() - 2 - i] != 0;
  }
  /// The vertex that a side proposes next, if its front is on a verified edge or one begins within the distance ahead.
  [[nodiscard]] std::optional<std::size_t> next_target(std::size_t side) const;
  /// Advances a front by an extension towards its target. Returns whether it advanced.
  bool follow_target(std::size_t side, const Outcome& outcome);
  /// Chooses the interval and the balls of a side's next proposals.
  void aim(std::size_t side);
  /// The arc length at which a node lies on the path: the nearest point within the window ahead of a front.
  /// \param far  also consider points beyond the window, if very near
  [[nodiscard]] std::optional<double> place(std::size_t side, View q, bool far) const;

  std::string source_;
  Space space_;
  Configurations path_;
  std::vector<double> lengths_;
  Settings settings_;
  std::vector<char> verified_;  ///< per edge of the path; empty: none
  double bin_ = 0.0;            ///< length of a bin of the path, metres in the metric
  std::size_t last_bin_ = 0;
  mutable Configurations centres_;               ///< centres of the bins, made when first needed
  mutable std::unique_ptr<NearestIndex> index_;  ///< index of the centres, made when first needed
  mutable Configuration last_;                   ///< the end of an edge that was rated last, and
  mutable NearestIndex::Neighbour at_last_;      ///< its nearest centre
  mutable std::array<Front, 2> fronts_;          ///< their kernels are made when first needed
  std::size_t side_ = 0;
  double progress_ = 0.0;
  std::uint64_t epoch_ = 0;
  std::optional<Configuration> refuted_place_;
};

}  // namespace trellis
