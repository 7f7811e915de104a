// SPDX-License-Identifier: MIT-0
#pragma once

#include <pybind11/pybind11.h>

#include <cstdint>
#include <memory>

#include <trellis/strategy/sampler.hpp>

/// A sampler for one thread of Python at a time. It releases the GIL while levels below are searched, and Ctrl-C ends a
/// draw.
class PythonSampler {
 public:
  PythonSampler(const trellis::GuideSpec& guide, const trellis::Problem& problem, std::uint64_t seed,
                trellis::SamplerOptions options);
  PythonSampler(const PythonSampler&) = delete;
  PythonSampler& operator=(const PythonSampler&) = delete;

  /// Adds the class to the module.
  static void add_to(pybind11::module_& module);

 private:
  struct Signals;

  /// Calls a function of the sampler without the GIL. \throws what a handler of a signal threw meanwhile
  template <class Body>
  auto released(const Body& body);

  std::shared_ptr<Signals> signals_;
  trellis::Sampler sampler_;
};
