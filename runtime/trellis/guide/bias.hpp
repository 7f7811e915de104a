// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by guides with S = {0}: h is a function of the parent's instance.
#pragma once

#include <memory>
#include <string>
#include <utility>

#include <trellis/guide/guide.hpp>

namespace trellis {

/// A guide with S = {0} whose h is a function of the parent's instance.
template <class Make, class Check>
class Bias final : public SamplingGuide {
 public:
  Bias(Make make, Check check) : make_(std::move(make)), check_(std::move(check)) {}
  void prepare(const Instance& parent) override { check_(parent); }
  std::unique_ptr<Heuristic> heuristic(Instance& parent, const Instance*, const Solution*) override {
    return make_(parent);
  }

 private:
  Make make_;
  Check check_;
};

/// \param make  returns h for an instance
/// \param check  throws Error if the guide does not apply to an instance
template <class Make, class Check>
std::unique_ptr<Guide> bias(Make make, Check check) {
  return std::make_unique<Bias<Make, Check>>(std::move(make), std::move(check));
}
template <class Make>
std::unique_ptr<Guide> bias(Make make) {
  return bias(std::move(make), [](const Instance&) {});
}

/// A kind of guide with S = {0}.
/// \param feedback  description of what h does in `observe`
GuideKind sampling_kind(const Component& component, std::unique_ptr<Guide> (*make)(const Options&), std::string h,
                        std::string density, bool closed_form, std::string feedback = "none");

}  // namespace trellis
