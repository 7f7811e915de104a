// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include <trellis/draw/canvas.hpp>

namespace trellis {

/// Writes STEM.svg, STEM.png and STEM.pdf. Throws Error where one cannot be written.
void write_picture(const draw::Canvas& canvas, const std::string& stem);

}  // namespace trellis
