// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/scene/precision.hpp>

#include <fmt/format.h>

#include <trellis/base/error.hpp>

namespace trellis {

void check_size(double size, double farthest, const char* name, const std::string& what) {
  const double least = least_size(farthest);
  if (size >= least) return;
  throw Error(fmt::format(
      "{}: its {} is {:g} m, below the precision of coordinates of up to {:g} m; expected at least {:.3g} m", what,
      name, size, farthest, least));
}

}  // namespace trellis
