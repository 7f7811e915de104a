// SPDX-License-Identifier: GPL-3.0-or-later
#include <trellis/base/version.hpp>

namespace trellis {

std::string version() { return TRELLIS_VERSION; }

}  // namespace trellis
