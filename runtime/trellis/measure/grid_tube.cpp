// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/measure/grid_tube.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

namespace trellis::measure {

namespace {

constexpr std::size_t grid_limit = 3;             // axes of the grid
constexpr std::uint64_t axis_limit = 1U << 20U;   // cells of one axis, so that three fit a key
constexpr double cell_budget = 30000.0;           // cells of the cover, about
constexpr double thinning = 1e-3;                 // as a share of the radius
constexpr std::uint64_t table_limit = 1U << 18U;  // cells of a grid that has a table of them
constexpr std::uint32_t no_cell = std::numeric_limits<std::uint32_t>::max();

/// Coordinates of a point over the tube's axes; on the stack except for spaces of very many axes.
class Gathered {
 public:
  Gathered(View y, const std::vector<std::size_t>& axes) {
    double* out = few_.data();
    if (axes.size() > few_.size()) {
      many_.resize(axes.size());
      out = many_.data();
    }
    for (std::size_t j = 0; j < axes.size(); ++j) out[j] = y[axes[j]];
    data_ = out;
  }
  Gathered(const Gathered&) = delete;
  Gathered& operator=(const Gathered&) = delete;
  [[nodiscard]] const double* data() const { return data_; }

 private:
  std::array<double, 16> few_;
  std::vector<double> many_;
  const double* data_ = nullptr;
};

}  // namespace

GridTube::GridTube(const Frame& frame, const Configurations& path, std::vector<std::size_t> axes, double radius)
    : Tube(frame, std::move(axes), radius), grid_axes_(std::min(axes_.size(), grid_limit)) {
  cut_path(frame.space(), path);
  choose_grid();
  fill_cells();
  bound_rest();
}

void GridTube::add_piece(const std::vector<double>& from, const std::vector<double>& step, double piece_limit) {
  double square = 0.0;
  for (const double s : step) square += s * s;
  const double length = std::sqrt(square);
  const auto parts = static_cast<std::size_t>(std::max(1.0, std::ceil(length / piece_limit)));
  for (std::size_t i = 0; i < parts; ++i) {
    double part_square = 0.0;
    for (std::size_t j = 0; j < axes_.size(); ++j) {
      const double begin = static_cast<double>(i) / static_cast<double>(parts);
      const double part = step[j] / static_cast<double>(parts);
      from_.push_back(frame_.fold(axes_[j], from[j] + begin * step[j]));
      step_.push_back(part);
      part_square += part * part;
    }
    begin_.push_back(begin_.empty() ? 0.0 : begin_.back() + std::sqrt(step_square_.back()));
    step_square_.push_back(part_square);
  }
}

void GridTube::cut_path(const Space& space, const Configurations& path) {
  const std::size_t count = axes_.size();
  // Unwrapped waypoints over the tube's axes: each leg takes the shorter direction, so positions are sums of
  // differences.
  std::vector<double> unrolled;
  std::vector<double> y(frame_.dimension());
  std::vector<double> delta(frame_.dimension());
  frame_.to_metric(path.front(), y);
  for (const std::size_t axis : axes_) unrolled.push_back(y[axis]);
  for (std::size_t i = 1; i < path.size(); ++i) {
    space.difference(path[i - 1], path[i], delta);
    for (std::size_t j = 0; j < count; ++j) {
      unrolled.push_back(unrolled[(i - 1) * count + j] + delta[axes_[j]] * space.axes()[axes_[j]].weight);
    }
  }
  for (std::size_t i = 1; i < path.size(); ++i) {
    double square = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      const double step = unrolled[i * count + j] - unrolled[(i - 1) * count + j];
      square += step * step;
    }
    length_ += std::sqrt(square);
  }
  // Pieces as long as the radius keep the lists of the cells short; a very thin tube must not have millions of pieces.
  const double piece_limit = std::max(radius_, length_ / 4096.0);
  const auto step_between = [&](std::size_t a, std::size_t b) {
    std::vector<double> step(count);
    for (std::size_t j = 0; j < count; ++j) step[j] = unrolled[b * count + j] - unrolled[a * count + j];
    return step;
  };
  const auto bends = [&](std::size_t a, std::size_t b) {  // whether a line from a to b misses a waypoint between
    const std::vector<double> step = step_between(a, b);
    double square = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      // A piece of more than half a period would take the wrong direction.
      if (std::abs(step[j]) > 0.25 * frame_.period(axes_[j])) return true;
      square += step[j] * step[j];
    }
    if (square > radius_ * radius_) return true;
    for (std::size_t i = a + 1; i < b; ++i) {
      const std::vector<double> u = step_between(a, i);
      double along = 0.0;
      for (std::size_t j = 0; j < count; ++j) along += u[j] * step[j];
      const double t = square > 0.0 ? std::clamp(along / square, 0.0, 1.0) : 0.0;
      double off = 0.0;
      for (std::size_t j = 0; j < count; ++j) off += (u[j] - t * step[j]) * (u[j] - t * step[j]);
      if (off > thinning * thinning * radius_ * radius_) return true;
    }
    return false;
  };
  const auto at = [&](std::size_t i) {
    std::vector<double> from(count);
    for (std::size_t j = 0; j < count; ++j) from[j] = frame_.fold(axes_[j], unrolled[i * count + j]);
    return from;
  };
  if (path.size() == 1) add_piece(at(0), std::vector<double>(count, 0.0), piece_limit);
  constexpr std::size_t run_limit = 64;  // keeps the search for bends linear in the number of waypoints
  for (std::size_t a = 0; a + 1 < path.size();) {
    std::size_t b = a + 1;
    while (b + 1 < path.size() && b - a < run_limit && !bends(a, b + 1)) ++b;
    add_piece(at(a), step_between(a, b), piece_limit);
    a = b;
  }
}

