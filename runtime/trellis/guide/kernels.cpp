// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/guide/kernels.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>

#include <trellis/base/error.hpp>

namespace trellis {

namespace {

/// Calls f(y) for every image y of x in metric coordinates that may lie within r of the box [lo, hi]: x itself, its
/// mirror images at the bounds, and its copies along periodic axes.
template <class F>
void for_each_image(const Space& space, View x, const double* lo, const double* hi, double r, F&& f) {
  struct Candidates {
    std::array<double, 3> y{};
    std::uint8_t count = 0;
    std::uint8_t at = 0;
  };
  const auto& axes = space.axes();
  const std::size_t d = axes.size();
  std::vector<Candidates> candidates(d);
  std::vector<double> y(d);
  for (std::size_t j = 0; j < d; ++j) {
    const auto& axis = axes[j];
    auto& mine = candidates[j];
    const auto offer = [&](double raw) {
      const double image = axis.weight * raw;
      if (image >= lo[j] - r && image <= hi[j] + r) mine.y[mine.count++] = image;
    };
    offer(x[j]);
    if (axis.periodic) {
      offer(x[j] - axis.period());
      offer(x[j] + axis.period());
    } else {
      if (x[j] > axis.lo) offer(2.0 * axis.lo - x[j]);
      if (x[j] < axis.hi) offer(2.0 * axis.hi - x[j]);
    }
    if (mine.count == 0) return;
    y[j] = mine.y[0];
  }
  for (;;) {
    f(y.data());
    std::size_t j = 0;
    for (; j < d; ++j) {
      auto& mine = candidates[j];
      mine.at = mine.at + 1 < mine.count ? static_cast<std::uint8_t>(mine.at + 1) : std::uint8_t{0};
      y[j] = mine.y[mine.at];
      if (mine.at != 0) break;
    }
    if (j == d) return;
  }
}

/// Calls f(y) for q and its mirror images at bounds that are nearer than r. In a space with rotations.
template <class F>
void for_each_mirror_image(const Space& space, View q, double r, F&& f) {
  std::vector<std::pair<std::size_t, double>> mirrored;  // columns, and what they may be besides
  for (const Factor& factor : space.factors()) {
    if (factor.kind != Factor::Kind::line) continue;
    const Axis& axis = factor.axis;
    const double x = q[factor.column];
    if (x > axis.lo && axis.weight * (x - axis.lo) <= r) mirrored.emplace_back(factor.column, 2.0 * axis.lo - x);
    if (x < axis.hi && axis.weight * (axis.hi - x) <= r) mirrored.emplace_back(factor.column, 2.0 * axis.hi - x);
  }
  Configuration image(q.begin(), q.end());
  const std::size_t all = std::size_t{1} << mirrored.size();
  for (std::size_t chosen = 0; chosen < all; ++chosen) {
    std::copy(q.begin(), q.end(), image.begin());
    bool twice = false;  // one coordinate at both of its bounds
    for (std::size_t k = 0; k < mirrored.size(); ++k) {
      if ((chosen >> k & 1U) == 0) continue;
      const auto [column, x] = mirrored[k];
      twice = twice || image[column] != q[column];
      image[column] = x;
    }
    if (!twice) f(View(image));
  }
}

/// Converts intervals that may overlap into disjoint ones: adds the rates of the intervals that cover the same part.
/// Parts that no interval covers have a mass of exactly 0.
std::vector<TubeDensity::Stretch> added_up(const std::vector<TubeDensity::Stretch>& stretches) {
  std::vector<double> cuts;
  std::map<double, double> points;
  for (const auto& s : stretches) {
    if (s.to <= s.from) {
      points[s.from] += s.mass;
      continue;
    }
    cuts.push_back(s.from);
    cuts.push_back(s.to);
  }
  std::sort(cuts.begin(), cuts.end());
  cuts.erase(std::unique(cuts.begin(), cuts.end()), cuts.end());
  std::vector<double> rates(cuts.size(), 0.0);  // between each cut and the next
  for (const auto& s : stretches) {
    if (s.to <= s.from) continue;
    const double rate = s.mass / (s.to - s.from);
    auto i = static_cast<std::size_t>(std::lower_bound(cuts.begin(), cuts.end(), s.from) - cuts.begin());
    for (; cuts[i] < s.to; ++i) rates[i] += rate;
  }
  std::vector<TubeDensity::Stretch> result;
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    if (rates[i] > 0.0) result.push_back({cuts[i], cuts[i + 1], rates[i] * (cuts[i + 1] - cuts[i])});
  }
  for (const auto& [at, mass] : points) result.push_back({at, at, mass});
  return result;
}

}  // namespace

