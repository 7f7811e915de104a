// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include <trellis/draw/canvas.hpp>

/// The layout that all pictures share: texts, margins, and the rows of a legend.
namespace trellis::draw::page {

inline constexpr Font title_font{.size = 10.0, .bold = true};
inline constexpr Font panel_font{.size = 8.0, .bold = true};
inline constexpr Font label_font{.size = 8.0};
inline constexpr Font tick_font{.size = 7.0};
inline constexpr Font legend_font{.size = 7.5};
inline constexpr Font caption_font{.size = 7.5};

inline constexpr double border = 6.0;
inline constexpr double gap = 12.0;  ///< between panels
inline constexpr double swatch = 16.0;

double line_height(const Font& font);
double block_height(const std::vector<std::string>& lines, const Font& font);
/// Returns no line for an empty text.
std::vector<std::string> wrapped(const std::string& text, double width, const Font& font, std::size_t most);
/// Draws lines below each other, with the top of the first one at the given point.
void block(Canvas& canvas, const std::vector<std::string>& lines, Point at, TextStyle style);

/// Returns the width of a legend's entry with this name, including its symbol.
double entry_width(const std::string& name);
/// Draws the name of an entry beside its symbol, which starts at `at.x` and has the width of a swatch; `at` is the top
/// left.
void entry_name(Canvas& canvas, const std::string& name, Point at);

/// Rows of a legend above the panels: the position of each entry, relative to the legend's top left.
struct LegendRows {
  std::vector<Point> at;
  double height = 0.0;
};
LegendRows flow(const std::vector<std::string>& names, double width);

}  // namespace trellis::draw::page
