// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace trellis {

/// One configuration that owns its coordinates: raw values in the order of the space's axes.
using Configuration = std::vector<double>;
/// A configuration that another object owns.
using View = std::span<const double>;
using MutableView = std::span<double>;

/// Configurations of one dimension in one contiguous block, row by row. Rows never change once pushed. The next push
/// invalidates views.
class Configurations {
 public:
  Configurations() = default;
  explicit Configurations(std::size_t dimension) : dimension_(dimension) {}

  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  [[nodiscard]] std::size_t size() const { return dimension_ == 0 ? 0 : data_.size() / dimension_; }
  [[nodiscard]] bool empty() const { return data_.empty(); }
  [[nodiscard]] View operator[](std::size_t i) const { return {data_.data() + i * dimension_, dimension_}; }
  [[nodiscard]] MutableView operator[](std::size_t i) { return {data_.data() + i * dimension_, dimension_}; }
  [[nodiscard]] View front() const { return (*this)[0]; }
  [[nodiscard]] View back() const { return (*this)[size() - 1]; }
  [[nodiscard]] std::span<const double> values() const { return data_; }

  /// Appends a copy and returns its index. `q` may be a row of this same block.
  std::uint32_t push(View q) {
    const auto id = static_cast<std::uint32_t>(size());
    if (data_.size() + dimension_ > data_.capacity()) {
      const Configuration copy(q.begin(), q.end());
      constexpr std::size_t least_rows = 8;
      data_.reserve(std::max(least_rows * dimension_, 2 * data_.capacity()));
      data_.insert(data_.end(), copy.begin(), copy.end());
    } else {
      // A row is a few numbers: pushing them one by one costs less than inserting a range.
      for (const double x : q) data_.push_back(x);
    }
    return id;
  }
  void reserve(std::size_t rows) { data_.reserve(rows * dimension_); }
  void clear() { data_.clear(); }

 private:
  std::size_t dimension_ = 0;
  std::vector<double> data_;
};

}  // namespace trellis
