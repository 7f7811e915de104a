// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/reader/svg_path.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <string>

#include <trellis/base/error.hpp>
#include <trellis/scene/limits.hpp>

namespace trellis {

namespace {

constexpr int chords = 32;

/// Numbers, commas and letters of an attribute, one after the other.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : text_(text) {}

  [[nodiscard]] bool at_end() {
    skip();
    return at_ == text_.size();
  }
  /// The next character that is no separator.
  [[nodiscard]] char peek() { return at_end() ? '\0' : text_[at_]; }
  char take() {
    const char c = peek();
    if (c != '\0') ++at_;
    return c;
  }
  [[nodiscard]] bool at_number() {
    const char c = peek();
    return (c >= '0' && c <= '9') || c == '-' || c == '+' || c == '.';
  }
  double number() {
    skip();
    const std::size_t begin = at_;
    if (at_ < text_.size() && text_[at_] == '+') ++at_;
    double value = 0.0;
    const auto [end, fault] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), value);
    if (fault != std::errc() || !std::isfinite(value) || std::abs(value) > most_distant) {
      constexpr std::size_t shown = 12;
      throw Error(
          fmt::format("'{}' where a number of at most {:g} is expected", text_.substr(begin, shown), most_distant));
    }
    at_ = static_cast<std::size_t>(end - text_.data());
    return value;
  }
  /// The flags of an arc need no separator: "0 01-5,3".
  bool flag() {
    const char c = take();
    if (c != '0' && c != '1') throw Error("a flag of an arc is neither 0 nor 1");
    return c == '1';
  }
  std::string word() {
    std::string word;
    while (at_ < text_.size() && std::isalpha(static_cast<unsigned char>(text_[at_])) != 0) word += text_[at_++];
    return word;
  }

 private:
  void skip() {
    while (at_ < text_.size() && (std::isspace(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == ',')) {
      ++at_;
    }
  }

  std::string_view text_;
  std::size_t at_ = 0;
};

class PathReader {
 public:
  explicit PathReader(std::string_view text) : in_(text) {}

  std::vector<Vec2> points() {
    if (in_.at_end()) return {};
    if (in_.peek() != 'm' && in_.peek() != 'M') throw Error("path data begin with M or m");
    char command = '\0';
    while (!in_.at_end()) {
      if (!in_.at_number()) {
        command = in_.take();
      } else if (command == 'z' || command == 'Z') {
        throw Error("a number after z, expected a command");
      }
      step(command);
      if (command == 'M') command = 'L';
      if (command == 'm') command = 'l';
      if (points_.size() > most_vertices) throw Error(fmt::format("a path has more than {} points", most_vertices));
    }
    return std::move(points_);
  }

 private:
  void step(char command) {
    const bool relative = command >= 'a';
    const Vec2 from = relative ? now_ : Vec2{};
    switch (std::toupper(static_cast<unsigned char>(command))) {
      case 'M': to(begin_ = from + point()); break;
      case 'L': to(from + point()); break;
      case 'H': to({from.x + in_.number(), now_.y}); break;
      case 'V': to({now_.x, from.y + in_.number()}); break;
      case 'Z': to(begin_); break;
      case 'C': cubic(from + point(), from, command); return;
      case 'S': cubic(smooth_ == 'C' ? mirrored() : now_, from, command); return;
      case 'Q': quadratic(from + point(), from); return;
      case 'T': quadratic(smooth_ == 'Q' ? mirrored() : now_, from); return;
      case 'A': arc(from); break;
      default: throw Error(fmt::format("'{}' is no command of path data", printable(command)));
    }
    smooth_ = '\0';
  }

  static std::string printable(char c) {
    return c > ' ' && c < '\x7F' ? std::string(1, c) : fmt::format("byte {}", static_cast<unsigned char>(c));
  }

  Vec2 point() {
    const double x = in_.number();
    return {x, in_.number()};
  }
  void to(Vec2 p) {
    if (!in_range(p)) throw Error(fmt::format("a point farther than {:g} from the origin", most_distant));
    points_.push_back(now_ = p);
  }
  [[nodiscard]] Vec2 mirrored() const { return now_ + (now_ - control_); }

  void cubic(Vec2 a, Vec2 from, char /*command*/) {
    const Vec2 begin = now_;
    const Vec2 b = from + point();
    const Vec2 end = from + point();
    for (int i = 1; i <= chords; ++i) {
      const double t = static_cast<double>(i) / chords;
      const double s = 1.0 - t;
      to(s * s * s * begin + 3.0 * s * s * t * a + 3.0 * s * t * t * b + t * t * t * end);
    }
    control_ = b;
    smooth_ = 'C';
  }

  void quadratic(Vec2 a, Vec2 from) {
    const Vec2 begin = now_;
    const Vec2 end = from + point();
    for (int i = 1; i <= chords; ++i) {
      const double t = static_cast<double>(i) / chords;
      const double s = 1.0 - t;
      to(s * s * begin + 2.0 * s * t * a + t * t * end);
    }
    control_ = a;
    smooth_ = 'Q';
  }