double fitting_radius(const Space& space, double wanted) {
  double radius = std::min(wanted, 0.999 * space.injectivity_radius());
  for (const Factor& factor : space.factors()) {
    const Axis& axis = factor.axis;
    if (factor.kind == Factor::Kind::line) radius = std::min(radius, 0.5 * axis.weight * (axis.hi - axis.lo));
  }
  return radius;
}

BallKernel::BallKernel(Space space, double radius)
    : space_(std::move(space)),
      radius_(fitting_radius(space_, radius)),
      log_volume_(log_unit_ball(space_.degrees()) + static_cast<double>(space_.degrees()) * std::log(radius_)) {
  if (!(radius > 0.0)) throw Fault("a ball needs a radius greater than 0");
}

void BallKernel::sample(View centre, Stream& stream, MutableView out) const {
  if (!space_.flat()) {
    sample_tangent(centre, stream, out);
    return;
  }
  const auto& axes = space_.axes();
  double sum = 0.0;
  for (std::size_t j = 0; j < axes.size(); ++j) {
    out[j] = stream.normal();
    sum += out[j] * out[j];
  }
  const double length = radius_ * std::pow(stream.uniform(), 1.0 / static_cast<double>(axes.size()));
  const double scale = sum > 0.0 ? length / std::sqrt(sum) : 0.0;
  for (std::size_t j = 0; j < axes.size(); ++j) out[j] = centre[j] + scale * out[j] / axes[j].weight;
  space_.reflect(out);
}

void BallKernel::sample_tangent(View centre, Stream& stream, MutableView out) const {
  std::vector<double> v(space_.degrees());
  double sum = 0.0;
  for (double& x : v) {
    x = stream.normal();
    sum += x * x;
  }
  const double length = radius_ * std::pow(stream.uniform(), 1.0 / static_cast<double>(v.size()));
  for (double& x : v) x *= sum > 0.0 ? length / std::sqrt(sum) : 0.0;
  space_.exp(centre, v, out);
  space_.reflect(out);
}

double BallKernel::density_in_tangent(View centre, View image) const {
  std::vector<double> v(space_.degrees());
  space_.log(centre, image, v);
  double sum = 0.0;
  for (const double x : v) sum += x * x;
  return sum <= radius_ * radius_ ? std::exp(-log_volume_ - space_.log_jacobian(v)) : 0.0;
}

double BallKernel::density(View centre, View q) const {
  if (!space_.flat()) {
    double sum = 0.0;
    for_each_mirror_image(space_, q, radius_, [&](View image) { sum += density_in_tangent(centre, image); });
    return sum;
  }
  const auto& axes = space_.axes();
  std::vector<double> c(axes.size());
  for (std::size_t j = 0; j < c.size(); ++j) c[j] = axes[j].weight * centre[j];
  int images = 0;
  for_each_image(space_, q, c.data(), c.data(), radius_, [&](const double* y) {
    double sum = 0.0;
    for (std::size_t j = 0; j < c.size(); ++j) sum += (y[j] - c[j]) * (y[j] - c[j]);
    if (sum <= radius_ * radius_) ++images;
  });
  return images * std::exp(-log_volume_);
}

Tube::Tube(const Space& space, Configurations path, double radius) : ball_(space, radius), path_(std::move(path)) {
  if (path_.empty()) throw Fault("a tube needs a path");
  at_.push_back(0.0);
  for (std::size_t i = 1; i < path_.size(); ++i) {
    at_.push_back(at_.back() + space.distance(std::as_const(path_)[i - 1], std::as_const(path_)[i]));
  }
  if (space.flat() || at_.back() == 0.0) return;
  constexpr double share = 0.25;  // of the radius
  spacing_ = at_.back() / std::ceil(at_.back() / (share * ball_.radius()));
}

