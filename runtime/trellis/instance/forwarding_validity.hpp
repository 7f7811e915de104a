// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// A validity over another one of the same space. A derived class decides which configurations and motions are valid,
/// and what another thread may ask; every other question is answered by the inner validity.
/// \tparam Base  Validity, or a class derived from it
template <class Base = Validity>
class ForwardingValidity : public Base {
 public:
  explicit ForwardingValidity(std::shared_ptr<Validity> inner) : inner_(std::move(inner)) {}

  [[nodiscard]] double clearance(View q) override { return inner_->clearance(q); }
  [[nodiscard]] bool spends_checks() const override { return inner_->spends_checks(); }
  [[nodiscard]] bool needed(View q) override { return inner_->needed(q); }
  [[nodiscard]] std::optional<Contact> contact(View q) override { return inner_->contact(q); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) override { return inner_->nearest_obstacle(q); }
  [[nodiscard]] std::shared_ptr<Validity> checking() const override { return trellis::checking(inner_); }
  [[nodiscard]] std::uint64_t epoch() const override { return inner_->epoch(); }
  [[nodiscard]] double effort_factor(View a, View b) const override { return inner_->effort_factor(a, b); }
  [[nodiscard]] std::optional<double> excluded(View a, View b) override { return inner_->excluded(a, b); }
  [[nodiscard]] const CheckCost& cost() const override { return inner_->cost(); }
  void expect_guided(bool guided) override { inner_->expect_guided(guided); }
  [[nodiscard]] double invalid_radius(View q) override { return inner_->invalid_radius(q); }

 protected:
  std::shared_ptr<Validity> inner_;
};

}  // namespace trellis
