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
  std::size_t leaf = 20;   ///< samples that a leaf holds at least
  std::uint64_t seed = 1;  ///< the same samples, settings and seed give the same forest, on any number of threads
};

/// A random forest that regresses a number from a row of numbers.
class Forest {
 public:
  /// \param rows    of `columns` numbers each, finite
  /// \param values  one for each row, finite
  static Forest train(const std::vector<double>& rows, std::size_t columns, const std::vector<double>& values,
                      const ForestSettings& settings);
  /// What `bytes` made. Throws Error for anything else.
  static Forest from_bytes(const std::string& bytes, std::size_t columns);

  ~Forest();
  Forest(Forest&&) noexcept;
  Forest& operator=(Forest&&) noexcept;

  /// The same on every machine.
  [[nodiscard]] std::string bytes() const;
  /// The mean of the trees' leaves that a row falls into.
  [[nodiscard]] double operator()(std::span<const double> row) const;

 private:
  struct Trees;
  explicit Forest(std::unique_ptr<const Trees> trees);
  std::unique_ptr<const Trees> trees_;
};

}  // namespace trellis
