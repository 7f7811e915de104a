// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/instance/instance.hpp>
#include <trellis/planner/planner.hpp>
#include <trellis/strategy/informed_path.hpp>
#include <trellis/strategy/ledger.hpp>
#include <trellis/strategy/searched_guidance.hpp>

namespace trellis {

/// The heuristic h of a level: goal bias, uniform sampling, the guide, and a path received from another space. The
/// level's ledger decides whether the guide draws.
class LevelHeuristic final : public Guidance {
 public:
  /// \param ledger  of the level; outlives this object, as the others do
  /// \param below_root  the space is one below the root
  LevelHeuristic(const Instance& instance, const PlannerCommon& common, Ledger& ledger, bool below_root)
      : instance_(instance),
        common_(common),
        ledger_(ledger),
        below_root_(below_root),
        uniform_(instance.space),
        goal_(instance),
        informed_(instance) {}

  void set_guide(std::unique_ptr<SearchedGuidance> guide) { guide_ = std::move(guide); }
  [[nodiscard]] SearchedGuidance* guide() const { return guide_.get(); }
  /// Called before the search begins if `inform` may be called later.
  void expect_paths() { informed_.expect(); }
  void inform(Configurations path) { informed_.follow(std::move(path)); }
  [[nodiscard]] bool guided() const { return guide_ != nullptr || informed_.guides(); }
  [[nodiscard]] bool below_root() const { return below_root_; }

  void select_tree(TreeSide side) override;
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] bool preview(Stream& stream, MutableView out) const override;
  [[nodiscard]] std::uint32_t vertex() const override;
  std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) override;
  [[nodiscard]] bool worth_connecting(View from, View to) const override;
  [[nodiscard]] double progress() const override {
    return informed_.progress() + (guide_ != nullptr ? guide_->progress() : 0.0);
  }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override {
    return guide_ != nullptr ? guide_->edge_factor(a, b) : 1.0;
  }
  void lost(View place) {
    if (guide_ != nullptr) guide_->lost(place);
  }
  void found_invalid(View q) {
    if (guide_ != nullptr) guide_->found_invalid(q);
  }
  void restart() override;
  [[nodiscard]] std::uint64_t epoch() const override {
    return ledger_.changes() + informed_.epoch() + (guide_ != nullptr ? guide_->epoch() : 0);
  }
  void record(DensityRecord& record, double share) const override;
  void observe(const Outcome& outcome, bool mine) override;
  void found(double length) override;
  /// The same, without the length where nothing asks for it.
  template <class Length>
  requires std::invocable<Length>
  void found(const Length& length) { found(path_found_ || guide_ != nullptr ? length() : 0.0); }
  /// Sets a function that receives the length of each path that the level's planner finds.
  void report_paths(std::function<void(double)> report) { path_found_ = std::move(report); }

  /// Whether proposals of a source are guided: neither the goal nor uniform.
  [[nodiscard]] static bool is_guided(Source source) { return source >= 2; }
  [[nodiscard]] std::vector<std::string> sources() const override;

 private:
  enum class Part : std::uint8_t { goal, uniform, informed, guide };
  static constexpr double informed_share = 0.5;

  /// The probability of each part in `sample`.
  struct Shares {
    double goal = 0.0;
    double uniform = 0.0;
    double informed = 0.0;
    double guide = 0.0;
  };
  [[nodiscard]] Shares shares() const;
  /// The part that draws the next proposal.
  [[nodiscard]] Part choose(double u) const;
  /// The part that drew the last proposal if guided, else nullptr.
  [[nodiscard]] const Guidance* drawn_from() const;

  const Instance& instance_;
  const PlannerCommon& common_;
  Ledger& ledger_;
  bool below_root_;
  UniformGuidance uniform_;
  GoalGuidance goal_;
  InformedPath informed_;
  std::unique_ptr<SearchedGuidance> guide_;
  std::function<void(double)> path_found_;
  Part drawn_ = Part::goal;
};

}  // namespace trellis
