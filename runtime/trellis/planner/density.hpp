// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>

namespace trellis {

class Guidance;

/// A density as it was once, with respect to volume in metric coordinates. Never changes, so records may share it.
class Density {
 public:
  struct Term {
    std::shared_ptr<const Density> density;
    double weight = 0.0;
  };

  Density() = default;
  Density(const Density&) = delete;
  Density& operator=(const Density&) = delete;
  virtual ~Density() = default;

  [[nodiscard]] virtual double at(View q) const = 0;
  /// Whether weighted sums of the two have a form of their own, which costs less to evaluate than its terms.
  [[nodiscard]] virtual bool akin(const Density& other) const {
    static_cast<void>(other);
    return false;
  }
  /// The weighted sum of densities that are all akin to this one.
  [[nodiscard]] virtual std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const;
};

/// What h was while it served a level's proposals: q(x) = 1/N sum over the proposals t of h_t(x), in closed form. What
/// it holds grows with the number of different densities that served, not with the number of proposals.
class DensityRecord {
 public:
  /// Counts a proposal that h has just drawn. h says what it is (Guidance::record) only where that may have changed.
  void served(const Guidance& h);
  /// Counts the proposals of another record over the same space as well.
  void append(const DensityRecord& other);
  /// Sums what is akin. The value stays the same, evaluating costs less.
  void compact();

  // What h says of itself in Guidance::record; the shares of one h add up to 1.
  void add_uniform(double share, double density);
  /// A share that falls on finitely many points.
  void add_atoms(double share) { now_.atoms += share; }
  /// A share that has no closed form.
  void add_unknown(double share) { now_.unknown += share; }
  void add(const std::shared_ptr<const Density>& density, double share);
  /// What h over another space says of itself, its densities made into ones over this space by `lift`, which gives the
  /// same object for the same density. h has no uniform part.
  using Lift = std::function<std::shared_ptr<const Density>(const std::shared_ptr<const Density>&)>;
  void add_lifted(const Guidance& h, double share, const Lift& lift);

  /// The proposals counted.
  [[nodiscard]] double total() const { return past_.total + served_; }
  /// Whether `at` and `atoms` tell all: there were proposals, and none came from a part without closed form.
  [[nodiscard]] bool exact() const { return total() > 0.0 && past_.unknown + served_ * now_.unknown == 0.0; }
  /// The mean density over the proposals; the absolutely continuous part. NaN where it is not exact.
  [[nodiscard]] double at(View q) const;
  /// The share of the proposals that is atoms; what `at` integrates to is one less this. NaN without proposals.
  [[nodiscard]] double atoms() const { return (past_.atoms + served_ * now_.atoms) / total(); }
  /// The shares that were uniform, and that had no closed form. NaN without proposals.
  [[nodiscard]] double uniform() const { return (past_.uniform + served_ * now_.uniform) / total(); }
  [[nodiscard]] double unknown() const { return (past_.unknown + served_ * now_.unknown) / total(); }
  /// What h is made of now beside its uniform share.
  [[nodiscard]] std::vector<Density::Term> now() const;
  /// The densities beside the uniform one that are evaluated.
  [[nodiscard]] std::size_t terms() const { return terms_.size(); }

 private:
  static constexpr std::uint64_t never = std::numeric_limits<std::uint64_t>::max();
  static constexpr std::size_t many_terms = 4096;

  struct Weights {
    double total = 0.0;
    double uniform = 0.0;
    double atoms = 0.0;
    double unknown = 0.0;
  };

  /// Adds what `now_` served to the past.
  void settle();
  void renew(const Guidance& h);

  double served_ = 0.0;          ///< by h as it is now
  std::uint64_t epoch_ = never;  ///< of h as it is now
  const Lift* lift_ = nullptr;   ///< while what is over another space is added
  Weights now_;                  ///< one proposal's
  std::vector<std::pair<std::uint32_t, double>> now_terms_;
  Weights past_;
  std::vector<Density::Term> terms_;  ///< weights of the past
  std::unordered_map<const Density*, std::uint32_t> places_;
  double uniform_density_ = 0.0;
  std::size_t most_terms_ = many_terms;
};

}  // namespace trellis
