// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace trellis {

struct ForestSettings {
  std::size_t trees = 40;
  std::size_t leaf = 20;   ///< least number of samples in a leaf
  std::uint64_t seed = 1;  ///< equal samples, settings and seeds give equal forests, on any number of threads
};

/// A random forest for the regression of a number on a row of numbers.
class Forest {
 public:
  /// \param rows    of `columns` numbers each, finite
  /// \param values  one for each row, finite
  static Forest train(const std::vector<double>& rows, std::size_t columns, const std::vector<double>& values,
                      const ForestSettings& settings);
  /// Reads the result of `bytes`. \throws Error for other input.
  static Forest from_bytes(const std::string& bytes, std::size_t columns);

  ~Forest();
  Forest(Forest&&) noexcept;
  Forest& operator=(Forest&&) noexcept;

  /// Serialises the forest; the result is the same on every machine.
  [[nodiscard]] std::string bytes() const;
  /// Returns the mean of the leaves of all trees for a row.
  [[nodiscard]] double operator()(std::span<const double> row) const;

 private:
  struct Trees;
  explicit Forest(std::unique_ptr<const Trees> trees);
  std::unique_ptr<const Trees> trees_;
};

}  // namespace trellis
