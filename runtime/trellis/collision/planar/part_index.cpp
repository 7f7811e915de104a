// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/planar/part_index.hpp>

#include <algorithm>
#include <bit>
#include <utility>

namespace trellis {

namespace {

/// Beyond this number of boxes, a query of the tree takes less time than one of the rows of bits.
constexpr std::size_t most_in_rows = 4096;

}  // namespace

PartIndex::PartIndex(std::vector<kernel::Box> boxes)
    : boxes_(std::move(boxes)),
      slabs_(boxes_.size() <= 256 ? 64 : 256),
      words_(boxes_.size() <= most_in_rows ? (boxes_.size() + 63) / 64 : 0) {
  std::vector<Box2> plain;
  plain.reserve(boxes_.size());
  for (const auto& box : boxes_) plain.push_back({{box.xlo, box.ylo}, {box.xhi, box.yhi}});
  tree_ = PlanarBoxTree(plain);
  if (words_ == 0) return;
  build(x_, &kernel::Box::xlo, &kernel::Box::xhi);
  build(y_, &kernel::Box::ylo, &kernel::Box::yhi);
}

// Monotone in x, so rounding loses no overlap. Values beyond the ends, and NaN, map to a slab at an end.
std::size_t PartIndex::slab(const Axis& axis, double x) const {
  const double position = (x - axis.lo) * axis.per_metre;
  const auto last = static_cast<double>(slabs_ - 1);
  return position > 0.0 ? static_cast<std::size_t>(position < last ? position : last) : 0;
}

void PartIndex::build(Axis& axis, double kernel::Box::*lo, double kernel::Box::*hi) {
  axis.lo = boxes_.front().*lo;
  double end = boxes_.front().*hi;
  for (const auto& box : boxes_) {
    axis.lo = std::min(axis.lo, box.*lo);
    end = std::max(end, box.*hi);
  }
  axis.per_metre = end > axis.lo ? static_cast<double>(slabs_) / (end - axis.lo) : 0.0;
  axis.reach.assign(slabs_ * words_, 0);
  axis.begins.assign(slabs_ * words_, 0);
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const std::uint64_t bit = std::uint64_t{1} << (i % 64);
    axis.reach[slab(axis, boxes_[i].*hi) * words_ + i / 64] |= bit;
    axis.begins[slab(axis, boxes_[i].*lo) * words_ + i / 64] |= bit;
  }
  for (std::size_t k = axis.reach.size() - words_; k-- > 0;) axis.reach[k] |= axis.reach[k + words_];
  for (std::size_t k = words_; k < axis.begins.size(); ++k) axis.begins[k] |= axis.begins[k - words_];
}

void PartIndex::sort(unsigned* indices, unsigned count) const {
  if (count < boxes_.size() / 64) {
    std::sort(indices, indices + count);
    return;
  }
  // So many are sorted by a row of bits.
  std::vector<std::uint64_t> row((boxes_.size() + 63) / 64, 0);
  for (unsigned k = 0; k < count; ++k) row[indices[k] / 64] |= std::uint64_t{1} << (indices[k] % 64);
  for (std::size_t w = 0; w < row.size(); ++w) {
    for (std::uint64_t left = row[w]; left != 0; left &= left - 1) {
      *indices++ = static_cast<unsigned>(w * 64) + static_cast<unsigned>(std::countr_zero(left));
    }
  }
}

unsigned PartIndex::query(const kernel::Box& box, unsigned* out) const {
  unsigned count = 0;
  if (words_ == 0) {
    const Box2 wanted{{box.xlo, box.ylo}, {box.xhi, box.yhi}};
    tree_.each([&](const Box2& other) { return boxes_meet(wanted, other); },
               [&](std::uint32_t i) {
                 const kernel::Box& b = boxes_[i];
                 if (boxes_meet(wanted, {{b.xlo, b.ylo}, {b.xhi, b.yhi}})) out[count++] = i;
               });
    sort(out, count);
    return count;
  }
  const std::uint64_t* x_reach = &x_.reach[slab(x_, box.xlo) * words_];
  const std::uint64_t* x_begins = &x_.begins[slab(x_, box.xhi) * words_];
  const std::uint64_t* y_reach = &y_.reach[slab(y_, box.ylo) * words_];
  const std::uint64_t* y_begins = &y_.begins[slab(y_, box.yhi) * words_];
  for (std::size_t w = 0; w < words_; ++w) {
    std::uint64_t found = x_reach[w] & x_begins[w] & y_reach[w] & y_begins[w];
    while (found != 0) {
      const auto i = static_cast<unsigned>(w * 64) + static_cast<unsigned>(std::countr_zero(found));
      found &= found - 1;
      const kernel::Box& b = boxes_[i];
      // Without branches: a processor cannot predict whether a box in a common slab overlaps.
      out[count] = i;
      count += static_cast<unsigned>(static_cast<unsigned>(b.xlo <= box.xhi) & static_cast<unsigned>(box.xlo <= b.xhi) &
                                     static_cast<unsigned>(b.ylo <= box.yhi) & static_cast<unsigned>(box.ylo <= b.yhi));
    }
  }
  return count;
}

}  // namespace trellis
