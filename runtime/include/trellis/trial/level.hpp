// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <trellis/trial/trial.hpp>

namespace trellis::trial {

/// Selects a level of a strategy, which of its samples to measure, and in which space.
class Level {
 public:
  /// \param name  "root", a guide's name as "lazy" or "shrink(0.5)", the levels from it to the root as "skeleton >>
  ///     lazy", or a number
  Level(std::string name) : name_(std::move(name)) {}   // NOLINT(google-explicit-constructor): a name is a level
  Level(const char* name) : name_(name) {}              // NOLINT(google-explicit-constructor)
  Level(int number) : name_(std::to_string(number)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_expansion() const { return expansion_; }
  [[nodiscard]] bool is_lifted() const { return lifted_; }
  [[nodiscard]] bool is_mass() const { return mass_; }

  /// Selects the proposals of its h, instead of its tree.
  [[nodiscard]] Level expansion() const {
    Level changed = *this;
    changed.expansion_ = true;
    return changed;
  }
  /// Selects its samples lifted to the root's space, relative to the root's path, instead of its own space and path.
  [[nodiscard]] Level lifted() const {
    Level changed = *this;
    changed.lifted_ = true;
    return changed;
  }
  /// Selects the mass alone: how many more of its samples lie in the target than uniform ones, however they cover it.
  [[nodiscard]] Level mass() const {
    Level changed = *this;
    changed.mass_ = true;
    return changed;
  }

 private:
  std::string name_;
  bool expansion_ = false;
  bool lifted_ = false;
  bool mass_ = false;
};

/// Returns the key of the level that a test names.
/// \param runs  of one strategy
/// \param name  as of Level's constructor
/// \return LevelAccounts::key
/// \throws Error that lists the levels, or those that share the name.
std::string find_level(const std::vector<RunResult>& runs, const std::string& name);

}  // namespace trellis::trial
