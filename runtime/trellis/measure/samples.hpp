// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include <trellis/measure/frame.hpp>
#include <trellis/measure/point_tree.hpp>
#include <trellis/measure/target.hpp>

namespace trellis {

/// A set of samples made ready to be scored, on one target or on several of the same space: what does not depend on the
/// target is made once. Serves one thread at a time, as estimators leave in it what they derive from the samples.
///
/// A configuration that occurs more than once is an atom: singular against any target with a density, it carries mass
/// but no density of its own, so it stays out of the neighbour search, with all its copies, while N keeps them.
class PreparedSamples {
 public:
  /// \param samples  N configurations of the space; not sorted, may hold duplicates
  /// Throws Error for samples of another dimension than the space's or with coordinates that are not finite.
  PreparedSamples(const Space& space, const Configurations& samples);

  [[nodiscard]] const Space& space() const { return space_; }
  [[nodiscard]] const measure::Frame& frame() const { return frame_; }
  /// N, those outside of C among them.
  [[nodiscard]] std::size_t total() const { return total_; }
  /// Samples within C that occur once, row by row in metric coordinates, in the order of these.
  [[nodiscard]] const std::vector<double>& all() const { return all_; }
  [[nodiscard]] const measure::PointTree& tree() const { return tree_; }
  /// Each configuration that occurs more than once, once, and how often it does.
  [[nodiscard]] const std::vector<double>& atoms() const { return atoms_; }
  [[nodiscard]] const std::vector<std::size_t>& copies() const { return copies_; }
  [[nodiscard]] const measure::PointTree& atom_tree() const { return atom_tree_; }
  /// The configurations of `all`, then those of `atoms`.
  [[nodiscard]] const Configurations& distinct() const { return distinct_; }

  /// A number that follows from the samples alone: made when it is first asked for by this name.
  double remembered(const std::string& name, const std::function<double()>& make) const;

 private:
  Space space_;
  measure::Frame frame_;
  std::size_t total_ = 0;
  std::vector<double> all_, atoms_;
  std::vector<std::size_t> copies_;
  Configurations distinct_;
  measure::PointTree tree_, atom_tree_;
  mutable std::map<std::string, double> numbers_;
};

namespace measure {

/// What of a set of samples lies in a target.
struct InTarget {
  std::size_t count = 0;       ///< n, copies counted
  std::vector<double> inside;  ///< samples in A that occur once, row by row in metric coordinates
  /// Of a target with a path: where along it the samples in A lie, copies counted; first those that occur once.
  std::vector<double> arcs;
};
InTarget in_target(const Target& target, const PreparedSamples& samples);

}  // namespace measure

}  // namespace trellis
