// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <limits>
#include <memory>
#include <unordered_map>
#include <utility>
#include <vector>

#include <trellis/base/configurations.hpp>

namespace trellis {

class Guidance;

/// A snapshot of a density with respect to volume in metric coordinates. Immutable, so records may share it.
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

  /// Returns the density at q, per volume in metric coordinates.
  /// \param q  of the space that the density is over; another size is undefined behaviour
  [[nodiscard]] virtual double at(View q) const = 0;
  /// Whether a weighted sum of the two densities has a closed form that costs less to evaluate than its terms.
  /// \param other  over the same space
  [[nodiscard]] virtual bool mergeable(const Density& other) const {
    static_cast<void>(other);
    return false;
  }
  /// The weighted sum of densities. Requires that each of them can be merged with this one.
  /// \param terms  at least one, over the same space; this density may be among them
  /// \throws Fault by default: for a density that merges with no other
  [[nodiscard]] virtual std::shared_ptr<const Density> sum(const std::vector<Term>& terms) const;
};

/// The distribution from which a search drew its proposals: q(x) = 1/N sum over the proposals t of h_t(x), in closed
/// form. Its memory grows with the number of distinct densities, not with the number of proposals.
class DensityRecord {
 public:
  /// From now on counts nothing: then the record has no closed form.
  void disable() { enabled_ = false; }
  /// Counts a proposal that h has just drawn. Calls Guidance::record only if the distribution of h may have changed.
  /// \param h  the guidance that drew it: the same for all proposals of a search
  void served(const Guidance& h);
  /// Adds the proposals of another record over the same space.
  /// \param other  unchanged
  void append(const DensityRecord& other);
  /// Merges terms where their sum has a closed form. The value stays the same; it costs less to evaluate.
  void compact();

  // Guidance::record calls the following functions. The shares of one h add up to 1.
  /// Adds a share that is uniform over the space.
  /// \param share  of this distribution in h, in [0, 1]
  /// \param density  1 by the volume of the space in metric coordinates
  void add_uniform(double share, double density);
  /// Adds a share that falls on finitely many points.
  /// \param share  of this distribution in h, in [0, 1]
  void add_atoms(double share) { now_.atoms += share; }
  /// Adds a share without closed form.
  /// \param share  of this distribution in h, in [0, 1]
  void add_unknown(double share) { now_.unknown += share; }
  /// Adds a share with a density of its own. The same pointer is the same density.
  /// \param density  not nullptr; the record shares its ownership
  /// \param share  of this distribution in h, in [0, 1]; 0 adds nothing
  void add(const std::shared_ptr<const Density>& density, double share);

  /// The number of proposals counted.
  [[nodiscard]] double total() const { return past_.total + served_; }
  /// Whether the record has a closed form: it counts at least one proposal, and no share lacks a closed form.
  [[nodiscard]] bool exact() const { return total() > 0.0 && past_.unknown + served_ * now_.unknown == 0.0; }
  /// The mean density over the proposals at q, absolutely continuous part only. NaN if not `exact`.
  /// \param q  of the space that the densities are over, which is not checked
  [[nodiscard]] double at(View q) const;
  /// The share of the proposals that fell on atoms. `at` integrates to 1 minus this share. NaN without proposals.
  [[nodiscard]] double atoms() const { return (past_.atoms + served_ * now_.atoms) / total(); }
  /// The share of uniform proposals, and the share without closed form. NaN without proposals.
  [[nodiscard]] double uniform() const { return (past_.uniform + served_ * now_.uniform) / total(); }
  [[nodiscard]] double unknown() const { return (past_.unknown + served_ * now_.unknown) / total(); }
  /// The terms of the current distribution, without its uniform share.
  [[nodiscard]] std::vector<Density::Term> now() const;
  /// The number of stored densities, without the uniform one.
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

  /// Adds the proposals counted since the last change of the distribution to `past_`.
  void flush();
  void renew(const Guidance& h);

  bool enabled_ = true;
  double served_ = 0.0;          ///< proposals drawn from the current distribution
  std::uint64_t epoch_ = never;  ///< of the current distribution
  Weights now_;                  ///< of one proposal
  std::vector<std::pair<std::uint32_t, double>> now_terms_;
  Weights past_;
  std::vector<Density::Term> terms_;  ///< with their weights in `past_`
  std::unordered_map<const Density*, std::uint32_t> places_;
  double uniform_density_ = 0.0;
  std::size_t most_terms_ = many_terms;
};

}  // namespace trellis
