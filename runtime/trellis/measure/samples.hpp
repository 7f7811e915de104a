// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include <trellis/measure/frame.hpp>
#include <trellis/measure/target.hpp>
#include <trellis/space/nearest.hpp>

namespace trellis {

/// A set of samples prepared for scoring, on one target or on several of the same space: stores the results that do not
/// depend on the target.
///
/// A configuration that occurs more than once is an atom: singular relative to any target with a density, it has mass
/// but no density of its own. The neighbour search therefore omits it with all its copies, while N includes them.
class PreparedSamples {
 public:
  /// \param samples  N configurations of the space; not sorted, may contain duplicates
  /// \throws Error for samples of another dimension than the space's or with coordinates that are not finite.
  PreparedSamples(const Space& space, const Configurations& samples);

  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const measure::Frame& frame() const { return frame_; }
  /// Returns N, including samples outside of C.
  [[nodiscard]] std::size_t total() const { return total_; }
  /// Returns the samples within C that occur once, row by row in metric coordinates, sorted.
  [[nodiscard]] const std::vector<double>& all() const { return all_; }
  [[nodiscard]] const NearestIndex& tree() const { return tree_; }
  /// Returns each configuration that occurs more than once, and its multiplicity.
  [[nodiscard]] const std::vector<double>& atoms() const { return atoms_; }
  [[nodiscard]] const std::vector<std::size_t>& copies() const { return copies_; }
  [[nodiscard]] const NearestIndex& atom_tree() const { return atom_tree_; }
  /// Returns the configurations of `all`, then those of `atoms`.
  [[nodiscard]] const Configurations& distinct() const { return distinct_; }

 private:
  Space space_;
  measure::Frame frame_;
  std::size_t total_ = 0;
  std::vector<double> all_, atoms_;
  std::vector<std::size_t> copies_;
  Configurations distinct_;
  NearestIndex tree_, atom_tree_;
};

namespace measure {

/// The part of a set of samples that lies in a target.
struct InTarget {
  std::size_t count = 0;       ///< n, copies counted
  std::vector<double> inside;  ///< samples in A that occur once, row by row in metric coordinates
  /// Of a target with a path: the arc length of each sample in A, copies included; first those that occur once.
  std::vector<double> arcs;
};
InTarget in_target(const Target& target, const PreparedSamples& samples);

}  // namespace measure

}  // namespace trellis
