// SPDX-License-Identifier: GPL-3.0-or-later
// Clouds of the Point Cloud Library (PCD).
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include <trellis/reader/point_cloud_formats.hpp>

namespace trellis {

namespace {

struct Field {
  std::string name;
  std::size_t size = 4;
  char type = 'F';
  std::size_t count = 1;
  std::size_t offset = 0;  ///< in a row, in bytes; of a text in numbers

  [[nodiscard]] std::size_t bytes() const { return size * count; }
};

struct Header {
  std::vector<Field> fields;
  double width = 0.0, height = 1.0;
  std::optional<double> points;
  std::string data;
  std::size_t line = 0;
  std::size_t begin = 0;              ///< of the data, in bytes
  std::size_t row = 0;                ///< bytes
  std::array<std::size_t, 3> axes{};  ///< the fields x, y and z

  [[nodiscard]] std::size_t count() const { return static_cast<std::size_t>(*points); }
};

class HeaderReader {
 public:
  explicit HeaderReader(const MeshSource& source) : source_(source), lines_(source.text) {}

  Header read() {
    while (header_.data.empty()) {
      if (!lines_.next()) throw fault("the file ends before DATA");
      line();
    }
    header_.line = lines_.number();
    header_.begin = source_.text.size() - lines_.rest().size();
    finish();
    return std::move(header_);
  }

 private:
  [[nodiscard]] Error fault(const std::string& what) const { return source_.error(lines_.number(), what); }
  double natural(const char* what, double most) {
    const std::string_view word = take_word(lines_.here);
    const auto value = integer_in(word);
    if (!value || *value < 0 || static_cast<double>(*value) > most) {
      throw fault(fmt::format("{} must be an integer from 0 to {:.0f}, got {}", what, most, in_quotes(word)));
    }
    return static_cast<double>(*value);
  }
  /// Calls `set(field, word)` with one word for each field.
  template <class Set>
  void each(const char* what, const Set& set) {
    for (Field& field : header_.fields) {
      const std::string_view word = take_word(lines_.here);
      if (word.empty()) throw fault(fmt::format("{} has fewer entries than FIELDS", what));
      set(field, word);
    }
  }
  void line() {
    constexpr double most = 1e9;
    const std::string_view name = take_word(lines_.here);
    if (name.empty() || name.starts_with('#')) return;
    if (name == "VERSION" || name == "VIEWPOINT") return;
    if (name == "FIELDS" || name == "COLUMNS") {
      constexpr std::size_t most_fields = 1000;
      for (auto word = take_word(lines_.here); !word.empty(); word = take_word(lines_.here)) {
        if (header_.fields.size() == most_fields) throw fault(fmt::format("more than {} fields", most_fields));
        header_.fields.push_back({.name = std::string(word)});
      }
    } else if (name == "SIZE") {
      each("SIZE", [&](Field& field, std::string_view word) {
        const auto size = integer_in(word);
        if (!size || (*size != 1 && *size != 2 && *size != 4 && *size != 8)) {
          throw fault(fmt::format("the size of a field is 1, 2, 4 or 8, got {}", in_quotes(word)));
        }
        field.size = static_cast<std::size_t>(*size);
      });
    } else if (name == "TYPE") {
      each("TYPE", [&](Field& field, std::string_view word) {
        if (word != "F" && word != "I" && word != "U") {
          throw fault(fmt::format("the type of a field is F, I or U, got {}", in_quotes(word)));
        }
        field.type = word.front();
      });
    } else if (name == "COUNT") {
      each("COUNT", [&](Field& field, std::string_view word) {
        const auto count = integer_in(word);
        constexpr std::int64_t most_count = 10'000;
        if (!count || *count < 0 || *count > most_count) {
          throw fault(fmt::format("the count of a field is at most {}, got {}", most_count, in_quotes(word)));
        }
        field.count = static_cast<std::size_t>(*count);
      });
    } else if (name == "WIDTH") {
      header_.width = natural("WIDTH", most);
    } else if (name == "HEIGHT") {
      header_.height = natural("HEIGHT", most);
    } else if (name == "POINTS") {
      header_.points = natural("POINTS", most);
    } else if (name == "DATA") {
      header_.data = std::string(take_word(lines_.here));
      if (header_.data != "ascii" && header_.data != "binary" && header_.data != "binary_compressed") {
        throw fault(fmt::format("DATA is ascii, binary or binary_compressed, got {}", in_quotes(header_.data)));
      }
    } else {
      throw fault(fmt::format("expected a line of a PCD heading, got {}", in_quotes(name)));
    }
  }
  void finish() {
    if (!header_.points) header_.points = header_.width * header_.height;
    constexpr std::array<std::string_view, 3> names{"x", "y", "z"};
    std::size_t at = 0;
    for (Field& field : header_.fields) {
      field.offset = at;
      at += header_.data == "ascii" ? field.count : field.bytes();
      header_.row += field.bytes();
    }
    for (std::size_t k = 0; k < names.size(); ++k) {
      const auto found = std::find_if(header_.fields.begin(), header_.fields.end(),
                                      [&](const Field& field) { return field.name == names[k]; });
      if (found == header_.fields.end() || found->count != 1) {
        throw source_.error(0, fmt::format("the points need a field '{}' of count 1", names[k]));
      }
      header_.axes[k] = static_cast<std::size_t>(found - header_.fields.begin());
    }
  }