double Tube::centre_at(double s) const {
  if (spacing_ == 0.0) return s;
  return std::min((std::floor(s / spacing_) + 0.5) * spacing_, at_.back());
}

void Tube::point(double s, MutableView out) const {
  if (path_.size() == 1 || at_.back() == 0.0) {
    std::copy(path_.front().begin(), path_.front().end(), out.begin());
    return;
  }
  const auto it = std::upper_bound(at_.begin() + 1, at_.end() - 1, s);
  const auto i = static_cast<std::size_t>(it - at_.begin()) - 1;
  const double span = at_[i + 1] - at_[i];
  const double t = span > 0.0 ? std::clamp((s - at_[i]) / span, 0.0, 1.0) : 0.0;
  ball_.space().interpolate(path_[i], path_[i + 1], t, out);
}

TubeDensity::TubeDensity(std::vector<Part> parts)
    : tube_(parts.front().tube),
      parts_(std::move(parts)),
      space_(tube_->ball().space()),
      radius_(tube_->ball().radius()),
      height_(std::exp(-tube_->ball().log_volume())) {}

TubeDensity::TubeDensity(std::shared_ptr<const Tube> tube, const Stretch& stretch)
    : tube_(std::move(tube)),
      stretch_(stretch),
      space_(tube_->ball().space()),
      radius_(tube_->ball().radius()),
      height_(std::exp(-tube_->ball().log_volume())) {}

void TubeDensity::index() const {
  if (!space_.flat()) {
    centres_ = std::make_unique<Centres>(space_);
    for_each_stretch([&](const auto& tube, const Stretch& stretch) { add_centres(*tube, stretch); });
    return;
  }
  for_each_stretch([&](const auto& tube, const Stretch& stretch) { add_legs(*tube, stretch); });
  if (legs_.empty()) return;
  std::vector<std::uint32_t> order(legs_.size());
  std::iota(order.begin(), order.end(), 0U);
  build(order, 0, static_cast<std::uint32_t>(order.size()));
  // Sorts the legs into the order of the tree's leaves.
  const std::size_t width = 2 * space_.dimension();
  std::vector<Leg> legs;
  std::vector<double> numbers;
  legs.reserve(legs_.size());
  numbers.reserve(numbers_.size());
  for (const std::uint32_t leg : order) {
    legs.push_back(legs_[leg]);
    const auto from = numbers_.begin() + static_cast<std::ptrdiff_t>(leg * width);
    numbers.insert(numbers.end(), from, from + static_cast<std::ptrdiff_t>(width));
  }
  legs_ = std::move(legs);
  numbers_ = std::move(numbers);
}

void TubeDensity::add_centres(const Tube& tube, const Stretch& stretch) const {
  Configuration centre(space_.dimension());
  const auto add = [&](double s, double mass) {
    tube.point(tube.centre_at(s), centre);
    centres_->index.add(centre);
    centres_->rows.push(centre);
    centres_->mass.push_back(mass);
  };
  const double spacing = tube.spacing();
  if (stretch.to <= stretch.from || spacing == 0.0) {
    add(stretch.from, stretch.mass);
    return;
  }
  const double rate = stretch.mass / (stretch.to - stretch.from);
  for (double k = std::floor(stretch.from / spacing); k * spacing < stretch.to; ++k) {
    const double from = std::max(stretch.from, k * spacing);
    const double to = std::min(stretch.to, (k + 1.0) * spacing);
    if (to > from) add((k + 0.5) * spacing, rate * (to - from));
  }
}

double TubeDensity::at_centres(View q) const {
  double sum = 0.0;
  std::vector<NearestIndex::Neighbour> near;
  for_each_mirror_image(space_, q, radius_, [&](View image) {
    centres_->index.within(image, radius_, near);
    for (const auto& centre : near) {
      sum +=
          centres_->mass[centre.id] * tube_->ball().density_in_tangent(std::as_const(centres_->rows)[centre.id], image);
    }
  });
  return sum;
}

