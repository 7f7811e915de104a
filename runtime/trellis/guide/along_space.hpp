// SPDX-License-Identifier: GPL-3.0-or-later
// What spaces share whose first coordinates are places of robots along paths.
#pragma once

#include <cstddef>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/guide/guide.hpp>

namespace trellis {

/// A space of places along paths, then of other coordinates.
/// \param lengths  of the paths
/// \param widest   how long a path counts at most
/// \param own      the space of the other coordinates
Space space_along(const std::vector<double>& lengths, double widest, const Space& own, const std::string& name);

/// Completes an instance in such a space with what it has of its parent's: start, goals, the coordinates of a position,
/// resolution and validity of other robots. Requires its scene.
/// \param ends  of the paths: those of the goals
void complete_along(const Guide& f, const Instance& parent, const std::vector<double>& ends, Instance& instance);

/// Validity of what a configuration of S places.
/// \tparam E  the embedding: `space` is S, `places` counts the coordinates that `place` writes, and `each_piece(a, b,
///     from, to, f)` calls `f(before, after)` for the straight pieces of what a motion places, with `from` and `to` at
///     their ends, until it returns false; false: no such motion. `keeps` is false outside of S.
template <class E>
class AlongValidity final : public Validity {
 public:
  AlongValidity(std::shared_ptr<const E> embedding, std::shared_ptr<Validity> placed)
      : embedding_(std::move(embedding)),
        placed_(std::move(placed)),
        from_(embedding_->places()),
        to_(embedding_->places()) {}

  [[nodiscard]] bool state(View s) override { return embedding_->keeps(s) && placed_->state(at(s)); }
  [[nodiscard]] MotionReport motion(View a, View b) override {
    MotionReport all{true, 0, std::numeric_limits<double>::quiet_NaN()};
    const bool moves = embedding_->keeps(b) && each_piece(a, b, [&](double before, double after) {
                         const MotionReport piece = placed_->motion(from_, to_);
                         all.checks += piece.checks;
                         if (piece.valid) return true;
                         all.valid = false;
                         all.invalid_at = before + piece.invalid_at * (after - before);
                         return false;
                       });
    return moves ? all : MotionReport{false, 1, 1.0};
  }
  void certify(View a, View b, Certificate& certificate) override {
    const bool moves = embedding_->keeps(b) && each_piece(a, b, [&](double before, double after) {
                         placed_->certify(from_, to_, certificate);
                         if (!certificate.refuted_at) return true;
                         certificate.refuted_at = before + *certificate.refuted_at * (after - before);
                         return false;
                       });
    if (!moves) certificate.refuted_at = 1.0;
  }
  [[nodiscard]] double clearance(View s) override { return placed_->clearance(at(s)); }
  [[nodiscard]] const CheckCost& cost() const override { return placed_->cost(); }
  [[nodiscard]] bool spends_checks() const override { return placed_->spends_checks(); }
  [[nodiscard]] std::optional<Contact> contact(View s) override { return placed_->contact(at(s)); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View s) override { return placed_->nearest_obstacle(at(s)); }
  [[nodiscard]] std::uint64_t epoch() const override { return placed_->epoch(); }

 private:
  const Configuration& at(View s) {
    embedding_->place(s, from_);
    return from_;
  }
  template <class F>
  bool each_piece(View a, View b, const F& f) {
    return embedding_->each_piece(a, b, from_, to_, f);
  }

  std::shared_ptr<const E> embedding_;
  std::shared_ptr<Validity> placed_;
  Configuration from_;
  Configuration to_;
};

}  // namespace trellis
