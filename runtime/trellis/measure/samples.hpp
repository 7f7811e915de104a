// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/measure/frame.hpp>
#include <trellis/measure/target.hpp>

namespace trellis::measure {

/// A set of samples made ready for estimators, in metric coordinates, row by row. A configuration that occurs more
/// than once is an atom: singular against any target with a density, it carries mass but no density of its own, so it
/// stays out of the neighbour search, with all its copies, while N keeps them.
struct SampleSet {
  std::size_t total = 0;            ///< N
  std::size_t in_target = 0;        ///< n: samples in A, copies counted
  std::vector<double> all;          ///< samples within C that occur once
  std::vector<double> inside;       ///< those of them that lie in A
  std::vector<double> atoms;        ///< each configuration that occurs more than once, once
  std::vector<std::size_t> copies;  ///< how often each of the atoms occurs
  std::vector<double> arcs;         ///< of a target with a path: where along it the samples in A lie, copies counted
};

/// Throws Error for samples of another dimension than the target's space or with coordinates that are not finite.
SampleSet prepare(const Target& target, const Frame& frame, const Configurations& samples);

}  // namespace trellis::measure
