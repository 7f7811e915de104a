// SPDX-License-Identifier: GPL-3.0-or-later
// Heuristics over S, lifted to C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>

namespace trellis {

/// f of configurations, and its fibres; see Guide.
class Projection {
 public:
  Projection() = default;
  virtual ~Projection() = default;
  virtual void project(View q, MutableView s) const = 0;
  virtual void lift(View s, Stream& stream, MutableView q) const = 0;
  /// Whether the density on the fibre is known.
  [[nodiscard]] virtual bool closed_form() const = 0;
  /// As Guide::log_fibre_density; minus infinity outside of C.
  [[nodiscard]] virtual double log_fibre_density(View q) const = 0;
  /// Whether f never increases distances, each in its space's metric. Lengths in S are then lower bounds of lengths in
  /// C.
  [[nodiscard]] virtual bool contracts() const { return false; }
  /// A path in S from f(start) to f(goal), lifted to C; empty if fibres can only be sampled.
  [[nodiscard]] virtual Configurations lifted(const Configurations& path, View start, View goal) const {
    static_cast<void>(path);
    static_cast<void>(start);
    static_cast<void>(goal);
    return {};
  }
  /// The density over f(C) at s of the samples of a density over S. It differs from `density` if `lift` maps the part
  /// of S outside of f(C) into f(C).
  [[nodiscard]] virtual double folded(View s, const std::function<double(View)>& density) const { return density(s); }

 protected:
  Projection(const Projection&) = default;
  Projection& operator=(const Projection&) = default;
};

/// A density over S, lifted to C.
class LiftedDensity final : public Density {
 public:
  /// \param dimension  of S
  LiftedDensity(std::shared_ptr<const Projection> projection, std::size_t dimension,
                std::shared_ptr<const Density> density);

  [[nodiscard]] double at(View q) const override;
  [[nodiscard]] bool mergeable(const Density& other) const override;
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override;

 private:
  std::shared_ptr<const Projection> projection_;
  std::size_t dimension_;
  std::shared_ptr<const Density> density_;
};

/// A heuristic over S that guides a planner in C: samples and densities are lifted, and the planner's outcomes and
/// queries are projected to S. Nodes keep their rows in the planner's Search.
class LiftedHeuristic final : public Heuristic {
 public:
  /// What the single points of S are to which h gives probability: without a density over C, so that h has none; or
  /// atoms of C.
  enum class Points : std::uint8_t { unknown, atoms };

  /// \param start,  goal  in C: the ends of the guiding path
  /// \param source  name of the only source of samples; empty: the sources of h over S
  LiftedHeuristic(std::shared_ptr<const Projection> projection, const Space& s, std::unique_ptr<Heuristic> inner,
                  Configuration start, Configuration goal, Points points, std::string source = {});

  void select_tree(TreeSide side) override { inner_->select_tree(side); }
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override { return inner_->vertex(); }
  std::uint32_t draw_control(Stream& stream, const ControlQuery& query, MutableView control) override;
  [[nodiscard]] bool worth_connecting(View from, View to) const override;
  /// 0 if f does not contract: lengths in S then do not bound those in C.
  [[nodiscard]] double progress() const override { return projection_->contracts() ? inner_->progress() : 0.0; }
  [[nodiscard]] double connected() const override { return projection_->contracts() ? inner_->connected() : 0.0; }
  [[nodiscard]] std::optional<double> edge_factor(View a, View b) const override;
  void restart() override { inner_->restart(); }
  /// If f contracts, a path of C is at most as long in S. Otherwise its length has no meaning in S.
  void found(double length) override {
    if (projection_->contracts()) inner_->found(length);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return inner_->epoch(); }
  void record(DensityRecord& record, double share) const override;
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override {
    return source_.empty() ? inner_->sources() : std::vector{source_};
  }
  [[nodiscard]] bool stale() const override { return inner_->stale(); }
  [[nodiscard]] Configurations lifted_path() const override {
    return projection_->lifted(inner_->lifted_path(), start_, goal_);
  }

 private:
  /// The lift of a density; the same object for the same density, as long as it is among the last of many.
  [[nodiscard]] std::shared_ptr<const Density> lifted(const std::shared_ptr<const Density>& density) const;

  std::shared_ptr<const Projection> projection_;
  std::unique_ptr<Heuristic> inner_;  ///< over S
  Configuration start_;
  Configuration goal_;
  Points points_;
  std::string source_;
  std::shared_ptr<const Density> uniform_;  ///< uniform on S, lifted
  mutable std::vector<std::pair<std::shared_ptr<const Density>, std::shared_ptr<const Density>>> lifted_;
  // Projected views; members, to avoid allocation in `sample` and `observe`.
  mutable Configuration proposal_;
  mutable Configuration near_;
  Configuration added_;
  Configuration blocked_;
};

}  // namespace trellis
