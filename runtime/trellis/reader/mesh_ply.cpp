// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <trellis/reader/mesh_formats.hpp>
#include <trellis/reader/point_cloud_formats.hpp>

namespace trellis {

namespace {

enum class Encoding : std::uint8_t { ascii, little, big };

struct Number {
  std::size_t bytes = 0;
  bool real = false;
  bool negative = false;  ///< whether it has a sign
};

struct Property {
  std::string name;
  Number type;
  std::optional<Number> list;  ///< of a list: the type of its length
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct Header {
  Encoding encoding = Encoding::ascii;
  std::vector<Element> elements;
  std::size_t lines = 0;
  std::size_t bytes = 0;
};

std::optional<Number> type_named(std::string_view name) {
  static constexpr std::array<std::pair<std::string_view, Number>, 16> types{{{"char", {1, false, true}},
                                                                              {"int8", {1, false, true}},
                                                                              {"uchar", {1, false, false}},
                                                                              {"uint8", {1, false, false}},
                                                                              {"short", {2, false, true}},
                                                                              {"int16", {2, false, true}},
                                                                              {"ushort", {2, false, false}},
                                                                              {"uint16", {2, false, false}},
                                                                              {"int", {4, false, true}},
                                                                              {"int32", {4, false, true}},
                                                                              {"uint", {4, false, false}},
                                                                              {"uint32", {4, false, false}},
                                                                              {"float", {4, true, true}},
                                                                              {"float32", {4, true, true}},
                                                                              {"double", {8, true, true}},
                                                                              {"float64", {8, true, true}}}};
  const auto* const type = std::find_if(types.begin(), types.end(), [&](const auto& t) { return t.first == name; });
  return type == types.end() ? std::nullopt : std::optional(type->second);
}

/// Reads the heading of a file.
class HeaderReader {
 public:
  explicit HeaderReader(const MeshSource& source) : source_(source), lines_(source.text) {}

  Header read() {
    next("'ply'");
    if (const auto word = take(); word != "ply") throw fault(fmt::format("expected 'ply', got {}", in_quotes(word)));
    format();
    while (true) {
      next("'end_header'");
      const std::string_view word = take();
      if (word == "end_header") break;
      if (word.empty() || word == "comment" || word == "obj_info") continue;
      if (word == "element") {
        element();
      } else if (word == "property") {
        property();
      } else {
        throw fault(fmt::format("expected 'element', 'property', 'comment' or 'end_header', got {}", in_quotes(word)));
      }
    }
    header_.lines = lines_.number();
    header_.bytes = source_.text.size() - lines_.rest().size();
    return std::move(header_);
  }

 private:
  std::string_view take() { return take_word(lines_.here); }
  [[nodiscard]] Error fault(const std::string& what) const { return source_.error(lines_.number(), what); }
  void next(const char* expected) {
    if (!lines_.next()) throw fault(fmt::format("the file ends before {}", expected));
  }
  void format() {
    next("'format'");
    const std::string_view word = take(), encoding = take(), version = take();
    if (encoding == "ascii") {
      header_.encoding = Encoding::ascii;
    } else if (encoding == "binary_little_endian") {
      header_.encoding = Encoding::little;
    } else {
      header_.encoding = Encoding::big;
    }
    if (word != "format" || version != "1.0" ||
        (header_.encoding == Encoding::big && encoding != "binary_big_endian")) {
      throw fault("expected 'format ascii 1.0', 'format binary_little_endian 1.0' or 'format binary_big_endian 1.0'");
    }
  }
  void element() {
    constexpr std::size_t most_elements = 100;
    const std::string_view name = take(), word = take();
    const auto count = integer_in(word);
    if (!count || *count < 0)
      throw fault(fmt::format("expected the number of {} elements, got {}", in_quotes(name), in_quotes(word)));
    if (header_.elements.size() == most_elements) throw fault(fmt::format("more than {} elements", most_elements));
    header_.elements.push_back({std::string(name), static_cast<std::uint64_t>(*count), {}});
  }
  Number type() {
    const std::string_view name = take();
    const auto found = type_named(name);
    if (!found) throw fault(fmt::format("{} is no type of a PLY file", in_quotes(name)));
    return *found;
  }
  void property() {
    constexpr std::size_t most_properties = 1000;
    if (header_.elements.empty()) throw fault("a property before the first element");
    auto& properties = header_.elements.back().properties;
    if (properties.size() == most_properties) throw fault(fmt::format("more than {} properties", most_properties));
    Property made;
    std::string_view rest = lines_.here;
    if (take_word(rest) == "list") {
      lines_.here = rest;
      made.list = type();
      if (made.list->real) throw fault("the length of a list must be of an integer type");
    }
    made.type = type();
    made.name = std::string(take());
    properties.push_back(std::move(made));
  }

