// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/report/pictures.hpp>

#include <trellis/report/report.hpp>

namespace trellis {

void write_picture(const draw::Canvas& canvas, const std::string& stem) {
  write_file(stem + ".svg", canvas.render(draw::Format::svg));
  write_file(stem + ".png", canvas.render(draw::Format::png));
  write_file(stem + ".pdf", canvas.render(draw::Format::pdf));
}

}  // namespace trellis
