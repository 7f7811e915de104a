// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <trellis/trial/trial.hpp>

namespace trellis::trial {

/// A cost that a run counts.
enum class Quantity : std::uint8_t { none, validity_checks, motion_checks, proposals, nodes };
/// "validity checks".
/// \param quantity  a value of the enumeration
/// \throws Fault for another value
std::string_view to_string(Quantity quantity);

/// A criterion for a statistic of a trial: the number or the other trial to compare with, the confidence, and the
/// quantity.
class Criterion {
 public:
  enum class Kind : std::uint8_t { at_least, at_most, below, above, exactly };

  /// \param kind  how a statistic is compared with the value
  /// \param value  in the unit of what the matcher compares: a share, a number of checks, metres or nats
  /// \throws Error for a number that is not finite
  Criterion(Kind kind, double value);
  /// Requires less or more than the other trial, paired by seed.
  /// \param kind  `below` or `above`
  /// \param other  on the same seeds; its runs start when the criterion is checked
  /// \throws Fault for another kind
  Criterion(Kind kind, Trial other);

  [[nodiscard]] Kind kind() const { return kind_; }
  [[nodiscard]] double value() const { return value_; }
  [[nodiscard]] const std::optional<Trial>& other() const { return other_; }
  [[nodiscard]] double margin() const { return margin_; }
  [[nodiscard]] Quantity quantity() const { return quantity_; }
  [[nodiscard]] const std::string& level() const { return level_; }  ///< "": all levels together
  /// Returns the requested confidence; none where the test sets no confidence.
  [[nodiscard]] const std::optional<double>& asked_confidence() const { return confidence_; }
  [[nodiscard]] double confidence() const { return confidence_.value_or(default_confidence); }

  /// Of a comparison: requires at least this margin.
  /// \param margin  at least 0: of costs a share of the other's cost (0.2: 20 % less), of efficiencies nats
  /// \throws Error without another trial, or for a negative margin
  [[nodiscard]] Criterion by(double margin) const;
  /// Sets the confidence of a statement about all seeds.
  /// \param confidence  in (0.5, 1)
  /// \throws Error for another number
  [[nodiscard]] Criterion with_confidence(double confidence) const;
  /// Sets the cost that is compared.
  /// \param quantity  for `spends`; the other matchers take none
  [[nodiscard]] Criterion of(Quantity quantity) const;
  [[nodiscard]] Criterion validity_checks() const { return of(Quantity::validity_checks); }
  [[nodiscard]] Criterion motion_checks() const { return of(Quantity::motion_checks); }
  [[nodiscard]] Criterion proposals() const { return of(Quantity::proposals); }
  [[nodiscard]] Criterion nodes() const { return of(Quantity::nodes); }
  /// Restricts the cost to one level.
  /// \param level  as of Level; "": all levels together
  [[nodiscard]] Criterion in_level(std::string level) const;

  /// Whether an upper confidence bound can satisfy it (less is better), and whether a lower one can.
  [[nodiscard]] bool from_above() const { return kind_ == Kind::at_most || kind_ == Kind::below; }
  /// Whether a value satisfies it; for criteria with a number only.
  /// \param figure  in the unit of value()
  [[nodiscard]] bool met_by(double figure) const;
  /// "at least 0.95", "less than planner", "more than planner".
  [[nodiscard]] std::string text() const;

  static constexpr double default_confidence = 0.95;

 private:
  Kind kind_;
  double value_ = 0.0;
  std::optional<Trial> other_;
  double margin_ = 0.0;
  std::optional<double> confidence_;
  Quantity quantity_ = Quantity::none;
  std::string level_;
};

/// "at least".
/// \param kind  a value of the enumeration
/// \throws Fault for another value
std::string_view to_string(Criterion::Kind kind);

/// Requires that a statistic is at least x.
/// \param x  finite, in the unit of the statistic
/// \throws Error for another number
inline Criterion at_least(double x) { return {Criterion::Kind::at_least, x}; }
/// Requires that a statistic is at most x.
/// \param x  finite, in the unit of the statistic
/// \throws Error for another number
inline Criterion at_most(double x) { return {Criterion::Kind::at_most, x}; }
/// Requires that a statistic is less than x.
/// \param x  finite, in the unit of the statistic
/// \throws Error for another number
inline Criterion below(double x) { return {Criterion::Kind::below, x}; }
/// Requires that a statistic is greater than x.
/// \param x  finite, in the unit of the statistic
/// \throws Error for another number
inline Criterion above(double x) { return {Criterion::Kind::above, x}; }
/// Requires that a statistic equals x.
/// \param x  finite, in the unit of the statistic
/// \throws Error for another number
inline Criterion exactly(double x) { return {Criterion::Kind::exactly, x}; }
/// Requires less than another trial, paired by seed.
/// \param other  on the same seeds
inline Criterion below(Trial other) { return {Criterion::Kind::below, std::move(other)}; }
/// Requires more than another trial, paired by seed.
/// \param other  on the same seeds
inline Criterion above(Trial other) { return {Criterion::Kind::above, std::move(other)}; }

}  // namespace trellis::trial
