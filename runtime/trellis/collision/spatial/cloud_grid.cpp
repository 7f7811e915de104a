// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/collision/spatial/cloud_grid.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <trellis/scene/spatial/ranges.hpp>

namespace trellis {

namespace {

/// Replaces the squares of distances along one line of cells by the least of them plus the square of the number of
/// cells to there: the lower envelope of parabolas (Felzenszwalb and Huttenlocher 2012).
class Envelope {
 public:
  void apply(float* values, std::size_t count, std::size_t stride) {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    line_.resize(count);
    root_.resize(count);
    from_.resize(count + 1);
    std::size_t last = 0;
    bool any = false;
    for (std::size_t i = 0; i < count; ++i) {
      line_[i] = values[i * stride];
      if (line_[i] == infinity) continue;
      const auto height = [&](std::size_t at) { return line_[at] + static_cast<float>(at * at); };
      while (any) {
        const std::size_t before = root_[last];
        const float meet = (height(i) - height(before)) / static_cast<float>(2 * (i - before));
        if (meet > from_[last]) {
          from_[++last] = meet;
          break;
        }
        if (last == 0) {
          any = false;
        } else {
          --last;
        }
      }
      if (!any) {
        from_[0] = -infinity;
        any = true;
      }
      root_[last] = i;
    }
    if (!any) return;
    for (std::size_t i = 0, k = 0; i < count; ++i) {
      while (k < last && from_[k + 1] < static_cast<float>(i)) ++k;
      const auto away = static_cast<float>(i > root_[k] ? i - root_[k] : root_[k] - i);
      values[i * stride] = away * away + line_[root_[k]];
    }
  }

 private:
  std::vector<float> line_;
  std::vector<std::size_t> root_;
  std::vector<float> from_;
};

}  // namespace

CloudGrid::CloudGrid(const std::vector<Vec3>& points, double radius) {
  data_.radius = radius;
  choose_cells(points);
  sort(points);
  measure();
}

std::size_t CloudGrid::cells() const { return std::size_t{data_.count[0]} * data_.count[1] * data_.count[2]; }

void CloudGrid::choose_cells(const std::vector<Vec3>& points) {
  const Box3 box = bounds_of(points);
  const Vec3 extent = box.hi - box.lo;
  const std::array<double, 3> side{extent.x, extent.y, extent.z};
  const double longest = std::max({extent.x, extent.y, extent.z});
  // So many cells cost as much time as the points do.
  constexpr double per_point = 4.0, fewest = 4096.0, most = 262144.0;
  const double wanted = std::clamp(per_point * static_cast<double>(points.size()), fewest, most);
  // A cloud of one point has one cell.
  double cell = longest > 0.0 ? longest / 128.0 : 1.0;
  const auto count = [&](std::size_t k) { return std::floor(side[k] / cell) + 1.0; };
  while (count(0) * count(1) * count(2) > wanted) cell *= 1.02;
  data_.cell = cell;
  data_.per_metre = 1.0 / cell;
  const std::array<double, 3> lo{box.lo.x, box.lo.y, box.lo.z};
  const std::array<double, 3> hi{box.hi.x, box.hi.y, box.hi.z};
  for (std::size_t k = 0; k < 3; ++k) {
    data_.lo[k] = lo[k];
    data_.hi[k] = hi[k];
    // As the kernels compute the cell of the farthest point.
    data_.count[k] = static_cast<unsigned>((hi[k] - lo[k]) * data_.per_metre) + 1;
  }
}

void CloudGrid::sort(const std::vector<Vec3>& points) {
  const auto cell_of = [&](const Vec3& p) {
    const auto i = static_cast<std::size_t>((p.x - data_.lo[0]) * data_.per_metre);
    const auto j = static_cast<std::size_t>((p.y - data_.lo[1]) * data_.per_metre);
    const auto k = static_cast<std::size_t>((p.z - data_.lo[2]) * data_.per_metre);
    return (k * data_.count[1] + j) * data_.count[0] + i;
  };
  begin_.assign(cells() + 1, 0);
  std::vector<unsigned> cell(points.size());
  for (std::size_t i = 0; i < points.size(); ++i) {
    cell[i] = static_cast<unsigned>(cell_of(points[i]));
    ++begin_[cell[i] + 1];
  }
  for (std::size_t c = 0; c < cells(); ++c) begin_[c + 1] += begin_[c];
  std::vector<unsigned> next(begin_.begin(), begin_.end() - 1);
  const std::size_t blocks = (points.size() + kernel::lanes - 1) / kernel::lanes;
  // What fills the last block repeats a point, so that it changes no answer.
  kernel::Lanes filled{};
  for (auto* axis : {&x_, &y_, &z_}) axis->assign(blocks, filled);
  const auto put = [&](std::size_t at, const Vec3& p) {
    x_[at / kernel::lanes].v[at % kernel::lanes] = p.x;
    y_[at / kernel::lanes].v[at % kernel::lanes] = p.y;
    z_[at / kernel::lanes].v[at % kernel::lanes] = p.z;
  };
  for (std::size_t i = 0; i < points.size(); ++i) put(next[cell[i]]++, points[i]);
  for (std::size_t at = points.size(); at < blocks * kernel::lanes; ++at) put(at, points.front());
  data_.x = x_.data();
  data_.y = y_.data();
  data_.z = z_.data();
  data_.begin = begin_.data();
}

void CloudGrid::measure() {
  constexpr float infinity = std::numeric_limits<float>::infinity();
  const std::size_t nx = data_.count[0], ny = data_.count[1], nz = data_.count[2];
  clear_.assign(cells(), infinity);
  // From a cell to its neighbour the distance may be 0: cells with points grow by one to each side, so that the
  // distance between two cells counts the cells between them.
  for (std::size_t k = 0, c = 0; k < nz; ++k) {
    for (std::size_t j = 0; j < ny; ++j) {
      for (std::size_t i = 0; i < nx; ++i, ++c) {
        if (begin_[c] == begin_[c + 1]) continue;
        for (std::size_t w = k == 0 ? 0 : k - 1; w <= std::min(k + 1, nz - 1); ++w) {
          for (std::size_t v = j == 0 ? 0 : j - 1; v <= std::min(j + 1, ny - 1); ++v) {
            for (std::size_t u = i == 0 ? 0 : i - 1; u <= std::min(i + 1, nx - 1); ++u) {
              clear_[(w * ny + v) * nx + u] = 0.0F;
            }
          }
        }
      }
    }
  }
  Envelope envelope;
  for (std::size_t row = 0; row < ny * nz; ++row) envelope.apply(&clear_[row * nx], nx, 1);
  for (std::size_t k = 0; k < nz; ++k) {
    for (std::size_t i = 0; i < nx; ++i) envelope.apply(&clear_[k * ny * nx + i], ny, nx);
  }
  for (std::size_t i = 0; i < nx * ny; ++i) envelope.apply(&clear_[i], nz, nx * ny);
  // Less by what rounding may add.
  constexpr float sure = 1.0F - 1e-5F;
  const auto cell = static_cast<float>(data_.cell);
  for (float& value : clear_) value = sure * cell * std::sqrt(value);
  data_.clear = clear_.data();
}

}  // namespace trellis
