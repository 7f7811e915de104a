// SPDX-License-Identifier: MIT-0
#pragma once

#include <pybind11/pybind11.h>

#include <functional>

#include <dsl/language/core/program.hpp>
#include <trellis/scene/scene.hpp>

/// What the language needs of the rest of the module.
struct LanguagePlace {
  /// Calls a function in a thread of its own without the GIL, while this one handles signals.
  std::function<void(const std::function<void()>&)> interruptibly;
  /// Whether the calls that are running are to stop.
  std::function<bool()> stopped;
  /// The object in Python for a problem, and for an experiment.
  std::function<pybind11::object(trellis::Problem)> problem;
  std::function<pybind11::object(trellis::dsl::Program)> experiment;
  /// The problem of an object in Python, nullptr for another one.
  std::function<const trellis::Problem*(pybind11::handle)> problem_of;
};

/// Adds the words of the language to the module, which has the classes Strategy, Guide and Problem already.
void add_language(pybind11::module_& module, LanguagePlace place);