double GridTube::squared(std::size_t piece, const double* z, std::size_t count, double* at) const {
  const double* a = &from_[piece * axes_.size()];
  const double* d = &step_[piece * axes_.size()];
  // As the point of the piece moves from t = 0 to 1, the nearest image of z changes on a periodic axis where the two
  // are half a period apart, at most once per axis. Between such changes the squared distance is a parabola.
  double best = std::numeric_limits<double>::infinity();
  double from = 0.0;
  while (true) {
    double to = 1.0;
    const auto offset = [&](std::size_t j) {
      const double u = frame_.shortest(axes_[j], z[j] - a[j]);
      if (!frame_.periodic(axes_[j])) return u;
      const double period = std::copysign(frame_.period(axes_[j]), d[j]);
      const double change = (u + 0.5 * period) / d[j];
      if (change <= from) return u + period;
      if (change < to) to = change;
      return u;
    };
    double along = 0.0;
    double length_square = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      along += offset(j) * d[j];
      length_square += d[j] * d[j];
    }
    const double t = length_square > 0.0 ? std::clamp(along / length_square, from, to) : from;
    double sum = 0.0;
    for (std::size_t j = 0; j < count; ++j) {
      const double v = offset(j) - t * d[j];
      sum += v * v;
    }
    if (sum < best) {
      best = sum;
      if (at != nullptr) *at = t;
    }
    if (to >= 1.0) return best;
    from = to;
  }
}

template <class Look>
void GridTube::look_near(View y, const double* z, Look look) const {
  // A point of the tube is nearest to one of the pieces in its cell's list.
  if (const auto cell = cell_of(y); cell && near(*cell, z)) {
    for (std::uint32_t i = first_[*cell]; i < first_[*cell + 1]; ++i) look(near_[i]);
  } else {
    for (std::size_t i = 0; i < pieces(); ++i) look(i);
  }
}

double GridTube::distance(View y) const {
  const Gathered z(y, axes_);
  double best = std::numeric_limits<double>::infinity();
  look_near(y, z.data(), [&](std::size_t piece) { best = std::min(best, squared(piece, z.data(), axes_.size())); });
  return std::sqrt(best);
}

double GridTube::along(View y) const {
  const Gathered z(y, axes_);
  double best = std::numeric_limits<double>::infinity();
  double arc = 0.0;
  look_near(y, z.data(), [&](std::size_t piece) {
    double t = 0.0;
    const double square = squared(piece, z.data(), axes_.size(), &t);
    if (square < best) {
      best = square;
      arc = begin_[piece] + t * std::sqrt(step_square_[piece]);
    }
  });
  return arc;
}

