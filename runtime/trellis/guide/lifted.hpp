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

/// A heuristic over S that guides a planner in C: samples are lifted, and the planner's outcomes and queries are
/// projected to S. Nodes keep their rows in the planner's Search.
class ProjectedHeuristic : public Heuristic {
 public:
  /// \param dimension  of S
  /// \param start,  goal  in C: the ends of the guiding path
  ProjectedHeuristic(std::shared_ptr<const Projection> projection, std::size_t dimension, Configuration start,
                     Configuration goal);

  void select_tree(TreeSide side) override { inner().select_tree(side); }
  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] std::uint32_t vertex() const override { return inner().vertex(); }
  [[nodiscard]] bool worth_connecting(View from, View to) const override;
  /// 0 if f does not contract: lengths in S then do not bound those in C.
  [[nodiscard]] double progress() const override { return projection_->contracts() ? inner().progress() : 0.0; }
  [[nodiscard]] double connected() const override { return projection_->contracts() ? inner().connected() : 0.0; }
  [[nodiscard]] double edge_factor(View a, View b) const override;
  void restart() override { inner().restart(); }
  /// If f contracts, a path of C is at most as long in S. Otherwise its length has no meaning in S.
  void found(double length) override {
    if (projection_->contracts()) inner().found(length);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return inner().epoch(); }
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return inner().sources(); }
  [[nodiscard]] bool stale() const override { return inner().stale(); }
  [[nodiscard]] Configurations lifted_path() const override {
    return projection_->lifted(inner().lifted_path(), start_, goal_);
  }

 protected:
  /// The heuristic over S.
  [[nodiscard]] virtual Heuristic& inner() const = 0;
  [[nodiscard]] std::size_t dimension() const { return proposal_.size(); }
  [[nodiscard]] const std::shared_ptr<const Projection>& projection() const { return projection_; }

 private:
  std::shared_ptr<const Projection> projection_;
  Configuration start_;
  Configuration goal_;
  // Projected views; members, to avoid allocation in `sample` and `observe`.
  mutable Configuration proposal_;
  mutable Configuration near_;
  Configuration added_;
  Configuration blocked_;
};

/// A heuristic over S whose samples are lifted to C.
class LiftedHeuristic final : public ProjectedHeuristic {
 public:
  /// \param start,  goal  in C: the ends of the guiding path
  LiftedHeuristic(std::string source, std::shared_ptr<const Projection> projection, const Space& s,
                  std::unique_ptr<Heuristic> inner, Configuration start, Configuration goal);

  Source sample(Stream& stream, MutableView out) override {
    ProjectedHeuristic::sample(stream, out);
    return 0;
  }
  void record(DensityRecord& record, double share) const override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }

 protected:
  [[nodiscard]] Heuristic& inner() const override { return *inner_; }

 private:
  std::string source_;
  std::unique_ptr<Heuristic> inner_;
  std::shared_ptr<const Density> uniform_;  ///< uniform on S, lifted
  mutable Configuration s_;                 ///< scratch
  /// Densities of inner_ at the last `record`, each with its lift.
  mutable std::vector<std::pair<std::shared_ptr<const Density>, std::shared_ptr<const Density>>> lifted_;
};

}  // namespace trellis
