// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/draw/page.hpp>

#include <trellis/draw/text.hpp>

namespace trellis::draw::page {

double line_height(const Font& font) { return text_extents("", font).height(); }

double block_height(const std::vector<std::string>& lines, const Font& font) {
  return static_cast<double>(lines.size()) * line_height(font);
}

std::vector<std::string> wrapped(const std::string& text, double width, const Font& font, std::size_t most) {
  if (text.empty()) return {};
  return wrap_text(text, width, font, most);
}

void block(Canvas& canvas, const std::vector<std::string>& lines, Point at, TextStyle style) {
  style.stand = Stand::top;
  for (const auto& line : lines) {
    canvas.text(line, at, style);
    at.y += line_height(style.font);
  }
}

double entry_width(const std::string& name) { return swatch + 4.0 + text_extents(name, legend_font).width; }

void entry_name(Canvas& canvas, const std::string& name, Point at) {
  canvas.text(name, {at.x + swatch + 4.0, at.y + 0.5 * line_height(legend_font)},
              {legend_font, palette::ink, Align::left, Stand::middle});
}

LegendRows flow(const std::vector<std::string>& names, double width) {
  LegendRows rows;
  rows.at.reserve(names.size());
  constexpr double apart = 14.0;
  const double line = line_height(legend_font) + 2.0;
  Point at;
  for (const auto& name : names) {
    const double needed = entry_width(name);
    if (at.x > 0.0 && at.x + needed > width) at = {0.0, at.y + line};
    rows.at.push_back(at);
    at.x += needed + apart;
  }
  rows.height = names.empty() ? 0.0 : at.y + line + 4.0;
  return rows;
}

}  // namespace trellis::draw::page