void GridTube::choose_grid() {
  // Small cells waste few points and much memory; the memory of a cell grows with the dimension.
  double side = radius_ / (grid_axes_ <= 2 ? 8.0 : 4.0);
  const auto expected = [&](double h) {
    double cells = (length_ + 2.0 * (radius_ + h)) / h;
    for (std::size_t g = 1; g < grid_axes_; ++g) cells *= 2.0 * (radius_ + h) / h;
    double all = 1.0;
    for (std::size_t g = 0; g < grid_axes_; ++g) all *= std::max(1.0, frame_.extent(axes_[g]) / h);
    return std::min(cells, all);
  };
  while (expected(side) > cell_budget) side *= 1.1;
  for (std::size_t g = 0; g < grid_axes_; ++g) {
    const double extent = frame_.extent(axes_[g]);
    const double wanted = std::ceil(extent / side);
    cells_.push_back(static_cast<std::uint64_t>(std::clamp(wanted, 1.0, static_cast<double>(axis_limit))));
    side_.push_back(extent / static_cast<double>(cells_.back()));
  }
}

void GridTube::fill_cells() {
  double diagonal = 0.0;
  for (const double h : side_) diagonal += h * h;
  const double half_diagonal = 0.5 * std::sqrt(diagonal);
  // A cell may contain points of the tube only if its centre is this near; the margin covers rounding.
  const double reach = (radius_ + half_diagonal) * (1.0 + 1e-9);
  const double sure = grid_axes_ == axes_.size() ? radius_ * (1.0 - 1e-9) - half_diagonal : -1.0;

  struct Entry {
    std::uint64_t key;
    std::uint32_t piece;
    bool inside;
  };
  std::vector<Entry> entries;
  std::array<std::int64_t, grid_limit> begin{};
  std::array<std::int64_t, grid_limit> index{};
  std::array<std::int64_t, grid_limit> end{};
  std::array<double, grid_limit> centre{};
  for (std::size_t piece = 0; piece < pieces(); ++piece) {
    for (std::size_t g = 0; g < grid_axes_; ++g) {
      const double a = from_[piece * axes_.size() + g];
      const double b = a + step_[piece * axes_.size() + g];
      const double lo = frame_.lo(axes_[g]);
      const auto n = static_cast<double>(cells_[g]);
      double first = std::floor((std::min(a, b) - radius_ - lo) / side_[g] - 1e-6);
      double last = std::floor((std::max(a, b) + radius_ - lo) / side_[g] + 1e-6);
      if (!frame_.periodic(axes_[g])) {
        first = std::clamp(first, 0.0, n - 1.0);
        last = std::clamp(last, 0.0, n - 1.0);
      } else if (last - first + 1.0 >= n) {
        first = 0.0;
        last = n - 1.0;
      }
      begin[g] = static_cast<std::int64_t>(first);
      end[g] = static_cast<std::int64_t>(last);
    }
    index = begin;
    while (true) {
      std::uint64_t key = 0;
      for (std::size_t g = grid_axes_; g-- > 0;) {
        const auto n = static_cast<std::int64_t>(cells_[g]);
        const std::int64_t i = (index[g] % n + n) % n;
        centre[g] = frame_.lo(axes_[g]) + (static_cast<double>(i) + 0.5) * side_[g];
        key = key * cells_[g] + static_cast<std::uint64_t>(i);
      }
      const double square = squared(piece, centre.data(), grid_axes_);
      if (square < reach * reach) {
        entries.push_back({key, static_cast<std::uint32_t>(piece), sure > 0.0 && square < sure * sure});
      }
      std::size_t g = 0;
      for (; g < grid_axes_; ++g) {
        if (++index[g] <= end[g]) break;
        index[g] = begin[g];
      }
      if (g == grid_axes_) break;
    }
  }
  std::sort(entries.begin(), entries.end(),
            [](const Entry& a, const Entry& b) { return a.key != b.key ? a.key < b.key : a.piece < b.piece; });
  for (const Entry& entry : entries) {
    if (keys_.empty() || keys_.back() != entry.key) {
      keys_.push_back(entry.key);
      first_.push_back(static_cast<std::uint32_t>(near_.size()));
      inside_.push_back(0);
    }
    near_.push_back(entry.piece);
    if (entry.inside) inside_.back() = 1;
  }
  first_.push_back(static_cast<std::uint32_t>(near_.size()));

  std::uint64_t all = 1;
  for (const std::uint64_t n : cells_) all = all > table_limit ? all : all * n;
  if (all > table_limit) return;
  cell_of_key_.assign(all, no_cell);
  for (std::size_t cell = 0; cell < keys_.size(); ++cell) cell_of_key_[keys_[cell]] = static_cast<std::uint32_t>(cell);
}