  const MeshSource& source_;
  Lines lines_;
  Header header_;
};

/// The numbers after the heading, one after another.
class Values {
 public:
  Values(const MeshSource& source, const Header& header)
      : source_(source), encoding_(header.encoding), at_(header.bytes), line_(header.lines) {}

  /// The line of the last number, 0 in a binary file.
  [[nodiscard]] std::size_t line() const { return encoding_ == Encoding::ascii ? line_ : 0; }
  [[nodiscard]] std::size_t left() const { return source_.text.size() - at_; }
  [[nodiscard]] Error fault(const std::string& what) const {
    return encoding_ == Encoding::ascii ? source_.error(line_, what) : source_.error_at_byte(at_, what);
  }
  double next(const Number& type) { return encoding_ == Encoding::ascii ? next_word(type) : next_bytes(type); }

 private:
  double next_word(const Number& type) {
    while (words_.empty()) {
      const std::size_t end = std::min(source_.text.find('\n', at_), source_.text.size());
      if (at_ == source_.text.size()) throw fault("the file ends too early");
      words_ = std::string_view(source_.text).substr(at_, end - at_);
      at_ = std::min(end + 1, source_.text.size());
      ++line_;
      std::string_view rest = words_;
      if (take_word(rest).empty()) words_ = {};
    }
    const std::string_view word = take_word(words_);
    std::string_view rest = words_;
    if (take_word(rest).empty()) words_ = {};
    const auto value = number_in(word);
    if (!value) throw fault(fmt::format("expected a number, got {}", in_quotes(word)));
    if (!type.real && !(*value >= -2147483648.0 && *value < 4294967296.0 &&
                        *value == static_cast<double>(static_cast<std::int64_t>(*value)))) {
      throw fault(fmt::format("expected an integer, got {}", in_quotes(word)));
    }
    return *value;
  }
  double next_bytes(const Number& type) {
    if (left() < type.bytes) throw fault("the file ends too early");
    std::array<unsigned char, 8> bytes{};
    std::memcpy(bytes.data(), source_.text.data() + at_, type.bytes);
    at_ += type.bytes;
    if (encoding_ == Encoding::big)
      std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(type.bytes));
    std::uint64_t bits = 0;
    for (std::size_t i = type.bytes; i-- > 0;) bits = bits << 8U | bytes[i];
    if (type.real) {
      if (type.bytes == sizeof(double)) return std::bit_cast<double>(bits);
      return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
    }
    const std::uint64_t sign = std::uint64_t{1} << (8 * type.bytes - 1);
    const auto value = static_cast<double>(bits);
    return type.negative && bits >= sign ? value - 2.0 * static_cast<double>(sign) : value;
  }

  const MeshSource& source_;
  Encoding encoding_;
  std::size_t at_;
  std::size_t line_;
  std::string_view words_;
};

/// Refuses an element with more rows than the rest of the file has bytes for.
void check_room(const Element& element, const Header& header, const Values& values) {
  if (element.properties.empty() && element.count > 0) {
    throw values.fault(fmt::format("element '{}' has no properties", element.name));
  }
  double row = 0.0;
  for (const Property& property : element.properties) {
    // In ASCII a digit and a blank, which the last one may lack.
    const Number& number = property.list ? *property.list : property.type;
    row += header.encoding == Encoding::ascii ? 2.0 : static_cast<double>(number.bytes);
  }
  if (static_cast<double>(element.count) * row > static_cast<double>(values.left()) + 1.0) {
    throw values.fault(
        fmt::format("the file declares {} elements {}, which take at least {:.0f} bytes, but {} are left",
                    element.count, in_quotes(element.name), static_cast<double>(element.count) * row, values.left()));
  }
}

std::size_t length_of(const Property& property, Values& values) {
  if (!property.list) return 1;
  const double length = values.next(*property.list);
  if (!(length >= 0.0)) throw values.fault(fmt::format("a list of length {}", length));
  return static_cast<std::size_t>(length);
}

void skip(const Property& property, Values& values) {
  for (std::size_t n = length_of(property, values); n > 0; --n) static_cast<void>(values.next(property.type));
}

/// \param add  receives each vertex and its line
template <class Add>
void read_vertices(const MeshSource& source, const Element& element, Values& values, const Add& add) {
  constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
  for (const std::string_view name : names) {
    const auto same = [&](const Property& p) { return p.name == name && !p.list; };
    if (std::count_if(element.properties.begin(), element.properties.end(), same) != 1) {
      throw source.error(0, fmt::format("the vertices need one property '{}'", name));
    }
  }
  for (std::uint64_t i = 0; i < element.count; ++i) {
    std::array<double, 3> v{};
    for (const Property& property : element.properties) {
      const auto* const axis = std::find(names.begin(), names.end(), property.name);
      if (axis == names.end() || property.list) {
        skip(property, values);
      } else {
        v[static_cast<std::size_t>(axis - names.begin())] = values.next(property.type);
      }
    }
    add(Vec3{v[0], v[1], v[2]}, values.line());
  }
}

void skip_rows(const Element& element, Values& values) {
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) skip(property, values);
  }
}