  /// An elliptical arc, as the specification computes its centre (appendix B.2.4).
  void arc(Vec2 from) {
    const Vec2 begin = now_;
    double rx = std::abs(in_.number());
    double ry = std::abs(in_.number());
    const double turn = in_.number() * std::numbers::pi / 180.0;
    const bool large = in_.flag();
    const bool sweep = in_.flag();
    const Vec2 end = from + point();
    if (rx == 0.0 || ry == 0.0 || begin == end) return to(end);
    const double c = std::cos(turn);
    const double s = std::sin(turn);
    const Vec2 half = 0.5 * (begin - end);
    const Vec2 p{c * half.x + s * half.y, c * half.y - s * half.x};
    const double needed = std::hypot(p.x / rx, p.y / ry);
    if (needed > 1.0) {
      rx *= needed;
      ry *= needed;
    }
    const double part = (p.x / rx) * (p.x / rx) + (p.y / ry) * (p.y / ry);
    const double factor = (large == sweep ? -1.0 : 1.0) * std::sqrt(std::max(0.0, 1.0 / part - 1.0));
    const Vec2 q{factor * rx * p.y / ry, -factor * ry * p.x / rx};
    const Vec2 middle = 0.5 * (begin + end) + Vec2{c * q.x - s * q.y, s * q.x + c * q.y};
    const double first = std::atan2((p.y - q.y) / ry, (p.x - q.x) / rx);
    double turned = std::atan2((-p.y - q.y) / ry, (-p.x - q.x) / rx) - first;
    if (sweep && turned < 0.0) turned += 2.0 * std::numbers::pi;
    if (!sweep && turned > 0.0) turned -= 2.0 * std::numbers::pi;
    for (int i = 1; i < chords; ++i) {
      const double angle = first + turned * i / chords;
      const Vec2 on{rx * std::cos(angle), ry * std::sin(angle)};
      to(middle + Vec2{c * on.x - s * on.y, s * on.x + c * on.y});
    }
    to(end);
  }

  Scanner in_;
  std::vector<Vec2> points_;
  Vec2 now_;
  Vec2 begin_;
  Vec2 control_;
  char smooth_ = '\0';  ///< the kind of curve before, which S and T continue
};

SvgTransform rotation(double degrees) {
  const double angle = degrees * std::numbers::pi / 180.0;
  return {std::cos(angle), std::sin(angle), -std::sin(angle), std::cos(angle), 0.0, 0.0};
}

SvgTransform transform_of(const std::string& name, const std::vector<double>& v) {
  const auto expect = [&](std::initializer_list<std::size_t> counts) {
    if (std::find(counts.begin(), counts.end(), v.size()) != counts.end()) return;
    throw Error(
        fmt::format("'{}' of a transform has {} numbers, expected {}", name, v.size(), fmt::join(counts, " or ")));
  };
  if (name == "translate") {
    expect({1, 2});
    return {1.0, 0.0, 0.0, 1.0, v[0], v.size() > 1 ? v[1] : 0.0};
  }
  if (name == "scale") {
    expect({1, 2});
    return {v[0], 0.0, 0.0, v.back(), 0.0, 0.0};
  }
  if (name == "rotate") {
    expect({1, 3});
    if (v.size() == 1) return rotation(v[0]);
    return SvgTransform{1.0, 0.0, 0.0, 1.0, v[1], v[2]}.after(rotation(v[0])).after({1.0, 0.0, 0.0, 1.0, -v[1], -v[2]});
  }
  if (name == "matrix") {
    expect({6});
    return {v[0], v[1], v[2], v[3], v[4], v[5]};
  }
  if (name == "skewX" || name == "skewY") {
    expect({1});
    const double slope = std::tan(v[0] * std::numbers::pi / 180.0);
    return name == "skewX" ? SvgTransform{1.0, 0.0, slope, 1.0, 0.0, 0.0}
                           : SvgTransform{1.0, slope, 0.0, 1.0, 0.0, 0.0};
  }
  throw Error(fmt::format("'{}' is no transform, expected matrix, translate, scale, rotate, skewX or skewY", name));
}

}  // namespace

SvgTransform SvgTransform::after(const SvgTransform& inner) const {
  return {a * inner.a + c * inner.b, b * inner.a + d * inner.b,     a * inner.c + c * inner.d,
          b * inner.c + d * inner.d, a * inner.e + c * inner.f + e, b * inner.e + d * inner.f + f};
}

SvgTransform svg_transform(std::string_view text) {
  Scanner in(text);
  SvgTransform all;
  while (!in.at_end()) {
    const std::string name = in.word();
    if (in.take() != '(') throw Error(fmt::format("'{}' where a transform as translate(1, 2) is expected", text));
    std::vector<double> numbers;
    constexpr std::size_t most = 6;
    while (in.at_number() && numbers.size() <= most) numbers.push_back(in.number());
    if (in.take() != ')') throw Error(fmt::format("no ')' after the numbers of '{}'", name));
    all = all.after(transform_of(name, numbers));
  }
  return all;
}

std::vector<Vec2> svg_path(std::string_view text) { return PathReader(text).points(); }

std::vector<double> svg_numbers(std::string_view text) {
  Scanner in(text);
  std::vector<double> numbers;
  while (!in.at_end()) {
    numbers.push_back(in.number());
    if (numbers.size() > 2 * most_vertices) throw Error(fmt::format("more than {} points", most_vertices));
  }
  return numbers;
}

}  // namespace trellis
