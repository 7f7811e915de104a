// SPDX-License-Identifier: GPL-3.0-or-later
// Validity in spaces whose world differs from C's and may change.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// The instance's robot in a replaceable world. Makes collision checks even if the parent presumes validity.
class ChangingWorld final : public Validity {
 public:
  ChangingWorld(Instance parent, std::shared_ptr<const Scene> scene) : parent_(std::move(parent)) {
    set(std::move(scene));
  }

  void set(std::shared_ptr<const Scene> scene) {
    scene_ = std::move(scene);
    validity_ = parent_.validity_in(scene_);
    ++epoch_;
  }
  [[nodiscard]] const std::shared_ptr<const Scene>& scene() const { return scene_; }

  [[nodiscard]] bool state(View q) override { return validity_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override { return validity_->motion(a, b); }
  [[nodiscard]] const CheckCost& cost() const override { return validity_->cost(); }
  [[nodiscard]] double clearance(View q) override { return validity_->clearance(q); }
  /// The contact of the robot with this world.
  [[nodiscard]] std::optional<Contact> contact(View q) override { return validity_->contact(q); }
  [[nodiscard]] std::optional<Proximity> nearest_obstacle(View q) override { return validity_->nearest_obstacle(q); }
  [[nodiscard]] double invalid_radius(View q) override { return validity_->invalid_radius(q); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }

 private:
  Instance parent_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<Validity> validity_;
  std::uint64_t epoch_ = 0;
};

}  // namespace trellis
