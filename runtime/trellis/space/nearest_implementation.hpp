// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <vector>

#include <trellis/space/nearest.hpp>

namespace trellis {

/// What an index of one kind of space does; see NearestIndex.
class NearestIndex::Implementation {
 public:
  Implementation() = default;
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  virtual ~Implementation() = default;
  virtual std::uint32_t add(View q) = 0;
  /// \param ids  for each point its new id, in ascending order, or `removed`
  /// \param kept  number of points that stay
  virtual void renumber(const std::vector<std::uint32_t>& ids, std::size_t kept) = 0;
  static constexpr std::uint32_t removed = std::numeric_limits<std::uint32_t>::max();
  [[nodiscard]] virtual std::size_t size() const = 0;
  [[nodiscard]] virtual Neighbour nearest(View q) const = 0;
  [[nodiscard]] virtual double squared_distance(View point, View q) const = 0;
  virtual void k_nearest(View q, std::size_t k, std::vector<Neighbour>& out) const = 0;
  virtual void within(View q, double radius, std::vector<Neighbour>& out) const = 0;
  virtual void nearest_distances(View q, std::span<double> squared) const = 0;
  [[nodiscard]] virtual std::size_t count_within(View q, double squared) const = 0;
};

/// The order of neighbours: by distance, then by id. A function object, so that the heap functions inline it.
struct NearerNeighbour {
  bool operator()(const NearestIndex::Neighbour& a, const NearestIndex::Neighbour& b) const {
    return a.squared_distance < b.squared_distance || (a.squared_distance == b.squared_distance && a.id < b.id);
  }
};

/// Puts a squared distance that is less than the last one among ascending ones.
inline void insert_distance(double d, std::span<double> squared) {
  std::size_t i = squared.size() - 1;
  for (; i > 0 && squared[i - 1] > d; --i) squared[i] = squared[i - 1];
  squared[i] = d;
}

/// Collects the k nearest of the candidates that a search offers.
class NearestCollector {
 public:
  NearestCollector(std::size_t k, std::vector<NearestIndex::Neighbour>& out) : k_(k), out_(out) { out.clear(); }

  /// The squared distance beyond which no candidate is one of the k nearest.
  [[nodiscard]] double limit() const { return limit_; }

  void offer(const NearestIndex::Neighbour& candidate) {
    constexpr NearerNeighbour nearer;
    if (candidate.squared_distance > limit_) return;
    if (k_ > few_) {
      out_.push_back(candidate);
      if (out_.size() == (limit_ < infinity ? k_ + k_ / 2 : k_ + 1)) select();
      return;
    }
    // Few candidates are sorted.
    if (out_.size() < k_) {
      out_.push_back(candidate);
    } else if (!nearer(candidate, out_.back())) {
      return;
    }
    std::size_t at = out_.size() - 1;
    for (; at > 0 && nearer(candidate, out_[at - 1]); --at) out_[at] = out_[at - 1];
    out_[at] = candidate;
    if (out_.size() == k_) limit_ = out_.back().squared_distance;
  }

  /// Leaves the k nearest, nearest first.
  void finish() {
    if (k_ <= few_) return;
    if (out_.size() > k_) select();
    std::sort(out_.begin(), out_.end(), NearerNeighbour());
  }

 private:
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  static constexpr std::size_t few_ = 24;

  /// Removes all but the k nearest.
  void select() {
    const auto last = out_.begin() + static_cast<std::ptrdiff_t>(k_ - 1);
    std::nth_element(out_.begin(), last, out_.end(), NearerNeighbour());
    limit_ = last->squared_distance;
    out_.resize(k_);
  }

  std::size_t k_;
  std::vector<NearestIndex::Neighbour>& out_;
  double limit_ = infinity;
};

/// The index of a space with rotations.
std::unique_ptr<NearestIndex::Implementation> make_rotation_index(const Space& space);

}  // namespace trellis