void TubeDensity::add_legs(const Tube& tube, const Stretch& stretch) const {
  const auto& axes = space_.axes();
  const auto& at = tube.at();
  const std::size_t d = axes.size();
  std::vector<double> v(d);
  if (stretch.to <= stretch.from || tube.length() == 0.0) {
    tube.point(stretch.from, v);
    for (std::size_t j = 0; j < d; ++j) numbers_.push_back(axes[j].weight * v[j]);
    numbers_.insert(numbers_.end(), d, 0.0);
    legs_.push_back({0.0, stretch.mass});
    return;
  }
  const double rate = stretch.mass / (stretch.to - stretch.from);
  auto i = static_cast<std::size_t>(std::upper_bound(at.begin(), at.end(), stretch.from) - at.begin());
  for (i = std::max<std::size_t>(i, 1); i < at.size() && at[i - 1] < stretch.to; ++i) {
    const double span = at[i] - at[i - 1];
    const double from = std::max(stretch.from, at[i - 1]);
    const double to = std::min(stretch.to, at[i]);
    if (to <= from) continue;
    const View a = tube.path()[i - 1];
    space_.difference(a, tube.path()[i], v);
    for (std::size_t j = 0; j < d; ++j) {
      numbers_.push_back(axes[j].weight * (a[j] + (from - at[i - 1]) / span * v[j]));
    }
    for (std::size_t j = 0; j < d; ++j) numbers_.push_back(axes[j].weight * ((to - from) / span * v[j]));
    legs_.push_back({to - from, rate});
  }
}

std::uint32_t TubeDensity::build(std::vector<std::uint32_t>& order, std::uint32_t begin, std::uint32_t end) const {
  constexpr std::uint32_t leaf = 4;
  const std::size_t d = space_.dimension();
  const std::size_t width = 2 * d;
  const auto id = static_cast<std::uint32_t>(nodes_.size());
  nodes_.push_back({begin, end, 0});
  boxes_.insert(boxes_.end(), d, std::numeric_limits<double>::infinity());
  boxes_.insert(boxes_.end(), d, -std::numeric_limits<double>::infinity());
  double* box = &boxes_[id * width];
  for (std::uint32_t i = begin; i < end; ++i) {
    const double* p = &numbers_[order[i] * width];
    for (std::size_t j = 0; j < d; ++j) {
      box[j] = std::min({box[j], p[j], p[j] + p[d + j]});
      box[d + j] = std::max({box[d + j], p[j], p[j] + p[d + j]});
    }
  }
  if (end - begin <= leaf) return id;
  std::size_t axis = 0;
  for (std::size_t j = 1; j < d; ++j) {
    if (box[d + j] - box[j] > box[d + axis] - box[axis]) axis = j;
  }
  const auto middle = [&](std::uint32_t leg) {
    return numbers_[leg * width + axis] + 0.5 * numbers_[leg * width + d + axis];
  };
  const std::uint32_t half = begin + (end - begin) / 2;
  std::nth_element(order.begin() + begin, order.begin() + half, order.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) { return std::pair(middle(a), a) < std::pair(middle(b), b); });
  build(order, begin, half);
  const std::uint32_t right = build(order, half, end);
  nodes_[id].right = right;
  return id;
}

double TubeDensity::mass_near(const Leg& leg, const double* numbers, const double* y) const {
  // |u - t v|^2 <= r^2 for t in [t0, t1], u = y - p
  const std::size_t d = space_.dimension();
  double uv = 0.0;
  double uu = 0.0;
  for (std::size_t j = 0; j < d; ++j) {
    const double u = y[j] - numbers[j];
    uv += u * numbers[d + j];
    uu += u * u;
  }
  if (leg.length == 0.0) return uu <= radius_ * radius_ ? leg.rate : 0.0;
  const double vv = leg.length * leg.length;
  const double under = uv * uv - vv * (uu - radius_ * radius_);
  if (under <= 0.0) return 0.0;
  const double t0 = std::max(0.0, (uv - std::sqrt(under)) / vv);
  const double t1 = std::min(1.0, (uv + std::sqrt(under)) / vv);
  return t1 > t0 ? leg.rate * leg.length * (t1 - t0) : 0.0;
}

