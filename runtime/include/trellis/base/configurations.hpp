// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <utility>
#include <vector>

namespace trellis {

/// One configuration that owns its coordinates: raw values in the order of the space's axes.
using Configuration = std::vector<double>;
/// A configuration that another object owns.
using View = std::span<const double>;
using MutableView = std::span<double>;

/// Configurations of one dimension in one contiguous block, row by row. Rows never change once pushed. The next push
/// invalidates views. A large block grows in place (realloc moves pages instead of bytes), so a record of a million
/// proposals never takes its memory twice.
class Configurations {
 public:
  Configurations() = default;
  /// Makes an empty block.
  /// \param dimension  number of coordinates of each row
  explicit Configurations(std::size_t dimension) : dimension_(dimension) {}
  ~Configurations() = default;
  /// A copy takes no more memory than its rows.
  /// \param other  unchanged; views of its rows stay valid
  /// \throws std::bad_alloc without memory
  Configurations(const Configurations& other) : dimension_(other.dimension_) {
    allocate(other.size_);
    std::copy_n(other.data_.get(), other.size_, data_.get());
    size_ = other.size_;
  }
  /// Takes the block of another one, whose views stay valid.
  /// \param other  empty afterwards; it keeps its dimension
  Configurations(Configurations&& other) noexcept
      : dimension_(other.dimension_),
        size_(std::exchange(other.size_, 0)),
        capacity_(std::exchange(other.capacity_, 0)),
        data_(std::move(other.data_)) {}
  /// Takes a copy of the rows and of the dimension.
  /// \param other  may be this object
  /// \throws std::bad_alloc without memory
  Configurations& operator=(const Configurations& other) {
    if (this != &other) *this = Configurations(other);
    return *this;
  }
  /// Takes the block and the dimension of another one and releases its own block.
  /// \param other  empty afterwards; it keeps its dimension
  Configurations& operator=(Configurations&& other) noexcept {
    dimension_ = other.dimension_;
    data_ = std::move(other.data_);
    size_ = std::exchange(other.size_, 0);
    capacity_ = std::exchange(other.capacity_, 0);
    return *this;
  }

  [[nodiscard]] std::size_t dimension() const { return dimension_; }
  [[nodiscard]] std::size_t size() const { return dimension_ == 0 ? 0 : size_ / dimension_; }
  [[nodiscard]] bool empty() const { return size_ == 0; }
  /// Returns a row.
  /// \param i  from 0 to size() - 1, which is not checked
  /// \return valid until the next push, `reserve` or assignment
  [[nodiscard]] View operator[](std::size_t i) const { return {data_.get() + i * dimension_, dimension_}; }
  /// As above, to write to.
  /// \param i  from 0 to size() - 1, which is not checked
  [[nodiscard]] MutableView operator[](std::size_t i) { return {data_.get() + i * dimension_, dimension_}; }
  [[nodiscard]] View front() const { return (*this)[0]; }
  [[nodiscard]] View back() const { return (*this)[size() - 1]; }
  [[nodiscard]] std::span<const double> values() const { return {data_.get(), size_}; }

  /// Appends a copy and returns its index. `q` may be a row of this same block.
  /// \param q  `dimension` numbers, which is not checked
  /// \throws std::bad_alloc without memory
  std::uint32_t push(View q) {
    const auto id = static_cast<std::uint32_t>(size());
    if (size_ + dimension_ > capacity_) {
      const Configuration copy(q.begin(), q.end());
      constexpr std::size_t least_rows = 8;
      allocate(std::max(least_rows * dimension_, 2 * capacity_));
      append(copy);
    } else {
      append(q);
    }
    return id;
  }
  /// Makes room for rows, so that pushes up to this number move no memory. Never makes the block smaller.
  /// \param rows  in all, those that it has included
  /// \throws std::bad_alloc without memory
  void reserve(std::size_t rows) {
    if (rows * dimension_ > capacity_) allocate(rows * dimension_);
  }
  /// Removes all rows and keeps the memory.
  void clear() { size_ = 0; }

 private:
  struct Release {
    void operator()(double* block) const { std::free(block); }
  };

  /// Gives the block room for `capacity` >= size_ numbers.
  void allocate(std::size_t capacity) {
    if (capacity == 0) return;
    // No C++ allocator grows in place.
    auto* block = static_cast<double*>(std::realloc(data_.get(), capacity * sizeof(double)));
    if (block == nullptr) throw std::bad_alloc();
    static_cast<void>(data_.release());  // realloc has taken it
    data_.reset(block);
    capacity_ = capacity;
  }
  void append(View q) {
    for (const double x : q) data_[size_++] = x;
  }

  std::size_t dimension_ = 0;
  std::size_t size_ = 0;                     ///< in numbers, not rows
  std::size_t capacity_ = 0;                 ///< likewise
  std::unique_ptr<double[], Release> data_;  // NOLINT(modernize-avoid-c-arrays): one block
};

}  // namespace trellis
