// SPDX-License-Identifier: GPL-3.0-or-later
// Validity in spaces whose world differs from C's and may change.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <utility>

#include <trellis/instance/forwarding_validity.hpp>

namespace trellis {

/// The instance's robot in a replaceable world. Makes collision checks even if the parent presumes validity.
class ChangingWorld final : public ForwardingValidity<> {
 public:
  ChangingWorld(Instance parent, std::shared_ptr<const Scene> scene)
      : ForwardingValidity(nullptr), parent_(std::move(parent)) {
    set(std::move(scene));
  }

  void set(std::shared_ptr<const Scene> scene) {
    scene_ = std::move(scene);
    inner_ = parent_.validity_in(scene_);
    ++epoch_;
  }
  [[nodiscard]] const std::shared_ptr<const Scene>& scene() const { return scene_; }

  [[nodiscard]] bool state(View q) override { return inner_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override { return inner_->motion(a, b); }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }

 private:
  Instance parent_;
  std::shared_ptr<const Scene> scene_;
  std::uint64_t epoch_ = 0;
};

}  // namespace trellis