void GridTube::bound_rest() {
  double cell_volume = 1.0;
  for (const double h : side_) cell_volume *= h;
  double free_volume = 1.0;
  for (std::size_t j = 0; j < frame_.dimension(); ++j) {
    if (std::find(axes_.begin(), axes_.end(), j) == axes_.end()) free_volume *= frame_.extent(j);
  }
  double sum = 0.0;
  for (std::size_t cell = 0; cell < keys_.size(); ++cell) {
    double volume = cell_volume * free_volume;
    for (std::size_t j = grid_axes_; j < axes_.size(); ++j) {
      const std::size_t axis = axes_[j];
      double lo = 0.0;
      double hi = 0.0;
      for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
        double a = from_[near_[i] * axes_.size() + j];
        const double step = step_[near_[i] * axes_.size() + j];
        if (i == first_[cell]) {
          lo = hi = a;
        } else {
          const double middle = 0.5 * (lo + hi);
          a = middle + frame_.shortest(axis, a - middle);
        }
        lo = std::min({lo, a, a + step});
        hi = std::max({hi, a, a + step});
      }
      lo -= radius_;
      hi += radius_;
      if (!frame_.periodic(axis)) {
        lo = std::max(lo, frame_.lo(axis));
        hi = std::min(hi, frame_.hi(axis));
      } else if (hi - lo >= frame_.period(axis)) {
        lo = frame_.lo(axis);
        hi = frame_.hi(axis);
      }
      rest_.push_back(lo);
      rest_.push_back(hi - lo);
      volume *= hi - lo;
    }
    sum += volume;
    cumulative_.push_back(sum);
  }
  cover_volume_ = sum;
}

bool GridTube::near(std::size_t cell, const double* z) const {
  if (inside_[cell] != 0) return true;
  for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i) {
    if (squared(near_[i], z, axes_.size()) < radius_ * radius_) return true;
  }
  return false;
}

std::optional<std::size_t> GridTube::cell_of(View y) const {
  std::uint64_t key = 0;
  for (std::size_t g = grid_axes_; g-- > 0;) {
    const double at = (y[axes_[g]] - frame_.lo(axes_[g])) / side_[g];
    if (!(at >= 0.0)) return std::nullopt;
    key = key * cells_[g] + std::min(static_cast<std::uint64_t>(at), cells_[g] - 1);
  }
  if (!cell_of_key_.empty()) {
    const std::uint32_t cell = cell_of_key_[key];
    if (cell == no_cell) return std::nullopt;
    return cell;
  }
  const auto found = std::lower_bound(keys_.begin(), keys_.end(), key);
  if (found == keys_.end() || *found != key) return std::nullopt;
  return static_cast<std::size_t>(found - keys_.begin());
}

bool GridTube::contains(View y) const {
  const auto cell = cell_of(y);
  if (!cell) return false;
  const Gathered z(y, axes_);
  return near(*cell, z.data());
}

double GridTube::log_cover_volume() const { return std::log(cover_volume_); }

std::size_t GridTube::cell_at(double volume) const {
  const std::size_t last = cumulative_.size() - 1;
  if (rest_.empty()) {
    // Cells of equal volume: exact up to rounding.
    auto cell = std::min(last, static_cast<std::size_t>(volume / cumulative_.front()));
    while (cell < last && cumulative_[cell] <= volume) ++cell;
    while (cell > 0 && cumulative_[cell - 1] > volume) --cell;
    return cell;
  }
  const auto found = std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, volume);
  return static_cast<std::size_t>(found - cumulative_.begin());
}

bool GridTube::draw(View unit, MutableView y) const {
  const double at = unit[0] * cover_volume_;
  const std::size_t cell = cell_at(at);
  for (std::size_t j = 0; j < frame_.dimension(); ++j) y[j] = frame_.lo(j) + unit[j + 1] * frame_.extent(j);
  std::uint64_t key = keys_[cell];
  for (std::size_t g = 0; g < grid_axes_; ++g) {
    const auto i = static_cast<double>(key % cells_[g]);
    key /= cells_[g];
    y[axes_[g]] = frame_.lo(axes_[g]) + (i + unit[axes_[g] + 1]) * side_[g];
  }
  for (std::size_t j = grid_axes_; j < axes_.size(); ++j) {
    const double* range = &rest_[2 * ((axes_.size() - grid_axes_) * cell + j - grid_axes_)];
    y[axes_[j]] = frame_.fold(axes_[j], range[0] + unit[axes_[j] + 1] * range[1]);
  }
  const Gathered z(y, axes_);
  return near(cell, z.data());
}

}  // namespace trellis::measure