double TubeDensity::mass_near(const double* y) const {
  const std::size_t d = space_.dimension();
  const std::size_t width = 2 * d;
  double mass = 0.0;
  std::uint32_t at = 0;
  std::array<std::uint32_t, 32> waiting{};  // the tree is balanced: fewer than 2^32 legs give a depth of at most 32
  std::size_t height = 0;
  for (;;) {
    const double* box = &boxes_[at * width];
    double squared = 0.0;
    for (std::size_t j = 0; j < d; ++j) {
      const double gap = std::max({box[j] - y[j], y[j] - box[d + j], 0.0});
      squared += gap * gap;
    }
    const Node& node = nodes_[at];
    if (squared <= radius_ * radius_) {
      if (node.right != 0) {
        waiting[height++] = node.right;
        ++at;
        continue;
      }
      for (std::uint32_t i = node.begin; i < node.end; ++i) mass += mass_near(legs_[i], &numbers_[i * width], y);
    }
    if (height == 0) return mass;
    at = waiting[--height];
  }
}

double TubeDensity::at(View q) const {
  std::call_once(indexed_, [this] { index(); });
  if (centres_) return at_centres(q);
  if (legs_.empty()) return 0.0;
  double mass = 0.0;
  for_each_image(space_, q, boxes_.data(), boxes_.data() + space_.dimension(), radius_,
                 [&](const double* y) { mass += mass_near(y); });
  return mass * height_;
}

bool TubeDensity::mergeable(const Density& other) const {
  const auto* tubes = dynamic_cast<const TubeDensity*>(&other);
  return tubes != nullptr && tubes->radius_ == radius_ && tubes->space_ == space_;
}

std::shared_ptr<const Density> TubeDensity::sum(const std::vector<Term>& terms) const {
  std::vector<Part> all;
  std::unordered_map<const Tube*, std::size_t> places;
  for (const auto& term : terms) {
    dynamic_cast<const TubeDensity&>(*term.density).for_each_stretch([&](const auto& tube, Stretch stretch) {
      const auto [it, fresh] = places.try_emplace(tube.get(), all.size());
      if (fresh) all.push_back({tube, {}});
      stretch.mass *= term.weight;
      all[it->second].stretches.push_back(stretch);
    });
  }
  for (auto& part : all) part.stretches = added_up(part.stretches);
  return std::make_shared<TubeDensity>(std::move(all));
}

TubeKernel::TubeKernel(const Space& space, Configurations path, double radius)
    : tube_(std::make_shared<Tube>(space, std::move(path), radius)), centre_(space.dimension()) {
  activate(0.0, tube_->length());
}

void TubeKernel::activate(std::vector<std::pair<double, double>> stretches) {
  if (stretches.size() == 1) {
    activate(stretches.front().first, stretches.front().second);
    return;
  }
  active_ = std::move(stretches);
  active_length_ = 0.0;
  for (const auto& [from, to] : active_) active_length_ += to - from;
  std::vector<TubeDensity::Stretch> shares;
  for (const auto& [from, to] : active_) {
    if (active_length_ > 0.0) shares.push_back({from, to, (to - from) / active_length_});
  }
  if (shares.empty()) shares.push_back({active_.front().first, active_.front().first, 1.0});
  density_ = std::make_shared<TubeDensity>(std::vector<TubeDensity::Part>{{tube_, std::move(shares)}});
}

void TubeKernel::activate(double from, double to) {
  active_.assign(1, {from, to});
  active_length_ = to - from;
  const double end = active_length_ > 0.0 ? to : from;
  density_ = std::make_shared<TubeDensity>(tube_, TubeDensity::Stretch{from, end, 1.0});
}

void TubeKernel::sample(Stream& stream, MutableView out) {
  double s = stream.uniform(0.0, active_length_);
  double at = active_.front().first;
  for (const auto& [from, to] : active_) {
    at = std::min(from + s, to);
    if (s < to - from) break;
    s -= to - from;
  }
  tube_->point(tube_->centre_at(at), centre_);
  tube_->ball().sample(centre_, stream, out);
}

}  // namespace trellis