bool is_indices(const Property& property) {
  return property.list && (property.name == "vertex_indices" || property.name == "vertex_index");
}

void read_faces(const MeshSource& source, const Element& element, Values& values, Polygons& polygons) {
  if (std::count_if(element.properties.begin(), element.properties.end(), is_indices) != 1) {
    throw source.error(0, "the faces need one list property 'vertex_indices' or 'vertex_index'");
  }
  std::vector<std::uint32_t> corners;
  for (std::uint64_t i = 0; i < element.count; ++i) {
    for (const Property& property : element.properties) {
      if (!is_indices(property)) {
        skip(property, values);
        continue;
      }
      if (property.type.real) throw source.error(0, "the indices of vertices must be of an integer type");
      const std::size_t length = length_of(property, values);
      if (length > most_corners) {
        throw values.fault(fmt::format("polygon {} has {} vertices; it needs 3 to {}", i + 1, length, most_corners));
      }
      corners.clear();
      for (std::size_t k = 0; k < length; ++k) {
        const auto index = static_cast<std::int64_t>(values.next(property.type));
        corners.push_back(polygons.vertex(index, 0, values.line()));
      }
      polygons.add(corners, values.line());
    }
  }
}

}  // namespace

void read_ply(const MeshSource& source, Polygons& polygons) {
  const Header header = HeaderReader(source).read();
  polygons.format = header.encoding == Encoding::ascii ? "PLY, ASCII" : "PLY, binary";
  Values values(source, header);
  // All limits before any row is read.
  for (const Element& element : header.elements) {
    const auto count = static_cast<double>(element.count);
    if (element.name == "vertex" || element.name == "face") {
      polygons.check_limits(element.name == "vertex" ? count : 0.0, element.name == "face" ? count : 0.0, 0);
    }
    if (element.name == "tristrips") throw source.error(0, "strips of triangles are not read; export faces");
  }
  bool faces = false;
  for (const Element& element : header.elements) {
    check_room(element, header, values);
    if (element.name == "vertex") {
      read_vertices(source, element, values, [&](const Vec3& v, std::size_t line) { polygons.add_vertex(v, line); });
    } else if (element.name == "face") {
      faces = true;
      read_faces(source, element, values, polygons);
    } else {
      skip_rows(element, values);
    }
  }
  if (!faces) {
    throw source.error(0,
                       "it has no faces: it is a cloud of points, which point_cloud { \"FILE\", radius = 0.01 } reads");
  }
}

void read_ply_points(const MeshSource& source, PointSink& sink) {
  const Header header = HeaderReader(source).read();
  sink.format = header.encoding == Encoding::ascii ? "PLY, ASCII" : "PLY, binary";
  Values values(source, header);
  for (const Element& element : header.elements) {
    if (element.name == "vertex") sink.check_limit(static_cast<double>(element.count), 0);
  }
  for (const Element& element : header.elements) {
    check_room(element, header, values);
    if (element.name == "vertex") {
      read_vertices(source, element, values, [&](const Vec3& v, std::size_t line) { sink.add(v, line); });
      return;
    }
    skip_rows(element, values);
  }
  throw source.error(0, "it has no vertices");
}

}  // namespace trellis
