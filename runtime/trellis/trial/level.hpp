// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <utility>
#include <vector>

#include <trellis/trial/trial.hpp>

namespace trellis::trial {

/// A level of a strategy as a test names it, and which of its samples are meant, in which space.
class Level {
 public:
  /// "root", a guide's name as "lazy" or "shrink(0.5)", the way from it to the root as "skeleton >> lazy", or a number.
  Level(std::string name) : name_(std::move(name)) {}   // NOLINT(google-explicit-constructor): a name is a level
  Level(const char* name) : name_(name) {}              // NOLINT(google-explicit-constructor)
  Level(int number) : name_(std::to_string(number)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] const std::string& name() const { return name_; }
  [[nodiscard]] bool is_expansion() const { return expansion_; }
  [[nodiscard]] bool is_lifted() const { return lifted_; }

  /// What its h proposed, instead of its tree.
  [[nodiscard]] Level expansion() const {
    Level changed = *this;
    changed.expansion_ = true;
    return changed;
  }
  /// Its samples lifted to the root's space, on the root's path, instead of its own space and path.
  [[nodiscard]] Level lifted() const {
    Level changed = *this;
    changed.lifted_ = true;
    return changed;
  }

 private:
  std::string name_;
  bool expansion_ = false;
  bool lifted_ = false;
};

/// The key of the level that a test means. Throws Error with the levels that there are, or that share the name.
std::string find_level(const std::vector<RunResult>& runs, const std::string& name);

}  // namespace trellis::trial