  const MeshSource& source_;
  Lines lines_;
  Header header_;
};

double number_at(const char* from, const Field& field) {
  std::uint64_t bits = 0;
  for (std::size_t i = field.size; i-- > 0;) bits = bits << 8U | static_cast<unsigned char>(from[i]);
  if (field.type == 'F') {
    if (field.size == sizeof(double)) return std::bit_cast<double>(bits);
    return double{std::bit_cast<float>(static_cast<std::uint32_t>(bits))};
  }
  if (field.type == 'U') return static_cast<double>(bits);
  const std::uint64_t sign = std::uint64_t{1} << (8 * field.size - 1);
  return static_cast<double>(static_cast<std::int64_t>((bits ^ sign) - sign));
}

/// Expands what LZF compressed: a byte below 32 is followed by so many bytes and one more, another one begins what
/// repeats earlier bytes: so many, from so far before.
std::optional<std::string> expanded(std::string_view from, std::size_t size) {
  std::string out;
  out.reserve(size);
  std::size_t at = 0;
  const auto left = [&] { return from.size() - at; };
  const auto take = [&] { return static_cast<unsigned char>(from[at++]); };
  while (left() > 0) {
    const std::size_t control = take();
    if (control < 32) {
      const std::size_t count = control + 1;
      if (left() < count || out.size() + count > size) return std::nullopt;
      out.append(from.substr(at, count));
      at += count;
      continue;
    }
    std::size_t count = control >> 5U;
    if (count == 7) {
      if (left() == 0) return std::nullopt;
      count += take();
    }
    if (left() == 0) return std::nullopt;
    const std::size_t back = ((control & 31U) << 8U | take()) + 1;
    count += 2;
    if (back > out.size() || out.size() + count > size) return std::nullopt;
    for (std::size_t i = 0; i < count; ++i) out.push_back(out[out.size() - back]);
  }
  return out.size() == size ? std::optional(std::move(out)) : std::nullopt;
}

void read_text(const MeshSource& source, const Header& header, PointSink& sink) {
  Lines lines(std::string_view(source.text).substr(header.begin));
  for (std::size_t i = 0; i < header.count();) {
    if (!lines.next()) {
      throw source.error(0, fmt::format("it declares {} points and has {}", header.count(), i));
    }
    std::array<double, 3> p{};
    std::size_t at = 0;
    std::size_t found = 0;
    for (auto word = take_word(lines.here); !word.empty(); word = take_word(lines.here), ++at) {
      for (std::size_t k = 0; k < p.size(); ++k) {
        if (header.fields[header.axes[k]].offset != at) continue;
        const auto value = number_in(word);
        if (!value) {
          throw source.error(header.line + lines.number(), fmt::format("expected a number, got {}", in_quotes(word)));
        }
        p[k] = *value;
        ++found;
      }
    }
    if (at == 0) continue;
    if (found < p.size()) throw source.error(header.line + lines.number(), "the line has fewer numbers than FIELDS");
    sink.add({p[0], p[1], p[2]}, header.line + lines.number());
    ++i;
  }
}

/// \param apart  whether all numbers of a field come before those of the next one
void read_bytes(const Header& header, std::string_view bytes, bool apart, PointSink& sink) {
  const std::size_t count = header.count();
  for (std::size_t i = 0; i < count; ++i) {
    std::array<double, 3> p{};
    for (std::size_t k = 0; k < p.size(); ++k) {
      const Field& field = header.fields[header.axes[k]];
      const std::size_t at = apart ? field.offset * count + i * field.size : i * header.row + field.offset;
      p[k] = number_at(bytes.data() + at, field);
    }
    sink.add({p[0], p[1], p[2]}, 0);
  }
}

}  // namespace

void read_pcd(const MeshSource& source, PointSink& sink) {
  const Header header = HeaderReader(source).read();
  sink.check_limit(*header.points, header.line);
  sink.format = header.data == "ascii" ? "PCD, ASCII" : header.data == "binary" ? "PCD, binary" : "PCD, compressed";
  if (header.data == "ascii") {
    read_text(source, header, sink);
    return;
  }
  const std::size_t size = header.count() * header.row;
  const std::string_view rest = std::string_view(source.text).substr(header.begin);
  for (const std::size_t axis : header.axes) {
    if (header.fields[axis].type == 'F' && header.fields[axis].size < sizeof(float)) {
      throw source.error(0, "a coordinate of type F has 4 or 8 bytes");
    }
  }
  if (header.data == "binary") {
    if (rest.size() < size) {
      throw source.error(
          0, fmt::format("its {} points take {} bytes, and {} follow the heading", header.count(), size, rest.size()));
    }
    read_bytes(header, rest, false, sink);
    return;
  }
  constexpr std::size_t heading = 8, largest = std::size_t{512} << 20U;
  const auto number = [&](std::size_t at) {
    std::size_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8U | static_cast<unsigned char>(rest[at + i]);
    return value;
  };
  if (rest.size() < heading) throw source.error(0, "the file ends before its compressed points");
  if (size > largest) throw source.error(0, fmt::format("its points take {} bytes, more than {}", size, largest));
  if (number(4) != size || rest.size() - heading < number(0)) {
    throw source.error(0, fmt::format("its {} points take {} bytes; it declares {}, compressed to {}, and {} follow",
                                      header.count(), size, number(4), number(0), rest.size() - heading));
  }
  const auto bytes = expanded(rest.substr(heading, number(0)), size);
  if (!bytes) throw source.error(0, "its compressed points are damaged");
  read_bytes(header, *bytes, true, sink);
}

}  // namespace trellis
