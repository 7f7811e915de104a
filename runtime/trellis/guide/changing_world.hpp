// SPDX-License-Identifier: GPL-3.0-or-later
// Validity in spaces whose world is not C's, and need not stay what it is.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <utility>

#include <trellis/instance/instance.hpp>

namespace trellis {

/// The instance's robot in a world that can be exchanged. Checked for real, whatever the parent presumes.
class ChangingWorld final : public Validity {
 public:
  ChangingWorld(const Instance& parent, World world)
      : robot_(parent.scene->robot),
        space_(parent.space),
        collision_(parent.collision),
        resolution_(parent.resolution),
        motion_model_(parent.motion_model) {
    set(std::move(world));
  }

  void set(World world) {
    scene_ = std::make_shared<Scene>(Scene{std::move(world), robot_});
    validity_ = make_validity(collision_, scene_, space_, resolution_, motion_model_);
    checker_.reset();
    ++epoch_;
  }
  [[nodiscard]] const std::shared_ptr<const Scene>& scene() const { return scene_; }

  [[nodiscard]] bool state(View q) override { return validity_->state(q); }
  [[nodiscard]] MotionReport motion(View a, View b) override { return validity_->motion(a, b); }
  [[nodiscard]] double clearance(View q) override { return validity_->clearance(q); }
  /// What the robot touches in this world; none where it is valid.
  [[nodiscard]] std::optional<Contact> contact(View q) {
    if (!checker_) checker_ = make_checker(collision_, scene_, space_, resolution_);
    return checker_->contact(q);
  }
  [[nodiscard]] std::uint64_t epoch() const override { return epoch_; }

 private:
  Robot robot_;
  Space space_;
  std::string collision_;
  double resolution_;
  std::shared_ptr<const MotionModel> motion_model_;
  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<Validity> validity_;
  std::unique_ptr<Checker> checker_;  ///< of contacts, made when one is asked for
  std::uint64_t epoch_ = 0;
};

}  // namespace trellis
