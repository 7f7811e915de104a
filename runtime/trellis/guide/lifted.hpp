// SPDX-License-Identifier: GPL-3.0-or-later
// What is drawn in S and lifted to C.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>

namespace trellis {

/// f of configurations, and its fibres: see Guide.
class Projection {
 public:
  Projection() = default;
  virtual ~Projection() = default;
  virtual void project(View q, MutableView s) const = 0;
  virtual void lift(View s, Stream& stream, MutableView q) const = 0;
  /// Whether the fibre's density is known.
  [[nodiscard]] virtual bool closed_form() const = 0;
  /// As Guide's; minus infinity outside of C.
  [[nodiscard]] virtual double log_fibre_density(View q) const = 0;

 protected:
  Projection(const Projection&) = default;
  Projection& operator=(const Projection&) = default;
};

/// A density over S, lifted: with the fibre's density on it.
class LiftedDensity final : public Density {
 public:
  /// \param dimension  of S
  LiftedDensity(std::shared_ptr<const Projection> projection, std::size_t dimension,
                std::shared_ptr<const Density> density);

  [[nodiscard]] double at(View q) const override;
  [[nodiscard]] bool akin(const Density& other) const override;
  [[nodiscard]] std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const override;

 private:
  std::shared_ptr<const Projection> projection_;
  std::size_t dimension_;
  std::shared_ptr<const Density> density_;
};

/// A heuristic over S whose draws are lifted to C.
class LiftedHeuristic final : public Heuristic {
 public:
  LiftedHeuristic(std::string source, std::shared_ptr<const Projection> projection, const Space& s,
                  std::unique_ptr<Heuristic> inner);

  Source sample(Stream& stream, MutableView out) override;
  [[nodiscard]] double density(View q) const override;
  [[nodiscard]] double atom_mass() const override { return inner_->atom_mass(); }
  [[nodiscard]] std::uint64_t epoch() const override { return inner_->epoch(); }
  void record(DensityRecord& record, double share) const override;
  void observe(const Outcome& outcome, bool mine) override;
  [[nodiscard]] std::vector<std::string> sources() const override { return {source_}; }
  [[nodiscard]] bool stale() const override { return inner_->stale(); }

 private:
  std::string source_;
  std::shared_ptr<const Projection> projection_;
  std::unique_ptr<Heuristic> inner_;
  std::shared_ptr<const Density> uniform_;  ///< on S, lifted
  mutable Configuration s_;                 ///< scratch
  /// What inner_ was made of when it was recorded last, and the same lifted.
  mutable std::vector<std::pair<std::shared_ptr<const Density>, std::shared_ptr<const Density>>> lifted_;
};

}  // namespace trellis
